//! Small scenes: many steps of many worlds in one dispatch, and steps on one thread of the CPU.

#[cfg_attr(
    any(not(feature = "gpu"), target_family = "wasm"),
    allow(dead_code, reason = "only the native GPU backend runs worlds")
)]
pub(crate) mod run_worlds;
pub(crate) mod small_positions;
