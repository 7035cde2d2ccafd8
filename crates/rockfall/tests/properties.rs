//! What must hold for any scene, on random ones: conservation, symmetry, and that neither lists nor edits change results.
//!
//! The cases are the same in every run, so that a failure here is a failure everywhere.

#[path = "properties/crowd.rs"]
mod crowd;
#[path = "properties/lists.rs"]
mod lists;
#[path = "properties/rubbing.rs"]
mod rubbing;
#[path = "properties/symmetry.rs"]
mod symmetry;
#[path = "properties/things.rs"]
mod things;
