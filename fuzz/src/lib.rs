//! The fuzz targets: any bytes as a scene text, and any bytes as a scene with actions on it.
//!
//! A target panics when the library breaks a promise. The fuzzer calls the targets with bytes that it generates. The tests of
//! `crates/rockfall` call them with the corpus.

mod case;
mod motion;
mod number;
mod scene_text;
mod twins;

pub use motion::motion;
pub use scene_text::scene_text;
