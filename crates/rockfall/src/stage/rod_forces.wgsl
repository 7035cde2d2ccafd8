// rod_forces
