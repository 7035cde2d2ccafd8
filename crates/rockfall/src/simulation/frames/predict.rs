//! What a scene can expect of the contact law `rigid`, before it runs.

use std::f32::consts::TAU;
use std::fmt;

use super::Frames;
use super::check::check;
use crate::error::Result;
use crate::options::Options;
use crate::report::short_number;
use crate::rigid::frame::{auto_substeps, least_width};
use crate::rigid::spring_bound::SpringBound;
use crate::scene::Scene;

/// How the solver of the contact law `rigid` takes a scene (docs/physics.md section 11).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct HardContacts {
    /// Length of a frame, in s.
    pub frame: f32,
    /// Number of substeps of a frame: that of [`RunDefaults::substeps`](crate::RunDefaults), or what the solver chooses.
    pub substeps: u32,
    /// Number of substeps that the solver chooses.
    pub auto_substeps: u32,
    /// The least edge or diameter of a moving body, in units; infinite without moving bodies.
    pub width: f32,
    /// Overlap of a body at rest with the ground below it, in units: g / w² with the stiffness w² of a contact with something that
    /// has no mass.
    pub overlap: f32,
    /// The least number of substeps of a frame in which springs and tethers are stable; 1 without any.
    pub spring_substeps: u32,
    /// The longest substep in which they are stable, in s; infinite without any.
    pub spring_substep: f64,
    /// The greatest stiffness over mass of all springs together, in 1/s²; 0 without any.
    pub spring_stiffness: f64,
    /// The greatest damping over mass of all springs together, in 1/s; 0 without any.
    pub spring_damping: f64,
}

impl Scene {
    /// What `check` and `run` warn of under the contact law `rigid` in frames of `dt` seconds: springs and muscles that are too fast for the
    /// substeps.
    pub(crate) fn concerns_of_frames(&self, dt: f32) -> Vec<String> {
        if self.springs().is_empty() && self.tethers().is_empty() {
            return Vec::new();
        }
        // An object that the law does not know is an error elsewhere.
        let Ok(frames) = self.hard_contacts(dt) else { return Vec::new() };
        let muscle = self.fast_muscle(dt / frames.substeps as f32).map(|muscle| {
            format!(
                "the muscle of {} has a frequency of {} /s and so only {} substeps in a period; its motion is wrong with less than 10",
                self.name_of_spring(muscle.spring),
                short_number(muscle.frequency.into(), 3),
                short_number(muscle.steps, 3)
            )
        });
        frames.concern().into_iter().chain(muscle).collect()
    }

    /// How the solver of the contact law `rigid` takes this scene in frames of `dt` seconds.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for objects that the law does not know.
    pub fn hard_contacts(&self, dt: f32) -> Result<HardContacts> {
        let mut scene = self.clone();
        scene.imply_bodies();
        check(&scene, &Options::default())?;
        let world = Frames::of(&scene)?.world;
        let width = least_width(&world);
        let auto_substeps = auto_substeps(&world, dt);
        let substeps = self.run.substeps.unwrap_or(auto_substeps);
        // The frequency of contacts is 0.18 per substep, twice that with a body without mass.
        let frequency = TAU * 0.36 * substeps as f32 / dt;
        let springs = SpringBound::of(&world);
        Ok(HardContacts {
            frame: dt,
            substeps,
            auto_substeps,
            width,
            overlap: world.gravity.length() / frequency.powi(2),
            spring_substeps: springs.substeps(dt),
            spring_substep: springs.substep(),
            spring_stiffness: springs.stiffness,
            spring_damping: springs.damping,
        })
    }
}

impl HardContacts {
    /// What is wrong with the substeps of springs, with numbers. `None` if they are stable.
    fn concern(&self) -> Option<String> {
        let Self { frame, substeps, spring_substeps, spring_substep, spring_stiffness, spring_damping, .. } = *self;
        if substeps >= spring_substeps {
            return None;
        }
        let [stiffness, damping] = [spring_stiffness, spring_damping].map(|number| short_number(number, 3));
        let [present, longest] = [f64::from(frame) / f64::from(substeps), spring_substep].map(|time| short_number(time, 3));
        Some(format!(
            "the springs may be unstable in substeps of {present} s: with a stiffness over mass of up to {stiffness} /s² and a damping over \
             mass of up to {damping} /s they need at most {longest} s, so use --substeps {spring_substeps} or --substeps auto"
        ))
    }
}

impl fmt::Display for HardContacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frame, substeps, auto_substeps, width, overlap, spring_substeps, .. } = *self;
        let [frame, width, overlap] = [frame, width, overlap].map(|number| short_number(number.into(), 4));
        write!(f, "contact law rigid: frames of {frame} s in {substeps} substeps, least width of a moving body {width}, ")?;
        write!(f, "overlap of a body at rest on the ground about {overlap}")?;
        if self.spring_substep.is_finite() {
            write!(f, ", springs are stable in {spring_substeps} substeps or more")?;
        }
        if substeps < auto_substeps {
            write!(f, "; substeps=auto would take {auto_substeps}")?;
        }
        Ok(())
    }
}
