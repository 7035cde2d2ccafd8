// apply_collisions
