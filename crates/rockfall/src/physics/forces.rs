//! Forces on spheres and rods (docs/physics.md section 4).

pub(crate) mod net_force;
