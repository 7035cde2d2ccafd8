//! Behaviour over many steps at the default time step of 20 ms: piles come to rest, a Newton's cradle swings, bodies
//! lie still. Also degenerate input, which must give the documented result, and bodies that become non-finite, which
//! must be reported, and lengths of all sizes.

#[macro_use]
mod common;

#[path = "behaviour/degenerate.rs"]
mod degenerate;
#[path = "behaviour/finite.rs"]
mod finite;
#[path = "behaviour/rest.rs"]
mod rest;
#[path = "behaviour/scale.rs"]
mod scale;
