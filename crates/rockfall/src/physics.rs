//! The formulas of docs/physics, in Rust for the CPU backend and in WGSL for the kernels.
//!
//! Both versions are written from the specification. Neither is a translation of the other, so a comparison of their results
//! finds mistakes in either.

pub(crate) mod balls;
pub(crate) mod chain;
pub(crate) mod collision;
pub(crate) mod contact;
pub(crate) mod fine_geometry;
pub(crate) mod first_contact;
pub(crate) mod forces;
pub(crate) mod friction_impulses;
pub(crate) mod geometry;
pub(crate) mod laws;
pub(crate) mod lengths;
pub(crate) mod motions;
pub(crate) mod pairs;
pub(crate) mod passage;
pub(crate) mod rigid;
pub(crate) mod rod_polygon;
pub(crate) mod rounding;
pub(crate) mod servo;
pub(crate) mod side;
pub(crate) mod sides;
pub(crate) mod smooth;
pub(crate) mod surface;
pub(crate) mod touch;
pub(crate) mod travel;
pub(crate) mod walls;
