//! Volume and moments of bodies between triangles.

use glam::{DMat3, DVec3};

/// Volume, first and second moments of a closed surface of triangles.
pub(crate) struct Moments {
    pub(crate) volume: f64,
    pub(crate) first: DVec3,
    pub(crate) second: DMat3,
}

/// Moments of the tetrahedra between the origin and triangles that run counterclockwise from outside.
pub(crate) fn moments(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Moments {
    let mut sum = Moments { volume: 0.0, first: DVec3::ZERO, second: DMat3::ZERO };
    for [p, q, r] in triangles {
        let volume = p.dot(q.cross(r)) / 6.0;
        let total = p + q + r;
        sum.volume += volume;
        sum.first += total * (volume / 4.0);
        sum.second += (outer(p) + outer(q) + outer(r) + outer(total)) * (volume / 20.0);
    }
    sum
}

/// The product v v^T.
pub(crate) fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}
