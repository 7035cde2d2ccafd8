//! Ctrl-C and SIGTERM. A signal ends a command at once, unless the command holds on to finish its outputs. Then the first signal
//! asks it to stop, and it has [`GRACE`] to notice. The second signal always ends the command at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

use crate::failure::INTERRUPTED;
use crate::output;

/// Time from the first signal until a command that does not notice it is ended. A step may take longer than that, and nothing
/// can end it in the middle. The whole command must end within a second.
const GRACE: Duration = Duration::from_millis(800);
/// Time between two looks at the flags.
const TICK: Duration = Duration::from_millis(20);

/// Requests to stop the command. There is one for the whole program.
pub(crate) struct Interrupt {
    /// A signal ends the program at once. Also set by the first signal, so that the second one does.
    at_once: Arc<AtomicBool>,
    requested: Arc<AtomicBool>,
    noticed: AtomicBool,
    /// What holds the results, for the message when the command is ended within a step.
    left: Mutex<String>,
}

impl Interrupt {
    /// Installs the signal handlers. If the system refuses, a signal ends the program as usual.
    pub(crate) fn listen() -> &'static Self {
        static INTERRUPT: OnceLock<Interrupt> = OnceLock::new();
        INTERRUPT.get_or_init(|| {
            let (at_once, requested) = (Arc::new(AtomicBool::new(true)), Arc::new(AtomicBool::new(false)));
            for signal in [SIGINT, SIGTERM] {
                // The order matters: the first signal must find the flag unset before it sets it.
                let _ = flag::register_conditional_shutdown(signal, i32::from(INTERRUPTED), Arc::clone(&at_once))
                    .and_then(|_| flag::register(signal, Arc::clone(&at_once)))
                    .and_then(|_| flag::register(signal, Arc::clone(&requested)));
            }
            Self { at_once, requested, noticed: AtomicBool::new(false), left: Mutex::default() }
        })
    }

    /// From now on the first signal leaves the command [`GRACE`] to call [`Interrupt::is_requested`] and to stop by itself.
    pub(crate) fn hold(&'static self) {
        self.at_once.store(false, Ordering::SeqCst);
        // Without this thread, a step that does not end could not be interrupted but by a second signal.
        let _ = thread::Builder::new().name("signals".into()).spawn(|| self.watch());
    }

    /// Whether the command should stop. A command that got `true` writes its results, without a limit of time.
    pub(crate) fn is_requested(&self) -> bool {
        let requested = self.requested.load(Ordering::SeqCst);
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

    fn watch(&self) {
        while !self.requested.load(Ordering::SeqCst) {
            thread::sleep(TICK);
        }
        let asked = Instant::now();
        while asked.elapsed() < GRACE {
            if self.noticed.load(Ordering::SeqCst) {
                return;
            }
            thread::sleep(TICK);
        }
        let left = self.left.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if !self.noticed.load(Ordering::SeqCst) {
            output::note(&format!("stopped within a step that takes longer than {} s{left}", GRACE.as_secs_f32()));
            // Ends the process without its destructors, which would wait for the step.
            low_level::exit(i32::from(INTERRUPTED));
        }
    }
}
