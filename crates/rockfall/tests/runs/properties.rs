//! Properties that hold for any scene, tested on random scenes: conservation laws, symmetries, and results that do not
//! depend on pair lists or on edits.
//!
//! The cases are the same in every run, so a failure can be repeated on any machine.

mod contact_law;
mod crowd;
mod hard;
mod lists;
mod symmetry;
mod things;
