//! Forces on rods. The stages of `integrate` evaluate the forces on spheres.

pub(crate) mod law_forces;
pub(crate) mod rod_forces;
