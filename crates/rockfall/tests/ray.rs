//! Ray queries against values derived by hand and against a walk along the ray in small steps.

#[macro_use]
mod common;

#[path = "ray/closed_form.rs"]
mod closed_form;
#[path = "ray/walk.rs"]
mod walk;
