//! Worlds under the contact law `rigid` that share frames on the device.

use rayon::prelude::*;

use crate::checkpoint::Checkpoint;
use crate::error::Result;
use crate::exec::gpu::Gpu;
use crate::options::{Backend, Options};
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::simulation::frames::joined::{JoinedFrames, Outcome};
use crate::worlds::{World, WorldPath};

/// What has changed of a world since the last run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Nothing,
    /// Drives of its joints.
    Drives,
    Everything,
}

/// The worlds that share frames.
#[derive(Debug, Default)]
pub(super) struct Joined {
    frames: Option<JoinedFrames>,
    /// Their numbers, ascending.
    members: Vec<usize>,
    /// Of each world of the batch; a world beyond the end has changed.
    changes: Vec<Change>,
    /// Time step of the last run, in s.
    dt: f32,
    /// The device has advanced the worlds since they were read back.
    is_ahead: bool,
}

/// The simulation that holds a world on the host while frames are shared; `None` for a world that needs a simulation of its own.
pub(super) fn holder(scene: &Scene, options: &Options) -> Result<Option<Simulation>> {
    let holds = Simulation::may_join(scene);
    holds.then(|| Simulation::with_options(scene.clone(), options.clone().backend(Backend::Cpu))).transpose()
}

fn runs(world: &World) -> bool {
    world.path == WorldPath::Joined && world.stopped.is_none()
}

/// The simulations of the worlds that run.
fn simulations(worlds: &mut [World]) -> Vec<&mut Simulation> {
    worlds.iter_mut().filter(|world| runs(world)).map(|world| &mut world.simulation).collect()
}

impl Joined {
    /// Notes that all of a world must be uploaded before it runs.
    pub(super) fn changed(&mut self, world: usize) {
        self.change(world, Change::Everything);
    }

    /// Notes that the drives of the joints of a world, and nothing else, must be uploaded before it runs.
    pub(super) fn drives_changed(&mut self, world: usize) {
        if self.changes.get(world) == Some(&Change::Nothing) {
            self.change(world, Change::Drives);
        }
    }

    fn change(&mut self, world: usize, change: Change) {
        if let Some(own) = self.changes.get_mut(world) {
            *own = change;
        }
    }

    /// Advances the worlds by frames of `dt` seconds. A world that cannot share frames with the others gets a simulation from `resume`.
    pub(super) fn run(
        &mut self,
        gpu: &Gpu,
        worlds: &mut [World],
        frames: u64,
        dt: f32,
        resume: impl Fn(Checkpoint) -> Result<Simulation>,
    ) -> Result<()> {
        let mut left = frames;
        while left > 0 && worlds.iter().any(runs) {
            self.upload(gpu, worlds, dt, &resume)?;
            let Some(shared) = &mut self.frames else { return Ok(()) };
            self.is_ahead = true;
            match shared.run(&mut simulations(worlds), left, dt)? {
                Outcome::Done => left = 0,
                Outcome::Stopped { world, frames, error } => {
                    // The others go on without it.
                    left -= frames;
                    self.refresh(worlds)?;
                    worlds[self.members[world]].stopped = Some(error.to_string());
                }
            }
        }
        Ok(())
    }

    /// Brings what has changed to the device.
    fn upload(
        &mut self,
        gpu: &Gpu,
        worlds: &mut [World],
        dt: f32,
        resume: &impl Fn(Checkpoint) -> Result<Simulation>,
    ) -> Result<()> {
        self.changes.resize(worlds.len(), Change::Everything);
        let running: Vec<usize> = (0..worlds.len()).filter(|world| runs(&worlds[*world])).collect();
        let is_whole =
            dt != self.dt || running != self.members || running.iter().any(|world| self.changes[*world] == Change::Everything);
        if is_whole {
            self.refresh(worlds)?;
        }
        let changes = &self.changes;
        let due = |number: usize, world: &World| runs(world) && (is_whole || changes[number] != Change::Nothing);
        let prepare = |(number, world): (usize, &mut World)| {
            if due(number, world) {
                world.stopped = world.simulation.prepare_frames(dt).err().map(|error| error.to_string());
            }
        };
        worlds.par_iter_mut().enumerate().for_each(prepare);
        if is_whole {
            self.join(gpu, worlds, resume)?;
        } else if let Some(shared) = &mut self.frames {
            let drives: Vec<usize> =
                (0..running.len()).filter(|place| self.changes[running[*place]] == Change::Drives).collect();
            drives.iter().for_each(|place| shared.set_drives(*place, &worlds[running[*place]].simulation));
            if !drives.is_empty() {
                shared.send_drives();
            }
        }
        self.changes.fill(Change::Nothing);
        self.dt = dt;
        Ok(())
    }

    /// Joins the worlds that may join the first of them. The others get simulations of their own.
    fn join(&mut self, gpu: &Gpu, worlds: &mut [World], resume: &impl Fn(Checkpoint) -> Result<Simulation>) -> Result<()> {
        let Some(first) = worlds.iter().position(runs) else { return Ok(()) };
        for number in first..worlds.len() {
            let joins = worlds[first].simulation.joins(&worlds[number].simulation);
            let world = &mut worlds[number];
            if runs(world) && !joins {
                world.simulation = resume(world.simulation.checkpoint()?)?;
                world.path = WorldPath::Simulation;
            }
        }
        let members: Vec<usize> = (0..worlds.len()).filter(|world| runs(&worlds[*world])).collect();
        let all: Vec<&Simulation> = members.iter().map(|world| &worlds[*world].simulation).collect();
        let is_put = match &mut self.frames {
            Some(shared) if members == self.members => shared.put(&all)?,
            _ => false,
        };
        if !is_put {
            self.frames = None;
            self.frames = Some(JoinedFrames::new(gpu, &all)?);
        }
        self.members = members;
        Ok(())
    }

    /// Reads the states of all worlds back, if the device has advanced them.
    pub(super) fn refresh(&mut self, worlds: &mut [World]) -> Result<()> {
        match &mut self.frames {
            Some(shared) if std::mem::take(&mut self.is_ahead) => shared.fetch(&mut simulations(worlds)),
            _ => Ok(()),
        }
    }
}
