//! Polyhedra: their lists, the reduction to four places, and the general pair (docs/physics section 11.13). Radii are 0.

use rockfall::glam::{DMat3, DVec3};

use super::boxes::cut;
use super::closest;
use super::shapes::{Core, EPSILON, Manifold, Place, corner_signs, sgn};

#[derive(Clone, Debug)]
pub(crate) struct Facet {
    /// Vertices, counterclockwise from outside. A side of a face has two.
    pub(crate) corners: Vec<usize>,
    pub(crate) n: DVec3,
}

#[derive(Clone, Debug)]
pub(crate) struct Poly {
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) faces: Vec<Facet>,
    /// Two vertices and the two faces beside each edge.
    pub(crate) edges: Vec<[usize; 4]>,
    half: f64,
}

const BOX_FACES: [[usize; 4]; 6] = [[1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4], [4, 5, 7, 6], [0, 2, 3, 1]];
const BOX_EDGES: [[usize; 4]; 12] = [
    [0, 1, 3, 5],
    [2, 3, 2, 5],
    [4, 5, 3, 4],
    [6, 7, 2, 4],
    [0, 2, 1, 5],
    [1, 3, 0, 5],
    [4, 6, 1, 4],
    [5, 7, 0, 4],
    [0, 4, 1, 3],
    [1, 5, 0, 3],
    [2, 6, 1, 2],
    [3, 7, 0, 2],
];

impl Poly {
    pub(crate) fn of(core: &Core) -> Self {
        match *core {
            Core::Cuboid(half) => {
                let vertices = (0..8).map(|k| half * corner_signs(k)).collect();
                let normal = |f: usize| if f.is_multiple_of(2) { DVec3::AXES[f / 2] } else { -DVec3::AXES[f / 2] };
                let faces = BOX_FACES.iter().enumerate().map(|(f, corners)| Facet { corners: corners.to_vec(), n: normal(f) });
                Self { vertices, faces: faces.collect(), edges: BOX_EDGES.to_vec(), half: half.min_element() }
            }
            Core::Face { u, v, triangle } => Self::face(u, if u.cross(v).z < 0.0 { -v } else { v }, triangle),
            Core::HalfSpace | Core::Point => unreachable!("it has no faces"),
        }
    }

    fn face(u: DVec3, v: DVec3, triangle: bool) -> Self {
        let vertices = if triangle { vec![u, v, -u - v] } else { vec![-u - v, u - v, u + v, v - u] };
        let count = vertices.len();
        let ring: Vec<usize> = (0..count).collect();
        let mut faces = vec![
            Facet { corners: ring.clone(), n: DVec3::Z },
            Facet { corners: ring.iter().rev().copied().collect(), n: -DVec3::Z },
        ];
        let mut edges = Vec::new();
        for k in 0..count {
            let to = (k + 1) % count;
            let n = (vertices[to] - vertices[k]).cross(DVec3::Z).normalize();
            faces.push(Facet { corners: vec![k, to], n });
        }
        for side in 0..2 {
            edges.extend((0..count).map(|k| [k, (k + 1) % count, side, 2 + k]));
        }
        // The width of a face with the radius 0 (section 11.13).
        let area = u.cross(v).length();
        let sides = [2.0 * u + v, u + 2.0 * v, u - v].map(DVec3::length);
        let width =
            if triangle { 3.0 * area / sides[0].max(sides[1]).max(sides[2]) } else { 2.0 * area / u.length().max(v.length()) };
        Self { vertices, faces, edges, half: 0.5 * width }
    }

    pub(crate) fn placed(&self, p: DVec3, r: DMat3) -> Self {
        let vertices = self.vertices.iter().map(|&vertex| p + r * vertex).collect();
        let faces = self.faces.iter().map(|face| Facet { n: r * face.n, ..face.clone() }).collect();
        Self { vertices, faces, ..self.clone() }
    }

    fn scale(&self, origin: DVec3) -> f64 {
        self.vertices.iter().map(|vertex| (*vertex - origin).abs().max_element()).fold(0.0, f64::max)
    }

    fn anchor(&self, face: usize) -> DVec3 {
        self.vertices[self.faces[face].corners[0]]
    }

    /// The least height of vertices above a face of another one.
    fn least_above(&self, other: &Self, face: usize) -> f64 {
        let (anchor, n) = (other.anchor(face), other.faces[face].n);
        self.vertices.iter().map(|y| (*y - anchor).dot(n)).fold(f64::INFINITY, f64::min)
    }
}

/// The first k whose value is within a part of the greatest one.
fn first_near(values: &[f64], part: f64, margin: f64) -> usize {
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    values.iter().position(|value| *value >= greatest - part * greatest.abs() - margin).expect("candidates")
}

/// Reduces candidates to four.
pub(crate) fn reduced(all: Vec<Place>, n: DVec3, e: DVec3) -> Vec<Place> {
    if all.len() <= 4 {
        return all;
    }
    let values = |of: &dyn Fn(&Place) -> f64| -> Vec<f64> { all.iter().map(of).collect() };
    let wide = all.iter().map(|place| place.x.distance(all[0].x)).fold(0.0, f64::max);
    let a = first_near(&values(&|place| -(place.y - place.x).dot(n) - 1e-3 * place.x.dot(e)), 0.0, 0.5e-3 * wide);
    let from = all[a].x;
    let b = first_near(&values(&|place| (place.x - from).length_squared()), 0.01, 0.0);
    let along = all[b].x - from;
    let alpha = |place: &Place| along.cross(place.x - from).dot(n);
    let theta = 1e-5 * along.length_squared();
    let c = first_near(&values(&|place| alpha(place).abs()), 0.01, 0.0);
    if alpha(&all[c]).abs() <= theta {
        return vec![all[a], all[b]];
    }
    let side = sgn(alpha(&all[c]));
    let beta = |place: &Place| {
        let over = |p: usize, q: usize| (place.x - all[p].x).cross(all[q].x - all[p].x).dot(side * n);
        over(a, b).max(over(b, c)).max(over(c, a))
    };
    let d = first_near(&values(&beta), 0.01, 0.0);
    let mut left = vec![all[a], all[b], all[c]];
    if beta(&all[d]) > theta {
        left.push(all[d]);
    }
    left
}

/// Two polyhedra, the second one in its place.
struct Pair<'a> {
    cores: [&'a Core; 2],
    p: DVec3,
    r: DMat3,
    a: Poly,
    b: Poly,
    nu: f64,
    /// Half the less width.
    half: f64,
    bar: f64,
}

/// The general pair.
pub(crate) fn manifold(one: &Core, other: &Core, p: DVec3, r: DMat3, bar: f64) -> Option<Manifold> {
    let (a, b) = (Poly::of(one), Poly::of(other).placed(p, r));
    let nu = 4.0 * EPSILON * (a.scale(DVec3::ZERO) + b.scale(p) + p.abs().max_element());
    let half = a.half.min(b.half);
    let pair = Pair { cores: [one, other], p, r, a, b, nu, half, bar };
    if let Core::Face { triangle: false, .. } = one {
        return if p.z < 0.0 || pair.b.vertices.iter().all(|y| y.z > bar) { None } else { pair.face((0, 0)) };
    }
    let phi = 1e-3 * half + nu;
    let (edges, faces) = (pair.best_edges(1.0)?, pair.best_face(1.0)?);
    let (edge, face) = (edges.map_or(f64::NEG_INFINITY, |(_, value)| value), faces.1);
    let both = edge.max(face);
    let contact = |pi: f64| pair.best_edges(pi).flatten().and_then(|(edges, _)| pair.edges(edges));
    let mut found = None;
    if edge > face + 0.05 * face.abs() + 0.01 * half {
        found = contact(1.0).or_else(|| contact(0.0));
    }
    let found = found.or_else(|| pair.face(faces.0));
    let near = || closest::contact(one, other, p, r, bar, phi);
    match found {
        Some(found) if both > 0.0 && found.least() > both + 20.0 * phi => {
            Some(near().filter(|other| other.least() < found.least() - 20.0 * phi).unwrap_or(found))
        }
        Some(found) if both <= 0.0 && found.least() > both + 0.1 * both.abs() + 20.0 * phi => {
            Some(pair.strict().filter(|other| other.least() < found.least()).unwrap_or(found))
        }
        Some(found) => Some(found),
        None if both > -10.0 * phi => near().or_else(|| contact(1.0)),
        None => pair.strict(),
    }
}

impl Pair<'_> {
    /// The best face, of a (0) or of b (1), and its separation; `None` beyond the reach.
    fn best_face(&self, pi: f64) -> Option<((usize, usize), f64)> {
        let of_a = (0..self.a.faces.len()).map(|face| ((0, face), self.b.least_above(&self.a, face)));
        let of_b = (0..self.b.faces.len()).map(|face| ((1, face), self.a.least_above(&self.b, face)));
        let phi = 1e-3 * self.half + self.nu;
        let mut best: Option<((usize, usize), f64)> = None;
        for (face, value) in of_a.chain(of_b) {
            if value > self.bar {
                return None;
            }
            if best.is_none_or(|(_, f)| value > f + pi * (0.02 * f.abs() + phi)) {
                best = Some((face, value));
            }
        }
        best
    }

    /// The normal and the separation along the axis of two edges.
    fn edge_axis(&self, i: usize, j: usize) -> Option<(DVec3, f64)> {
        let (one, other) = (self.a.edges[i], self.b.edges[j]);
        let d = (self.a.vertices[one[1]] - self.a.vertices[one[0]]).normalize();
        let e = (self.b.vertices[other[1]] - self.b.vertices[other[0]]).normalize();
        let [n1, n2] = [one[2], one[3]].map(|face| self.a.faces[face].n);
        let [m1, m2] = [other[2], other[3]].map(|face| self.b.faces[face].n);
        let across = d.cross(e);
        let crosses = n1.dot(e) * n2.dot(e) < 0.0 && m1.dot(d) * m2.dot(d) < 0.0;
        if !crosses || across.length_squared() < 1e-6 || across.dot(n1 + n2) * -across.dot(m1 + m2) <= 0.0 {
            return None;
        }
        let size = across.length();
        let n = across / size * sgn(across.dot(n1 + n2));
        let apart = (self.b.vertices[other[0]] - self.a.vertices[one[0]]).dot(n) - self.nu / size;
        Some((n, apart))
    }

    /// The best edges and their separation. The outer `None` is beyond the reach.
    #[expect(clippy::option_option, reason = "no manifold, and no axis of edges")]
    fn best_edges(&self, pi: f64) -> Option<Option<((usize, usize), f64)>> {
        let mut best: Option<((usize, usize), f64)> = None;
        for i in 0..self.a.edges.len() {
            for j in 0..self.b.edges.len() {
                let Some((_, value)) = self.edge_axis(i, j) else { continue };
                if value > self.bar {
                    return None;
                }
                if best.is_none_or(|(_, f)| value > f + pi * (0.02 * f.abs() + 1e-3 * self.half)) {
                    best = Some(((i, j), value));
                }
            }
        }
        Some(best)
    }

    fn edges(&self, (i, j): (usize, usize)) -> Option<Manifold> {
        let (n, _) = self.edge_axis(i, j)?;
        let ends = |poly: &Poly, edge: [usize; 4]| [poly.vertices[edge[0]], poly.vertices[edge[1]]];
        let ([x0, x1], [y0, y1]) = (ends(&self.a, self.a.edges[i]), ends(&self.b, self.b.edges[j]));
        let (one, other) = ((x1 - x0).length(), (y1 - y0).length());
        let (d, e) = ((x1 - x0) / one, (y1 - y0) / other);
        let (s, t) = closest::lines(x0, d, y0, e)?;
        let beyond = |place: f64, length: f64| place <= -1e-4 * length || place >= 1.0001 * length;
        let (x, y) = (x0 + s * d, y0 + t * e);
        if beyond(s, one) || beyond(t, other) || (y - x).dot(n) > self.bar {
            return None;
        }
        Manifold::one(n, x, y, (1 << 31) + ((i as u32) << 12) + j as u32)
    }

    /// Contact of a face of a (0) or of b (1).
    fn face(&self, (side, number): (usize, usize)) -> Option<Manifold> {
        let (own, other) = if side == 0 { (&self.a, &self.b) } else { (&self.b, &self.a) };
        let face = &own.faces[number];
        let nf = face.n;
        let lowest = other.vertices.iter().map(|y| y.dot(nf)).fold(f64::INFINITY, f64::min);
        let first = other.vertices.iter().position(|y| y.dot(nf) == lowest).expect("vertices");
        let mut incident: Option<(usize, f64)> = None;
        for (k, facet) in other.faces.iter().enumerate().filter(|(_, facet)| facet.corners.contains(&first)) {
            let product = facet.n.dot(nf);
            if incident.is_none_or(|(_, f)| product < f - 1e-4) {
                incident = Some((k, product));
            }
        }
        let (incident, product) = incident.expect("a face at a vertex");
        let corners =
            |poly: &Poly, facet: usize| -> Vec<DVec3> { poly.faces[facet].corners.iter().map(|&k| poly.vertices[k]).collect() };
        let (ring, faced) = (corners(own, number), corners(other, incident));
        let features = (1 << 30) + ((side as u32) << 24) + ((number as u32) << 18) + ((incident as u32) << 12);
        let places: Vec<(DVec3, DVec3, u32)> = if ring.len() == 2 {
            if product >= -1e-3 {
                return None;
            }
            let m = other.faces[incident].n;
            let left = self.clipped(&ring, &faced, nf);
            let across = |x: DVec3| x + nf * ((faced[0] - x).dot(m) / nf.dot(m));
            left.into_iter().map(|(x, id)| (x, across(x), id)).collect()
        } else {
            let left = self.clipped(&faced, &ring, nf);
            left.into_iter().map(|(y, id)| (y - nf * (y - ring[0]).dot(nf), y, id)).collect()
        };
        let (outward, swapped) = if side == 0 { (nf, false) } else { (-nf, true) };
        let fits = |(x, y, _): &(DVec3, DVec3, u32)| (*y - *x).dot(nf) <= self.bar;
        let of = |(x, y, id): (DVec3, DVec3, u32)| {
            let (x, y) = if swapped { (y, x) } else { (x, y) };
            Place { x, y, id: features + id }
        };
        let places: Vec<Place> = places.into_iter().filter(fits).map(of).collect();
        Manifold::new(outward, reduced(places, outward, (ring[1] - ring[0]).normalize()))
    }

    /// A polygon or an edge cut at the planes through the edges of a ring that stand along n. With the labels before and after.
    fn clipped(&self, polygon: &[DVec3], ring: &[DVec3], n: DVec3) -> Vec<(DVec3, u32)> {
        let mut left: Vec<(DVec3, u32)> = polygon.iter().copied().zip(0..).collect();
        for (k, &from) in ring.iter().enumerate() {
            let along = ring[(k + 1) % ring.len()] - from;
            let out = along.cross(n).normalize_or_zero();
            // The ring of an incident face is seen from behind.
            let out = if (ring.iter().sum::<DVec3>() / ring.len() as f64 - from).dot(out) > 0.0 { -out } else { out };
            left = cut(&left, 32 + k as u32, |y| (y - from).dot(out) - self.nu);
        }
        let before = |at: usize| left[(at + left.len() - 1) % left.len()].1;
        (0..left.len()).map(|at| (left[at].0, (before(at) << 6) + left[at].1)).collect()
    }

    fn strict(&self) -> Option<Manifold> {
        let (edges, (face, separation)) = (self.best_edges(0.0)?, self.best_face(0.0)?);
        let edge = edges.map_or(f64::NEG_INFINITY, |(_, value)| value);
        let by_edges = || edges.and_then(|(edges, _)| self.edges(edges));
        let found = if edge > separation { by_edges().or_else(|| self.face(face)) } else { self.face(face).or_else(by_edges) };
        found.or_else(|| {
            let (poly, n) = if face.0 == 0 { (&self.a, self.a.faces[face.1].n) } else { (&self.b, -self.b.faces[face.1].n) };
            let b = Poly::of(self.cores[1]).placed(self.p, self.r);
            let y = closest::points(&self.a.vertices, &b.vertices).y;
            Manifold::one(n, y - n * (y - poly.anchor(face.1)).dot(n), y, 0)
        })
    }
}
