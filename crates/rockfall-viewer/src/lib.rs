//! Looking at a rockfall simulation: pictures, films and a window.
//!
//! [`draw::Renderer`] draws a [`Simulation`](rockfall::Simulation) straight from the buffers that the physics runs on;
//! [`picture`] draws into memory
//! instead of a window, [`film`] a row of pictures into a file. There is no physics here: only rockfall's public interface is used.
//!
//! # Features
//! `window` (default): the window, on winit and egui.
//!
//! `gpu` (default): all but that. Drawing takes a graphics device, software Vulkan included, whichever backend moves the bodies.
#![cfg(feature = "gpu")]

mod bounds;
pub mod camera;
pub mod draw;
pub mod film;
pub mod legend;
pub mod palette;
pub mod picture;
mod pixels;
mod read_back;
#[cfg(feature = "window")]
pub mod window;
