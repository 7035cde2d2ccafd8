//! Generated meshes.

use std::f64::consts::TAU;

use glam::DVec3;

use super::turn::sin_cos;
use super::{Mesh, rounded};
use crate::error::{Error, Result};

/// Greatest number of facets of a generated mesh around an axis.
const MOST_FACETS: u32 = 1_000_000;
/// Greatest number of steps times rings of a screw flight.
const MOST_STEPS: f64 = 10_000_000.0;
/// Greatest number of subdivisions of a sphere, which has 1,310,720 triangles then.
const MOST_SUBDIVISIONS: u32 = 8;

impl Mesh {
    /// A tube without caps around the z axis, from z = 0 to z = `length`. Its outside is the outer side.
    ///
    /// It has 2 triangles for each of its `facets`, a number from 3 to 1,000,000. The vertices lie on the cylinder, so that the area
    /// is smaller than 2 pi `radius` `length` by about 1.6 / `facets`². Lengths are in the unit of the scene.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a radius or length that is not finite and positive, and another number of facets.
    pub fn cylinder(radius: f64, length: f64, facets: u32) -> Result<Self> {
        positive("cylinder.radius", radius)?;
        positive("cylinder.length", length)?;
        whole("cylinder.facets", facets, 3, MOST_FACETS, "a whole number from 3 to 1000000")?;
        let ring = (0..facets).flat_map(|facet| {
            let (sin, cos) = sin_cos(f64::from(facet), f64::from(facets));
            [0.0, length].map(|z| rounded(DVec3::new(radius * cos, radius * sin, z)))
        });
        let pair = |facet| {
            let (low, next) = (2 * facet, 2 * ((facet + 1) % facets));
            [[low, next, next + 1], [low, next + 1, low + 1]]
        };
        Self::new(ring.collect(), (0..facets).flat_map(pair).collect())
    }

    /// A sphere around the origin, with triangles of nearly equal size: an icosahedron whose triangles were divided into four so many
    /// times, from 0 to 8. Lengths are in the unit of the scene.
    ///
    /// It has 20 times 4^`subdivisions` triangles. The vertices lie on the sphere, so that the area is smaller than 4 pi `radius`² by
    /// 24 % without subdivision, by 7 % with one, and by about a quarter as much for each further one.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a radius that is not finite and positive, and another number of subdivisions.
    pub fn sphere(radius: f64, subdivisions: u32) -> Result<Self> {
        positive("sphere.radius", radius)?;
        whole("sphere.subdivisions", subdivisions, 0, MOST_SUBDIVISIONS, "a whole number from 0 to 8")?;
        let mut triangles = icosahedron();
        for _ in 0..subdivisions {
            triangles = triangles.into_iter().flat_map(divided).collect();
        }
        // A middle is the same number for both triangles of an edge, so that the vertices can be welded.
        let vertices: Vec<_> = triangles.into_iter().flatten().map(|vertex| rounded(vertex * radius)).collect();
        let indices = (0..vertices.len() as u32 / 3).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner));
        Self::new(vertices, indices.collect())
    }

    /// A screw flight around the z axis: the surface that a line from `inner_radius` to `outer_radius` sweeps while it turns and rises
    /// by `pitch` with each turn. It begins at the x axis at z = 0 and ends at z = |`pitch`| `turns`. Its outside is the upper side.
    ///
    /// A positive pitch makes a right-handed screw, a negative one a left-handed screw. With pitch 0, `turns` is at most 1, and the
    /// flight is a flat ring, or a disc if the inner radius is 0. Lengths are in the unit of the scene.
    ///
    /// `facets` is the number of steps in a turn, from 3 to 1,000,000. A step has 2 triangles for each of its rings. There are so many
    /// rings that the slope changes from one to the next by at most the angle of a step, 2 pi / `facets`: with one ring, triangles
    /// with the slope of the inner edge would alternate with those of the outer edge. A flat ring or disc has one ring. In a disc,
    /// a step has one triangle. Together there are at most 10,000,000 steps times rings.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a negative inner radius, an outer radius that is not greater than it, a number that is not finite, turns
    /// that are not positive, and another number of facets.
    pub fn helix(inner_radius: f64, outer_radius: f64, pitch: f64, turns: f64, facets: u32) -> Result<Self> {
        check_helix(inner_radius, outer_radius, pitch, turns)?;
        whole("helix.facets", facets, 3, MOST_FACETS, "a whole number from 3 to 1000000")?;
        let radii = radii(inner_radius, outer_radius, pitch.abs(), facets);
        let steps = (turns * f64::from(facets)).ceil();
        if steps * radii.len() as f64 > MOST_STEPS {
            return Err(invalid("helix.turns", turns, "at most 10000000 steps, which are turns times facets times rings"));
        }
        let (steps, ends) = (steps as u32, radii.len() as u32);
        let (is_left, is_disc) = (pitch < 0.0, pitch == 0.0 && inner_radius == 0.0);
        let line = |step: u32| {
            let turned = turns * (f64::from(step) / f64::from(steps));
            let (sin, cos) = sin_cos(turned % 1.0, 1.0);
            let (sin, z) = (if is_left { -sin } else { sin }, pitch.abs() * turned);
            radii.iter().map(move |r| rounded(DVec3::new(r * cos, r * sin, z)))
        };
        let cell = |cell: u32| {
            let (step, ring) = (cell / (ends - 1), cell % (ends - 1));
            let inner = step * ends + ring;
            let [outer, next_inner, next_outer] = [1, ends, ends + 1].map(|further| inner + further);
            // In a disc, the inner ends of all lines are one vertex.
            let second = (!is_disc).then_some([inner, next_outer, next_inner]);
            let flipped = move |[a, b, c]: [u32; 3]| if is_left { [a, c, b] } else { [a, b, c] };
            std::iter::once([inner, outer, next_outer]).chain(second).map(flipped)
        };
        Self::new((0..=steps).flat_map(line).collect(), (0..steps * (ends - 1)).flat_map(cell).collect())
    }
}

/// The radii of the edges of the rings of a screw flight. Their slopes differ by equal angles, at most the angle of a facet.
fn radii(inner: f64, outer: f64, pitch: f64, facets: u32) -> Vec<f64> {
    let [steep, gentle] = [inner, outer].map(|radius| pitch.atan2(TAU * radius));
    let rings = ((steep - gentle) / TAU * f64::from(facets)).ceil().max(1.0) as u32;
    let radius = |ring: u32| match ring {
        0 => inner,
        _ if ring == rings => outer,
        _ => {
            let slope = steep + (gentle - steep) * (f64::from(ring) / f64::from(rings));
            pitch / TAU * slope.cos() / slope.sin()
        }
    };
    (0..=rings).map(radius).collect()
}

/// Checks the numbers of a screw flight.
fn check_helix(inner_radius: f64, outer_radius: f64, pitch: f64, turns: f64) -> Result<()> {
    if !(inner_radius.is_finite() && inner_radius >= 0.0) {
        return Err(invalid("helix.inner_radius", inner_radius, "a finite number of at least 0"));
    }
    if !(outer_radius.is_finite() && outer_radius > inner_radius) {
        return Err(invalid("helix.outer_radius", outer_radius, "a finite number greater than the inner radius"));
    }
    if !pitch.is_finite() {
        return Err(invalid("helix.pitch", pitch, "a finite number"));
    }
    positive("helix.turns", turns)?;
    if pitch == 0.0 && turns > 1.0 {
        return Err(invalid("helix.turns", turns, "at most 1 turn with pitch 0"));
    }
    Ok(())
}

/// The triangles of an icosahedron with vertices on the unit sphere.
fn icosahedron() -> Vec<[DVec3; 3]> {
    // Two poles, and two rings of five vertices at latitudes of +-atan(1/2).
    let ring = |z: f64, first: f64| {
        let across = (1.0 - z * z).sqrt();
        [0.0, 1.0, 2.0, 3.0, 4.0].map(|index| {
            let (sin, cos) = sin_cos(index + first, 5.0);
            DVec3::new(across * cos, across * sin, z)
        })
    };
    let height = 0.2_f64.sqrt();
    let (upper, lower) = (ring(height, 0.0), ring(-height, 0.5));
    let faces = |at: usize| {
        let next = (at + 1) % 5;
        [
            [DVec3::Z, upper[at], upper[next]],
            [upper[at], lower[at], upper[next]],
            [upper[next], lower[at], lower[next]],
            [DVec3::NEG_Z, lower[next], lower[at]],
        ]
    };
    (0..5).flat_map(faces).collect()
}

/// The four triangles of a triangle on the unit sphere.
fn divided([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

fn invalid(field: &'static str, value: impl ToString, expected: &'static str) -> Error {
    Error::Invalid { field, value: value.to_string(), expected }
}

fn positive(field: &'static str, value: f64) -> Result<()> {
    let is_positive = value.is_finite() && value > 0.0;
    is_positive.then_some(()).ok_or_else(|| invalid(field, value, "a finite number greater than 0"))
}

fn whole(field: &'static str, value: u32, least: u32, most: u32, expected: &'static str) -> Result<()> {
    (least..=most).contains(&value).then_some(()).ok_or_else(|| invalid(field, value, expected))
}
