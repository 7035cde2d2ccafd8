//! What a scene can expect of the contact law `rigid`, before it runs.

use std::f32::consts::TAU;
use std::fmt;

use super::Frames;
use super::check::check;
use super::joints::keeps_distance;
use crate::error::Result;
use crate::report::short_number;
use crate::rigid::frame::{JointMotion, auto_substeps, least_width, motions_of_joints};
use crate::rigid::joints::Joint;
use crate::rigid::spring_bound::SpringBound;
use crate::scene::{Body, RunDefaults, Scene};

/// How the solver of the contact law `rigid` takes a scene (docs/physics section 11).
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
    /// What `check` and `run` warn of under the contact law `rigid` in frames of `dt` seconds: contacts, springs and muscles that are too
    /// fast for the substeps.
    pub(crate) fn concerns_of_frames(&self, dt: f32) -> Vec<String> {
        // Substeps that the solver chooses suit the contacts.
        let has_links = !(self.springs().is_empty() && self.tethers().is_empty() && self.joints().is_empty());
        if self.run.substeps.is_none() && !has_links && self.rods().is_empty() {
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
        let joints = self.concern_of_joints(frames.substeps);
        frames.concern().into_iter().chain(muscle).chain(joints).chain(self.concern_of_rods()).collect()
    }

    /// Rods that touch nothing.
    fn concern_of_rods(&self) -> Option<String> {
        let mut scene = self.clone();
        scene.imply_bodies();
        let count = scene.rod_ids().filter(|id| keeps_distance(&scene, *id)).count();
        let rods = if count == 1 { "1 rod keeps".to_owned() } else { format!("{count} rods keep") };
        (count > 0).then(|| {
            format!(
                "{rods} the distance of the ends and touch{} nothing under the contact law rigid, because no body has them as a part",
                if count == 1 { "es" } else { "" }
            )
        })
    }

    /// The first joint whose anchors miss each other at the start, and the one whose bodies differ most in mass, if they are too soft.
    fn concern_of_joints(&self, substeps: u32) -> Option<String> {
        let mut scene = self.clone();
        scene.imply_bodies();
        let world = Frames::of(&scene, None).ok()?.world;
        let rods: Vec<_> = scene.rod_ids().filter(|id| keeps_distance(&scene, *id)).collect();
        let name = |number: usize| match self.joints().get(number) {
            Some(joint) => format!("the joint {}", joint.name.clone().unwrap_or_else(|| format!("number {number}"))),
            None => scene.name_of(Body::Rod(rods[number - self.joints().len()])),
        };
        let ends = |joint: &Joint| joint.ends.map(|end| &world.bodies[end.body as usize]);
        let missed = |(number, (joint, motion)): (usize, (&Joint, JointMotion))| {
            let size = ends(joint).iter().map(|body| body.radius).filter(|radius| radius.is_finite()).fold(0.0, f32::max);
            (motion.error > 1e-3 * size).then(|| {
                let error = short_number(motion.error.into(), 3);
                format!(
                    "the anchors of {} miss each other by {error} at the start; the first frames pull them together",
                    name(number)
                )
            })
        };
        let ratio = |joint: &Joint| {
            let [a, b] = ends(joint).map(|body| body.inverse_mass);
            if a > 0.0 && b > 0.0 { (a / b).max(b / a) } else { 1.0 }
        };
        let list = &world.joints.list;
        // Rods whose ends miss their length are told of elsewhere.
        let of_joints = list.iter().zip(motions_of_joints(&world)).take(self.joints().len());
        let first = of_joints.enumerate().find_map(missed);
        let heaviest = (0..list.len()).max_by(|one, other| ratio(&list[*one]).total_cmp(&ratio(&list[*other])));
        first.or_else(|| {
            let number = heaviest?;
            let needed = ((4.0 * (ratio(&list[number]) / 100.0).sqrt()).ceil() as u32).min(RunDefaults::MAX_SUBSTEPS);
            let ratio = short_number(ratio(&list[number]).into(), 3);
            let joint = name(number);
            (needed > substeps).then(|| {
                format!("{joint} connects masses with a ratio of {ratio}: it opens less with --substeps {needed} or more")
            })
        })
    }

    /// How the solver of the contact law `rigid` takes this scene in frames of `dt` seconds.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for objects that the law does not know.
    pub fn hard_contacts(&self, dt: f32) -> Result<HardContacts> {
        let mut scene = self.clone();
        scene.imply_bodies();
        check(&scene)?;
        let world = Frames::of(&scene, None)?.world;
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
    /// What is wrong with the number of substeps, with numbers. `None` if it is enough.
    fn concern(&self) -> Option<String> {
        self.concern_of_springs().or_else(|| self.concern_of_contacts())
    }

    /// With half as many substeps contacts are a quarter as stiff.
    fn concern_of_contacts(&self) -> Option<String> {
        let Self { substeps, auto_substeps, width, .. } = *self;
        let width = short_number(width.into(), 3);
        (2 * substeps <= auto_substeps).then(|| {
            format!(
                "contacts are soft in {substeps} substeps: for bodies with a least width of {width} use --substeps {auto_substeps} or \
                 --substeps auto"
            )
        })
    }

    fn concern_of_springs(&self) -> Option<String> {
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// Dice of 16 mm take 31 substeps.
    #[test]
    fn too_few_substeps_for_small_bodies_are_named() {
        for (substeps, is_few) in [("4", true), ("15", true), ("16", false), ("auto", false)] {
            let text = format!(
                "set contact_law rigid\nset gravity 9.81\n@run substeps={substeps}\n@body die mass=0.005\n\
                 B 0 0 0 0.016 0 0 0 0.016 0 0 0 0.016\n@end\n@place die at=0,1,0\n"
            );
            let scene = Scene::parse(&text, Path::new("test")).expect("a scene").scene;
            let found = scene.concerns_of_frames(1.0 / 60.0);
            assert_eq!(found.iter().any(|text| text.contains("contacts are soft") && text.contains("31")), is_few, "{found:?}");
        }
    }
}
