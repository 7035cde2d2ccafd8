// end_collisions
