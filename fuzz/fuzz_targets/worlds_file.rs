//! `cargo fuzz run worlds_file`
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| rockfall_fuzz::worlds_file(bytes));
