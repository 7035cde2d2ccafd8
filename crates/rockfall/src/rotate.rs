//! Rotations in `f32` with the same bits on every processor. Those of glam depend on its vector instructions and on the sine of the
//! system.

use glam::{Quat, Vec3};

/// A vector after a rotation by a unit quaternion.
pub(crate) fn rotated(q: Quat, v: Vec3) -> Vec3 {
    let axis = Vec3::new(q.x, q.y, q.z);
    let t = 2.0 * axis.cross(v);
    v + q.w * t + axis.cross(t)
}

/// The rotation `b` followed by `a`.
pub(crate) fn product(a: Quat, b: Quat) -> Quat {
    let [u, v] = [Vec3::new(a.x, a.y, a.z), Vec3::new(b.x, b.y, b.z)];
    let axis = a.w * v + b.w * u + u.cross(v);
    Quat::from_xyzw(axis.x, axis.y, axis.z, a.w * b.w - u.dot(v))
}

/// The rotation about the direction of a vector by its length, in rad.
pub(crate) fn by(turn: Vec3) -> Quat {
    let angle = turn.length();
    if angle == 0.0 {
        return Quat::IDENTITY;
    }
    let (sine, cosine) = libm::sincosf(0.5 * angle);
    let axis = turn * (sine / angle);
    Quat::from_xyzw(axis.x, axis.y, axis.z, cosine)
}

/// The quaternion of length 1 in the direction of another one.
pub(crate) fn unit(q: Quat) -> Quat {
    let length = (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w).sqrt();
    Quat::from_xyzw(q.x / length, q.y / length, q.z / length, q.w / length)
}

/// The opposite rotation.
pub(crate) fn back(q: Quat) -> Quat {
    Quat::from_xyzw(-q.x, -q.y, -q.z, q.w)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_glam() {
        let (a, b) = (Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 2.0), Quat::from_rotation_y(0.4));
        let v = Vec3::new(0.2, -0.7, 0.9);
        assert!(rotated(a, v).distance(a * v) < 1e-6);
        assert!(product(a, b).dot(a * b) > 1.0 - 1e-6);
        assert!(by(v).dot(Quat::from_scaled_axis(v)) > 1.0 - 1e-6);
        assert!(rotated(back(a), rotated(a, v)).distance(v) < 1e-6);
        assert!(unit(a * 3.0).dot(a) > 1.0 - 1e-6);
    }
}
