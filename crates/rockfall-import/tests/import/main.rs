//! Robots of small files: what they become, how they move, and what is refused.

mod common;
mod errors;
mod fuzz;
mod hostile;
mod mjcf;
mod motion;
mod urdf;
