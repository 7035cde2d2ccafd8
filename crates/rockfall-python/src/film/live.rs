//! Films of what the program runs itself.

use pyo3::prelude::*;
use rockfall_viewer::film::Moment;

use crate::errors::Raise;
use crate::film::Shooting;

/// What a film that the program runs has seen.
#[derive(Default)]
pub(super) struct Seen {
    /// Number of steps before the last state.
    step: Option<u64>,
    /// Place of the followed body in that state.
    place: Option<rockfall::glam::Vec3>,
}

/// Number of steps before the state at which the picture of a moment can be taken.
fn end(moment: Moment) -> u64 {
    moment.step + u64::from(moment.blend > 0.0)
}

impl Shooting {
    fn next(&self) -> Option<Moment> {
        self.moments.get(self.reel.len()).copied()
    }

    /// Number of steps before the next state that must be seen; `None` when all pictures are taken.
    pub(super) fn due(&self) -> Option<u64> {
        let next = self.next()?;
        let Some(seen) = self.seen.step else { return Some(0) };
        let due = if seen < next.step { next.step } else { end(next) };
        let has_past = self.tools.renderer.motion().interval().is_some();
        Some(if has_past { due.min(seen + 1) } else { due })
    }

    /// Sees the state after a number of steps, and takes the pictures that it completes.
    pub(super) fn see(&mut self, simulation: &mut rockfall::Simulation, step: u64) -> PyResult<()> {
        let shot = match self.shot {
            Some(shot) => shot,
            None => self.begin(simulation)?,
        };
        let place = match &self.view.follow {
            Some(subject) => Some(subject.place(simulation.sync().or_raise()?).or_raise()?),
            None => None,
        };
        self.tools.renderer.update(simulation, &self.style).or_raise()?;
        while let Some(moment) = self.next().filter(|next| end(*next) <= step) {
            let blend = if moment.blend > 0.0 { moment.blend } else { 1.0 };
            self.tools.renderer.set_blend(blend);
            let followed = place.map(|place| self.seen.place.unwrap_or(place).lerp(place, blend));
            let camera = shot.at(self.reel.len() as f64 / f64::from(self.timing.fps), followed);
            let picture = self.picture(&camera)?;
            self.reel.push(&picture).or_raise()?;
        }
        self.tools.renderer.set_blend(1.0);
        self.tools.renderer.record();
        self.tools.renderer.remember();
        (self.seen.step, self.seen.place) = (Some(step), place);
        Ok(())
    }
}
