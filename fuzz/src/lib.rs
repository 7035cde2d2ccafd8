//! The fuzz targets: any bytes as a scene text, as a scene with actions on it, as the text of a law, and as a mesh file; changed
//! checkpoints, and changed files of worlds.
//!
//! A target panics when the library breaks a promise. The fuzzer calls the targets with bytes that it generates. The tests of
//! `crates/rockfall` call them with the corpus.

mod case;
mod checkpoint_file;
mod damage;
mod hard;
mod law_text;
mod laws;
mod mesh;
mod message;
mod motion;
mod number;
mod scene_text;
mod twins;
mod worlds_file;

pub use checkpoint_file::checkpoint_file;
pub use law_text::law_text;
pub use mesh::mesh;
pub use motion::motion;
pub use scene_text::scene_text;
pub use worlds_file::worlds_file;
