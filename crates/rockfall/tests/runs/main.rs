//! Runs of whole scenes: rest, conservation, symmetry, warnings, and the amount of work.

#[path = "../common/mod.rs"]
#[macro_use]
mod common;

mod behaviour;
mod flow;
mod machines;
mod placement;
mod properties;
mod scenes;
mod silent;
mod stability;
mod work;
