//! Input of any kind: special numbers in every field, the corpus of the fuzzer, and how scenes are run.

#[path = "../common/mod.rs"]
#[macro_use]
mod common;

mod fuzz;
mod poison;
mod running;
mod shake;
