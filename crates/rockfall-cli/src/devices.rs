//! `rockfall devices`: lists the devices that a scene can run on.

use std::fmt::Write as _;

use crate::failure::Failure;
use crate::output;

pub(crate) fn devices() -> Result<(), Failure> {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (number, device) in rockfall::devices().into_iter().enumerate() {
        let software = if device.software { ", software: used only with --backend gpu or --device" } else { "" };
        let driver = if device.driver.is_empty() { "unknown driver" } else { &device.driver };
        let _ = writeln!(text, "gpu {number}  {} ({}, {}, {driver}{software})", device.name, device.backend, device.kind);
    }
    if text.is_empty() {
        let reason = if cfg!(feature = "gpu") { "found" } else { "available: built without the feature `gpu`" };
        let _ = writeln!(text, "gpu  none {reason}");
    }
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let _ = writeln!(text, "cpu  {}", crate::options::counted(threads, "thread", "threads"));
    output::print(&text)
}
