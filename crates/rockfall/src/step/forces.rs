//! Forces on rods. The stages of `integrate` evaluate the forces on spheres.

pub(crate) mod rod_forces;
