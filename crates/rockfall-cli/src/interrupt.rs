//! Ctrl-C and SIGTERM. A signal ends a command at once, unless the command holds on to finish its outputs. Then the first signal
//! asks it to stop, and it has the time of [`Steps::patience`] to notice. A second signal ends the command at once if it comes at
//! least the time [`APART`] after the first. Signals that come together are one request: `timeout` signals the program and its
//! process group, and a terminal may do the same.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

use crate::failure::INTERRUPTED;
use crate::output;

/// Time from the first signal until a command that does not notice it is ended, before its first step has ended. A step may take
/// longer than that, and nothing can end it in the middle.
const GRACE: Duration = Duration::from_millis(800);
/// After the first step, the command is given as much longer than the longest step so far, because the machine may be loaded, but not
/// more than the greatest time.
const SLOWER: u32 = 20;
const MOST: Duration = Duration::from_secs(20);
/// Least time from the first signal to a second one that ends the command at once.
const APART: Duration = Duration::from_secs(1);
/// Time between two looks at the flags.
const TICK: Duration = Duration::from_millis(20);

/// Requests to stop the command. There is one for the whole program.
pub(crate) struct Interrupt {
    /// A signal ends the program at once. It is so before [`Interrupt::hold`], and again from the time [`APART`] after the first
    /// signal.
    at_once: Arc<AtomicBool>,
    requested: Arc<AtomicBool>,
    noticed: AtomicBool,
    steps: Mutex<Steps>,
    /// What holds the results, for the message when the command is ended within a step.
    left: Mutex<String>,
}

/// The times of the steps.
#[derive(Default)]
struct Steps {
    /// When the command looked for a signal for the last time, which it does between steps.
    last: Option<Instant>,
    longest: Option<Duration>,
}

impl Steps {
    /// Takes that the command looks for a signal.
    fn look(&mut self, now: Instant) {
        let step = self.last.replace(now).map(|last| now - last);
        self.longest = self.longest.max(step);
    }

    /// Time from the first signal until the command is ended within a step.
    fn patience(&self) -> Duration {
        self.longest.map_or(GRACE, |longest| (SLOWER * longest).clamp(GRACE, MOST))
    }
}

impl Interrupt {
    /// Installs the signal handlers. If the system refuses, a signal ends the program as usual.
    pub(crate) fn listen() -> &'static Self {
        static INTERRUPT: OnceLock<Interrupt> = OnceLock::new();
        INTERRUPT.get_or_init(|| {
            let (at_once, requested) = (Arc::new(AtomicBool::new(true)), Arc::new(AtomicBool::new(false)));
            for signal in [SIGINT, SIGTERM] {
                let _ = flag::register_conditional_shutdown(signal, i32::from(INTERRUPTED), Arc::clone(&at_once))
                    .and_then(|_| flag::register(signal, Arc::clone(&requested)));
            }
            Self { at_once, requested, noticed: AtomicBool::new(false), steps: Mutex::default(), left: Mutex::default() }
        })
    }

    /// From now on the first signal leaves the command the time of [`Steps::patience`] to call [`Interrupt::is_requested`] and to stop by itself.
    pub(crate) fn hold(&'static self) {
        self.at_once.store(false, Ordering::SeqCst);
        // Without this thread, nothing could end the command within a step.
        let _ = thread::Builder::new().name("signals".into()).spawn(|| self.watch());
    }

    /// Whether the command should stop. A command that got `true` writes its results, without a limit of time.
    pub(crate) fn is_requested(&self) -> bool {
        let requested = self.requested.load(Ordering::SeqCst);
        self.steps().look(Instant::now());
        if requested {
            self.noticed.store(true, Ordering::SeqCst);
        }
        requested
    }

    /// The command has done its steps and writes its results, without a limit of time.
    pub(crate) fn finishes(&self) {
        self.noticed.store(true, Ordering::SeqCst);
    }

    /// Describes what is left of the results if the command is ended before it notices the signal.
    pub(crate) fn leaves(&self, left: String) {
        *self.left.lock().unwrap_or_else(PoisonError::into_inner) = left;
    }

    fn steps(&self) -> MutexGuard<'_, Steps> {
        self.steps.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn watch(&self) {
        while !self.requested.load(Ordering::SeqCst) {
            thread::sleep(TICK);
        }
        let (asked, patience) = (Instant::now(), self.steps().patience());
        loop {
            let (waited, is_noticed) = (asked.elapsed(), self.noticed.load(Ordering::SeqCst));
            if waited >= patience && !is_noticed {
                self.abandon(patience);
            }
            if waited >= APART {
                if !self.at_once.swap(true, Ordering::SeqCst) && !is_noticed {
                    output::note("waiting for the end of the step; a second signal ends the command at once");
                }
                if is_noticed {
                    return;
                }
            }
            thread::sleep(TICK);
        }
    }

    /// Ends the process within a step, unless the step has just ended.
    fn abandon(&self, patience: Duration) {
        let left = self.left.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if !self.noticed.load(Ordering::SeqCst) {
            output::note(&format!("stopped within a step that takes longer than {} s{left}", patience.as_secs_f32()));
            // Ends the process without its destructors, which would wait for the step.
            low_level::exit(i32::from(INTERRUPTED));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_has_many_times_the_time_of_its_longest_step() {
        let start = Instant::now();
        let patience = |millis: &[u64]| {
            let mut steps = Steps::default();
            millis.iter().for_each(|at| steps.look(start + Duration::from_millis(*at)));
            steps.patience()
        };
        assert_eq!([patience(&[]), patience(&[5]), patience(&[5, 10, 12])], [GRACE; 3]);
        assert_eq!(patience(&[0, 300, 310]), Duration::from_secs(6));
        assert_eq!(patience(&[0, 5000]), MOST);
    }
}
