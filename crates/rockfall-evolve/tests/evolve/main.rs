//! Evolutions and the creatures that came from them.

mod champions;
mod common;
mod evolution;
