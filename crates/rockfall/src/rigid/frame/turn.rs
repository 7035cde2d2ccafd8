//! Inertia and the free rotation (docs/physics sections 5.9 and 11.1).

use glam::{Mat3A, Quat, Vec3, Vec3A};

use crate::rotate::{product, unit};

/// The principal moments of a body, ready for use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moments {
    /// The moments themselves. 1 without mass.
    moments: Vec3A,
    /// 1 / J_m, the inverse of the middle one. 0 without mass.
    middle: f32,
    /// kappa: by how much the inverses of the moments exceed it.
    excess: Vec3A,
    /// From the principal axes to those of the body.
    axes: Quat,
    /// All moments are equal, so the inertia does not turn.
    ball: bool,
}

impl Moments {
    /// Of a body without mass: it does not turn by itself.
    pub(super) const NONE: Self =
        Self { moments: Vec3A::ONE, middle: 0.0, excess: Vec3A::ZERO, axes: Quat::IDENTITY, ball: true };

    pub(super) fn new(moments: Vec3A, axes: Quat) -> Self {
        let middle = moments.x.max(moments.y).min(moments.x.min(moments.y).max(moments.z));
        let excess = Vec3A::from_array(moments.to_array().map(|j| if j == middle { 0.0 } else { 1.0 / j - 1.0 / middle }));
        Self { moments, middle: 1.0 / middle, excess, axes, ball: excess == Vec3A::ZERO }
    }

    /// Inverse of the inertia along the axes of the world.
    pub(super) fn inverse_inertia(&self, orientation: Quat) -> Mat3A {
        let middle = Mat3A::from_diagonal(Vec3::splat(self.middle));
        if self.ball {
            return middle;
        }
        let axes = Mat3A::from_quat(product(orientation, self.axes));
        let [p, q, r] = [0, 1, 2].map(|k| (axes.col(k), self.excess[k] * axes.col(k)));
        let sum = |i: usize, j: usize| p.1[i] * p.0[j] + q.1[i] * q.0[j] + r.1[i] * r.0[j];
        let (xy, xz, yz) = (sum(0, 1), sum(0, 2), sum(1, 2));
        middle + Mat3A::from_cols(Vec3A::new(sum(0, 0), xy, xz), Vec3A::new(xy, sum(1, 1), yz), Vec3A::new(xz, yz, sum(2, 2)))
    }

    /// The angular momentum of a body with this orientation and this angular velocity.
    pub(super) fn momentum(&self, orientation: Quat, spin: Vec3A) -> Vec3A {
        if self.ball {
            return self.moments.x * spin;
        }
        let axes = Mat3A::from_quat(product(orientation, self.axes));
        axes * (self.moments * (axes.transpose() * spin))
    }

    /// Phi: the orientation after a free rotation for a time, in s, which may be negative.
    pub(super) fn turned(&self, orientation: Quat, momentum: Vec3A, time: f32) -> Quat {
        let start = product(about(time * self.middle * momentum), orientation);
        if self.ball {
            return unit(start);
        }
        // A rotation about an axis of the body is a factor on the right, which has one component beside the cosine.
        let mut axes = product(start, self.axes);
        for (k, share) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
            if self.excess[k] != 0.0 {
                let rate = share * time * self.excess[k];
                axes = match k {
                    0 => about_axis::<0>(axes, momentum, rate),
                    1 => about_axis::<1>(axes, momentum, rate),
                    _ => about_axis::<2>(axes, momentum, rate),
                };
            }
        }
        unit(product(axes, self.axes.conjugate()))
    }
}

/// Turns principal axes about the axis `I` by the momentum along it times a rate.
#[inline(always)]
fn about_axis<const I: usize>(q: Quat, momentum: Vec3A, rate: f32) -> Quat {
    let (i, j, k) = (I, (I + 1) % 3, (I + 2) % 3);
    let (mut v, w, momentum) = ([q.x, q.y, q.z], q.w, momentum.to_array());
    let axis = [1.0 - 2.0 * (v[j] * v[j] + v[k] * v[k]), 2.0 * (v[i] * v[j] + w * v[k]), 2.0 * (v[i] * v[k] - w * v[j])];
    let angle = rate * (axis[0] * momentum[i] + axis[1] * momentum[j] + axis[2] * momentum[k]);
    let (share, cosine) = half(angle * angle);
    let sine = share * angle;
    (v[i], v[j], v[k]) = (cosine * v[i] + sine * w, cosine * v[j] + sine * v[k], cosine * v[k] - sine * v[j]);
    Quat::from_xyzw(v[0], v[1], v[2], cosine * w - sine * [q.x, q.y, q.z][i])
}

/// Rotation by an angular velocity times a time.
pub(super) fn about(turn: Vec3A) -> Quat {
    let (share, cosine) = half(turn.length_squared());
    let part = share * turn;
    Quat::from_xyzw(part.x, part.y, part.z, cosine)
}

/// Sine of half an angle over the angle, and its cosine, from the square of the angle.
#[inline(always)]
fn half(squared: f32) -> (f32, f32) {
    // The next terms of both series are below the last bit there.
    if squared < 0.25 {
        let sine = 0.5 - squared * (1.0 / 48.0 - squared * (1.0 / 3840.0 - squared * (1.0 / 645_120.0)));
        let cosine = 1.0 - squared * (0.125 - squared * (1.0 / 384.0 - squared * (1.0 / 46_080.0)));
        return (sine, cosine);
    }
    let angle = squared.sqrt();
    let (sine, cosine) = libm::sincosf(0.5 * angle);
    (sine / angle, cosine)
}
