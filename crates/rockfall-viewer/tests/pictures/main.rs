//! Pictures: single objects, sequences of frames, culling, and reference pictures.
#![cfg(feature = "gpu")]

mod common;
mod far;
mod frames;
mod golden;
mod hulls;
mod joints;
mod looks;
mod shapes;
