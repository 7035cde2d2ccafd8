//! A frame of the law `rigid` (docs/physics section 11).
//!
//! | room | what it knows |
//! |---|---|
//! | `bodies` | the bodies in flat arrays: kick, drift, margins |
//! | `turn` | inertia and free rotation |
//! | `contacts` | blocks, pairs and points in flat arrays |
//! | `detect` | pairs, manifolds and blocks of a frame |
//! | `matching` | impulses and colours of the last frame |
//! | `colours` | blocks that share no body |
//! | `refresh` | geometry and rows in a pose |
//! | `rows` | normal and friction rows of a block |
//! | `seams` | static surfaces of several shapes |
//! | `springs` | forces of springs and of the program |
//! | `joints` | rows of joints |
//! | `passes` | all blocks, colour by colour; the warm start |
//! | `impacts`, `times` | impacts at their time of contact |
//! | `energy` | energy and momenta |
//! | `upload` | the rows of a frame for the device |

mod bodies;
mod colours;
mod contacts;
mod detect;
mod energy;
mod impacts;
mod joints;
mod matching;
mod passes;
mod refresh;
mod rows;
mod seams;
mod springs;
#[cfg(test)]
mod tests;
mod times;
mod turn;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod upload;

pub(crate) use energy::{auto_substeps, least_width};
#[cfg(test)]
pub(crate) use energy::{energy, kinetic_energy, momenta};
pub(crate) use joints::{JointMotion, motions_of_joints};

use crate::rigid::common::{FREQUENCY, REPEATS};
pub(crate) use crate::rigid::common::{FrameReport, MOST_MARGIN};
use crate::rigid::history::History;
use crate::rigid::joints::JointState;
use crate::rigid::world::RigidWorld;
use bodies::Bodies;
use contacts::{Contacts, Found, for_each};
use joints::Joints;
use rows::{Pass, Softness};
use times::Scope;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
pub(crate) use upload::{bodies_alone, constants_alone};

/// Advances all bodies by a frame of `dt` seconds in `substeps` substeps.
#[cfg(test)]
pub(crate) fn advance(world: &mut RigidWorld, dt: f32, substeps: u32) -> FrameReport {
    advance_or_stop(world, dt, substeps, true)
}

/// Advances all bodies by a frame of `dt` seconds in `substeps` substeps. A body whose state stops being finite stops and keeps its
/// place. Unless `keeps_going` is set, no body moves then.
pub(crate) fn advance_or_stop(world: &mut RigidWorld, dt: f32, substeps: u32, keeps_going: bool) -> FrameReport {
    let mut repeats = 0;
    let mut last: Option<Solved> = None;
    loop {
        let bodies = Bodies::load(world, dt);
        let found = detect::manifolds(world, &bodies, last.as_ref().map(|last| (&last.bodies, &*last.found)));
        let solved = match last {
            Some(last) if last.found == found => last.within(&bodies),
            _ => Solved::new(world, bodies, found, dt, substeps),
        };
        if repeats < REPEATS && widen(world, &solved.bodies, repeats) {
            repeats += 1;
            last = Some(solved);
            continue;
        }
        let Solved { mut bodies, contacts, mut joints, h, .. } = solved;
        let stopped = bodies.stop();
        if stopped.is_some() && !keeps_going {
            return FrameReport { repeats, stopped, ..FrameReport::default() };
        }
        bodies.store(&mut world.bodies);
        world.history = History::new(&contacts, h);
        joints::end(&mut joints, dt);
        world.joints.states = joints;
        world.take_into_box();
        let broken = world.joints.break_loaded();
        return FrameReport { stopped, broken, ..report(&contacts, repeats) };
    }
}

/// A frame at its end, which may be rejected.
struct Solved {
    /// The manifolds at its start.
    found: Vec<Found>,
    bodies: Bodies,
    contacts: Contacts,
    joints: Vec<JointState>,
    h: f32,
}

impl Solved {
    fn new(world: &RigidWorld, bodies: Bodies, found: Vec<Found>, dt: f32, substeps: u32) -> Self {
        let mut frame = Frame::with(world, bodies, found.clone(), dt, substeps);
        for _ in 0..substeps {
            frame.substep();
        }
        let Frame { bodies, contacts, joints, h, .. } = frame;
        Self { found, bodies, contacts, joints: joints.states, h }
    }

    /// The same with the margins of other bodies. They matter to the manifolds alone, so with the same manifolds all else is the same.
    fn within(mut self, others: &Bodies) -> Self {
        for (own, other) in self.bodies.constants.iter_mut().zip(&others.constants) {
            own.margin = other.margin;
        }
        self
    }
}

/// A frame while it is solved.
struct Frame<'a> {
    world: &'a RigidWorld,
    bodies: Bodies,
    contacts: Contacts,
    joints: Joints<'a>,
    h: f32,
    /// Substeps that are done.
    done: u32,
    /// Some pair is round.
    is_round: bool,
    biased: Pass,
    relax: Pass,
}

impl<'a> Frame<'a> {
    /// Contacts of the frame with what is kept of the last one.
    #[cfg(test)]
    fn open(world: &'a RigidWorld, dt: f32, substeps: u32) -> Self {
        let bodies = Bodies::load(world, dt);
        let found = detect::manifolds(world, &bodies, None);
        Self::with(world, bodies, found, dt, substeps)
    }

    /// The same for manifolds that are known.
    fn with(world: &'a RigidWorld, bodies: Bodies, found: Vec<Found>, dt: f32, substeps: u32) -> Self {
        let h = dt / substeps as f32;
        let mut contacts = detect::blocks(world, &bodies, found, dt);
        world.history.recall(&mut contacts, &bodies, h);
        colours::colour(&mut contacts, &bodies, &world.history);
        let mut frame = Self::new(world, bodies, contacts, h);
        frame.refresh();
        frame.joints.start_rotors(&frame.bodies);
        frame
    }

    fn new(world: &'a RigidWorld, bodies: Bodies, contacts: Contacts, h: f32) -> Self {
        let biased = Pass { biased: true, softness: [Softness::new(FREQUENCY, h), Softness::new(2.0 * FREQUENCY, h)] };
        let relax = Pass { biased: false, ..biased };
        let is_round = contacts.pairs.iter().any(|pair| pair.round);
        let ratio = if world.history.substep > 0.0 { h / world.history.substep } else { 1.0 };
        let joints = Joints::begin(world, ratio, h);
        Self { world, bodies, contacts, joints, h, done: 0, is_round, biased, relax }
    }

    fn substep(&mut self) {
        if impacts::impacts(self.world, &mut self.contacts, &mut self.bodies, self.h) {
            self.joints.refresh(&self.bodies);
        }
        springs::pull(self.world, &mut self.bodies, self.done, self.h);
        self.bodies.kick(self.h);
        self.joints.warm_start(&mut self.bodies);
        passes::warm_start(&mut self.contacts, &mut self.bodies);
        self.spare();
        self.joints.pass(&mut self.bodies, &self.biased);
        passes::pass(&mut self.contacts, &mut self.bodies, &self.biased);
        self.bodies.follow();
        self.bodies.drift(self.h);
        self.refresh();
        self.joints.pass(&mut self.bodies, &self.relax);
        passes::pass(&mut self.contacts, &mut self.bodies, &self.relax);
        self.bodies.follow();
        self.done += 1;
    }

    /// Looks along the paths of round contacts before the biased pass.
    fn spare(&mut self) {
        if !self.is_round {
            return;
        }
        let (scope, bodies) = (Scope { world: self.world, h: self.h }, &self.bodies);
        let count = self.contacts.blocks.len();
        let mut done = vec![(); count];
        for_each(self.contacts.part(0..count), &mut done, &|mut view| scope.spare(bodies, &mut view));
    }

    /// Forms the geometry and the rows of all blocks anew.
    fn refresh(&mut self) {
        let (world, bodies, h) = (self.world, &self.bodies, self.h);
        self.joints.refresh(bodies);
        let count = self.contacts.blocks.len();
        let mut done = vec![(); count];
        for_each(self.contacts.part(0..count), &mut done, &|view| refresh::refresh(world, bodies, view, h));
    }
}

/// Widens the margins of bodies whose path has left them. False if there are none.
fn widen(world: &mut RigidWorld, bodies: &Bodies, repeats: u32) -> bool {
    let factor = if repeats < 3 { 1.25 } else { 2.5 };
    let mut any = false;
    for (i, body) in world.bodies.iter_mut().enumerate() {
        if let Some(beyond) = bodies.beyond(i) {
            body.margin_scale = (factor * beyond * body.margin_scale).min(MOST_MARGIN);
            any = true;
        }
    }
    any
}

fn report(contacts: &Contacts, repeats: u32) -> FrameReport {
    let mut report = FrameReport { repeats, ..FrameReport::default() };
    for pair in &contacts.pairs {
        for k in pair.first as usize..pair.first as usize + usize::from(pair.count) {
            let (gap, normal) = (contacts.rows[k].gap, contacts.impulses[k].normal);
            report.contacts += u32::from(gap <= 0.0 || normal > 0.0);
            report.max_overlap = report.max_overlap.max(-gap);
        }
    }
    report
}
