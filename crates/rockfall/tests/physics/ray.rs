//! Ray queries against values derived by hand and against a walk along the ray in small steps.

mod closed_form;
mod walk;
