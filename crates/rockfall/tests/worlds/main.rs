//! Many worlds side by side.

#[path = "../common/mod.rs"]
#[macro_use]
mod common;

mod broken;
mod checkpoint;
mod hard;
mod observe;
mod pairs;
mod sampled;
mod shared;
mod sleep;
#[cfg(feature = "gpu")]
#[path = "../common/verdicts.rs"]
mod verdicts;
mod walls;
mod worlds;
