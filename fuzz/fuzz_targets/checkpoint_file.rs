//! `cargo fuzz run checkpoint_file`
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| rockfall_fuzz::checkpoint_file(bytes));
