//! Many steps of a small scene in one dispatch.

pub(crate) mod run_steps;
#[cfg_attr(
    any(not(feature = "gpu"), target_family = "wasm"),
    allow(dead_code, reason = "only the native GPU backend runs worlds")
)]
pub(crate) mod run_worlds;
pub(crate) mod small_positions;
