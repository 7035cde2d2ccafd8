//! Joints: the warm start, and a visit of all joints in a pass (docs/physics section 11.14).

use glam::{Mat3A, Vec3, Vec3A};

use crate::rigid::frame::bodies::{Bodies, Motion};
use crate::rigid::frame::rows::{Pass, Softness};
use crate::rigid::joints::{Drive, Free, Joint, JointState, within};
use crate::rigid::world::RigidWorld;

mod pivot;

use pivot::{Block, Pivot, Row, inverse, mask, reduced};

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
            Visit { biased: pass.biased, is_first, soft: self.soft[at], h: self.h }.solve(joint, state, &mut ends);
            if !pass.biased && !is_first {
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
    fn solve(&self, joint: &Joint, state: &mut JointState, ends: &mut Ends<'_>) {
        self.drive(joint, state, ends);
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

    /// The rows of the free axis and of the cone.
    fn drive(&self, joint: &Joint, state: &mut JointState, ends: &mut Ends<'_>) {
        let drive = &joint.drive;
        let free = ends.pivot.free;
        match &free {
            Some((row, position)) => {
                self.spring(joint, *position, state, ends);
                if !self.biased {
                    let [speed, most] = drive.motor_at(*position, self.h);
                    self.motor(row, speed, most, &mut state.impulses.motor, ends);
                }
            }
            None => (state.impulses.motor, state.impulses.lower, state.impulses.upper) = (0.0, 0.0, 0.0),
        }
        if joint.kind.is_ball() {
            self.resist(drive, state, ends);
        }
        if let Some((row, position)) = free {
            self.hold(joint, &row, position, state, ends);
        }
        if let Some((row, angle)) = &ends.pivot.cone {
            self.limit(row, drive.cone - angle, &mut state.impulses.cone, ends);
        }
    }

    /// Friction, limits and a locked distance.
    fn hold(&self, joint: &Joint, row: &Row, position: f32, state: &mut JointState, ends: &mut Ends<'_>) {
        let (drive, own) = (&joint.drive, &mut state.impulses);
        if !joint.kind.is_ball() && !self.biased {
            self.motor(row, 0.0, drive.friction, &mut own.friction, ends);
        }
        let [low, high] = drive.limits;
        self.limit(row, position - low, &mut own.lower, ends);
        let opposite = Row { along: -row.along, ..*row };
        self.limit(&opposite, high - position, &mut own.upper, ends);
        if drive.locked {
            let speed = ends.speed_of(row);
            let step = if self.biased {
                -(self.soft.mass * speed + self.soft.rate * (position - drive.target)) / row.inverse
                    - self.soft.impulse * own.locked
            } else {
                -speed / row.inverse
            };
            own.locked += step;
            ends.apply(row, step);
        }
    }

    /// The spring in the first visit of the biased pass, a damper in both. Its impulse stays as it is.
    fn spring(&self, joint: &Joint, position: f32, state: &mut JointState, ends: &mut Ends<'_>) {
        let Drive { stiffness, damping, target, spring_limit, locked, .. } = joint.drive;
        let damping = if joint.kind.is_ball() { 0.0 } else { damping };
        let acts = if stiffness == 0.0 { damping > 0.0 } else { self.is_first };
        if !self.biased || locked || !acts {
            return;
        }
        let h = self.h;
        let off = if joint.kind.free == Free::Turn { reduced(position - target, 0.0) } else { position - target };
        let [push, turn] = ends.pivot.spring_row(joint.kind);
        let [moved, turned] = ends.pivot.response(push, turn);
        let inverse = push.dot(moved) + turn.dot(turned);
        let theta = (1.0 - 1.0 / (stiffness * h * h * inverse)).max(0.0);
        let resistance = h * damping + theta * h * h * stiffness;
        let speed = push.dot(ends.speed()) + turn.dot(ends.rate());
        let before = std::mem::take(&mut state.spring);
        let step = -(h * stiffness * off + resistance * speed + before) / (1.0 + resistance * inverse);
        let all = within(before + step, spring_limit, h);
        if self.is_first && stiffness == 0.0 {
            state.spring = all;
        }
        let impulse = all - before;
        ends.push(impulse * push);
        ends.turn(impulse * turn);
        state.force += Vec3::from(impulse * push);
        state.torque += Vec3::from(impulse * turn);
    }

    /// Friction and damping of a ball, against all rotations.
    fn resist(&self, drive: &Drive, state: &mut JointState, ends: &mut Ends<'_>) {
        let (give, axes) = (ends.pivot.turning(), ends.pivot.axes);
        if self.biased && self.is_first && drive.damping > 0.0 {
            let damped = give + Mat3A::from_diagonal(Vec3::splat((self.h * drive.damping).recip()));
            let impulse = -(inverse(damped) * ends.rate());
            ends.turn(impulse);
            state.torque += Vec3::from(impulse);
        } else if !self.biased && drive.friction > 0.0 {
            let before = axes * Vec3A::from(state.impulses.angular);
            let kept = (before - inverse(give) * ends.rate()).clamp_length_max(self.h * drive.friction);
            state.impulses.angular = (axes.transpose() * kept).into();
            ends.turn(kept - before);
        }
    }

    /// A row towards a speed, with a greatest force.
    fn motor(&self, row: &Row, speed: f32, most: f32, kept: &mut f32, ends: &mut Ends<'_>) {
        if most == 0.0 && *kept == 0.0 {
            return;
        }
        let before = *kept;
        *kept = within(before - (ends.speed_of(row) - speed) / row.inverse, most, self.h);
        ends.apply(row, *kept - before);
    }

    /// A row that keeps a room from falling below 0. It grows along the row.
    fn limit(&self, row: &Row, room: f32, kept: &mut f32, ends: &mut Ends<'_>) {
        let before = *kept;
        if room == f32::INFINITY {
            return;
        }
        let speed = ends.speed_of(row);
        let step = match self.biased {
            true if room > 0.0 => -(speed + room / self.h) / row.inverse,
            true => -(self.soft.mass * speed + self.soft.rate * room) / row.inverse - self.soft.impulse * before,
            false if room <= 0.0 || before > 0.0 => -speed / row.inverse,
            false => return,
        };
        *kept = (before + step).max(0.0);
        ends.apply(row, *kept - before);
    }
}
