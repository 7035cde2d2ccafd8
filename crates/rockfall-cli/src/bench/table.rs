//! Results as tables, for people.

use std::fmt::Write as _;

use rockfall::{Profile, StageTime};

use crate::bench::measure::Measured;
use crate::bench::phases::PHASES;
use crate::bench::{Arguments, title};

/// One table of all sizes, then a table of the stages for each size.
pub(crate) fn tables(arguments: &Arguments, sizes: &[Measured]) -> String {
    let mut text = format!("{}\n", title(arguments, sizes));
    // Writing to a string cannot fail.
    if let Some(driver) = sizes.first().map(|size| &size.backend.driver).filter(|driver| !driver.is_empty()) {
        let _ = writeln!(text, "driver {driver}");
    }
    let _ = writeln!(
        text,
        "{} steps of {} s after {} warm-up steps, broad phase {}, median (minimum to maximum) of {} runs",
        arguments.steps,
        arguments.dt(),
        arguments.warmup(),
        arguments.engine.broad_phase,
        arguments.runs,
    );
    self::sizes(&mut text, sizes);
    text
}

/// The bandwidth of a copy, one table of all sizes, then a table of the stages for each size.
pub(crate) fn sizes(text: &mut String, sizes: &[Measured]) {
    if let Some(best) = sizes.iter().filter_map(|size| size.copy_bandwidth).reduce(f64::max) {
        let _ = writeln!(text, "bandwidth of a plain copy: {} GB/s, read and written bytes together", short(best / 1e9));
    }
    let _ = writeln!(
        text,
        "\n{:>10} {:>34} {:>11} {:>16} {:>10} {:>8} {:>10} {:>9}",
        "spheres", "ms per step", "steps/s", "sphere-steps/s", "contacts", "replays", "B/sphere", "bandwidth"
    );
    for size in sizes {
        row(text, size);
    }
    for size in sizes {
        if let Some(profile) = &size.profile {
            stages(text, size, profile);
        }
    }
}

fn row(text: &mut String, size: &Measured) {
    let ms = |seconds: f64| short(1e3 * seconds / size.steps as f64);
    let spread = format!("{} ({} to {})", ms(size.seconds.median), ms(size.seconds.min), ms(size.seconds.max));
    let _ = writeln!(
        text,
        "{:>10} {spread:>34} {:>11} {:>14} M {:>10} {:>8} {:>10.0} {:>9}",
        size.counts.spheres,
        short(size.steps_per_second().median),
        short(size.sphere_steps_per_second().median / 1e6),
        size.report.contacts,
        size.report.replays,
        size.memory() as f64 / size.counts.spheres as f64,
        percent(size.bandwidth_used()),
    );
}

fn stages(text: &mut String, size: &Measured, profile: &Profile) {
    let steps = profile.steps.max(1) as f64;
    let total = profile.stage_seconds();
    let _ = writeln!(
        text,
        "\n{} spheres, broad phase {}: {} dispatches per step, timed by {}\n{:<34} {:>6} {:>12} {:>7} {:>15} {:>9}",
        size.counts.spheres,
        size.broad_phase,
        short(profile.runs() as f64 / steps),
        profile.clock.name(),
        "",
        "runs",
        "us per step",
        "share",
        "bytes/sphere",
        "bandwidth",
    );
    let mut line = |name: &str, runs: u64, seconds: f64, bytes: u64| {
        let bandwidth = size.copy_bandwidth.filter(|_| bytes > 0).map(|copy| bytes as f64 / seconds / copy);
        let _ = writeln!(
            text,
            "{name:<34} {:>6} {:>12} {:>7} {:>15.0} {:>9}",
            short(runs as f64 / steps),
            short(1e6 * seconds / steps),
            percent(Some(seconds / total)),
            bytes as f64 / steps / size.counts.spheres as f64,
            percent(bandwidth),
        );
    };
    for (phase, name, _) in PHASES {
        let of_phase: Vec<&StageTime> = profile.stages.iter().filter(|stage| stage.phase == phase).collect();
        let sum = |number: fn(&StageTime) -> u64| of_phase.iter().map(|stage| number(stage)).sum();
        line(name, sum(|stage| stage.runs), profile.phase_seconds(phase), sum(|stage| stage.least_bytes));
        for stage in of_phase {
            line(&format!("  {}", stage.name), stage.runs, stage.seconds, stage.least_bytes);
        }
    }
    line("all", profile.runs(), total, profile.least_bytes());
    if profile.rejected_seconds > 0.0 {
        let _ = writeln!(text, "plus {} ms in total for rejected steps", short(1e3 * profile.rejected_seconds));
    }
}

fn percent(part: Option<f64>) -> String {
    match part {
        Some(part) if part.is_finite() => format!("{:.1} %", 100.0 * part),
        _ => "-".to_owned(),
    }
}

/// Formats a number with four significant digits; below 0.001, with four decimal places.
fn short(number: f64) -> String {
    let digits = if number.abs() >= 1e-3 { (3 - number.abs().log10().floor() as i32).max(0) } else { 4 };
    format!("{number:.*}", digits as usize)
}
