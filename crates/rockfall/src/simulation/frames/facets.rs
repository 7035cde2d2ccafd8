//! Faces that stand for cylinders, cones and balls as walls under the law `rigid` (docs/physics section 11.1).

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use crate::scene::ConeAxis;

/// Number of faces around a cylinder or a cone.
const AROUND: usize = 128;
/// Number of parts of each edge of the octahedron whose faces become a ball.
const ALONG_EDGE: usize = 32;
/// A smaller share of the wider radius is a tip.
const TIP: f64 = 1e-4;

/// A face that is touched on the side of `left` x `right`: a parallelogram or a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facet {
    pub(super) corner: DVec3,
    pub(super) left: DVec3,
    pub(super) right: DVec3,
    pub(super) is_triangle: bool,
}

impl Facet {
    /// A triangle whose front is where `a`, `b` and `c` go round counterclockwise.
    fn triangle([a, b, c]: [DVec3; 3]) -> Self {
        Self { corner: a, left: b - a, right: c - a, is_triangle: true }
    }

    /// The same face, touched on the other side.
    fn turned(self) -> Self {
        Self { left: self.right, right: self.left, ..self }
    }
}

/// The faces of a cylinder or a cone whose axis begins at `start`; `out` is at right angles to the axis. Their distance from the axis
/// exceeds the radius at their edges as much as it falls short of it at their middles.
pub(super) fn of_cone(start: DVec3, axis: &ConeAxis, out: DVec3, inside: bool) -> Vec<Facet> {
    let u = out.normalize();
    let v = axis.along.normalize().cross(u);
    let half = 0.5 * TAU / AROUND as f64;
    let [wide, narrow] = axis.radii.map(|radius| radius * 2.0 / (1.0 + libm::cos(half)));
    let on_rim = |centre: DVec3, radius: f64, k: usize| {
        let (sin, cos) = libm::sincos(TAU * (k % AROUND) as f64 / AROUND as f64);
        centre + radius * (cos * u + sin * v)
    };
    let end = start + axis.along;
    let of_sector = |k: usize| {
        let [a, b] = [k, k + 1].map(|k| on_rim(start, wide, k));
        let [d, c] = [k, k + 1].map(|k| on_rim(end, narrow, k));
        if narrow == wide {
            vec![Facet { corner: a, left: b - a, right: d - a, is_triangle: false }]
        } else if narrow < TIP * wide {
            vec![Facet::triangle([a, b, end])]
        } else {
            vec![Facet::triangle([a, b, c]), Facet::triangle([a, c, d])]
        }
    };
    let outside = (0..AROUND).flat_map(of_sector);
    if inside { outside.map(Facet::turned).collect() } else { outside.collect() }
}

/// The faces of a ball that is touched from inside: those of an octahedron, divided and pushed out to the ball.
pub(super) fn of_bowl(centre: DVec3, radius: f64) -> Vec<Facet> {
    // Equal angles along the edges of the octahedron make the faces more alike.
    let part = |k: usize| libm::sin(FRAC_PI_2 * k as f64 / ALONG_EDGE as f64);
    let mut faces = Vec::with_capacity(8 * ALONG_EDGE * ALONG_EDGE);
    for octant in 0..8 {
        let signs = DVec3::from([1, 2, 4].map(|bit| if octant & bit == 0 { 1.0 } else { -1.0 }));
        let at = |i: usize, j: usize| signs * DVec3::new(part(i), part(j), part(ALONG_EDGE - i - j)).normalize();
        let mut add = |corners: [DVec3; 3]| {
            let [a, b, c] = corners;
            let is_inward = (b - a).cross(c - a).dot(a) < 0.0;
            faces.push(if is_inward { [a, b, c] } else { [a, c, b] });
        };
        for i in 0..ALONG_EDGE {
            for j in 0..ALONG_EDGE - i {
                add([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < ALONG_EDGE {
                    add([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    let height = |[a, b, c]: &[DVec3; 3]| (b - a).cross(c - a).normalize().dot(*a).abs();
    let lowest = faces.iter().map(height).fold(1.0, f64::min);
    let scale = 2.0 * radius / (1.0 + lowest);
    faces.into_iter().map(|corners| Facet::triangle(corners.map(|corner| centre + scale * corner))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The middle of a face, and its normal.
    fn middle(facet: &Facet) -> (DVec3, DVec3) {
        let share = if facet.is_triangle { 3.0 } else { 2.0 };
        (facet.corner + (facet.left + facet.right) / share, facet.left.cross(facet.right).normalize())
    }

    fn area(facets: &[Facet]) -> f64 {
        let of = |facet: &Facet| facet.left.cross(facet.right).length() / if facet.is_triangle { 2.0 } else { 1.0 };
        facets.iter().map(of).sum()
    }

    #[test]
    fn faces_of_a_cone_have_its_area_and_look_to_the_right_side() {
        let start = DVec3::new(1.0, 2.0, 3.0);
        for radii in [[2.0, 2.0], [2.0, 1.0], [2.0, 0.0]] {
            let axis = ConeAxis { along: DVec3::new(0.0, 0.0, -1.5), radii };
            for inside in [false, true] {
                let facets = of_cone(start, &axis, DVec3::X, inside);
                let slant = (radii[0] - radii[1]).hypot(1.5);
                let expected = 0.5 * TAU * (radii[0] + radii[1]) * slant;
                assert!((area(&facets) / expected - 1.0).abs() < 1e-3, "{radii:?}: {} for {expected}", area(&facets));
                for (place, normal) in facets.iter().map(middle) {
                    let out = (place - start).with_z(0.0).normalize();
                    assert_eq!(normal.dot(out) < 0.0, inside, "{radii:?}");
                }
            }
        }
    }

    #[test]
    fn faces_of_a_ball_lie_within_a_thousandth_and_look_inwards() {
        let centre = DVec3::new(-1.0, 0.5, 4.0);
        let facets = of_bowl(centre, 3.0);
        assert_eq!(facets.len(), 8 * ALONG_EDGE * ALONG_EDGE);
        assert!((area(&facets) / (2.0 * TAU * 9.0) - 1.0).abs() < 1e-3);
        for facet in &facets {
            let (place, normal) = middle(facet);
            assert!(normal.dot(place - centre) < 0.0);
            for point in [place, facet.corner, facet.corner + facet.left, facet.corner + facet.right] {
                assert!(((point - centre).length() / 3.0 - 1.0).abs() < 1e-3);
            }
        }
    }
}
