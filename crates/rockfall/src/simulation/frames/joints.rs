//! Joints of a scene as those of the law `rigid` (docs/physics section 11.14), and what a run reads of them.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::{DQuat, DVec3, Vec3};

use super::build::Builder;
use super::check::is_fixed_or_part;
use super::springs::ends_of_spheres;
use super::{Frames, Owner};
use crate::error::Result;
use crate::rigid::frame::{JointMotion, motions_of_joints};
use crate::rigid::joints::{Drive, End, Joint as Row, JointState, Joints, Kind};
use crate::rigid::pose::Pose;
use crate::scene::{Anchor, Joint, JointFrame, JointId, JointKind, RodId, Scene, SphereId};
use crate::simulation::Simulation;
use crate::simulation::edit::Dirty;

/// What a joint does at present.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct JointReading {
    /// Position of the free axis: the angle in rad of a hinge or of the twist of a ball, the way of a slider or the distance of the
    /// anchors of a distance joint in units. 0 for a fixed joint.
    pub position: f32,
    /// Its rate, in rad/s or units/s.
    pub speed: f32,
    /// Force that the joint exerts on its second body at the anchor, in mass units/s²: the mean of the last step.
    pub force: Vec3,
    /// Torque that the joint exerts on its second body, in mass units²/s²: the mean of the last step.
    pub torque: Vec3,
    /// By how much the anchors miss each other, in units. Along the axis of a slider they may. A distance joint that keeps its
    /// length misses that; it is 0 if the joint keeps none.
    pub error: f32,
    /// The joint is broken and exerts nothing any more. The other numbers are 0.
    pub broken: bool,
}

impl Builder<'_> {
    /// All joints in order of addition, then the rods that only keep a distance.
    pub(super) fn joints(&mut self) -> Result<()> {
        let mut list = self.joints_of_rods()?;
        if list.is_empty() && self.scene.joints().is_empty() {
            return Ok(());
        }
        let bodies: HashMap<Anchor, u32> = self.numbers();
        let rods = list.split_off(0);
        for joint in self.scene.joints() {
            let ends = self.scene.joint_poses_of(joint, false)?;
            let frames = joint.ends().unwrap_or([JointFrame { place: Vec3::ZERO, turn: glam::Quat::IDENTITY }; 2]);
            let anchors = joint.anchors();
            let end = |side: usize| self.end(&bodies, anchors[side], frames[side], ends[side]);
            list.push(row_of(joint, [end(0), end(1)]));
        }
        list.extend(rods);
        self.world.joints = Joints::new(list, &self.world.with_mass());
        Ok(())
    }

    /// Rods of fixed length that are not part of a body, as joints that keep the distance of their ends.
    fn joints_of_rods(&self) -> Result<Vec<Row>> {
        let scene = self.scene;
        let rods: Vec<_> = scene.rod_ids().filter(|id| keeps_distance(scene, *id)).collect();
        let ends = if rods.is_empty() { HashMap::new() } else { ends_of_spheres(scene, &self.owners) };
        let end = |id: SphereId| -> Result<End> {
            let fixed = (0, self.local(scene.sphere(id)?.centre().into()));
            let (body, place) = ends.get(&id).map_or(fixed, |end| (end.body, end.place));
            Ok(End { body, place, turn: glam::Quat::IDENTITY })
        };
        let row = |id: &RodId| {
            let rod = scene.rod(*id)?;
            let drive = Drive { locked: true, target: rod.length.unwrap_or_default(), ..Drive::default() };
            let (ends, strength) = ([end(rod.end1)?, end(rod.end2)?], [f32::INFINITY; 2]);
            Ok(Row { kind: Kind::DISTANCE, ends, drive, strength, collides: false })
        };
        rods.iter().map(row).collect()
    }

    /// Numbers of the bodies to which ends are attached. All others are the world.
    fn numbers(&self) -> HashMap<Anchor, u32> {
        let declared: Vec<_> = self.scene.body_ids().collect();
        let bodies: Vec<_> = self.scene.whole_bodies().collect();
        let mut numbers = HashMap::new();
        for (number, owner) in (0..).zip(&self.owners) {
            match *owner {
                Owner::World | Owner::Motion(_) => (),
                Owner::Sphere(id) => drop(numbers.insert(Anchor::Sphere(id), number)),
                Owner::Body(place) => match declared.get(place) {
                    Some(id) => drop(numbers.insert(Anchor::Body(*id), number)),
                    None => numbers.extend(bodies[place].spheres.iter().map(|id| (Anchor::Sphere(*id), number))),
                },
            }
        }
        numbers
    }

    fn end(&self, bodies: &HashMap<Anchor, u32>, anchor: Anchor, frame: JointFrame, (point, turn): (DVec3, DQuat)) -> End {
        let body = bodies.get(&anchor).copied().unwrap_or_default();
        let is_part = matches!(anchor, Anchor::Sphere(_)) && matches!(self.owners[body as usize], Owner::Body(_));
        if !is_part {
            let place = if body == 0 { self.local(frame.place.as_dvec3()) } else { frame.place };
            return End { body, place, turn: frame.turn };
        }
        // The sphere of a capsule: its coordinates are not those of the body.
        let Pose { position, turn: own } = self.world.bodies[body as usize].pose;
        let back = own.as_dquat().normalize().inverse();
        End {
            body,
            place: (back * (point - self.base - position.as_dvec3())).as_vec3(),
            turn: (back * turn).as_quat().normalize(),
        }
    }
}

/// Whether a rod only keeps the distance of its ends: it has a fixed length, is not part of a body, and an end is loose.
pub(crate) fn keeps_distance(scene: &Scene, id: RodId) -> bool {
    scene.rod(id).is_ok_and(|rod| rod.length.is_some()) && !is_fixed_or_part(scene, id)
}

fn kind_of(kind: JointKind) -> Kind {
    match kind {
        JointKind::Ball => Kind::BALL,
        JointKind::Hinge => Kind::HINGE,
        JointKind::Slider => Kind::SLIDER,
        JointKind::Fixed => Kind::FIXED,
        JointKind::Distance => Kind::DISTANCE,
    }
}

fn row_of(joint: &Joint, ends: [End; 2]) -> Row {
    let strength = [joint.break_force, joint.break_torque];
    Row { kind: kind_of(joint.kind), ends, drive: drive_of(joint), strength, collides: joint.collides }
}

fn drive_of(joint: &Joint) -> Drive {
    let [least, most] = joint.limits.unwrap_or([f32::NEG_INFINITY, f32::INFINITY]);
    Drive {
        limits: [least, most],
        cone: joint.cone.unwrap_or(f32::INFINITY),
        locked: joint.is_locked(),
        target: joint.rest(),
        stiffness: joint.stiffness,
        damping: joint.damping,
        effort: joint.effort,
        spring_limit: joint.max_force,
        drag: joint.drag,
        armature: joint.armature,
        speed: joint.speed.unwrap_or_default(),
        motor_limit: if joint.speed.is_some() { joint.max_force } else { 0.0 },
        friction: joint.friction,
    }
}

impl Frames {
    /// Takes over the drives and strengths of the joints, which may change between frames.
    pub(super) fn set_drives(&mut self, scene: &Scene) {
        for (row, joint) in self.world.joints.list.iter_mut().zip(scene.joints()) {
            (row.drive, row.strength) = (drive_of(joint), [joint.break_force, joint.break_torque]);
        }
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(device) = &mut self.device {
            device.set_drives(&self.world);
        }
    }
}

/// Energy that the spring of a joint stores, in mass units²/s².
fn stored((joint, reading): (&Joint, &JointReading)) -> f64 {
    if reading.broken {
        return 0.0;
    }
    let apart = f64::from(reading.position) - f64::from(joint.rest());
    let turns = if joint.kind.turns() { (apart / TAU).round() } else { 0.0 };
    0.5 * f64::from(joint.stiffness) * (apart - turns * TAU).powi(2)
}

impl Simulation {
    /// Energy that the springs of all joints store, in mass units²/s².
    pub(in crate::simulation) fn joint_energy(&mut self) -> Result<f64> {
        if self.scene.joints().iter().all(|joint| joint.stiffness == 0.0) {
            return Ok(0.0);
        }
        let readings = self.joints()?;
        Ok(self.scene.joints().iter().zip(&readings).map(stored).sum())
    }

    /// Adds a joint between two bodies in their present places. It acts from the next step on.
    ///
    /// # Errors
    /// As for [`Scene::add_joint`] and [`Simulation::sync`].
    pub fn add_joint(&mut self, joint: Joint) -> Result<JointId> {
        self.sync()?;
        let id = self.scene.add_joint(joint)?;
        self.dirty = self.dirty.max(Dirty::Topology);
        Ok(id)
    }

    /// Removes joints.
    ///
    /// # Errors
    /// As for [`Scene::remove_joints`].
    pub fn remove_joints(&mut self, ids: &[JointId]) -> Result<()> {
        self.scene.remove_joints(ids)?;
        self.dirty = self.dirty.max(Dirty::Topology);
        Ok(())
    }

    /// Changes the limits, the motor, the spring, the friction, the length and the strength of a joint, from the next step on.
    /// This is cheap: a controller may do it in every step.
    ///
    /// # Errors
    /// As for [`Scene::update_joint`].
    pub fn update_joint(&mut self, id: JointId, change: impl FnOnce(&mut Joint)) -> Result<()> {
        self.scene.update_joint(id, change)?;
        self.drives_due = true;
        Ok(())
    }

    /// Moves bodies so that their joints have these positions and speeds: see [`Scene::place_joints`].
    ///
    /// # Errors
    /// As for [`Scene::place_joints`] and [`Simulation::sync`].
    pub fn place_joints(&mut self, positions: &[f32], speeds: &[f32]) -> Result<()> {
        self.move_bodies(|scene| scene.place_joints(positions, speeds))
    }

    /// What all joints do at present, in order of addition. Before the first step there are no forces.
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    pub fn joints(&mut self) -> Result<Vec<JointReading>> {
        if self.scene.joints().is_empty() {
            return Ok(Vec::new());
        }
        self.sync()?;
        if self.frames.is_none() || self.frames_due {
            self.renew_frames()?;
        }
        let Some(mut frames) = self.frames.take() else { return Ok(Vec::new()) };
        if std::mem::take(&mut self.drives_due) {
            frames.set_drives(&self.scene);
        }
        let read = |(state, motion): (&JointState, JointMotion)| {
            if state.broken {
                return JointReading { broken: true, ..JointReading::default() };
            }
            let JointMotion { position, speed, error } = motion;
            JointReading { position, speed, error, force: state.force, torque: state.torque, broken: false }
        };
        let states = frames.world.joints.states.iter().take(self.scene.joints().len());
        let all = states.zip(motions_of_joints(&frames.world)).map(read).collect();
        self.frames = Some(frames);
        Ok(all)
    }
}
