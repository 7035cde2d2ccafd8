//! `cargo fuzz run scene_text`
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| rockfall_fuzz::scene_text(bytes));
