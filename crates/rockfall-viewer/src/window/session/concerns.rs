//! Warns of time steps and constants that do not work for a scene, before it runs.

use rockfall::{Integrator, Scene, Settings};

use super::Session;
use crate::window::message::Level;

/// Number of springs, tethers and contacts that are too stiff for which a message is shown.
const SHOWN: usize = 2;

/// What the last warnings were about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Checked {
    settings: Settings,
    time_step: f32,
    scene: u64,
}

/// Returns the warnings about a scene at a time step of `dt` seconds.
fn concerns(scene: &Scene, dt: f32, integrator: Integrator) -> Vec<String> {
    let stiff = scene.stability(dt, integrator);
    let mut texts: Vec<String> = stiff.iter().take(SHOWN).map(ToString::to_string).collect();
    if stiff.len() > SHOWN {
        texts.push(format!("{} more parts of the scene are too stiff for the time step", stiff.len() - SHOWN));
    }
    texts.extend(scene.sinking(integrator).map(|sinking| sinking.to_string()));
    texts
}

impl Session {
    /// Shows the warnings about the scene, unless nothing has changed since they were shown last.
    pub(super) fn warn(&mut self) {
        let time_step = self.pace.time_step;
        let checked = Checked { settings: *self.simulation.settings(), time_step, scene: self.simulation_version };
        if self.checked != Some(checked) {
            self.checked = Some(checked);
            for text in concerns(self.simulation.scene(), time_step, self.simulation.integrator()) {
                self.tell(Level::Warning, text);
            }
        }
    }
}
