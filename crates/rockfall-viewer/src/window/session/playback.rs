//! Plays a trajectory: the steps of the session are its frames, and nothing is simulated.

use rockfall::{Error, Result, Simulation};

use super::Session;
use crate::survey::Survey;
use crate::window::message::Level;

/// Gives the states of a frame to a simulation.
pub type ShowFrame = Box<dyn FnMut(usize, &mut Simulation) -> Result<()>>;

/// A trajectory to play.
pub struct Playback {
    /// Name of the source that it belongs to. When another scene is opened, that one is simulated.
    pub name: String,
    /// Number of steps done and simulated time in s of every frame; at least one.
    pub moments: Vec<(u64, f64)>,
    /// Gives the states of a frame to a simulation of the scene of the trajectory.
    pub show: ShowFrame,
    /// The places of the bodies in all frames, from which the camera is chosen.
    pub survey: Option<Survey>,
}

impl Playback {
    /// The mean time between two frames, in s, as the time step of the session; `None` for a single frame.
    pub fn time_step(&self) -> Option<f32> {
        let frames = self.moments.len() - 1;
        let seconds = self.moments[frames].1 - self.moments[0].1;
        (frames > 0 && seconds > 0.0).then(|| (seconds / frames as f64) as f32)
    }

    /// The time step of the run that wrote the trajectory, in s; `None` for a single frame.
    pub fn step_of_run(&self) -> Option<f32> {
        let (first, last) = (self.moments[0], self.moments[self.moments.len() - 1]);
        let (steps, seconds) = (last.0.saturating_sub(first.0), last.1 - first.1);
        // Times have rounding errors of f64, which must not show.
        (steps > 0 && seconds > 0.0).then(|| format!("{:.6e}", seconds / steps as f64).parse().unwrap_or_default())
    }
}

impl Session {
    /// Plays a trajectory from its first frame instead of simulating the scene.
    pub fn play(&mut self, playback: Playback) {
        self.playback = Some(playback);
        self.show_frame(0);
    }

    /// Whether a trajectory is played.
    pub fn is_playing_back(&self) -> bool {
        self.played().is_some()
    }

    /// The trajectory that is played.
    pub fn played(&self) -> Option<&Playback> {
        self.playback.as_ref().filter(|playback| playback.name == self.source.name)
    }

    /// Shows the frame that many frames after the present one, and stops at the last one.
    pub(super) fn play_frames(&mut self, frames: u64) -> bool {
        let Some(moments) = self.playback.as_ref().map(|playback| &playback.moments) else {
            return true;
        };
        let done = self.simulation.report().steps;
        let at = moments.partition_point(|(step, _)| *step <= done).saturating_sub(1);
        let last = moments.len() - 1;
        let next = at.saturating_add(usize::try_from(frames).unwrap_or(usize::MAX)).min(last);
        let shown = next == at || self.show_frame(next);
        if next == last {
            self.set_running(false);
            self.tell(Level::Note, "the trajectory ends here; a reset plays it again");
        }
        shown
    }

    pub(super) fn show_frame(&mut self, index: usize) -> bool {
        let Some(playback) = &mut self.playback else {
            return false;
        };
        let (step, time) = playback.moments[index];
        let mut show = || -> Result<()> {
            (playback.show)(index, &mut self.simulation)?;
            // The step and the time of the simulation become those of the frame.
            let mut state = self.simulation.checkpoint()?;
            (state.report.steps, state.report.time) = (step, time);
            self.simulation.restore(&state)
        };
        let shown = show();
        if let Err(Error::Invalid { .. }) = shown {
            // The user added or removed bodies.
            let step_of_run = self.playback.take().and_then(|playback| playback.step_of_run());
            self.pace.time_step = step_of_run.unwrap_or(self.pace.time_step);
            self.tell(Level::Warning, "the trajectory does not have these bodies; from here on the scene is simulated");
            return true;
        }
        self.stop_on(shown)
    }
}
