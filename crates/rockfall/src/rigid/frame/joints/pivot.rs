//! The geometry of a joint in one pose of its bodies, and what follows from it (docs/physics section 11.14).

use std::f32::consts::{PI, TAU};

use glam::{Mat3A, Vec3, Vec3A};

use crate::rigid::frame::bodies::{Bodies, Mass};
use crate::rigid::joints::{Free, Joint, JointState, Kind};
use crate::rotate::{back, product, rotated};

/// Axes that point away from each other by more than this cosine have no mean.
const OPPOSITE: f32 = -0.9;

/// A joint in one pose of its bodies. A substep reads it four to five times between two drifts.
pub(super) struct Pivot {
    pub(super) mass_a: Mass,
    pub(super) mass_b: Mass,
    /// The anchor of B from the centres of A and B.
    pub(super) arm_a: Vec3A,
    pub(super) arm_b: Vec3A,
    /// From the anchor of A to that of B.
    apart: Vec3A,
    /// The joint frame of A; its first axis is that of the joint.
    pub(super) axes: Mat3A,
    /// The axis in the joint frame of B.
    other: Vec3A,
    /// Twice the vector part of the rotation from the joint frame of A to that of B, along the axes of A, and its scalar.
    turned: Vec3A,
    scalar: f32,
    /// The row of the free axis, and the position.
    pub(super) free: Option<(Row, f32)>,
    /// The row that turns B back to the axis of A, and the angle between both axes.
    pub(super) cone: Option<(Row, f32)>,
    pub(super) linear: Option<Block>,
    pub(super) angular: Option<Block>,
    /// How the block that answers a drive does so.
    pub(super) answer: Option<Answer>,
}

/// How the linear block of a turn, or the angular one of a slide, answers the drive along the free axis. Along the axes of the joint.
pub(super) struct Answer {
    /// The rate of the block that an impulse of 1 of the drive gives, and the rate of the drive that one of the block gives.
    pub(super) across: Vec3A,
    /// `scale` of the block times this is the impulse that takes that rate away.
    pub(super) against: Vec3A,
}

/// A row along a direction, with the inverse of its mass.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) along: Vec3A,
    pub(super) angular: bool,
    pub(super) inverse: f32,
}

/// The rows of a joint along some of its axes, which are solved together.
pub(super) struct Block {
    /// 1 for the axes that have a row.
    pub(super) mask: Vec3A,
    /// How far the bodies are from where the rows want them.
    pub(super) off: Vec3A,
    /// `scale` times this is the inverse of K.
    pub(super) inverse: Mat3A,
    pub(super) scale: f32,
}

impl Pivot {
    pub(super) fn new(joint: &Joint, bodies: &Bodies) -> Self {
        let mut pivot = Self::placed(joint, bodies);
        let (kind, drive) = (joint.kind, &joint.drive);
        pivot.free = pivot.free_row(kind).map(|row| (row, pivot.position(kind.free, drive.limits)));
        pivot.cone = pivot.swing().filter(|_| drive.cone.is_finite()).map(|direction| {
            let sine = pivot.axes.x_axis.cross(pivot.other).length();
            (pivot.angular_row(-direction), libm::atan2f(sine, pivot.axes.x_axis.dot(pivot.other)))
        });
        pivot.linear = (kind.linear != 0).then(|| {
            let [a, b] = [(&pivot.mass_a, pivot.arm_a), (&pivot.mass_b, pivot.arm_b)].map(|(mass, arm)| at_arm(mass, arm));
            Block::new(a + b, kind.linear, &pivot.axes, pivot.missed())
        });
        pivot.angular = (kind.angular != 0).then(|| {
            let off = match kind.angular {
                0b111 => pivot.turned,
                _ => pivot.axes.transpose() * pivot.axes.x_axis.cross(pivot.other),
            };
            Block::new(pivot.turning(), kind.angular, &pivot.axes, off)
        });
        pivot.answer = pivot.free.and_then(|(row, _)| pivot.answer_to(&row, kind));
        pivot
    }

    fn answer_to(&self, row: &Row, kind: Kind) -> Option<Answer> {
        let (block, rows, across) = match row.angular {
            true => (&self.linear, kind.linear, self.moved_by(row.along)),
            false => (&self.angular, kind.angular, self.turned_by(row.along)),
        };
        let block = block.as_ref().filter(|_| rows == 0b111)?;
        let across = self.axes.transpose() * across;
        Some(Answer { across, against: block.inverse * across })
    }

    /// The places and turns alone.
    fn placed(joint: &Joint, bodies: &Bodies) -> Self {
        let [end_a, end_b] = &joint.ends;
        let [a, b] = [end_a.body as usize, end_b.body as usize];
        let (pose_a, pose_b) = (&bodies.poses[a], &bodies.poses[b]);
        let [own, other] = [product(pose_a.turn, end_a.turn), product(pose_b.turn, end_b.turn)];
        let arm_b = Vec3A::from(rotated(pose_b.turn, end_b.place));
        let anchor_a = Vec3A::from(rotated(pose_a.turn, end_a.place));
        let between = Vec3A::from(pose_b.position - pose_a.position);
        let image = Vec3A::from(bodies.periods.nearest((between + (arm_b - anchor_a)).into()));
        let arm_a = between + arm_b + image;
        let relative = product(back(own), other);
        let sign = if relative.w < 0.0 { -1.0 } else { 1.0 };
        Self {
            mass_a: bodies.masses[a],
            mass_b: bodies.masses[b],
            arm_a,
            arm_b,
            apart: arm_a - anchor_a,
            axes: Mat3A::from_quat(own),
            other: rotated(other, Vec3::X).into(),
            turned: Vec3A::new(relative.x, relative.y, relative.z) * (2.0 * sign),
            scalar: sign * relative.w,
            free: None,
            cone: None,
            linear: None,
            angular: None,
            answer: None,
        }
    }

    /// From the anchor of A to that of B, along the axes of the joint.
    pub(super) fn missed(&self) -> Vec3A {
        self.axes.transpose() * self.apart
    }

    /// The change of the relative spin by an angular impulse.
    pub(super) fn turning(&self) -> Mat3A {
        self.mass_a.inverse_inertia + self.mass_b.inverse_inertia
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
        Row { along, angular: true, inverse: along.dot(self.turning() * along) }
    }

    /// What an impulse on B at its anchor gives: the spin of B relative to A.
    fn turned_by(&self, push: Vec3A) -> Vec3A {
        self.mass_a.inverse_inertia * self.arm_a.cross(push) + self.mass_b.inverse_inertia * self.arm_b.cross(push)
    }

    /// What an angular impulse on B gives: the velocity of B at its anchor, relative to A.
    fn moved_by(&self, turn: Vec3A) -> Vec3A {
        (self.mass_a.inverse_inertia * turn).cross(self.arm_a) + (self.mass_b.inverse_inertia * turn).cross(self.arm_b)
    }

    /// The position of the free axis.
    pub(super) fn position(&self, free: Free, limits: [f32; 2]) -> f32 {
        match free {
            Free::None => 0.0,
            Free::Turn => reduced(2.0 * libm::atan2f(0.5 * self.turned.x, self.scalar), middle(limits)),
            Free::Slide => self.axes.x_axis.dot(self.apart),
            Free::Line => self.apart.length(),
        }
    }

    /// The impulses of the last substep on B: a push at its anchor and an angular impulse.
    pub(super) fn total(&self, joint: &Joint, state: &JointState) -> (Vec3A, Vec3A) {
        let own = &state.impulses;
        let mut push = self.axes * Vec3A::from(own.linear);
        let mut turn = self.axes * Vec3A::from(own.angular + own.resistance);
        let along = own.locked + own.motor + own.friction + own.lower - own.upper + own.drive;
        match joint.kind.free {
            Free::None => (),
            Free::Turn => turn += along * self.twist_axis(),
            Free::Slide => push += along * self.axes.x_axis,
            Free::Line => push += along * self.line(),
        }
        if let Some((row, _)) = &self.cone {
            turn += own.cone * row.along;
        }
        (push, turn)
    }

    /// The direction about which the axis of B is turned away from that of A.
    fn swing(&self) -> Option<Vec3A> {
        self.axes.x_axis.cross(self.other).try_normalize()
    }
}

impl Block {
    fn new(inverse: Mat3A, rows: u8, axes: &Mat3A, off: Vec3A) -> Self {
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
        Self { mask, off: mask * off, inverse: matrix.inverse(), scale }
    }
}

/// 1 for the axes that have a row.
pub(super) fn mask(rows: u8) -> Vec3A {
    Vec3A::from_array([0, 1, 2].map(|axis| if rows & (1 << axis) != 0 { 1.0 } else { 0.0 }))
}

fn middle([low, high]: [f32; 2]) -> f32 {
    if low.is_finite() && high.is_finite() { 0.5 * (low + high) } else { 0.0 }
}

/// An angle that is within half a turn of another one.
pub(super) fn reduced(angle: f32, about: f32) -> f32 {
    if (angle - about).abs() <= PI { angle } else { angle - TAU * ((angle - about) / TAU).round() }
}

/// The inverse of a positive matrix, whatever its scale.
pub(super) fn inverse(matrix: Mat3A) -> Mat3A {
    let scale = (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z).recip();
    (matrix * scale).inverse() * scale
}

/// How a body gives way at an arm: its inverse mass with that of its rotation.
fn at_arm(mass: &Mass, arm: Vec3A) -> Mat3A {
    let cross =
        Mat3A::from_cols(Vec3A::new(0.0, arm.z, -arm.y), Vec3A::new(-arm.z, 0.0, arm.x), Vec3A::new(arm.y, -arm.x, 0.0));
    Mat3A::from_diagonal(Vec3::splat(mass.inverse_mass)) + cross * mass.inverse_inertia * cross.transpose()
}
