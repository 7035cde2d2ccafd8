//! The interactive window: runs and shows a scene.
//!
//! Modules that are tested without a window use no window or widget types: [`session`] owns the scene and runs it, [`pace`]
//! decides when steps are due, [`controls`] maps keys to commands, [`navigation`] moves the camera, and [`viewer`] combines
//! them. `ui`, `menu`, `transport`, `panel`, `joints_panel`, `picked_window`, `marks`, `file_window` and `quit_window` are the
//! widgets, `input` translates their events, `graphics` manages the device and
//! `app` the window.

mod app;
pub mod capture;
pub mod constants;
mod constants_panel;
pub mod controls;
pub mod dialog;
mod file_window;
pub mod follow;
mod graphics;
pub mod hold;
mod input;
mod joints_panel;
mod launch;
mod marks;
mod menu;
pub mod message;
pub mod names;
pub mod navigation;
pub mod new_name;
mod overlay;
pub mod pace;
mod panel;
pub mod past;
mod picked_window;
mod plots;
mod quit_window;
pub mod rates;
mod report;
pub mod session;
pub mod track;
mod transport;
mod ui;
pub mod viewer;
pub mod watch;

pub use app::run;
pub use launch::{Failure, Launch};
