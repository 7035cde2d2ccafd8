// find_collisions
