//! What a scene can expect of the contact law `rigid`, before it runs.

use std::f32::consts::TAU;
use std::fmt;

use super::Frames;
use super::check::check;
use crate::error::Result;
use crate::options::Options;
use crate::report::short_number;
use crate::rigid::frame::{auto_substeps, least_width};
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
}

impl Scene {
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
        Ok(HardContacts { frame: dt, substeps, auto_substeps, width, overlap: world.gravity.length() / frequency.powi(2) })
    }
}

impl fmt::Display for HardContacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frame, substeps, auto_substeps, width, overlap } = *self;
        let [frame, width, overlap] = [frame, width, overlap].map(|number| short_number(number.into(), 4));
        write!(f, "contact law rigid: frames of {frame} s in {substeps} substeps, least width of a moving body {width}, ")?;
        write!(f, "overlap of a body at rest on the ground about {overlap}")?;
        if substeps < auto_substeps {
            write!(f, "; substeps=auto would take {auto_substeps}")?;
        }
        Ok(())
    }
}
