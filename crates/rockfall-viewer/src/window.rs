//! The window: a scene that runs, is looked at and played with.
//!
//! What can be tested without one is free of window and widget types: [`session`] holds the scene and moves it, [`pace`]
//! says when, [`controls`] what keys do, [`navigation`] how the camera moves, and [`viewer`] puts them together. `ui`,
//! `panel` and `dialog` are the widgets, `input` hands their events on, `graphics` and `app` are the device and the window.

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
