//! Four vectors side by side, one per SIMD lane: processors compute four numbers as fast as one.

use std::ops::{Add, Div, Mul, Sub};

use glam::{BVec4A, Mat4, Vec3, Vec4};

/// Number of lanes.
pub(crate) const LANES: usize = 4;

/// Returns a mask of the first `count` lanes.
#[inline]
pub(crate) fn first_lanes(count: usize) -> BVec4A {
    Vec4::new(0.0, 1.0, 2.0, 3.0).cmplt(Vec4::splat(count as f32))
}

/// Four vectors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Vec3x4 {
    pub(crate) x: Vec4,
    pub(crate) y: Vec4,
    pub(crate) z: Vec4,
}

impl Vec3x4 {
    /// Repeats a vector in all four lanes.
    pub(crate) fn splat(v: Vec3) -> Self {
        Self { x: Vec4::splat(v.x), y: Vec4::splat(v.y), z: Vec4::splat(v.z) }
    }

    /// Splits four rows into four vectors of their first three components, and the fourth components.
    #[inline]
    pub(crate) fn from_rows(rows: [Vec4; LANES]) -> (Self, Vec4) {
        let [a, b, c, d] = rows;
        let Mat4 { x_axis, y_axis, z_axis, w_axis } = Mat4::from_cols(a, b, c, d).transpose();
        (Self { x: x_axis, y: y_axis, z: z_axis }, w_axis)
    }

    /// Returns the four vectors.
    #[inline]
    pub(crate) fn to_rows(self) -> [Vec3; LANES] {
        let rows = Mat4::from_cols(self.x, self.y, self.z, Vec4::ZERO).transpose();
        [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis].map(Vec4::truncate)
    }

    /// Sets the lanes that are not in the mask to 0.
    #[inline]
    pub(crate) fn or_zero(self, lanes: BVec4A) -> Self {
        let of = |v: Vec4| Vec4::select(lanes, v, Vec4::ZERO);
        Self { x: of(self.x), y: of(self.y), z: of(self.z) }
    }

    /// Adds the four vectors to a sum, one after the other. The last component of the sum has no meaning.
    #[inline]
    pub(crate) fn add_lanes_to(self, sum: Vec4) -> Vec4 {
        let rows = Mat4::from_cols(self.x, self.y, self.z, Vec4::ZERO).transpose();
        sum + rows.x_axis + rows.y_axis + rows.z_axis + rows.w_axis
    }

    #[inline]
    pub(crate) fn dot(self, other: Self) -> Vec4 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }
}

impl Add for Vec3x4 {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Vec3x4 {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Mul<Vec4> for Vec3x4 {
    type Output = Self;

    #[inline]
    fn mul(self, factor: Vec4) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl Div<Vec4> for Vec3x4 {
    type Output = Self;

    /// Divides each component. Multiplication by the reciprocal would round twice; then a vector along an axis would not give
    /// an exact unit vector.
    #[inline]
    fn div(self, divisor: Vec4) -> Self {
        Self { x: self.x / divisor, y: self.y / divisor, z: self.z / divisor }
    }
}
