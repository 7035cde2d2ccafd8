//! The interactive window: runs and shows a scene.
//!
//! Modules that are tested without a window use no window or widget types: [`session`] owns the scene and runs it, [`pace`]
//! decides when steps are due, [`controls`] maps keys to commands, [`navigation`] moves the camera, and [`viewer`] combines
//! them. `ui`, `panel` and `file_window` are the widgets, `input` translates their events, `graphics` manages the device and
//! `app` the window.

mod app;
pub mod constants;
pub mod controls;
pub mod dialog;
mod file_window;
mod graphics;
pub mod hold;
mod input;
pub mod message;
pub mod navigation;
pub mod pace;
mod panel;
pub mod rates;
mod report;
pub mod session;
mod ui;
pub mod viewer;
pub mod watch;

pub use app::{Failure, Launch, run};
