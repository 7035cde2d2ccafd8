//! Warns of time steps and constants that do not work for a scene, when they are set and before it runs.

use rockfall::Settings;

use super::Session;
use crate::window::message::Level;

/// Number of warnings that are shown. A scene may have thousands of springs that are too stiff.
const SHOWN: usize = 4;
/// Time after the last change of a constant until its warnings are shown, in s. A dragged slider passes many values.
pub(in crate::window) const SETTLED: f64 = 0.5;

/// What the last warnings were about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Checked {
    settings: Settings,
    time_step: f32,
    scene: u64,
}

impl Session {
    /// Shows the warnings about a constant or time step that was just changed, as soon as it does not change any more.
    pub(super) fn warn_soon(&mut self) {
        self.warn_at = Some(self.now + SETTLED);
    }

    /// Shows the warnings that are due.
    pub(super) fn warn_if_settled(&mut self) {
        if self.warn_at.take_if(|at| self.now >= *at).is_some() && !self.is_playing_back() {
            self.warn();
        }
    }

    /// Shows the warnings about the scene, unless nothing has changed since they were shown last.
    pub(super) fn warn(&mut self) {
        let time_step = self.pace.time_step;
        let checked = Checked { settings: *self.simulation.settings(), time_step, scene: self.simulation_version };
        if self.checked != Some(checked) {
            self.checked = Some(checked);
            let mut concerns = self.simulation.scene().concerns(time_step, self.simulation.integrator());
            let more = concerns.len().saturating_sub(SHOWN);
            concerns.truncate(SHOWN);
            if more > 0 {
                concerns.push(format!("{more} more warnings; `rockfall check` prints them"));
            }
            // Those about earlier constants no longer hold.
            self.messages.withdraw(&std::mem::replace(&mut self.concerns, concerns.clone()));
            concerns.into_iter().for_each(|text| self.tell(Level::Warning, text));
        }
    }
}
