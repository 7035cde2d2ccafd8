//! `cargo fuzz run motion`
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| rockfall_fuzz::motion(bytes));
