//! Many steps of a small scene in one dispatch.

pub(crate) mod run_steps;
#[cfg(feature = "gpu")]
pub(crate) mod run_worlds;
pub(crate) mod small_positions;
