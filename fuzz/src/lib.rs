//! What is fuzzed: any bytes as a scene text, and any bytes as a scene with what is done to it.
//!
//! Each entry panics where the library breaks a promise. The fuzzer calls them with bytes of its own; the tests of
//! `crates/rockfall` call them with the corpus.

mod case;
mod motion;
mod number;
mod scene_text;
mod twins;

pub use motion::motion;
pub use scene_text::scene_text;
