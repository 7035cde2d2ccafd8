//! The backends that run a schedule of stages: CPU and GPU.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
