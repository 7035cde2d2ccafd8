// weigh_collisions
