//! What the window does, without one: scenes on the CPU backend, commands and the mouse as a window would give them.
#![cfg(feature = "window")]

#[path = "window/common.rs"]
mod common;
#[path = "window/device.rs"]
mod device;
#[path = "window/files.rs"]
mod files;
#[path = "window/hands.rs"]
mod hands;
#[path = "window/keys.rs"]
mod keys;
#[path = "window/time.rs"]
mod time;
