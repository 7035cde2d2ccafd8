//! `cargo fuzz run law_text`
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| rockfall_fuzz::law_text(bytes));
