//! How far a run is, on standard error: a bar on a terminal, else a line now and then.

use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::output;

/// Time between two looks at the run: what is submitted together takes about this long.
const LOOK: Duration = Duration::from_millis(200);
/// Time between two lines where there is no terminal.
const LINE: Duration = Duration::from_secs(30);

pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    /// What is counted.
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

    /// Of a film.
    #[cfg(feature = "view")]
    pub(crate) fn pictures(pictures: u64) -> Self {
        Self::of("pictures", pictures)
    }

    fn of(what: &'static str, steps: u64) -> Self {
        let template = format!("{{bar:40}} {{human_pos}}/{{human_len}} {what}, {{per_sec}}, {{eta}} to go");
        let style = ProgressStyle::with_template(&template);
        let bar = std::io::stderr()
            .is_terminal()
            .then(|| ProgressBar::new(steps).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())));
        let now = Instant::now();
        Self { bar, what, steps, done: 0, start: now, last_line: now }
    }

    /// Steps to do until the next look, at least 1.
    pub(crate) fn chunk(&self) -> u64 {
        let elapsed = self.start.elapsed().as_secs_f64();
        let speed = if self.done > 0 { self.done as f64 / elapsed.max(1e-6) } else { 0.0 };
        // Twice what was done at most: the first steps may be slower or faster than the others.
        let wish = ((speed * LOOK.as_secs_f64()) as u64).min(2 * self.done);
        wish.clamp(1, (self.steps - self.done).max(1))
    }

    pub(crate) fn advance(&mut self, steps: u64) {
        self.done += steps;
        if let Some(bar) = &self.bar {
            bar.set_position(self.done);
        } else if self.last_line.elapsed() > LINE {
            self.last_line = Instant::now();
            output::note(&format!("{} of {} {}", self.done, self.steps, self.what));
        }
    }

    pub(crate) fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
