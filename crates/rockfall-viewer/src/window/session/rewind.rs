//! Records the states of the last seconds and goes back to them.

use std::time::Instant;

use rockfall::Checkpoint;

use super::Session;
use crate::window::hold::Held;
use crate::window::past::Past;

impl Session {
    /// The states of the last seconds.
    pub fn past(&self) -> &Past {
        &self.past
    }

    /// Whether the scene is small enough to record its states.
    pub fn can_rewind(&self) -> bool {
        Past::capacity(self.simulation.scene()) > 0
    }

    /// Records the present state if that is due, or `forced`.
    pub(super) fn record(&mut self, forced: bool) {
        let report = self.simulation.report();
        let scene = self.simulation.scene();
        let due = self.past.is_due(scene, report.time, self.wall_time()) || forced && Past::capacity(scene) > 0;
        if self.device_failed || !due {
            return;
        }
        let start = Instant::now();
        if let Some(state) = self.state() {
            self.past.record(state, self.wall_time(), start.elapsed().as_secs_f64());
        }
    }

    /// Returns the present state, without the tether of a held body.
    pub(super) fn state(&mut self) -> Option<Checkpoint> {
        let state = self.simulation.checkpoint();
        let mut state = self.ok_or_report(state)?;
        if let Some(tether) = self.held.as_ref().and_then(Held::tether) {
            // The tether exists as long as a body is held.
            let _ = state.scene.remove_tether(tether);
        }
        Some(state)
    }

    /// Stops, and goes to the recorded state that is nearest to a simulated time, in s.
    pub fn seek(&mut self, time: f64) {
        self.record_present();
        if let Some(index) = self.past.nearest(time) {
            self.go_to(index);
        }
    }

    /// Stops, and goes to the next recorded state before or after the present one.
    pub fn rewind(&mut self, forward: bool) {
        self.record_present();
        if let Some(index) = self.past.next(self.simulation.report().steps, forward) {
            self.go_to(index);
        }
    }

    /// Records the state that the user leaves, so that one can come back to it.
    fn record_present(&mut self) {
        self.set_running(false);
        let steps = self.simulation.report().steps;
        if self.past.states().all(|state| state.report.steps < steps) {
            self.record(true);
        }
    }

    fn go_to(&mut self, index: usize) {
        self.release();
        let Some(state) = self.past.state(index).filter(|state| state.report.steps != self.simulation.report().steps) else {
            return;
        };
        let mut state = state.clone();
        // Going back moves bodies. It does not move sliders.
        state.scene.settings = *self.simulation.settings();
        self.restore(&state);
    }

    /// Replaces the state of the simulation, and returns whether that was possible.
    pub(super) fn restore(&mut self, state: &Checkpoint) -> bool {
        let restored = self.simulation.restore(state);
        if self.ok_or_report(restored).is_none() {
            return false;
        }
        self.apply_time_step(self.pace.time_step);
        self.pace.forget();
        self.held = None;
        self.objects_version += 1;
        self.watch.rewind(state.report.time);
        self.track.rewind(state.report.time);
        self.kept.iter_mut().for_each(|kept| kept.track.rewind(state.report.time));
        true
    }
}
