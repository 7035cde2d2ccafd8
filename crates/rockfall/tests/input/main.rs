//! Input of any kind: special numbers in every field, and the corpus of the fuzzer.

#[path = "../common/mod.rs"]
#[macro_use]
mod common;

mod fuzz;
mod poison;
