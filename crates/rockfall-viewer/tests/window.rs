//! Tests of the window's modules without a window: commands and mouse actions on scenes of the CPU backend.
#![cfg(feature = "window")]

#[path = "window/common.rs"]
mod common;
#[path = "window/device.rs"]
mod device;
#[path = "window/files.rs"]
mod files;
#[path = "window/follow.rs"]
mod follow;
#[path = "window/keys.rs"]
mod keys;
#[path = "window/past.rs"]
mod past;
#[path = "window/playback.rs"]
mod playback;
#[path = "window/pointer.rs"]
mod pointer;
#[path = "window/time.rs"]
mod time;
