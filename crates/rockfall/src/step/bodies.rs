//! Rigid bodies.

pub(crate) mod move_bodies;
pub(crate) mod push_bodies;
