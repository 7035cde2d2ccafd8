//! Forces on rods; those on spheres are evaluated by the stages of `integrate`.

pub(crate) mod rod_forces;
