//! Warns of time steps and constants that do not work for a scene, before it runs.

use rockfall::Settings;

use super::Session;
use crate::window::message::Level;

/// Number of warnings that are shown. A scene may have thousands of springs that are too stiff.
const SHOWN: usize = 4;

/// What the last warnings were about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Checked {
    settings: Settings,
    time_step: f32,
    scene: u64,
}

impl Session {
    /// Shows the warnings about the scene, unless nothing has changed since they were shown last.
    pub(super) fn warn(&mut self) {
        let time_step = self.pace.time_step;
        let checked = Checked { settings: *self.simulation.settings(), time_step, scene: self.simulation_version };
        if self.checked != Some(checked) {
            self.checked = Some(checked);
            let concerns = self.simulation.scene().concerns(time_step, self.simulation.integrator());
            let more = concerns.len().saturating_sub(SHOWN);
            for text in concerns.into_iter().take(SHOWN) {
                self.tell(Level::Warning, text);
            }
            if more > 0 {
                self.tell(Level::Warning, format!("{more} more warnings; `rockfall check` prints them"));
            }
        }
    }
}
