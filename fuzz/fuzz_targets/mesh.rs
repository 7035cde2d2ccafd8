//! `cargo fuzz run mesh`
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| rockfall_fuzz::mesh(bytes));
