//! Places bodies by the positions of their joints.

use std::collections::HashMap;

use glam::{DQuat, DVec3};

use super::{Anchor, Joint, JointFrame, JointKind};
use crate::error::{Error, Result};
use crate::scene::rigid::wide;
use crate::scene::{Frame, RigidBodyId, Scene};

/// What does not move: the world.
const STILL: Frame = Frame { centre: DVec3::ZERO, turn: DQuat::IDENTITY, velocity: DVec3::ZERO, spin: DVec3::ZERO };

/// Position and speed of a joint.
type Motion = (f64, f64);

/// The frame of one end of a joint, from that of the other one. `ends` begin with the known one. `motion` is that of the
/// unknown one against it.
fn other_end(kind: JointKind, known: &Frame, ends: [JointFrame; 2], (position, speed): Motion) -> Frame {
    let [own, other] = ends;
    let anchor = known.centre + known.turn * own.place.as_dvec3();
    let basis = known.turn * wide(own.turn);
    let axis = basis * DVec3::X;
    let (turned, slid) = match kind {
        JointKind::Ball | JointKind::Hinge => ((position, speed), (0.0, 0.0)),
        JointKind::Slider => ((0.0, 0.0), (position, speed)),
        JointKind::Fixed | JointKind::Distance => ((0.0, 0.0), (0.0, 0.0)),
    };
    let (sine, cosine) = libm::sincos(0.5 * turned.0);
    let turn = (basis * DQuat::from_xyzw(sine, 0.0, 0.0, cosine) * wide(other.turn).inverse()).normalize();
    let point = anchor + slid.0 * axis;
    let centre = point - turn * other.place.as_dvec3();
    let spin = known.spin + turned.1 * axis;
    let at_point = known.velocity + known.spin.cross(point - known.centre) + slid.1 * axis;
    Frame { centre, turn, velocity: at_point + spin.cross(centre - point), spin }
}

/// Bodies that have their place, in the order in which they got it.
#[derive(Default)]
struct Placed {
    frames: HashMap<RigidBodyId, Frame>,
    order: Vec<RigidBodyId>,
}

impl Placed {
    /// The frame of an end: `None` for a body that has no place yet.
    fn frame(&self, anchor: Anchor) -> Option<Frame> {
        match anchor {
            Anchor::Body(id) => self.frames.get(&id).copied(),
            Anchor::World | Anchor::Sphere(_) => Some(STILL),
        }
    }

    fn put(&mut self, anchor: Anchor, frame: Frame) {
        if let Anchor::Body(id) = anchor {
            self.frames.insert(id, frame);
            self.order.push(id);
        }
    }

    /// Places one end by the other one. Returns whether it did.
    fn follow(&mut self, joint: &Joint, (position, speed): Motion) -> bool {
        let Some([a, b]) = joint.ends() else { return false };
        match (self.frame(joint.a), self.frame(joint.b)) {
            (Some(known), None) => self.put(joint.b, other_end(joint.kind, &known, [a, b], (position, speed))),
            (None, Some(known)) => self.put(joint.a, other_end(joint.kind, &known, [b, a], (-position, -speed))),
            _ => return false,
        }
        true
    }
}

impl Scene {
    /// Moves bodies so that their joints have these positions and speeds, one of each per joint in order of addition: rad and
    /// rad/s, or units and units/s.
    ///
    /// A body that joints connect to the world is placed from there. Otherwise the first body of the first joint stays as it
    /// is, and all that it is connected to follows. A ball has the position as its twist and no swing. Numbers of fixed
    /// joints are ignored. Distance joints, and those that close a loop or end at a sphere that moves, place nothing.
    ///
    /// # Errors
    /// [`Error::Invalid`] for another number of positions or speeds than joints, and for numbers that are not finite. Nothing
    /// is changed then.
    pub fn place_joints(&mut self, positions: &[f32], speeds: &[f32]) -> Result<()> {
        let count = self.joints().len();
        for (field, values) in [("positions", positions), ("speeds", speeds)] {
            if values.len() != count {
                let value = format!("{} for {count}", values.len());
                return Err(Error::Invalid { field, value, expected: "one number per joint" });
            }
            if let Some(bad) = values.iter().find(|value| !value.is_finite()) {
                return Err(Error::Invalid { field, value: bad.to_string(), expected: "finite numbers" });
            }
        }
        let placed = self.placed_by(positions, speeds)?;
        for id in placed.order {
            let Some(frame) = placed.frames.get(&id) else { continue };
            let tensor = self.shape_mass(self.bodies.get(id)?.shape)?.tensor(frame.turn);
            self.update_body(id, |body| {
                body.set_centre(frame.centre);
                body.orientation = frame.turn.as_quat().normalize();
                (body.velocity, body.angular_momentum) = (frame.velocity.as_vec3(), (tensor * frame.spin).as_vec3());
            })?;
        }
        Ok(())
    }

    fn placed_by(&self, positions: &[f32], speeds: &[f32]) -> Result<Placed> {
        let moves = |anchor: Anchor| matches!(anchor, Anchor::Sphere(_)) && !self.is_still(anchor);
        let places = |joint: &Joint| joint.kind != JointKind::Distance && !joint.anchors().into_iter().any(moves);
        let numbers = positions.iter().zip(speeds).map(|(position, speed)| (f64::from(*position), f64::from(*speed)));
        let joints: Vec<_> = self.joints().iter().zip(numbers).filter(|(joint, _)| places(joint)).collect();
        let mut placed = Placed::default();
        loop {
            let before = placed.order.len();
            for (joint, motion) in &joints {
                placed.follow(joint, *motion);
            }
            if placed.order.len() > before {
                continue;
            }
            // The next group of bodies, which nothing connects to those before it.
            let first = joints.iter().map(|(joint, _)| joint.a).find(|anchor| placed.frame(*anchor).is_none());
            let Some(anchor @ Anchor::Body(id)) = first else { return Ok(placed) };
            placed.put(anchor, self.frame(id)?);
        }
    }
}
