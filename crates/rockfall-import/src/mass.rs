//! Mass, centre of mass and inertia, in `f64`.

use rockfall::MassProperties;
use rockfall::glam::{DMat3, DQuat, DVec3, Vec3};

/// Least principal moment of a body, as a share of the greatest one. Files have moments of 0 that no body has.
const LEAST_MOMENT: f64 = 1e-4;

/// A place and a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    pub(crate) at: DVec3,
    pub(crate) turn: DQuat,
}

impl Pose {
    pub(crate) const NONE: Self = Self { at: DVec3::ZERO, turn: DQuat::IDENTITY };

    pub(crate) fn point(&self, point: DVec3) -> DVec3 {
        self.at + self.turn * point
    }

    /// The point in `f32`. Coordinates that are 0 but for rounding are 0.
    pub(crate) fn rounded(&self, point: DVec3) -> Vec3 {
        let (place, size) = (self.point(point), self.at.abs().max_element() + point.abs().max_element());
        place.map(|x| if x.abs() <= 1e-12 * size { 0.0 } else { x }).as_vec3()
    }

    /// The pose of something that has the pose `inner` in coordinates of this one.
    pub(crate) fn then(&self, inner: &Self) -> Self {
        Self { at: self.point(inner.at), turn: (self.turn * inner.turn).normalize() }
    }

    pub(crate) fn inverse(&self) -> Self {
        let back = self.turn.inverse();
        Self { at: back * -self.at, turn: back }
    }
}

/// Mass properties. The inertia is that about the centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mass {
    pub(crate) mass: f64,
    pub(crate) centre: DVec3,
    pub(crate) inertia: DMat3,
}

impl Mass {
    pub(crate) const NONE: Self = Self { mass: 0.0, centre: DVec3::ZERO, inertia: DMat3::ZERO };

    /// From moments about the axes of a pose whose origin is the centre.
    pub(crate) fn diagonal(mass: f64, moments: DVec3) -> Self {
        Self { mass, centre: DVec3::ZERO, inertia: DMat3::from_diagonal(moments) }
    }

    /// From the elements xx, yy, zz, xy, xz, yz.
    pub(crate) fn tensor([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> DMat3 {
        DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
    }

    /// Seen from outside of a pose.
    pub(crate) fn moved(&self, pose: &Pose) -> Self {
        let turn = DMat3::from_quat(pose.turn);
        Self { mass: self.mass, centre: pose.point(self.centre), inertia: turn * self.inertia * turn.transpose() }
    }

    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { mass: self.mass * factor, centre: self.centre, inertia: self.inertia * factor }
    }

    /// Both as one body, by parallel axes.
    pub(crate) fn and(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass <= 0.0 {
            return Self { inertia: self.inertia + other.inertia, ..*self };
        }
        let centre = (self.mass * self.centre + other.mass * other.centre) / mass;
        let inertia = self.inertia + other.inertia + self.about(centre) + other.about(centre);
        Self { mass, centre, inertia }
    }

    /// What a point mass at the centre adds to the inertia about a point.
    fn about(&self, point: DVec3) -> DMat3 {
        let arm = self.centre - point;
        let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
        (DMat3::from_diagonal(DVec3::splat(arm.length_squared())) - outer) * self.mass
    }

    pub(crate) fn elements(&self) -> [f64; 6] {
        let [x, y, z] = [self.inertia.x_axis, self.inertia.y_axis, self.inertia.z_axis];
        [x.x, y.y, z.z, x.y, x.z, y.z]
    }

    /// The nearest inertia that a body of this mass can have: moments greater than 0, none greater than the sum of the others.
    /// The second value is whether it differs.
    pub(crate) fn repaired(&self) -> (Self, bool) {
        let properties = MassProperties { mass: self.mass, centre: self.centre.to_array(), inertia: self.elements() };
        let (moments, axes) = properties.principal();
        let greatest = moments.max_element();
        if greatest <= 0.0 {
            return (*self, true);
        }
        let mut sound = moments.max(DVec3::splat(LEAST_MOMENT * greatest));
        let excess = 2.0 * sound.max_element() - sound.element_sum();
        // Rounding to f32 must not break it again.
        if excess > -1e-6 * sound.max_element() {
            let lacking = (excess + 2e-6 * sound.max_element()) / 2.0;
            let top = sound.max_element();
            sound = sound.map(|moment| if moment == top { moment } else { moment + lacking });
        }
        let differs = (sound - moments).abs().max_element() > 1e-5 * greatest;
        let turn = DMat3::from_quat(axes);
        (Self { inertia: turn * DMat3::from_diagonal(sound) * turn.transpose(), ..*self }, differs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_axes() {
        let ball = Mass::diagonal(2.0, DVec3::splat(0.8));
        let pair = ball.moved(&Pose { at: DVec3::X, ..Pose::NONE }).and(&ball.moved(&Pose { at: -DVec3::X, ..Pose::NONE }));
        assert_eq!(pair.mass, 4.0);
        assert_eq!(pair.centre, DVec3::ZERO);
        assert_eq!(pair.elements(), [1.6, 5.6, 5.6, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn inertia_without_a_body_is_repaired() {
        let (sound, differs) = Mass::diagonal(1.0, DVec3::new(1.0, 1.0, 3.0)).repaired();
        assert!(differs);
        let [x, y, z, ..] = sound.elements();
        assert!(z <= x + y && (x - 1.5).abs() < 1e-3, "{x} {y} {z}");
        assert!(!Mass::diagonal(1.0, DVec3::new(1.0, 2.0, 2.0)).repaired().1);
        assert!(!Mass::diagonal(1.0, DVec3::new(1.0, 1.0, 2.0)).repaired().1);
    }
}
