//! The record of a servo in [`Buffer::Servos`](crate::model::buffer::Buffer::Servos), and the poses that follow from it (docs/physics
//! section 2.18).

use glam::{Vec3, Vec4};

use crate::model::layout::{POSE_FLOATS, SERVO_ROWS};
use crate::scene::{Scene, Servo};

/// A servo. A row of the record has a vector and a number, or four numbers:
///
/// | row | content |
/// |---|---|
/// | 0 | displacement, its low part, its rate, greatest rate |
/// | 1 | unit vector of the axis, force or torque that it seeks |
/// | 2 | a point of the axis, number of the body as in the records of walls |
/// | 3 | 1 if it turns, otherwise 0; number of servos; 0; 0 |
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ServoRecord {
    pub(crate) displacement: f32,
    pub(crate) low: f32,
    pub(crate) rate: f32,
    pub(crate) most: f32,
    pub(crate) axis: Vec3,
    pub(crate) target: f32,
    pub(crate) point: Vec3,
    pub(crate) body: u32,
    pub(crate) turns: bool,
    pub(crate) count: u32,
}

impl ServoRecord {
    /// The record of a servo of a scene.
    pub(crate) fn new(servo: &Servo, body: u32, count: u32) -> Self {
        let displacement = servo.displacement as f32;
        Self {
            displacement,
            low: (servo.displacement - f64::from(displacement)) as f32,
            rate: servo.velocity as f32,
            most: servo.speed as f32,
            axis: servo.direction().as_vec3(),
            target: servo.target() as f32,
            point: servo.through().as_vec3(),
            body,
            turns: servo.turns(),
            count,
        }
    }

    /// The records of the servos of a scene, in order of addition.
    pub(crate) fn all(scene: &Scene) -> Vec<Self> {
        let servos = || (1..).zip(scene.motions()).filter_map(|(body, motion)| Some((body, motion.servo?)));
        let count = servos().count() as u32;
        servos().map(|(body, servo)| Self::new(&servo, body, count)).collect()
    }

    /// Reads a record.
    pub(crate) fn of(rows: &[Vec4]) -> Self {
        Self {
            displacement: rows[0].x,
            low: rows[0].y,
            rate: rows[0].z,
            most: rows[0].w,
            axis: rows[1].truncate(),
            target: rows[1].w,
            point: rows[2].truncate(),
            body: rows[2].w as u32,
            turns: rows[3].x != 0.0,
            count: rows[3].y as u32,
        }
    }

    pub(crate) fn rows(&self) -> [Vec4; SERVO_ROWS as usize] {
        [
            Vec4::new(self.displacement, self.low, self.rate, self.most),
            self.axis.extend(self.target),
            self.point.extend(self.body as f32),
            Vec4::new(f32::from(u8::from(self.turns)), self.count as f32, 0.0, 0.0),
        ]
    }

    /// The displacement without rounding.
    pub(crate) fn place(&self) -> f64 {
        f64::from(self.displacement) + f64::from(self.low)
    }

    /// The servo after a time at its present rate.
    pub(crate) fn moved(&self, time: f32) -> Self {
        let place = self.place() + f64::from(self.rate * time);
        let displacement = place as f32;
        if !displacement.is_finite() {
            return *self;
        }
        Self { displacement, low: (place - f64::from(displacement)) as f32, ..*self }
    }

    /// The record of the pose of its body (see [`POSE_FLOATS`]).
    pub(crate) fn pose(&self) -> [f32; POSE_FLOATS as usize] {
        let (axis, rate) = (self.axis, self.rate * self.axis);
        let vectors = if self.turns {
            // R - 1 = sin q [a] + (1 - cos q) [a]^2 with the matrix [a] of the cross product with the axis.
            let (sine, cosine) = libm::sincos(0.5 * self.place());
            let (across, twice) = ((2.0 * sine * cosine) as f32, (2.0 * sine * sine) as f32);
            // Columns of the transpose are rows.
            let row = |unit: Vec3| twice * (axis.dot(unit) * axis - unit) - across * axis.cross(unit);
            let [x, y, z] = Vec3::AXES.map(row);
            [x, y, z, self.point, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, rate]
        } else {
            let (still, moved) = (Vec3::ZERO, self.displacement * axis);
            [still, still, still, still, moved, rate, still, still]
        };
        let mut record = [0.0; POSE_FLOATS as usize];
        for (place, vector) in record.chunks_exact_mut(4).zip(vectors) {
            place[..3].copy_from_slice(&vector.to_array());
        }
        record
    }
}
