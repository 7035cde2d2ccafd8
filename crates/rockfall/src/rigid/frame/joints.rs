//! Joints: the warm start, and a visit of all joints in a pass (docs/physics section 11.14).

use glam::{Vec3, Vec3A};

use crate::rigid::frame::bodies::{Bodies, Motion};
use crate::rigid::frame::rows::{Pass, Softness};
use crate::rigid::joints::{Drive, Joint, JointState, within};
use crate::rigid::world::RigidWorld;

mod axis;
mod drive;
mod pivot;

use axis::Axis;
use pivot::{Block, Pivot, Row, inverse, mask};

/// Damping ratio of the rows.
const DAMPING: f32 = 2.0;

/// The joints of a frame.
pub(super) struct Joints<'a> {
    list: &'a [Joint],
    pub(super) states: Vec<JointState>,
    /// The joints that are not broken, in the order in which they are solved.
    order: Vec<usize>,
    /// Their geometry in the present poses, in this order.
    pivots: Vec<Pivot>,
    soft: Vec<Softness>,
    h: f32,
}

impl<'a> Joints<'a> {
    /// The joints of a world at the start of a frame with substeps of `h` seconds, which are `ratio` times those of the last frame.
    pub(super) fn begin(world: &'a RigidWorld, ratio: f32, h: f32) -> Self {
        let joints = &world.joints;
        let begun = |(joint, state): (&Joint, &JointState)| {
            let impulses = state.impulses.begun(joint.kind, &joint.drive, ratio, h);
            JointState { impulses, force: Vec3::ZERO, torque: Vec3::ZERO, ..*state }
        };
        let states: Vec<JointState> = joints.list.iter().zip(&joints.states).map(begun).collect();
        let order: Vec<usize> =
            joints.order.iter().map(|number| *number as usize).filter(|number| !states[*number].broken).collect();
        let soft = order.iter().map(|number| Softness::of(joints.frequencies[*number], DAMPING, h)).collect();
        Self { list: &joints.list, states, order, pivots: Vec::new(), soft, h }
    }

    /// Forms the geometry anew after the bodies were moved.
    pub(super) fn refresh(&mut self, bodies: &Bodies) {
        self.pivots.clear();
        self.pivots.extend(self.order.iter().map(|number| Pivot::new(&self.list[*number], bodies)));
    }

    /// Takes over the rates of the rotors at the start of the frame.
    pub(super) fn start_rotors(&mut self, bodies: &Bodies) {
        for (number, pivot) in self.order.iter().zip(&self.pivots) {
            let (joint, state) = (&self.list[*number], &mut self.states[*number]);
            let ends = Ends::of(pivot, joint, bodies);
            state.rotor = match &pivot.free {
                _ if joint.drive.armature == 0.0 => Vec3::ZERO,
                _ if joint.kind.is_ball() => (pivot.axes.transpose() * ends.rate()).into(),
                Some((row, _)) => ends.speed_of(row) * Vec3::X,
                None => Vec3::ZERO,
            };
        }
    }

    /// Applies the impulses of the last substep.
    pub(super) fn warm_start(&self, bodies: &mut Bodies) {
        for (number, pivot) in self.order.iter().zip(&self.pivots) {
            let joint = &self.list[*number];
            let (push, turn) = pivot.total(joint, &self.states[*number]);
            let mut ends = Ends::of(pivot, joint, bodies);
            ends.push(push);
            ends.turn(turn);
            ends.put(joint, bodies);
        }
    }

    /// Solves all joints twice: colour by colour, and once more in the opposite order. The biased pass begins with the first colour, the
    /// relax pass with the last one.
    pub(super) fn pass(&mut self, bodies: &mut Bodies, pass: &Pass) {
        let count = self.order.len();
        for place in 0..2 * count {
            let (is_first, turned) = (place < count, if place < count { place } else { 2 * count - 1 - place });
            let at = if pass.biased { turned } else { count - 1 - turned };
            let (number, pivot) = (self.order[at], &self.pivots[at]);
            let (joint, state) = (&self.list[number], &mut self.states[number]);
            let mut ends = Ends::of(pivot, joint, bodies);
            let visit = Visit { biased: pass.biased, is_first, soft: self.soft[at], h: self.h };
            visit.solve(joint, state, &mut ends);
            if visit.is_last() {
                let (push, turn) = pivot.total(joint, state);
                state.force += Vec3::from(push);
                state.torque += Vec3::from(turn);
            }
            ends.put(joint, bodies);
        }
    }
}

/// Makes the mean loads of a frame of `dt` seconds from the sums of its impulses.
pub(super) fn end(states: &mut [JointState], dt: f32) {
    for state in states {
        state.force /= dt;
        state.torque /= dt;
    }
}

/// The position of a joint, its rate, and the distance by which its anchors miss what its rows want.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointMotion {
    pub(crate) position: f32,
    pub(crate) speed: f32,
    pub(crate) error: f32,
}

/// The motions of all joints at present.
pub(crate) fn motions_of_joints(world: &RigidWorld) -> Vec<JointMotion> {
    let bodies = Bodies::load(world, 0.0);
    let motion = |joint: &Joint| {
        let pivot = Pivot::new(joint, &bodies);
        let position = pivot.position(joint.kind.free, joint.drive.limits);
        let speed = pivot.free.map_or(0.0, |(row, _)| Ends::of(&pivot, joint, &bodies).speed_of(&row));
        let missed = mask(joint.kind.linear) * pivot.missed();
        let error = if joint.drive.locked { (position - joint.drive.target).abs() } else { missed.length() };
        JointMotion { position, speed, error }
    };
    world.joints.list.iter().map(motion).collect()
}

/// Both bodies of a joint while it is solved.
struct Ends<'a> {
    pivot: &'a Pivot,
    a: Motion,
    b: Motion,
}

impl<'a> Ends<'a> {
    fn of(pivot: &'a Pivot, joint: &Joint, bodies: &Bodies) -> Self {
        let [a, b] = [0, 1].map(|end: usize| bodies.motions[joint.ends[end].body as usize]);
        Self { pivot, a, b }
    }

    /// Writes the motions back.
    fn put(self, joint: &Joint, bodies: &mut Bodies) {
        for (end, motion) in joint.ends.iter().zip([self.a, self.b]) {
            let body = end.body as usize;
            if bodies.constants[body].dynamic {
                bodies.motions[body] = motion;
            }
        }
    }

    /// Velocity of B at the anchor relative to A.
    fn speed(&self) -> Vec3A {
        self.b.at(self.pivot.arm_b) - self.a.at(self.pivot.arm_a)
    }

    /// Angular velocity of B relative to A.
    fn rate(&self) -> Vec3A {
        self.b.spin - self.a.spin
    }

    /// An impulse on B at its anchor, and its opposite on A at the same point.
    fn push(&mut self, impulse: Vec3A) {
        let Pivot { mass_a, mass_b, arm_a, arm_b, .. } = self.pivot;
        self.a.velocity -= mass_a.inverse_mass * impulse;
        self.a.spin -= mass_a.inverse_inertia * arm_a.cross(impulse);
        self.b.velocity += mass_b.inverse_mass * impulse;
        self.b.spin += mass_b.inverse_inertia * arm_b.cross(impulse);
    }

    /// An angular impulse on B, and its opposite on A.
    fn turn(&mut self, impulse: Vec3A) {
        self.a.spin -= self.pivot.mass_a.inverse_inertia * impulse;
        self.b.spin += self.pivot.mass_b.inverse_inertia * impulse;
    }

    fn speed_of(&self, row: &Row) -> f32 {
        row.along.dot(if row.angular { self.rate() } else { self.speed() })
    }

    fn apply(&mut self, row: &Row, impulse: f32) {
        if row.angular {
            self.turn(impulse * row.along);
        } else {
            self.push(impulse * row.along);
        }
    }
}

/// A visit of a joint in a pass.
struct Visit {
    biased: bool,
    /// The first one of the two in a pass.
    is_first: bool,
    soft: Softness,
    h: f32,
}

impl Visit {
    /// Whether this is the last visit of the substep.
    fn is_last(&self) -> bool {
        !self.biased && !self.is_first
    }

    /// Rows that no block answers come before the blocks, and those that a block answers after them.
    fn solve(&self, joint: &Joint, state: &mut JointState, ends: &mut Ends<'_>) {
        let drive = &joint.drive;
        if joint.kind.is_ball() {
            self.resist(drive, state, ends);
            self.rub(drive, state, ends);
        }
        if let Some((row, angle)) = &ends.pivot.cone {
            self.limit(&mut Axis::alone(*row), 1.0, drive.cone - angle, &mut state.impulses.cone, ends);
        }
        let (own, axes) = (&mut state.impulses, &ends.pivot.axes);
        if let Some(block) = &ends.pivot.angular {
            let step = self.step(block, axes.transpose() * ends.rate(), own.angular.into());
            own.angular += Vec3::from(step);
            ends.turn(*axes * step);
        }
        if let Some(block) = &ends.pivot.linear {
            let step = self.step(block, axes.transpose() * ends.speed(), own.linear.into());
            own.linear += Vec3::from(step);
            ends.push(*axes * step);
        }
        self.along(joint, state, ends);
    }

    /// The part of a rate that a block takes away.
    fn gain(&self) -> f32 {
        if self.biased { self.soft.mass } else { 1.0 }
    }

    /// The change of the impulses of a block.
    fn step(&self, block: &Block, rate: Vec3A, before: Vec3A) -> Vec3A {
        let rate = block.mask * rate;
        if self.biased {
            let wanted = self.soft.mass * rate + self.soft.rate * block.off;
            -block.scale * (block.inverse * wanted) - self.soft.impulse * before
        } else {
            -block.scale * (block.inverse * rate)
        }
    }

    /// The rows of the free axis.
    fn along(&self, joint: &Joint, state: &mut JointState, ends: &mut Ends<'_>) {
        let drive = &joint.drive;
        let Some((row, position)) = ends.pivot.free else {
            let own = &mut state.impulses;
            (own.motor, own.lower, own.upper, own.drive) = (0.0, 0.0, 0.0, 0.0);
            return;
        };
        let armature = if joint.kind.is_ball() { 0.0 } else { drive.armature };
        let mut axis = Axis::new(row, ends.pivot, self.gain());
        self.act(joint, position, &mut axis, state, ends);
        axis.take_along(armature);
        if !self.biased {
            let [speed, most] = drive.motor_at(position, self.h);
            self.motor(&mut axis, speed, most, &mut state.impulses.motor, ends);
        }
        self.hold(joint, &mut axis, position, state, ends);
        axis.settle(&mut state.impulses);
        if self.is_last() {
            state.rotor.x = if armature > 0.0 { ends.speed_of(&row) } else { state.rotor.x };
        }
    }

    /// Friction, limits and a locked distance.
    fn hold(&self, joint: &Joint, axis: &mut Axis, position: f32, state: &mut JointState, ends: &mut Ends<'_>) {
        let (drive, own) = (&joint.drive, &mut state.impulses);
        if !joint.kind.is_ball() && !self.biased {
            self.motor(axis, 0.0, drive.friction, &mut own.friction, ends);
        }
        let [low, high] = drive.limits;
        self.limit(axis, 1.0, position - low, &mut own.lower, ends);
        self.limit(axis, -1.0, high - position, &mut own.upper, ends);
        if drive.locked {
            let speed = ends.speed_of(&axis.row);
            let step = if self.biased {
                -(self.soft.mass * speed + self.soft.rate * (position - drive.target)) / axis.give
                    - self.soft.impulse * own.locked
            } else {
                -speed / axis.give
            };
            own.locked += step;
            axis.apply(step, ends);
        }
    }

    /// Friction of a ball, against all rotations.
    fn rub(&self, drive: &Drive, state: &mut JointState, ends: &mut Ends<'_>) {
        if self.biased || drive.friction == 0.0 {
            return;
        }
        let (give, axes) = (ends.pivot.turning(), ends.pivot.axes);
        let before = axes * Vec3A::from(state.impulses.angular);
        let kept = (before - inverse(give) * ends.rate()).clamp_length_max(self.h * drive.friction);
        state.impulses.angular = (axes.transpose() * kept).into();
        ends.turn(kept - before);
    }

    /// A row towards a speed, with a greatest force.
    fn motor(&self, axis: &mut Axis, speed: f32, most: f32, kept: &mut f32, ends: &mut Ends<'_>) {
        if most == 0.0 && *kept == 0.0 {
            return;
        }
        let before = *kept;
        *kept = within(before - (ends.speed_of(&axis.row) - speed) / axis.give, most, self.h);
        axis.apply(*kept - before, ends);
    }

    /// A row that keeps a room from falling below 0. It grows along the row, or against it with the side -1.
    fn limit(&self, axis: &mut Axis, side: f32, room: f32, kept: &mut f32, ends: &mut Ends<'_>) {
        let before = *kept;
        if room == f32::INFINITY {
            return;
        }
        let (speed, inverse) = (side * ends.speed_of(&axis.row), axis.give);
        // A limit that is not reached in this substep.
        if before == 0.0 && room > 0.0 && (!self.biased || speed + room / self.h >= 0.0) {
            return;
        }
        let step = match self.biased {
            true if room > 0.0 => -(speed + room / self.h) / inverse,
            true => -(self.soft.mass * speed + self.soft.rate * room) / inverse - self.soft.impulse * before,
            false if room <= 0.0 || before > 0.0 => -speed / inverse,
            false => return,
        };
        *kept = (before + step).max(0.0);
        axis.apply(side * (*kept - before), ends);
    }
}
