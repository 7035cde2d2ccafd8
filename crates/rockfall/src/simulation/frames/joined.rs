//! Frames of many worlds as one on a device.
//!
//! The bodies of all worlds follow each other in one [`RigidWorld`]. They share its static body, so all worlds have the same walls.
//! Each body knows its home, and bodies of different homes never meet. Numbers of bodies within a home decide about colours, so a
//! world has the bits that it has alone.

use super::Frames;
use super::device::OnDevice;
use crate::error::{BadStage, Error, Result};
use crate::exec::gpu::Gpu;
use crate::model::status::Status;
use crate::rigid::history::History;
use crate::rigid::joints::Joints;
use crate::rigid::world::{Collider, RigidWorld};
use crate::scene::Scene;
use crate::simulation::Simulation;

/// Most static colliders of worlds that share a frame: every moving collider is tried against all of them.
const MOST_STATICS: usize = 64;

/// Where a world begins in the joined one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Start {
    /// Its first body, and its first collider that is not static.
    body: u32,
    collider: u32,
    joint: usize,
}

/// What a run came to.
#[derive(Debug)]
pub(crate) enum Outcome {
    Done,
    /// A body of this world stopped being finite after so many frames. No world has moved in that frame.
    Stopped {
        world: usize,
        frames: u64,
        error: Error,
    },
}

/// Worlds that share frames.
#[derive(Debug)]
pub(crate) struct JoinedFrames {
    world: RigidWorld,
    /// Of each world, and the end.
    starts: Vec<Start>,
    /// Colliders of the static body.
    statics: u32,
    substeps: u32,
    keeps_going: bool,
    device: OnDevice,
}

impl Simulation {
    /// Whether frames of a scene may run together with those of other worlds.
    pub(crate) fn may_join(scene: &Scene) -> bool {
        let moves = !scene.motions().is_empty() || !scene.springs().is_empty() || !scene.tethers().is_empty();
        scene.is_rigid() && !moves && !scene.is_periodic()
    }

    /// Applies edits, and makes the bodies with which frames of `dt` seconds begin.
    pub(crate) fn prepare_frames(&mut self, dt: f32) -> Result<()> {
        self.set_time_step(dt)?;
        self.flush()?;
        self.ready_frames()
    }

    /// Whether this world may share frames with another one: both are prepared.
    pub(crate) fn joins(&self, other: &Self) -> bool {
        let (Some(own), Some(theirs)) = (&self.frames, &other.frames) else { return false };
        let (a, b) = (&own.world, &theirs.world);
        let walls =
            |frames: &Frames| statics(&frames.world).map(|wall| (wall.clone(), shape_of(&frames.world, wall))).collect();
        let [mine, others]: [Vec<_>; 2] = [walls(own), walls(theirs)];
        (own.substeps, a.gravity, &a.surfaces, a.materials) == (theirs.substeps, b.gravity, &b.surfaces, b.materials)
            && self.options.keep_going == other.options.keep_going
            && mine.len() <= MOST_STATICS
            && mine == others
    }

    /// Takes over what frames elsewhere came to.
    fn finish_frames(&mut self, frames: u64) {
        let before = self.status;
        self.status = Status { last_contacts: 0, last_max_overlap: 0, last_collisions: 0, ..before };
        self.book(frames, &before);
        (self.synced, self.observation) = (false, None);
    }
}

fn shape_of(world: &RigidWorld, collider: &Collider) -> crate::rigid::shape::Shape {
    world.shapes[collider.shape as usize].clone()
}

/// The colliders of the static body. They come first.
fn statics(world: &RigidWorld) -> impl Iterator<Item = &Collider> {
    world.colliders.iter().take_while(|collider| collider.body == 0)
}

impl JoinedFrames {
    /// Joins worlds that are prepared, of which each may join the first.
    ///
    /// # Errors
    /// [`Error::Device`] when the device fails or has too little memory.
    pub(crate) fn new(gpu: &Gpu, worlds: &[&Simulation]) -> Result<Self> {
        let (world, starts) = joined(worlds);
        let first = worlds.first().and_then(|world| world.frames.as_ref());
        let statics = first.map_or(0, |frames| statics(&frames.world).count() as u32);
        let substeps = first.map_or(1, |frames| frames.substeps);
        let keeps_going = worlds.first().is_some_and(|world| world.options.keep_going);
        let device = OnDevice::new(gpu, &world)?;
        Ok(Self { world, starts, statics, substeps, keeps_going, device })
    }

    /// Takes over the present states of worlds that were edited. False if their objects are others than at the start.
    ///
    /// # Errors
    /// As for [`JoinedFrames::new`].
    pub(crate) fn put(&mut self, worlds: &[&Simulation]) -> Result<bool> {
        let (world, starts) = joined(worlds);
        let ends = |world: &RigidWorld| world.joints.list.iter().map(|joint| (joint.kind, joint.ends)).collect::<Vec<_>>();
        let fits = starts == self.starts
            && (&world.colliders, &world.shapes) == (&self.world.colliders, &self.world.shapes)
            && ends(&world) == ends(&self.world);
        if fits {
            self.world = world;
            self.device.put(&self.world)?;
            self.device.set_drives(&self.world);
        }
        Ok(fits)
    }

    /// Takes over the drives of the joints of a world.
    pub(crate) fn set_drives(&mut self, number: usize, world: &Simulation) {
        let Some(frames) = &world.frames else { return };
        let [from, to] = [0, 1].map(|next| self.starts[number + next].joint);
        let offset = self.starts[number].body - 1;
        for (joint, own) in self.world.joints.list[from..to].iter_mut().zip(&frames.world.joints.list) {
            *joint = own.clone();
            joint.ends.iter_mut().for_each(|end| end.body = moved(end.body, offset));
        }
    }

    /// Sends the drives to the device.
    pub(crate) fn send_drives(&mut self) {
        self.device.set_drives(&self.world);
    }

    /// Runs frames of `dt` seconds.
    ///
    /// # Errors
    /// [`Error::Device`] when the device fails.
    pub(crate) fn run(&mut self, worlds: &mut [&mut Simulation], frames: u64, dt: f32) -> Result<Outcome> {
        for done in 0..frames {
            let report = self.device.advance(dt, self.substeps, self.keeps_going)?;
            if let Some((_, body)) = report.stopped.filter(|_| !self.keeps_going) {
                let world = self.starts.partition_point(|start| start.body <= body).saturating_sub(1).min(worlds.len() - 1);
                let simulation = &worlds[world];
                let local = body - self.starts[world].body + 1;
                let sphere = simulation.frames.as_ref().map_or(0, |frames| frames.first_sphere(local, &simulation.scene));
                let step = simulation.report.steps + done + 1;
                worlds.iter_mut().for_each(|world| world.finish_frames(done));
                let error = Error::NonFinite { sphere, step, stage: BadStage::from_number(0) };
                return Ok(Outcome::Stopped { world, frames: done, error });
            }
        }
        worlds.iter_mut().for_each(|world| world.finish_frames(frames));
        Ok(Outcome::Done)
    }

    /// Brings the states of all worlds to the host.
    ///
    /// # Errors
    /// [`Error::Device`] when the device fails.
    pub(crate) fn fetch(&mut self, worlds: &mut [&mut Simulation]) -> Result<()> {
        self.device.fetch(&mut self.world)?;
        self.device.fetch_history(&mut self.world)?;
        let (starts, statics) = (&self.starts, self.statics);
        let home = |mover: u32, first: fn(&Start) -> u32| starts.partition_point(|start| first(start) <= mover) - 1;
        let histories = self.world.history.split(
            worlds.len(),
            |[a, b]| {
                let world = home(b, |start| start.collider);
                let own =
                    |collider: u32| if collider < statics { collider } else { collider - starts[world].collider + statics };
                (world, [own(a), own(b)])
            },
            |[a, b]| {
                let world = home(b, |start| start.body);
                let own = |body: u32| if body == 0 { 0 } else { body - starts[world].body + 1 };
                (world, [own(a), own(b)])
            },
        );
        for ((number, simulation), history) in worlds.iter_mut().enumerate().zip(histories) {
            let Some(frames) = &mut simulation.frames else { continue };
            let [from, to] = [starts[number], starts[number + 1]];
            for (own, joined) in
                frames.world.bodies[1..].iter_mut().zip(&self.world.bodies[from.body as usize..to.body as usize])
            {
                *own = joined.clone();
                own.home = 0;
            }
            frames.world.joints.states.copy_from_slice(&self.world.joints.states[from.joint..to.joint]);
            frames.world.history = history;
            simulation.synced = false;
        }
        Ok(())
    }
}

/// A number of a body or of a collider in the joined world.
fn moved(number: u32, offset: u32) -> u32 {
    if number == 0 { 0 } else { number + offset }
}

/// All worlds as one, and where each begins.
fn joined(worlds: &[&Simulation]) -> (RigidWorld, Vec<Start>) {
    let mut all = RigidWorld::default();
    let mut starts = Vec::with_capacity(worlds.len() + 1);
    let (mut joints, mut states) = (Vec::new(), Vec::new());
    for (number, frames) in worlds.iter().filter_map(|world| world.frames.as_ref()).enumerate() {
        let world = &frames.world;
        if number == 0 {
            all = RigidWorld {
                bodies: vec![world.bodies[0].clone()],
                colliders: statics(world).cloned().collect(),
                shapes: world.shapes.clone(),
                surfaces: world.surfaces.clone(),
                materials: world.materials,
                gravity: world.gravity,
                ..RigidWorld::default()
            };
            all.history = History::within(&world.history);
        }
        let start = Start { body: all.bodies.len() as u32, collider: all.colliders.len() as u32, joint: joints.len() };
        let statics = statics(world).count() as u32;
        let offset = start.body - 1;
        let shapes = if world.shapes == all.shapes[..world.shapes.len().min(all.shapes.len())] {
            0
        } else {
            all.shapes.extend(world.shapes.iter().cloned());
            (all.shapes.len() - world.shapes.len()) as u32
        };
        all.bodies.extend(world.bodies[1..].iter().cloned().map(|mut body| {
            body.home = start.body;
            body
        }));
        all.colliders.extend(world.colliders[statics as usize..].iter().cloned().map(|mut collider| {
            (collider.body, collider.shape) = (moved(collider.body, offset), collider.shape + shapes);
            collider
        }));
        joints.extend(world.joints.list.iter().cloned().map(|mut joint| {
            joint.ends.iter_mut().for_each(|end| end.body = moved(end.body, offset));
            joint
        }));
        states.extend_from_slice(&world.joints.states);
        let own = |collider: u32| if collider < statics { collider } else { collider - statics + start.collider };
        all.history.extend(&world.history, own, |body| moved(body, offset));
        starts.push(start);
    }
    starts.push(Start { body: all.bodies.len() as u32, collider: all.colliders.len() as u32, joint: joints.len() });
    all.history.sort();
    all.joints = Joints::new(joints, &all.with_mass());
    all.joints.states = states;
    (all, starts)
}
