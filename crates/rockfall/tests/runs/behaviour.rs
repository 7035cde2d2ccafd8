//! Behaviour over many steps at the default time step of 20 ms: piles come to rest, a Newton's cradle swings, bodies
//! lie still. Also degenerate input, which must give the documented result, and bodies that become non-finite, which
//! must be reported, and lengths of all sizes.

mod degenerate;
mod finite;
mod rest;
mod scale;
