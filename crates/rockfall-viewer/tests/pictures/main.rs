//! Pictures: single objects, sequences of frames, culling, and reference pictures.
#![cfg(feature = "gpu")]

mod common;
mod far;
mod frames;
mod golden;
mod hulls;
mod looks;
mod shapes;
