//! Pictures, films and a window for rockfall simulations.
//!
//! [`draw::Renderer`] draws a [`Simulation`](rockfall::Simulation) directly from the buffers of the physics. [`picture`] draws
//! into memory, and [`film`] writes a sequence of pictures to a file. This crate contains no physics and uses only rockfall's
//! public interface.
//!
//! # Features
//! `window` (default): the window, based on winit and egui.
//!
//! `gpu` (default): everything else. Drawing requires a graphics device (software Vulkan is sufficient), whichever backend runs
//! the simulation.
#![cfg(feature = "gpu")]

mod block;
mod bounds;
pub mod camera;
mod direction;
pub mod draw;
#[doc(hidden)]
pub mod drives;
mod extent;
#[cfg(not(target_family = "wasm"))]
pub mod film;
#[doc(hidden)]
pub mod grasp;
mod groups;
mod joints;
pub mod legend;
mod mark;
pub mod overlay;
pub mod palette;
pub mod picture;
mod pixels;
pub mod plot;
mod read_back;
mod sheet;
mod subject;
pub mod survey;
mod tags;
mod up;
mod whole;
#[cfg(feature = "window")]
pub mod window;
