//! The formulas of docs/physics.md: the CPU backend's in Rust, the kernels' in the WGSL files beside them.
//!
//! Either side is written from the specification and never translated from the other, so that the two can catch each other.

pub(crate) mod balls;
pub(crate) mod collision;
pub(crate) mod contact;
pub(crate) mod forces;
pub(crate) mod friction_impulses;
pub(crate) mod geometry;
pub(crate) mod lengths;
pub(crate) mod side;
pub(crate) mod touch;
pub(crate) mod travel;
