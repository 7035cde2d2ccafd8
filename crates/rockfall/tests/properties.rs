//! Properties that hold for any scene, tested on random scenes: conservation laws, symmetries, and results that do not
//! depend on pair lists or on edits.
//!
//! The cases are the same in every run, so a failure can be repeated on any machine.

#[path = "properties/contact_law.rs"]
mod contact_law;
#[path = "properties/crowd.rs"]
mod crowd;
#[path = "properties/lists.rs"]
mod lists;
#[path = "properties/symmetry.rs"]
mod symmetry;
#[path = "properties/things.rs"]
mod things;
