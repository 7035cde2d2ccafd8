//! Rigid bodies.

pub(crate) mod move_bodies;
