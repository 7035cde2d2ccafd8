//! Joints: the warm start, and a visit of all joints in a pass (docs/physics.md section 11.14).

use std::f32::consts::{PI, TAU};

use glam::{Mat3A, Vec3, Vec3A};

use crate::rigid::frame::bodies::{Bodies, Mass, Motion};
use crate::rigid::frame::rows::{Pass, Softness};
use crate::rigid::joints::{Drive, Free, Joint, JointState, Joints, Kind, within};
use crate::rigid::world::RigidWorld;
use crate::rotate::{back, product, rotated};

/// Damping ratio of the rows.
const DAMPING: f32 = 2.0;
/// Axes that point away from each other by more than this cosine have no mean.
const OPPOSITE: f32 = -0.9;

/// The states of the joints at the start of a frame with substeps of `h` seconds, which are `ratio` times those of the last frame.
pub(super) fn begin(joints: &Joints, ratio: f32, h: f32) -> Vec<JointState> {
    let begun = |(joint, state): (&Joint, &JointState)| {
        let impulses = state.impulses.begun(joint.kind, &joint.drive, ratio, h);
        JointState { impulses, force: Vec3::ZERO, torque: Vec3::ZERO, ..*state }
    };
    joints.list.iter().zip(&joints.states).map(begun).collect()
}

/// Makes the mean loads of a frame of `dt` seconds from the sums of its impulses.
pub(super) fn end(states: &mut [JointState], dt: f32) {
    for state in states {
        state.force /= dt;
        state.torque /= dt;
    }
}

/// The joints that are not broken, in the order in which they are solved.
fn present<'a>(joints: &'a Joints, states: &'a [JointState]) -> impl Iterator<Item = usize> + use<'a> {
    joints.order.iter().map(|number| *number as usize).filter(|number| !states[*number].broken)
}

/// Applies the impulses of the last substep.
pub(super) fn warm_start(joints: &Joints, states: &mut [JointState], bodies: &mut Bodies) {
    let order: Vec<usize> = present(joints, states).collect();
    for number in order {
        let (joint, state) = (&joints.list[number], &mut states[number]);
        let mut pivot = Pivot::new(joint, bodies);
        let (push, turn) = pivot.total(joint, state);
        pivot.push(push);
        pivot.turn(turn);
        pivot.put(joint, bodies);
    }
}

/// Solves all joints twice: colour by colour, and once more in the opposite order. The biased pass begins with the first colour, the relax
/// pass with the last one.
pub(super) fn pass(joints: &Joints, states: &mut [JointState], bodies: &mut Bodies, pass: &Pass, h: f32) {
    let order: Vec<usize> = present(joints, states).collect();
    let (there, back) = (order.iter().copied(), order.iter().rev().copied());
    let visits: Vec<usize> = if pass.biased { there.chain(back).collect() } else { back.chain(there).collect() };
    for (place, number) in visits.into_iter().enumerate() {
        let (joint, state) = (&joints.list[number], &mut states[number]);
        let mut pivot = Pivot::new(joint, bodies);
        let (is_first, soft) = (place < order.len(), Softness::of(joints.frequencies[number], DAMPING, h));
        Visit { biased: pass.biased, is_first, soft, h }.solve(joint, state, &mut pivot);
        if !pass.biased && !is_first {
            let (push, turn) = pivot.total(joint, state);
            state.force += Vec3::from(push);
            state.torque += Vec3::from(turn);
        }
        pivot.put(joint, bodies);
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
        let speed = pivot.free_row(joint.kind).map_or(0.0, |row| pivot.speed_of(&row));
        let missed = mask(joint.kind.linear) * (pivot.axes.transpose() * pivot.apart);
        let error = if joint.drive.locked { (position - joint.drive.target).abs() } else { missed.length() };
        JointMotion { position, speed, error }
    };
    world.joints.list.iter().map(motion).collect()
}

/// 1 for the axes that have a row.
fn mask(rows: u8) -> Vec3A {
    Vec3A::from_array([0, 1, 2].map(|axis| if rows & (1 << axis) != 0 { 1.0 } else { 0.0 }))
}

/// Both bodies of a joint and its geometry in their present poses.
struct Pivot {
    a: Motion,
    b: Motion,
    mass_a: Mass,
    mass_b: Mass,
    /// The anchor of B from the centres of A and B.
    arm_a: Vec3A,
    arm_b: Vec3A,
    /// From the anchor of A to that of B.
    apart: Vec3A,
    /// The joint frame of A; its first axis is that of the joint.
    axes: Mat3A,
    /// The axis in the joint frame of B.
    other: Vec3A,
    /// Twice the vector part of the rotation from the joint frame of A to that of B, along the axes of A, and its scalar.
    turned: Vec3A,
    scalar: f32,
}

/// A row along a direction, with the inverse of its mass.
#[derive(Clone, Copy)]
struct Row {
    along: Vec3A,
    angular: bool,
    inverse: f32,
}

impl Pivot {
    fn new(joint: &Joint, bodies: &Bodies) -> Self {
        let [end_a, end_b] = &joint.ends;
        let [a, b] = [end_a.body as usize, end_b.body as usize];
        let (pose_a, pose_b) = (&bodies.poses[a], &bodies.poses[b]);
        let between = Vec3A::from(pose_b.position - pose_a.position);
        let [own, other] = [product(pose_a.turn, end_a.turn), product(pose_b.turn, end_b.turn)];
        let arm_b = Vec3A::from(rotated(pose_b.turn, end_b.place));
        let arm_a = between + arm_b;
        let relative = product(back(own), other);
        let sign = if relative.w < 0.0 { -1.0 } else { 1.0 };
        Self {
            a: bodies.motions[a],
            b: bodies.motions[b],
            mass_a: bodies.masses[a],
            mass_b: bodies.masses[b],
            arm_a,
            arm_b,
            apart: arm_a - Vec3A::from(rotated(pose_a.turn, end_a.place)),
            axes: Mat3A::from_quat(own),
            other: rotated(other, Vec3::X).into(),
            turned: Vec3A::new(relative.x, relative.y, relative.z) * (2.0 * sign),
            scalar: sign * relative.w,
        }
    }

    /// Writes the motions back.
    fn put(self, joint: &Joint, bodies: &mut Bodies) {
        let Self { a, b, .. } = self;
        for (end, motion) in joint.ends.iter().zip([a, b]) {
            let body = end.body as usize;
            if bodies.constants[body].dynamic {
                bodies.motions[body] = motion;
            }
        }
    }

    /// Velocity of B at the anchor relative to A.
    fn speed(&self) -> Vec3A {
        self.b.at(self.arm_b) - self.a.at(self.arm_a)
    }

    /// Angular velocity of B relative to A.
    fn rate(&self) -> Vec3A {
        self.b.spin - self.a.spin
    }

    /// An impulse on B at its anchor, and its opposite on A at the same point.
    fn push(&mut self, impulse: Vec3A) {
        self.a.velocity -= self.mass_a.inverse_mass * impulse;
        self.a.spin -= self.mass_a.inverse_inertia * self.arm_a.cross(impulse);
        self.b.velocity += self.mass_b.inverse_mass * impulse;
        self.b.spin += self.mass_b.inverse_inertia * self.arm_b.cross(impulse);
    }

    /// An angular impulse on B, and its opposite on A.
    fn turn(&mut self, impulse: Vec3A) {
        self.a.spin -= self.mass_a.inverse_inertia * impulse;
        self.b.spin += self.mass_b.inverse_inertia * impulse;
    }

    /// The mean of both axes, about which the twist is measured.
    fn twist_axis(&self) -> Vec3A {
        let (axis, cosine) = (self.axes.x_axis, self.axes.x_axis.dot(self.other));
        if cosine < OPPOSITE { axis } else { (axis + self.other) / (1.0 + cosine) }
    }

    /// From the anchor of A to that of B; the axis where they are at the same place.
    fn line(&self) -> Vec3A {
        self.apart.try_normalize().unwrap_or(self.axes.x_axis)
    }

    /// The row of the free axis. A ball whose axes are almost opposite has no twist.
    fn free_row(&self, kind: Kind) -> Option<Row> {
        match kind.free {
            Free::None => None,
            Free::Turn if kind.is_ball() && self.axes.x_axis.dot(self.other) < OPPOSITE => None,
            Free::Turn => Some(self.angular_row(self.twist_axis())),
            Free::Slide => Some(self.linear_row(self.axes.x_axis)),
            Free::Line => Some(self.linear_row(self.line())),
        }
    }

    fn linear_row(&self, along: Vec3A) -> Row {
        let (turn_a, turn_b) = (self.arm_a.cross(along), self.arm_b.cross(along));
        let linear = self.mass_a.inverse_mass + self.mass_b.inverse_mass;
        let turning = turn_a.dot(self.mass_a.inverse_inertia * turn_a) + turn_b.dot(self.mass_b.inverse_inertia * turn_b);
        Row { along, angular: false, inverse: linear + turning }
    }

    fn angular_row(&self, along: Vec3A) -> Row {
        let inertia = self.mass_a.inverse_inertia + self.mass_b.inverse_inertia;
        Row { along, angular: true, inverse: along.dot(inertia * along) }
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

    /// What an impulse on B at its anchor and an angular impulse give: the velocity of B at the anchor and its spin, relative to A.
    fn response(&self, push: Vec3A, turn: Vec3A) -> [Vec3A; 2] {
        let a = self.mass_a.inverse_inertia * (self.arm_a.cross(push) + turn);
        let b = self.mass_b.inverse_inertia * (self.arm_b.cross(push) + turn);
        let linear = self.mass_a.inverse_mass + self.mass_b.inverse_mass;
        [linear * push + a.cross(self.arm_a) + b.cross(self.arm_b), a + b]
    }

    /// The impulse of a spring of 1 along the free axis, with what the rows of the joint answer at once: push and angular impulse.
    fn spring_row(&self, kind: Kind) -> [Vec3A; 2] {
        let axis = self.free_row(kind).map_or(Vec3A::ZERO, |row| row.along);
        match kind.free {
            Free::Turn if kind.linear == 0b111 => {
                let [moved, _] = self.response(Vec3A::ZERO, axis);
                let columns = Vec3A::AXES.map(|along| self.response(along, Vec3A::ZERO)[0]);
                [-(inverse(Mat3A::from_cols(columns[0], columns[1], columns[2])) * moved), axis]
            }
            Free::Slide if kind.angular == 0b111 => {
                let [_, turned] = self.response(axis, Vec3A::ZERO);
                [axis, -(inverse(self.mass_a.inverse_inertia + self.mass_b.inverse_inertia) * turned)]
            }
            Free::Turn => [Vec3A::ZERO, axis],
            _ => [axis, Vec3A::ZERO],
        }
    }

    /// The position of the free axis.
    fn position(&self, free: Free, limits: [f32; 2]) -> f32 {
        match free {
            Free::None => 0.0,
            Free::Turn => reduced(2.0 * libm::atan2f(0.5 * self.turned.x, self.scalar), middle(limits)),
            Free::Slide => self.axes.x_axis.dot(self.apart),
            Free::Line => self.apart.length(),
        }
    }

    /// The impulses of the last substep on B: a push at its anchor and an angular impulse.
    fn total(&self, joint: &Joint, state: &JointState) -> (Vec3A, Vec3A) {
        let own = &state.impulses;
        let mut push = self.axes * Vec3A::from(own.linear);
        let mut turn = self.axes * Vec3A::from(own.angular);
        let along = own.locked + own.motor + own.friction + own.lower - own.upper;
        match joint.kind.free {
            Free::None => (),
            Free::Turn => turn += along * self.twist_axis(),
            Free::Slide => push += along * self.axes.x_axis,
            Free::Line => push += along * self.line(),
        }
        if let Some(direction) = self.swing() {
            turn -= own.cone * direction;
        }
        (push, turn)
    }

    /// The direction about which the axis of B is turned away from that of A.
    fn swing(&self) -> Option<Vec3A> {
        self.axes.x_axis.cross(self.other).try_normalize()
    }
}

fn middle([low, high]: [f32; 2]) -> f32 {
    if low.is_finite() && high.is_finite() { 0.5 * (low + high) } else { 0.0 }
}

/// An angle that is within half a turn of another one.
fn reduced(angle: f32, about: f32) -> f32 {
    if (angle - about).abs() <= PI { angle } else { angle - TAU * ((angle - about) / TAU).round() }
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
    fn solve(&self, joint: &Joint, state: &mut JointState, pivot: &mut Pivot) {
        self.drive(joint, state, pivot);
        let own = &mut state.impulses;
        if joint.kind.angular != 0 {
            let inertia = pivot.mass_a.inverse_inertia + pivot.mass_b.inverse_inertia;
            let off = match joint.kind.angular {
                0b111 => pivot.turned,
                _ => pivot.axes.transpose() * pivot.axes.x_axis.cross(pivot.other),
            };
            let step = self.block(inertia, pivot.rate(), off, joint.kind.angular, &pivot.axes, own.angular.into());
            own.angular += Vec3::from(step);
            pivot.turn(pivot.axes * step);
        }
        if joint.kind.linear != 0 {
            let [a, b] = [(&pivot.mass_a, pivot.arm_a), (&pivot.mass_b, pivot.arm_b)].map(|(mass, arm)| at_arm(mass, arm));
            let off = pivot.axes.transpose() * pivot.apart;
            let step = self.block(a + b, pivot.speed(), off, joint.kind.linear, &pivot.axes, own.linear.into());
            own.linear += Vec3::from(step);
            pivot.push(pivot.axes * step);
        }
    }

    /// The change of the impulses of a block of rows along some axes.
    fn block(&self, inverse: Mat3A, speed: Vec3A, off: Vec3A, rows: u8, axes: &Mat3A, before: Vec3A) -> Vec3A {
        let mut matrix = axes.transpose() * inverse * *axes;
        let has = [0, 1, 2].map(|axis| rows & (1 << axis) != 0);
        let scale = (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z).recip();
        matrix *= scale;
        for axis in (0..3).filter(|axis| !has[*axis]) {
            for other in 0..3 {
                matrix.col_mut(axis)[other] = 0.0;
                matrix.col_mut(other)[axis] = 0.0;
            }
            matrix.col_mut(axis)[axis] = 1.0;
        }
        let mask = mask(rows);
        let rate = mask * (axes.transpose() * speed);
        let inverse = matrix.inverse();
        if self.biased {
            -scale * (inverse * (self.soft.mass * rate + self.soft.rate * (mask * off))) - self.soft.impulse * before
        } else {
            -scale * (inverse * rate)
        }
    }

    /// The rows of the free axis and of the cone.
    fn drive(&self, joint: &Joint, state: &mut JointState, pivot: &mut Pivot) {
        let drive = &joint.drive;
        let free = pivot.free_row(joint.kind).map(|row| (row, pivot.position(joint.kind.free, drive.limits)));
        match &free {
            Some((row, position)) => {
                self.spring(joint, *position, state, pivot);
                if !self.biased {
                    let [speed, most] = drive.motor_at(*position, self.h);
                    self.motor(row, speed, most, &mut state.impulses.motor, pivot);
                }
            }
            None => (state.impulses.motor, state.impulses.lower, state.impulses.upper) = (0.0, 0.0, 0.0),
        }
        if joint.kind.is_ball() {
            self.resist(drive, state, pivot);
        }
        if let Some((row, position)) = free {
            self.hold(joint, &row, position, state, pivot);
        }
        if drive.cone.is_finite()
            && let Some(direction) = pivot.swing()
        {
            let sine = pivot.axes.x_axis.cross(pivot.other).length();
            let angle = libm::atan2f(sine, pivot.axes.x_axis.dot(pivot.other));
            let row = pivot.angular_row(-direction);
            self.limit(&row, drive.cone - angle, &mut state.impulses.cone, pivot);
        }
    }

    /// Friction, limits and a locked distance.
    fn hold(&self, joint: &Joint, row: &Row, position: f32, state: &mut JointState, pivot: &mut Pivot) {
        let (drive, own) = (&joint.drive, &mut state.impulses);
        if !joint.kind.is_ball() && !self.biased {
            self.motor(row, 0.0, drive.friction, &mut own.friction, pivot);
        }
        let [low, high] = drive.limits;
        self.limit(row, position - low, &mut own.lower, pivot);
        let opposite = Row { along: -row.along, ..*row };
        self.limit(&opposite, high - position, &mut own.upper, pivot);
        if drive.locked {
            let speed = pivot.speed_of(row);
            let step = if self.biased {
                -(self.soft.mass * speed + self.soft.rate * (position - drive.target)) / row.inverse
                    - self.soft.impulse * own.locked
            } else {
                -speed / row.inverse
            };
            own.locked += step;
            pivot.apply(row, step);
        }
    }

    /// The spring in the first visit of the biased pass, a damper in both. Its impulse stays as it is.
    fn spring(&self, joint: &Joint, position: f32, state: &mut JointState, pivot: &mut Pivot) {
        let Drive { stiffness, damping, target, spring_limit, locked, .. } = joint.drive;
        let damping = if joint.kind.is_ball() { 0.0 } else { damping };
        let acts = if stiffness == 0.0 { damping > 0.0 } else { self.is_first };
        if !self.biased || locked || !acts {
            return;
        }
        let h = self.h;
        let off = if joint.kind.free == Free::Turn { reduced(position - target, 0.0) } else { position - target };
        let [push, turn] = pivot.spring_row(joint.kind);
        let [moved, turned] = pivot.response(push, turn);
        let inverse = push.dot(moved) + turn.dot(turned);
        let theta = (1.0 - 1.0 / (stiffness * h * h * inverse)).max(0.0);
        let resistance = h * damping + theta * h * h * stiffness;
        let speed = push.dot(pivot.speed()) + turn.dot(pivot.rate());
        let before = std::mem::take(&mut state.spring);
        let step = -(h * stiffness * off + resistance * speed + before) / (1.0 + resistance * inverse);
        let all = within(before + step, spring_limit, h);
        if self.is_first && stiffness == 0.0 {
            state.spring = all;
        }
        let impulse = all - before;
        pivot.push(impulse * push);
        pivot.turn(impulse * turn);
        state.force += Vec3::from(impulse * push);
        state.torque += Vec3::from(impulse * turn);
    }

    /// Friction and damping of a ball, against all rotations.
    fn resist(&self, drive: &Drive, state: &mut JointState, pivot: &mut Pivot) {
        let give = pivot.mass_a.inverse_inertia + pivot.mass_b.inverse_inertia;
        if self.biased && self.is_first && drive.damping > 0.0 {
            let damped = give + Mat3A::from_diagonal(Vec3::splat((self.h * drive.damping).recip()));
            let impulse = -(inverse(damped) * pivot.rate());
            pivot.turn(impulse);
            state.torque += Vec3::from(impulse);
        } else if !self.biased && drive.friction > 0.0 {
            let before = pivot.axes * Vec3A::from(state.impulses.angular);
            let kept = (before - inverse(give) * pivot.rate()).clamp_length_max(self.h * drive.friction);
            state.impulses.angular = (pivot.axes.transpose() * kept).into();
            pivot.turn(kept - before);
        }
    }

    /// A row towards a speed, with a greatest force.
    fn motor(&self, row: &Row, speed: f32, most: f32, kept: &mut f32, pivot: &mut Pivot) {
        if most == 0.0 && *kept == 0.0 {
            return;
        }
        let before = *kept;
        *kept = within(before - (pivot.speed_of(row) - speed) / row.inverse, most, self.h);
        pivot.apply(row, *kept - before);
    }

    /// A row that keeps a room from falling below 0. It grows along the row.
    fn limit(&self, row: &Row, room: f32, kept: &mut f32, pivot: &mut Pivot) {
        let before = *kept;
        if room == f32::INFINITY {
            return;
        }
        let speed = pivot.speed_of(row);
        let step = match self.biased {
            true if room > 0.0 => -(speed + room / self.h) / row.inverse,
            true => -(self.soft.mass * speed + self.soft.rate * room) / row.inverse - self.soft.impulse * before,
            false if room <= 0.0 || before > 0.0 => -speed / row.inverse,
            false => return,
        };
        *kept = (before + step).max(0.0);
        pivot.apply(row, *kept - before);
    }
}

/// The inverse of a positive matrix, whatever its scale.
fn inverse(matrix: Mat3A) -> Mat3A {
    let scale = (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z).recip();
    (matrix * scale).inverse() * scale
}

/// How a body gives way at an arm: its inverse mass with that of its rotation.
fn at_arm(mass: &Mass, arm: Vec3A) -> Mat3A {
    let cross =
        Mat3A::from_cols(Vec3A::new(0.0, arm.z, -arm.y), Vec3A::new(-arm.z, 0.0, arm.x), Vec3A::new(arm.y, -arm.x, 0.0));
    Mat3A::from_diagonal(Vec3::splat(mass.inverse_mass)) + cross * mass.inverse_inertia * cross.transpose()
}
