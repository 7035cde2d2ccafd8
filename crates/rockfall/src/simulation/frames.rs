//! Frames of the contact law `rigid`: the scene becomes bodies and colliders, which a solver advances.

use glam::{DVec3, Vec3};

use crate::error::{BadStage, Error, Result};
use crate::fine::Fine;
use crate::model::status::Status;
use crate::rigid::frame::{FrameReport, MOST_MARGIN, advance_or_stop, auto_substeps};
use crate::rigid::history::History;
use crate::rigid::world::{Body, RigidWorld};
use crate::scene::{Body as Part, BodyHandles, BodyState, JointId, RunDefaults, Scene, SphereId};
use crate::simulation::Simulation;
use crate::simulation::edit::Dirty;
use crate::step::schedule::Phase;
use crate::step::walls::move_walls::place_walls;

mod build;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod device;
mod facets;
mod grips;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
pub(crate) mod joined;
mod joints;
mod keep;
mod loads;
mod motions;
pub(crate) mod observe;
mod predict;
mod repeat;
mod springs;
mod walls;

pub use grips::Grip;
pub use joints::JointReading;
pub use predict::HardContacts;
pub(in crate::simulation) mod check;

/// Who a body is in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    /// Everything that never moves.
    World,
    /// The walls that follow a motion, by its number.
    Motion(usize),
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
    /// Where the coordinates of the world begin in those of the scene, in units: see [`build::base_of`].
    base: DVec3,
    /// Where the origin of the body of each motion lies before the motion, in units. Body 1 is that of the first motion.
    origins: Vec<DVec3>,
    /// What each collider is in the scene.
    parts: Vec<Part>,
    handles: BodyHandles,
    /// Handles of the joints, in the order of those of the world.
    joints: Vec<JointId>,
    /// Substeps of a frame; 0 before the first frame.
    substeps: u32,
    /// What a grip has changed.
    pulled: grips::Pulled,
    device: Device,
}

/// Words of a body in a checkpoint.
const BODY_WORDS: usize = 7;

/// The world on a device, if frames run on one.
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
type Device = Option<Box<device::OnDevice>>;
/// The world on a device: none without the GPU.
#[cfg(not(all(feature = "gpu", not(target_family = "wasm"))))]
type Device = Option<std::convert::Infallible>;

impl Frames {
    /// The bodies of a scene. Coordinates begin at `base`, or where the scene says.
    fn of(scene: &Scene, base: Option<DVec3>) -> Result<Self> {
        check::check_rods(scene)?;
        let base = base.unwrap_or_else(|| build::base_of(scene));
        let build::Builder { world, owners, origins, parts, .. } = build::Builder::build(scene, base)?;
        let (handles, joints) = (BodyHandles::of(scene), scene.joint_ids().collect());
        let pulled = Vec::new();
        Ok(Self { world, owners, base, origins, parts, handles, joints, substeps: 0, pulled, device: None })
    }

    /// What a checkpoint keeps beside the scene: where coordinates begin, the substeps, and of each body its place, its spin and the
    /// factor of its margin, then the joints and the contacts.
    fn words(&self) -> Vec<u32> {
        let base = self.base.to_array().map(f64::to_bits);
        let mut words: Vec<u32> = base.into_iter().flat_map(|bits| [bits as u32, (bits >> 32) as u32]).collect();
        words.extend([self.substeps, self.world.bodies.len() as u32]);
        for body in &self.world.bodies {
            words.extend(body.pose.position.to_array().map(f32::to_bits));
            words.extend(body.spin.to_array().map(f32::to_bits));
            words.push(body.margin_scale.to_bits());
        }
        words.extend(self.world.joints.to_words());
        words.extend(self.world.history.to_words());
        words
    }

    /// Takes over the words of a checkpoint after those of the base. Returns whether they are those of such bodies.
    fn put_words(&mut self, words: &[u32]) -> bool {
        let Some((head, rest)) = words.split_at_checked(2).filter(|(head, _)| head[1] as usize == self.world.bodies.len())
        else {
            return false;
        };
        let Some((bodies, rest)) = rest.split_at_checked(BODY_WORDS * self.world.bodies.len()) else { return false };
        let Some(history) = self.world.joints.put_words(rest) else { return false };
        let Some(history) = History::from_words(history) else { return false };
        for (body, words) in self.world.bodies.iter_mut().zip(bodies.chunks_exact(BODY_WORDS)) {
            let [x, y, z, p, q, r, scale] = [0, 1, 2, 3, 4, 5, 6].map(|place| f32::from_bits(words[place]));
            let place = Vec3::new(x, y, z);
            // The scene has the place up to the rounding of its coordinates.
            let room = 1e-6 * (self.base.abs().max_element() as f32 + place.abs().max_element());
            (body.spin, body.margin_scale) = (Vec3::new(p, q, r), scale);
            if !(place.is_finite() && body.spin.is_finite() && (1.0..=MOST_MARGIN).contains(&scale)) {
                return false;
            }
            // What has no mass is put where its motion is.
            if body.inverse_mass > 0.0 {
                // At a face of a periodic box, rounding may have taken the body to the other one.
                let around = self.world.periods.nearest(place - body.pose.position);
                if (body.pose.position - around).distance(place) > room {
                    return false;
                }
                body.pose.position = place;
                body.periods += (around * self.world.periods.inverse()).round().as_ivec3();
            }
        }
        (self.substeps, self.world.history) = (head[0], history);
        (1..=RunDefaults::MAX_SUBSTEPS).contains(&self.substeps)
    }

    /// What a checkpoint keeps of the bodies of a scene. `None` if it is nothing.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it does not fit the scene.
    pub(in crate::simulation) fn of_words(scene: &Scene, words: &[u32]) -> Result<Option<Box<Self>>> {
        if words.is_empty() || !scene.is_rigid() {
            return Ok(None);
        }
        let (base, rest) = words.split_at_checked(6).unwrap_or_default();
        let base = base.chunks_exact(2).map(|half| f64::from_bits(u64::from(half[0]) | u64::from(half[1]) << 32));
        let base: [f64; 3] = base.collect::<Vec<_>>().try_into().unwrap_or_default();
        let mut frames = Self::of(scene, Some(base.into()))?;
        if !(frames.base.is_finite() && frames.put_words(rest)) {
            let value = format!("{} words of hard contacts", words.len());
            return Err(Error::Invalid { field: "checkpoint", value, expected: "the contacts of the bodies of its scene" });
        }
        Ok(Some(Box::new(frames)))
    }

    /// Advances all bodies by a frame, on the device if there is one.
    fn advance(&mut self, dt: f32, keeps_going: bool) -> Result<FrameReport> {
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(device) = &mut self.device {
            return device.advance(dt, self.substeps, keeps_going);
        }
        Ok(advance_or_stop(&mut self.world, dt, self.substeps, keeps_going))
    }

    /// Reads the states of the bodies from the device.
    fn fetch(&mut self) -> Result<()> {
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(device) = &self.device {
            device.fetch(&mut self.world)?;
        }
        Ok(())
    }

    /// Reads what is remembered of the contacts from the device.
    fn fetch_history(&mut self) -> Result<()> {
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(device) = &mut self.device {
            device.fetch_history(&mut self.world)?;
        }
        Ok(())
    }

    /// Writes the states of all bodies to the scene.
    fn put(&self, scene: &mut Scene) -> Result<()> {
        let BodyHandles { declared, implied } = &self.handles;
        for (body, owner) in self.world.bodies.iter().zip(&self.owners) {
            let state = BodyState {
                position: self.in_scene_finely(body),
                velocity: body.velocity,
                momentum: body.momentum,
                orientation: body.pose.turn,
            };
            let put = match *owner {
                Owner::World | Owner::Motion(_) => Ok(()),
                Owner::Sphere(id) => scene.put_sphere(id, &state),
                Owner::Body(number) if number < declared.len() => scene.put_body(declared[number], state),
                Owner::Body(number) => scene.put_implied(implied[number - declared.len()], state),
            };
            // It may have been removed since the last frame.
            if !matches!(put, Err(Error::StaleHandle { .. })) {
                put?;
            }
        }
        Ok(())
    }

    /// The place of a body in coordinates of the scene, with what single precision leaves over.
    fn in_scene_finely(&self, body: &Body) -> Fine {
        let (point, base) = (body.pose.position, self.base + self.world.periods.ways(body.periods));
        if base == DVec3::ZERO {
            return Fine { high: point, low: Vec3::ZERO };
        }
        Fine::at((base + point.as_dvec3()).to_array())
    }

    /// The first sphere of a body, by its index.
    fn first_sphere(&self, body: u32, scene: &Scene) -> usize {
        let id = match self.owners[body as usize] {
            Owner::World | Owner::Motion(_) => None,
            Owner::Sphere(id) => Some(id),
            Owner::Body(number) => scene.whole_bodies().nth(number).and_then(|body| body.spheres.first().copied()),
        };
        id.and_then(|id| scene.spheres.index(id).ok()).unwrap_or_default()
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
    pub(in crate::simulation) async fn drive_frames(&mut self, phases: &[Phase], times: u64) -> Result<()> {
        if let [phase] = phases {
            let expected = "a whole step: the contact law rigid has no phases that run alone";
            return Err(Error::Invalid { field: "phase", value: format!("{phase:?}"), expected });
        }
        let mut left = times;
        while left > 0 {
            let until = self.pass().await?;
            let count = left.min(until);
            self.run_frames(count)?;
            left -= count;
        }
        Ok(())
    }

    /// Makes the bodies with which the next frame begins, and chooses the number of substeps.
    fn ready_frames(&mut self) -> Result<()> {
        if self.frames_due || self.frames.is_none() {
            self.renew_frames()?;
        }
        let Some(frames) = &mut self.frames else { return Ok(()) };
        if std::mem::take(&mut self.drives_due) {
            frames.set_drives(&self.scene);
        }
        if std::mem::take(&mut self.loads_due) {
            frames.set_loads(&self.scene);
        }
        frames.set_laws(&self.world.user_laws.forces);
        self.muscle_clock.set_time_step(self.time_step);
        if frames.substeps == 0 {
            frames.substeps = self.scene.run.substeps.unwrap_or_else(|| auto_substeps(&frames.world, self.time_step));
        }
        Ok(())
    }

    /// Runs frames of [`Simulation::time_step`] seconds.
    fn run_frames(&mut self, count: u64) -> Result<()> {
        self.ready_frames()?;
        let Some(mut frames) = self.frames.take() else { return Ok(()) };
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let (None, Some(gpu)) = (&frames.device, self.engine.frame_device()) {
            frames.device = Some(Box::new(device::OnDevice::new(gpu, &frames.world)?));
        }
        let dt = self.time_step;
        let keeps_going = self.options.keep_going;
        let mut failed = None;
        for _ in 0..count {
            frames.drive(&self.scene, self.muscle_clock.written_time(), dt);
            frames.set_muscles(&self.scene, &self.muscle_clock);
            frames.set_law_time(self.muscle_clock.time());
            self.pull_in(&mut frames)?;
            let report = frames.advance(dt, keeps_going)?;
            if let Some((_, first)) = report.stopped.filter(|_| !keeps_going) {
                failed = Some(frames.first_sphere(first, &self.scene));
                break;
            }
            self.book_frame(report);
        }
        // The states on a device are read when something asks for them.
        let on_device = frames.device.is_some();
        self.frames = Some(frames);
        (self.synced, self.observation) = (!on_device && self.pull_frames()?, None);
        match failed {
            Some(sphere) => Err(Error::NonFinite { sphere, step: self.report.steps + 1, stage: BadStage::from_number(0) }),
            None => Ok(()),
        }
    }

    /// Takes over the states of the bodies. Returns whether the contact law is `rigid`.
    pub(in crate::simulation) fn pull_frames(&mut self) -> Result<bool> {
        let Some(mut frames) = self.frames.take().filter(|_| self.has_frames()) else { return Ok(false) };
        let pulled = frames.fetch().and_then(|()| frames.put(&mut self.scene));
        self.frames = Some(frames);
        pulled?;
        // Objects may have been added since the scene was packed. It is packed again then.
        if self.dirty != Dirty::Everything {
            self.world.set_spheres(&self.scene);
            place_walls(&mut self.world, &self.scene, &self.muscle_clock);
        }
        Ok(true)
    }

    /// The bodies of the scene at the present time. Coordinates begin where those of earlier bodies do.
    fn frames_of_scene(&self, before: Option<&Frames>) -> Result<Frames> {
        let mut frames = Frames::of(&self.scene, before.map(|before| before.base))?;
        frames.place_motions(&self.scene, self.muscle_clock.written_time(), self.time_step);
        Ok(frames)
    }

    /// Makes the bodies anew from the scene. What is known of their contacts stays if the colliders are the same.
    fn renew_frames(&mut self) -> Result<()> {
        self.synced = self.synced || self.pull_frames()?;
        let mut frames = self.frames_of_scene(self.frames.as_deref())?;
        if let Some(mut before) = self.frames.take() {
            before.fetch_history()?;
            frames.keep(&before);
            frames.suit_springs(&self.scene, self.time_step);
        }
        (self.frames, self.frames_due) = (Some(Box::new(frames)), false);
        Ok(())
    }

    /// What a checkpoint keeps of the bodies of the law `rigid`; empty before the first frame.
    ///
    /// # Errors
    /// [`Error::Device`] when the device fails.
    pub(in crate::simulation) fn frame_words(&mut self) -> Result<Vec<u32>> {
        if self.substeps().is_none() {
            return Ok(Vec::new());
        }
        let Some(mut frames) = self.frames.take() else { return Ok(Vec::new()) };
        let words = frames.fetch_history().and_then(|()| self.words_of_next(&frames));
        self.frames = Some(frames);
        words
    }

    /// The words of the bodies that the next frame begins with.
    fn words_of_next(&self, frames: &Frames) -> Result<Vec<u32>> {
        if !self.frames_due {
            return Ok(frames.words());
        }
        // Edits may have changed the bodies.
        let mut edited = self.frames_of_scene(Some(frames))?;
        edited.keep(frames);
        edited.suit_springs(&self.scene, self.time_step);
        Ok(edited.words())
    }

    /// Goes on with what a checkpoint keeps of the bodies of the law `rigid`.
    pub(in crate::simulation) fn put_frames(&mut self, frames: Option<Box<Frames>>) {
        self.frames_due = frames.is_none();
        self.frames = frames;
        self.pulls = None;
    }

    fn book_frame(&mut self, frame: FrameReport) {
        let before = self.status;
        self.status = Status {
            last_contacts: frame.contacts,
            last_max_overlap: frame.max_overlap.to_bits(),
            last_collisions: 0,
            total_bad: self.status.total_bad.wrapping_add(frame.stopped.map_or(0, |(count, _)| count)),
            ..self.status
        };
        self.report.replays += u64::from(frame.repeats);
        self.book(1, &before);
    }
}
