//! Progress of a run, on standard error: a bar on a terminal, otherwise a line every 30 seconds.

use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::output;

/// Time between two progress updates. Steps are submitted in chunks that take about this long.
const UPDATE_INTERVAL: Duration = Duration::from_millis(200);
/// Time between two lines of output without a terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(30);

pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    /// Unit of the count, such as `steps`.
    what: &'static str,
    steps: u64,
    done: u64,
    start: Instant,
    last_line: Instant,
}

impl Progress {
    pub(crate) fn new(steps: u64) -> Self {
        Self::of("steps", steps)
    }

    /// Progress of a film.
    #[cfg(feature = "view")]
    pub(crate) fn pictures(pictures: u64) -> Self {
        Self::of("pictures", pictures)
    }

    /// Progress of the run from which the camera of a film is chosen.
    #[cfg(feature = "view")]
    pub(crate) fn survey(steps: u64) -> Self {
        Self::of("steps before the film is drawn", steps)
    }

    /// Progress of an evolution.
    pub(crate) fn generations(generations: u64) -> Self {
        Self::of("generations", generations)
    }

    /// Shows a message with the bar, or on a line of its own.
    pub(crate) fn tell(&mut self, text: &str) {
        match &self.bar {
            Some(bar) => bar.set_message(text.to_owned()),
            None if self.last_line.elapsed() > LINE_INTERVAL => output::note(text),
            None => {}
        }
    }

    fn of(what: &'static str, steps: u64) -> Self {
        let template = format!("{{wide_bar}} {{human_pos}}/{{human_len}} {what}, {{per_sec}}, {{eta}} to go {{msg}}");
        let style = ProgressStyle::with_template(&template);
        let bar = || {
            let bar = ProgressBar::new(steps).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            // Also in the middle of a step or picture that takes long.
            bar.enable_steady_tick(UPDATE_INTERVAL);
            bar
        };
        let bar = (std::io::stderr().is_terminal() && !output::is_silent() && steps > 0).then(bar);
        let now = Instant::now();
        Self { bar, what, steps, done: 0, start: now, last_line: now }
    }

    /// Number of steps to do until the next update, at least 1.
    pub(crate) fn chunk(&self) -> u64 {
        let elapsed = self.start.elapsed().as_secs_f64();
        let speed = if self.done > 0 { self.done as f64 / elapsed.max(1e-6) } else { 0.0 };
        // At most twice the steps done so far, because the first steps may be slower or faster than the others.
        let wish = ((speed * UPDATE_INTERVAL.as_secs_f64()) as u64).min(2 * self.done);
        wish.clamp(1, (self.steps - self.done).max(1))
    }

    pub(crate) fn advance(&mut self, steps: u64) {
        self.done += steps;
        if let Some(bar) = &self.bar {
            bar.set_position(self.done);
        } else if self.last_line.elapsed() > LINE_INTERVAL {
            self.last_line = Instant::now();
            output::note(&format!("{} of {} {}", self.done, self.steps, self.what));
        }
    }

    /// Clears the bar.
    pub(crate) fn finish(self) {
        drop(self);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        // Also after an error, so that its message does not follow a bar that is left in the middle.
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
