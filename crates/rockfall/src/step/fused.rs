//! Many steps of a small scene in one dispatch.

pub(crate) mod run_steps;
pub(crate) mod small_positions;
