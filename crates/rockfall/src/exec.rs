//! What runs a schedule: the CPU, or a GPU.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
