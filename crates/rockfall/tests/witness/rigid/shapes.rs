//! Shapes and manifolds (docs/physics section 11.13). Everything is in coordinates of the first shape of a pair, in units.

use rockfall::glam::{DMat3, DQuat, DVec3};

use super::boxes;
use super::polyhedra::{self, Poly};

/// Relative distance of neighbouring f32 numbers.
pub(crate) const EPSILON: f64 = 1.0 / 8_388_608.0;

/// What a shape is made of, without its radius.
#[derive(Clone, Debug)]
pub(crate) enum Core {
    /// All points with y of at most 0.
    HalfSpace,
    /// A parallelogram with the half edges u and v, or the triangle u, v, -u - v, in the plane z = 0.
    Face {
        u: DVec3,
        v: DVec3,
        triangle: bool,
    },
    /// A box with these half edges.
    Cuboid(DVec3),
    Point,
}

#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) core: Core,
    pub(crate) radius: f64,
}

/// A place of both shapes that meet: x of the first one, y of the second one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) x: DVec3,
    pub(crate) y: DVec3,
    pub(crate) id: u32,
}

#[derive(Clone, Debug)]
pub(crate) struct Manifold {
    /// Unit normal from the first shape to the second one.
    pub(crate) n: DVec3,
    pub(crate) places: Vec<Place>,
}

impl Manifold {
    /// `None` without places.
    pub(crate) fn new(n: DVec3, places: Vec<Place>) -> Option<Self> {
        (!places.is_empty()).then_some(Self { n, places })
    }

    pub(crate) fn one(n: DVec3, x: DVec3, y: DVec3, id: u32) -> Option<Self> {
        Self::new(n, vec![Place { x, y, id }])
    }

    /// The least separation of its places.
    pub(crate) fn least(&self) -> f64 {
        self.places.iter().map(|place| (place.y - place.x).dot(self.n)).fold(f64::INFINITY, f64::min)
    }

    /// The manifold of the pair in exchanged order, in coordinates of the other shape, which is at `p` turned by `r`.
    pub(crate) fn turned_back(self, p: DVec3, r: DMat3) -> Self {
        let places = self.places.into_iter().map(|place| Place { x: p + r * place.y, y: p + r * place.x, ..place });
        Self { n: -(r * self.n), places: places.collect() }
    }
}

/// sgn(x) is -1 for x < 0 and 1 otherwise.
pub(crate) fn sgn(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

impl Shape {
    fn rank(&self) -> u8 {
        match self.core {
            Core::HalfSpace => 0,
            Core::Face { .. } => 1,
            Core::Cuboid(_) => 2,
            Core::Point => 5,
        }
    }

    pub(crate) fn is_ball(&self) -> bool {
        matches!(self.core, Core::Point)
    }

    /// Least edge or diameter.
    pub(crate) fn width(&self) -> f64 {
        match self.core {
            Core::Cuboid(half) => 2.0 * half.min_element(),
            _ => 2.0 * self.radius,
        }
    }

    /// Greatest distance of its surface from a point at `-place` of its coordinates' origin.
    pub(crate) fn reach(&self, place: DVec3, turn: DQuat) -> f64 {
        match self.core {
            Core::HalfSpace | Core::Face { .. } => f64::INFINITY,
            Core::Point => place.length() + self.radius,
            Core::Cuboid(half) => {
                let far = |k: usize| (place + turn * (half * corner_signs(k))).length();
                (0..8).map(far).fold(0.0, f64::max)
            }
        }
    }

    /// Bounds along the axes of the world.
    pub(crate) fn bounds(&self, x: DVec3, q: DQuat) -> [DVec3; 2] {
        match &self.core {
            Core::HalfSpace => [DVec3::splat(f64::NEG_INFINITY), DVec3::splat(f64::INFINITY)],
            Core::Point => [x - self.radius, x + self.radius],
            core => {
                let all = Poly::of(core).vertices.into_iter().map(|vertex| x + q * vertex);
                all.fold([x + f64::INFINITY, x - f64::INFINITY], |[low, high], at| [low.min(at), high.max(at)])
            }
        }
    }
}

/// The signs of vertex k of a box: bit i says whether coordinate i is positive.
pub(crate) fn corner_signs(k: usize) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| if k >> i & 1 == 1 { 1.0 } else { -1.0 }))
}

/// The manifold of two shapes, the second one at `p` turned by `r`, with places on the surfaces.
pub(crate) fn manifold(a: &Shape, b: &Shape, p: DVec3, r: DMat3, reach: f64) -> Option<Manifold> {
    if a.rank() > b.rank() {
        let back = r.transpose();
        return Some(manifold(b, a, -(back * p), back, reach)?.turned_back(p, r));
    }
    let bar = reach + a.radius + b.radius;
    let mut found = match (&a.core, &b.core) {
        (core, Core::Point) => nearest(core, p).filter(|found| found.least() <= bar)?,
        (Core::HalfSpace, Core::HalfSpace) => return None,
        (Core::HalfSpace, core) => half_space(&Poly::of(core).placed(p, r), bar)?,
        (Core::Cuboid(one), Core::Cuboid(other)) => boxes::manifold(*one, *other, p, r, reach)?,
        (one, other) => polyhedra::manifold(one, other, p, r, bar)?,
    };
    for place in &mut found.places {
        place.x += a.radius * found.n;
        place.y -= b.radius * found.n;
    }
    Some(found)
}

/// The unit vector from x to p, or `otherwise` where both are one.
fn unit(x: DVec3, p: DVec3, otherwise: DVec3) -> DVec3 {
    let far = (p - x).length();
    if far > (2.0 * EPSILON * p.abs().max_element()).max(2.0_f64.powi(-63)) { (p - x) / far } else { otherwise }
}

/// A ball's centre p and a core.
fn nearest(core: &Core, p: DVec3) -> Option<Manifold> {
    let (x, n) = match core {
        Core::Point => (DVec3::ZERO, unit(DVec3::ZERO, p, DVec3::Y)),
        Core::HalfSpace => (DVec3::new(p.x, 0.0, p.z), DVec3::Y),
        Core::Cuboid(half) => nearest_of_box(*half, p),
        Core::Face { triangle, .. } => {
            if p.z < 0.0 && !triangle {
                return None;
            }
            let poly = Poly::of(core);
            let ring: Vec<DVec3> = poly.faces[0].corners.iter().map(|&k| poly.vertices[k]).collect();
            let x = nearest_of_ring(&ring, DVec3::new(p.x, p.y, 0.0), p);
            (x, unit(x, p, sgn(p.z) * DVec3::Z))
        }
    };
    Manifold::one(n, x, p, 0)
}

pub(crate) fn nearest_of_box(half: DVec3, p: DVec3) -> (DVec3, DVec3) {
    if (0..3).any(|i| p[i].abs() > half[i]) {
        let x = p.clamp(-half, half);
        return (x, (p - x).normalize());
    }
    let depth = half - p.abs();
    let i = (0..3).find(|&i| depth[i] == depth.min_element()).expect("an axis");
    let mut x = p;
    x[i] = sgn(p[i]) * half[i];
    (x, sgn(p[i]) * DVec3::AXES[i])
}

/// The place of a face with a ring of vertices that is nearest to p, whose foot is given.
fn nearest_of_ring(ring: &[DVec3], foot: DVec3, p: DVec3) -> DVec3 {
    let edges = || (0..ring.len()).map(|k| (ring[k], ring[(k + 1) % ring.len()]));
    if edges().all(|(from, to)| (to - from).cross(foot - from).z >= 0.0) {
        return foot;
    }
    let places = edges().map(|(from, to)| on_segment(from, to, p));
    places.reduce(|best, x| if x.distance_squared(p) < best.distance_squared(p) { x } else { best }).expect("edges")
}

pub(crate) fn on_segment(from: DVec3, to: DVec3, p: DVec3) -> DVec3 {
    let along = to - from;
    from + along * ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0)
}

/// A half-space and vertices.
fn half_space(b: &Poly, bar: f64) -> Option<Manifold> {
    let low = b.vertices.iter().enumerate().filter(|(_, y)| y.y <= bar);
    let of = |(k, &y): (usize, &DVec3)| Place { x: DVec3::new(y.x, 0.0, y.z), y, id: (3 << 30) + k as u32 };
    Manifold::new(DVec3::Y, polyhedra::reduced(low.map(of).collect(), DVec3::Y, DVec3::X))
}
