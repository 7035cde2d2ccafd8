//! What must not change a result: threads, memory, devices, checkpoints, edits and optimizations.

#[path = "../common/mod.rs"]
#[macro_use]
mod common;

mod adapter;
mod broad_phase;
mod checkpoint;
mod chunks;
mod constants;
mod determinism;
mod device;
mod exchange;
mod limits;
mod optimizations;
mod shared_memory;
