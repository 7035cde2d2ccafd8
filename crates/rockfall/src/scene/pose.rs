//! Where motions put boxes and polygons (docs/physics section 2.12).

use glam::{DMat3, DQuat, DVec3, Vec3};

/// Where a motion takes the points of a body: x to R x + p. Both have their first and second derivatives by the time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub(super) turn: [DMat3; 3],
    pub(super) shift: [DVec3; 3],
}

/// The rotation about a unit vector by an angle, in rad, with the same bits on every system.
fn turn_about(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = libm::sincos(0.5 * angle);
    DQuat::from_vec4((sin * axis).extend(cos))
}

impl Pose {
    pub(super) const REST: Self = Self { turn: [DMat3::IDENTITY, DMat3::ZERO, DMat3::ZERO], shift: [DVec3::ZERO; 3] };

    /// A turn about a unit vector through a point, by an angle at a rate.
    pub(super) fn about(axis: DVec3, [angle, rate]: [f64; 2], through: DVec3) -> Self {
        let turn = DMat3::from_quat(turn_about(axis, angle));
        let across = cross_matrix(rate * axis);
        let (turn1, turn2) = (across * turn, across * across * turn);
        Self { turn: [turn, turn1, turn2], shift: [through - turn * through, -turn1 * through, -turn2 * through] }
    }

    /// The pose of a term that is inside this one.
    pub(super) fn of_inner(&self, inner: &Self) -> Self {
        let ([r, r1, r2], [p, p1, p2]) = (self.turn, self.shift);
        let ([q, q1, q2], [o, o1, o2]) = (inner.turn, inner.shift);
        Self {
            turn: [r * q, r1 * q + r * q1, r2 * q + 2.0 * (r1 * q1) + r * q2],
            shift: [r * o + p, r1 * o + r * o1 + p1, r2 * o + 2.0 * (r1 * o1) + r * o2 + p2],
        }
    }

    /// R - 1.
    pub(crate) fn turn_less_one(&self) -> DMat3 {
        self.turn[0] - DMat3::IDENTITY
    }

    /// Place, velocity and acceleration of a point of the body.
    pub(crate) fn of_point(&self, point: DVec3) -> [DVec3; 3] {
        [0, 1, 2].map(|order| self.turn[order] * point + self.shift[order])
    }

    /// Velocity of the body's point that is at a place now.
    pub(crate) fn velocity_at(&self, place: DVec3) -> DVec3 {
        self.of_point(self.turn[0].transpose() * (place - self.shift[0]))[1]
    }

    /// The turn, as a unit quaternion.
    pub(crate) fn orientation(&self) -> DQuat {
        DQuat::from_mat3(&self.turn[0]).normalize()
    }

    /// Angular velocity, in rad/s.
    pub(crate) fn spin(&self) -> DVec3 {
        // R' R^T is the matrix of the cross product with it.
        let across = self.turn[1] * self.turn[0].transpose();
        0.5 * DVec3::new(
            across.y_axis.z - across.z_axis.y,
            across.z_axis.x - across.x_axis.z,
            across.x_axis.y - across.y_axis.x,
        )
    }
}

impl Pose {
    /// A point of a body in f32.
    pub(super) fn corner(&self, point: Vec3) -> Vec3 {
        self.of_point(point.as_dvec3())[0].as_vec3()
    }

    /// A vector of a body in f32.
    pub(super) fn edge(&self, edge: Vec3) -> Vec3 {
        (self.turn[0] * edge.as_dvec3()).as_vec3()
    }
}

/// The matrix of the cross product with a vector.
fn cross_matrix(v: DVec3) -> DMat3 {
    DMat3::from_cols(v.cross(DVec3::X), v.cross(DVec3::Y), v.cross(DVec3::Z))
}
