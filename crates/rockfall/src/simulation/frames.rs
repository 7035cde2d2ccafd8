//! Frames of the contact law `rigid`: the scene becomes bodies and colliders, which a solver advances.

use crate::error::{BadStage, Error, Result};
use crate::fine::Fine;
use crate::model::status::Status;
use crate::rigid::frame::{FrameReport, advance};
use crate::rigid::world::{Body, RigidWorld};
use crate::scene::{BodyHandles, BodyState, Scene, SphereId};
use crate::simulation::Simulation;
use crate::step::schedule::Phase;

mod build;
mod predict;

pub use predict::HardContacts;
use predict::auto_substeps;
pub(in crate::simulation) mod check;

/// Who a body is in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    /// Everything that never moves.
    World,
    /// A loose sphere.
    Sphere(SphereId),
    /// A body that moves as a whole, by its number in [`Scene::whole_bodies`].
    Body(usize),
}

/// The bodies of a scene under the law `rigid`.
#[derive(Debug)]
pub(in crate::simulation) struct Frames {
    world: RigidWorld,
    owners: Vec<Owner>,
    handles: BodyHandles,
    /// Substeps of a frame; 0 before the first frame.
    substeps: u32,
}

impl Frames {
    fn of(scene: &Scene) -> Result<Self> {
        let build::Builder { world, owners, .. } = build::Builder::build(scene)?;
        Ok(Self { world, owners, handles: BodyHandles::of(scene), substeps: 0 })
    }

    /// Takes over what another world has learnt, if the colliders are the same.
    fn keep(&mut self, before: Self) {
        if before.owners == self.owners && before.world.colliders == self.world.colliders {
            self.world.history = before.world.history;
            for (body, before) in self.world.bodies.iter_mut().zip(before.world.bodies) {
                body.margin_scale = before.margin_scale;
            }
        }
        self.substeps = before.substeps;
    }

    /// Writes the states of all bodies to the scene.
    fn put(&self, scene: &mut Scene) -> Result<()> {
        let BodyHandles { declared, implied } = &self.handles;
        for (body, owner) in self.world.bodies.iter().zip(&self.owners) {
            let state = BodyState {
                position: Fine { high: body.pose.position, low: glam::Vec3::ZERO },
                velocity: body.velocity,
                momentum: body.momentum,
                orientation: body.pose.turn,
            };
            match *owner {
                Owner::World => {}
                Owner::Sphere(id) => scene.put_sphere(id, &state)?,
                Owner::Body(number) if number < declared.len() => scene.put_body(declared[number], state)?,
                Owner::Body(number) => scene.put_implied(implied[number - declared.len()], state)?,
            }
        }
        Ok(())
    }

    /// The first sphere of the first body whose state is not finite, by its index.
    fn first_bad(&self, scene: &Scene) -> Option<usize> {
        let is_finite = |body: &Body| [body.pose.position, body.velocity, body.momentum].into_iter().all(glam::Vec3::is_finite);
        let (_, owner) = self.world.bodies.iter().zip(&self.owners).find(|(body, _)| !is_finite(body))?;
        let id = match *owner {
            Owner::World => None,
            Owner::Sphere(id) => Some(id),
            Owner::Body(number) => scene.whole_bodies().nth(number).and_then(|body| body.spheres.first().copied()),
        };
        Some(id.and_then(|id| scene.spheres.index(id).ok()).unwrap_or_default())
    }
}

impl Simulation {
    /// Whether the contact law is `rigid`, so that steps are frames.
    pub(in crate::simulation) fn has_frames(&self) -> bool {
        self.scene.is_rigid()
    }

    /// Number of substeps of the solver of the contact law `rigid`; `None` before the first frame, and with other laws.
    pub fn substeps(&self) -> Option<u32> {
        self.frames.as_ref().map(|frames| frames.substeps).filter(|substeps| *substeps > 0)
    }

    /// Runs whole steps, which are frames.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a phase alone: the law has none. Otherwise as for [`Simulation::step`].
    pub(in crate::simulation) fn drive_frames(&mut self, phases: &[Phase], times: u64) -> Result<()> {
        if let [phase] = phases {
            let expected = "a whole step: the contact law rigid has no phases that run alone";
            return Err(Error::Invalid { field: "phase", value: format!("{phase:?}"), expected });
        }
        self.run_frames(times)
    }

    /// Runs frames of [`Simulation::time_step`] seconds.
    fn run_frames(&mut self, count: u64) -> Result<()> {
        let mut frames = match self.frames.take() {
            Some(frames) if !self.frames_due => frames,
            before => {
                let mut frames = Frames::of(&self.scene)?;
                if let Some(before) = before {
                    frames.keep(*before);
                }
                self.frames_due = false;
                Box::new(frames)
            }
        };
        let dt = self.time_step;
        if frames.substeps == 0 {
            frames.substeps = self.scene.run.substeps.unwrap_or_else(|| auto_substeps(&frames.world, dt));
        }
        let mut failed = None;
        for _ in 0..count {
            let report = advance(&mut frames.world, dt, frames.substeps);
            self.book_frame(report);
            if !self.options.keep_going {
                failed = frames.first_bad(&self.scene);
                if failed.is_some() {
                    break;
                }
            }
        }
        frames.put(&mut self.scene)?;
        self.frames = Some(frames);
        self.world.set_spheres(&self.scene);
        (self.synced, self.observation) = (true, None);
        match failed {
            Some(sphere) => Err(Error::NonFinite { sphere, step: self.report.steps, stage: BadStage::from_number(0) }),
            None => Ok(()),
        }
    }

    fn book_frame(&mut self, frame: FrameReport) {
        let before = self.status;
        self.status = Status {
            last_contacts: frame.contacts,
            last_max_overlap: frame.max_overlap.to_bits(),
            last_collisions: 0,
            ..self.status
        };
        self.report.replays += u64::from(frame.repeats);
        self.book(1, &before);
    }
}
