//! The wgpu backend: the stages' kernels, run on any GPU that wgpu can drive.
//!
//! [`Gpu`] is an opened device with its compiled kernels, [`GpuWorld`] the buffers of one [`World`](crate::model::world::World) on
//! it. Nothing here waits for the device but `async` functions, and [`block_on`], which native callers drive those with.
//!
//! This module is public for tools and tests; it may change between minor versions.

mod array;
mod check;
mod device;
mod fault;
mod fuse;
mod kernel;
mod memory;
mod split;
mod submit;
mod timer;
mod transfer;
mod wait;
mod world;

pub use device::{Gpu, adapters, instance};
pub use fault::catch;
pub use kernel::{join, locate_lines};
pub use split::{Split, split};
pub(crate) use timer::{clock, copy_bandwidth};
pub(crate) use wait::Mapped;
#[cfg(not(target_arch = "wasm32"))]
pub use wait::block_on;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use wait::drive;
pub use world::GpuWorld;
