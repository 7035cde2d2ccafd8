//! What a user sees, at the default step of 20 ms: piles come to rest, a cradle swings, things lie still; degenerate
//! input does what the documentation says, and a body that stops being finite is told.

#[macro_use]
mod common;

#[path = "behaviour/degenerate.rs"]
mod degenerate;
#[path = "behaviour/finite.rs"]
mod finite;
#[path = "behaviour/rest.rs"]
mod rest;
