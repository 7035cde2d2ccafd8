//! The step as one ordered list of stages, run by either backend.
//!
//! A stage is a pair of files of one name, in the folder of its phase: `NAME.rs` says what it does, declares its bindings and
//! holds the CPU twin; `NAME.wgsl` is the kernel. [`schedule`] is the step's table of contents.
//!
//! This module is public for tools and tests; it may change between minor versions.

pub(crate) mod aabbs;
pub(crate) mod bodies;
pub(crate) mod broad_phase;
pub mod catalog;
pub(crate) mod collisions;
pub(crate) mod forces;
pub(crate) mod fused;
pub(crate) mod integrate;
pub mod moves;
pub mod prune;
pub(crate) mod reorder;
pub mod schedule;
pub mod stage;
pub(crate) mod traffic;
pub(crate) mod walls;
pub mod wgsl;
