//! The fuzz targets: any bytes as a scene text, any bytes as a scene with actions on it, and changed files of worlds.
//!
//! A target panics when the library breaks a promise. The fuzzer calls the targets with bytes that it generates. The tests of
//! `crates/rockfall` call them with the corpus.

mod case;
mod motion;
mod number;
mod scene_text;
mod twins;
mod worlds_file;

pub use motion::motion;
pub use scene_text::scene_text;
pub use worlds_file::worlds_file;
