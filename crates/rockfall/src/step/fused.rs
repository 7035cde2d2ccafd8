//! Small scenes: many steps in one dispatch.

pub(crate) mod run_steps;
