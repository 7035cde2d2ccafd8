//! `cargo fuzz run robot`
#![no_main]

#[path = "../src/robot.rs"]
mod robot;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| robot::robot(bytes));
