// update_aabbs
