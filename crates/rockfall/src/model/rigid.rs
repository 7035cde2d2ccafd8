//! The state and the moments of inertia of rigid bodies (docs/physics sections 1.5 and 5.9).

use glam::{Mat3, Quat, Vec3, Vec4};

use crate::fine::Fine;
use crate::rotate::{by, product, rotated, unit};

/// The principal moments of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments {
    /// 1 / J_m, the inverse of the middle one.
    pub(crate) middle: f32,
    /// kappa: by how much the inverses of the moments exceed it.
    pub(crate) excess: Vec3,
    /// The rotation from the principal axes to the coordinates of the shape.
    pub(crate) axes: Quat,
}

impl Moments {
    /// The angular velocity of a body with this orientation and this angular momentum.
    pub(crate) fn spin(&self, orientation: Quat, momentum: Vec3) -> Vec3 {
        let along = Mat3::from_quat(product(orientation, self.axes));
        let part = |k: usize| self.excess[k] * along.col(k).dot(momentum) * along.col(k);
        self.middle * momentum + (part(0) + part(1) + part(2))
    }

    /// The tensor of the inverse inertia in the coordinates of the scene: xx, yy, zz, xy, xz, yz.
    pub(crate) fn inverse_inertia(&self, orientation: Quat) -> [f32; 6] {
        let along = Mat3::from_quat(product(orientation, self.axes));
        let element = |i: usize, j: usize| (0..3).map(|k| self.excess[k] * along.col(k)[i] * along.col(k)[j]).sum::<f32>();
        let diagonal = |i: usize| self.middle + element(i, i);
        [diagonal(0), diagonal(1), diagonal(2), element(0, 1), element(0, 2), element(1, 2)]
    }

    /// Phi: the orientation after a free rotation for a time, in s, with this angular momentum.
    pub(crate) fn turned(&self, orientation: Quat, momentum: Vec3, time: f32) -> Quat {
        let mut orientation = product(by(time * self.middle * momentum), orientation);
        for (k, share) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
            if self.excess[k] != 0.0 {
                let axis = rotated(orientation, rotated(self.axes, Vec3::AXES[k]));
                let turn = share * time * self.excess[k] * axis.dot(momentum);
                orientation = product(by(turn * axis), orientation);
            }
        }
        unit(orientation)
    }
}

/// A vector times a tensor whose elements are xx, yy, zz, xy, xz, yz.
pub(crate) fn times([xx, yy, zz, xy, xz, yz]: [f32; 6], v: Vec3) -> Vec3 {
    Vec3::new(xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z)
}

pub(crate) use crate::scene::BodyState as Pose;

impl Pose {
    /// Number of rows of a pose.
    pub(crate) const ROWS: usize = 5;

    /// The pose in the first rows of a body: position, low part of the position, velocity, angular momentum, orientation.
    pub(crate) fn of(rows: &[Vec4]) -> Self {
        let [high, low, velocity, momentum] = [0, 1, 2, 3].map(|place: usize| rows[place].truncate());
        Self { position: Fine { high, low }, velocity, momentum, orientation: Quat::from_vec4(rows[4]) }
    }

    /// The rows of the pose.
    pub(crate) fn rows(&self) -> [Vec4; Self::ROWS] {
        let Self { position: Fine { high, low }, velocity, momentum, orientation } = *self;
        [high.extend(0.0), low.extend(0.0), velocity.extend(0.0), momentum.extend(0.0), orientation.into()]
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.position.high.is_finite() && self.velocity.is_finite() && self.momentum.is_finite() && self.orientation.is_finite()
    }

    pub(crate) fn moved(self, by: Vec3) -> Self {
        Self { position: self.position.moved(by), ..self }
    }

    /// The rows of a member sphere at a place from the centre in the coordinates of the shape, with the spin of the body and the inverse
    /// inertia of the sphere: position, velocity, angular momentum, low part of the position.
    pub(crate) fn member(&self, place: Vec3, spin: Vec3, inverse_inertia: f32) -> [Vec3; 4] {
        let lever = rotated(self.orientation, place);
        let Fine { high, low } = self.position.moved(lever);
        [high, self.velocity + spin.cross(lever), spin / inverse_inertia, low]
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat, DVec3};

    use super::*;

    /// The exact rotation of a symmetric top: about L at the rate L / J_1, and about its axis.
    #[test]
    fn free_rotation_of_a_symmetric_top_is_exact() {
        let moments = Moments { middle: 1.0 / 2.0, excess: Vec3::new(0.0, 0.0, 1.0 / 0.7 - 1.0 / 2.0), axes: Quat::IDENTITY };
        let (momentum, start) = (Vec3::new(0.4, -0.3, 1.1), Quat::from_rotation_x(0.6));
        let mut axes = start;
        for _ in 0..100 {
            axes = moments.turned(axes, momentum, 0.05);
        }
        let (l, first) =
            (momentum.as_dvec3(), DQuat::from_xyzw(start.x.into(), start.y.into(), start.z.into(), start.w.into()));
        let own = (1.0 / 0.7 - 1.0 / 2.0) * (first * DVec3::Z).dot(l);
        let exact = DQuat::from_scaled_axis(5.0 * 0.5 * l) * first * DQuat::from_rotation_z(5.0 * own);
        let off = (axes.as_dquat() * exact.inverse()).to_scaled_axis().length();
        assert!(off < 2e-5, "{off}");
    }

    #[test]
    fn energy_of_a_free_asymmetric_top_stays() {
        let inverse = DVec3::new(1.0, 1.0 / 2.0, 1.0 / 3.0);
        let moments = Moments { middle: 0.5, excess: (inverse - DVec3::splat(0.5)).as_vec3(), axes: Quat::IDENTITY };
        let momentum = Vec3::new(0.01, 2.0, 0.0);
        let energy = |axes: Quat| {
            let along = DMat3::from_quat(axes.as_dquat()).transpose() * momentum.as_dvec3();
            0.5 * (along * along).dot(inverse)
        };
        let mut axes = Quat::IDENTITY;
        let (first, mut worst) = (energy(axes), 0.0_f64);
        let mut flips = 0;
        let mut before = 1.0;
        for _ in 0..40_000 {
            axes = moments.turned(axes, momentum, 0.05);
            worst = worst.max((energy(axes) / first - 1.0).abs());
            let along = (axes * Vec3::Y).dot(momentum);
            flips += u32::from(along * before < 0.0);
            before = along;
        }
        // Half a period of the flips is 20.7546 (rigid-bodies: asymmetric top with omega = (0.01, 1, 0)).
        assert!((f64::from(flips) - 2000.0 / 20.7546).abs() < 3.0, "{flips}");
        assert!(worst < 1e-4, "{worst}");
    }

    #[test]
    fn spin_and_tensor_agree() {
        let moments = Moments { middle: 0.5, excess: Vec3::new(0.3, 0.0, -0.2), axes: Quat::from_rotation_x(0.7) };
        let (axes, momentum) = (Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 2.0), Vec3::new(0.2, -0.7, 0.9));
        let tensor = moments.inverse_inertia(axes);
        assert!(times(tensor, momentum).distance(moments.spin(axes, momentum)) < 1e-6);
    }
}
