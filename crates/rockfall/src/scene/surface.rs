//! What surface a polygon stands for (docs/physics sections 2.7 and 2.17).

use glam::{DVec3, Vec3};

/// The surface that the corner P and the edges L and R of a [`Polygon`](crate::Polygon) stand for (docs/physics sections 2.7 and 2.17).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Surface {
    /// The parallelogram with the vertices P, P + L, P + L + R and P + R. It is touched on the side that L x R points to.
    #[default]
    Parallelogram,
    /// The triangle with the vertices P, P + L and P + R. It is touched on both sides.
    Triangle,
    /// All of the plane of the parallelogram, touched on the same side.
    Plane,
    /// A cone or a cylinder without caps: the segment from P + R to P + R + L, turned about the axis through P that is at right angles to
    /// R and in the plane of L and R.
    Cone {
        /// Whether it is touched from inside.
        inside: bool,
    },
    /// A sphere with the centre P and the radius |L|. R is at right angles to L and as long.
    Ball {
        /// Whether it is touched from inside.
        inside: bool,
    },
}

impl Surface {
    /// All surfaces. Their places are the numbers that kernels and checkpoints know them by.
    pub(crate) const ALL: [Self; 7] = [
        Self::Parallelogram,
        Self::Triangle,
        Self::Plane,
        Self::Cone { inside: false },
        Self::Cone { inside: true },
        Self::Ball { inside: false },
        Self::Ball { inside: true },
    ];

    /// The number by which kernels, checkpoints and tables know it: 0 parallelogram, 1 triangle, 2 plane, 3 cone, 5 ball, and one more if it is
    /// touched from inside.
    pub fn number(self) -> u32 {
        match self {
            Self::Parallelogram => 0,
            Self::Triangle => 1,
            Self::Plane => 2,
            Self::Cone { inside } => 3 + u32::from(inside),
            Self::Ball { inside } => 5 + u32::from(inside),
        }
    }

    /// The surface of a number, if there is one.
    pub(crate) fn of_number(number: u32) -> Option<Self> {
        Self::ALL.get(number as usize).copied()
    }

    /// Whether it is a cone, a cylinder or a ball.
    pub fn is_round(self) -> bool {
        matches!(self, Self::Cone { .. } | Self::Ball { .. })
    }

    /// Whether it is a cone, a cylinder or a ball that is touched from inside.
    pub fn is_inside(self) -> bool {
        matches!(self, Self::Cone { inside: true } | Self::Ball { inside: true })
    }

    /// Whether it is neither a parallelogram nor a triangle.
    pub fn is_smooth(self) -> bool {
        self.is_round() || self == Self::Plane
    }
}

/// The axis of a cone or cylinder, which begins at the corner of the [`Polygon`](crate::Polygon), at the wider end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ConeAxis {
    /// Vector from the start of the axis to its end, in units.
    pub along: DVec3,
    /// The radii at both ends, in units.
    pub radii: [f64; 2],
}

impl ConeAxis {
    /// The axis of the cone with the edges L and R.
    pub(crate) fn of(left: Vec3, right: Vec3) -> Self {
        let (left, right) = (left.as_dvec3(), right.as_dvec3());
        let radius = right.length();
        let out = right / radius;
        let slope = left.dot(out);
        Self { along: left - slope * out, radii: [radius, radius + slope] }
    }

    /// The least and the greatest coordinates of the rims, from the start of the axis.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        let unit = self.along.normalize();
        let reach = (DVec3::ONE - unit * unit).max(DVec3::ZERO).map(f64::sqrt);
        let [start, end] = self.radii.map(|radius| radius * reach);
        ((-start).min(self.along - end).as_vec3(), start.max(self.along + end).as_vec3())
    }
}
