//! Laws that a program gives: forces on bodies and the law of contacts, as WGSL text and as a function of Rust.
//!
//! Kernels contain the text of the WGSL itself. The CPU backend calls the function of Rust or, if there is none, evaluates the WGSL:
//! naga reads and checks it, and `compile` turns it into a list of operations (`program`). `source` puts the text into a function.

#[cfg(all(feature = "wgsl", not(target_family = "wasm")))]
mod compile;
mod contact;
mod force;
pub(crate) mod forces;
#[cfg(all(feature = "wgsl", not(target_family = "wasm")))]
mod operators;
#[cfg_attr(not(all(feature = "wgsl", not(target_family = "wasm"))), allow(dead_code, reason = "only the compiler uses it"))]
mod program;
pub(crate) mod set;
#[cfg_attr(not(all(feature = "wgsl", not(target_family = "wasm"))), allow(dead_code, reason = "only the compiler uses it"))]
mod source;
mod text;

pub(crate) use contact::MOST_PARAMETERS;
pub use contact::{ContactForceLaw, ContactInput, ContactResponse, Impact, PairParameter};
pub use force::{ForceInput, ForceLaw, ForceLoad};
