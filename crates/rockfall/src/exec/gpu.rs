//! The wgpu backend: runs the kernels of the stages on any GPU that wgpu supports.
//!
//! [`Gpu`] is an opened device with its compiled kernels. [`GpuWorld`] holds the buffers of one
//! [`World`](crate::model::world::World) on that device. Only the `async` functions here wait for the device, and [`block_on`],
//! which drives them for native callers.
//!
//! This module is public for tools and tests. It may change between minor versions.

mod array;
mod check;
mod copiers;
mod device;
mod early;
mod exchange;
mod fault;
mod kernel;
mod memory;
#[cfg(any(test, feature = "mpi"))]
pub(crate) mod share;
#[cfg(not(target_family = "wasm"))]
mod sharing;
mod split;
mod submit;
mod timer;
mod transfer;
mod wait;
mod world;
#[cfg(not(target_family = "wasm"))]
mod world_lengths;
#[cfg(not(target_family = "wasm"))]
pub(crate) mod worlds;

pub use device::{Gpu, adapters, instance};
pub use exchange::Table;
pub use fault::catch;
pub use kernel::{join, locate_lines};
#[cfg(not(target_family = "wasm"))]
#[doc(hidden)]
pub use sharing::SharedDevice;
pub use split::{Split, split};
pub(crate) use timer::{clock, copy_bandwidth};
pub(crate) use wait::Mapped;
#[cfg(not(target_arch = "wasm32"))]
pub use wait::block_on;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use wait::drive;
pub use world::GpuWorld;
