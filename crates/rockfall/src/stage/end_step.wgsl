// end_step
