// leap
