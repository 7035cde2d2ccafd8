//! The convex hull of points.
//!
//! An incremental hull in double precision: points are added one by one, the farthest from a face first, and replace the
//! triangles that they see by a fan over the horizon. Then triangles of one plane become one face.

use std::fmt;

use glam::{DVec3, Vec3};

use crate::rigid::shape::moments::moments;
use crate::rigid::shape::{Hull, MOST_FACES};

/// Thickness of a plane, as a part of the greatest coordinate about the middle.
const THICKNESS: f64 = 1e-6;
/// Greatest number of points. The search takes time in proportion to it.
const MOST_POINTS: usize = 100_000;
/// Greatest number of triangles while a hull grows. A hull with [`MOST_FACES`] faces has 116 at most; the others lie in their planes.
const MOST_TRIANGLES: usize = 512;

/// Why points have no hull that the solver takes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BadHull {
    /// What is wrong with the points.
    pub(crate) value: String,
    /// What is expected in its place.
    pub(crate) expected: &'static str,
}

impl BadHull {
    fn new(value: impl Into<String>, expected: &'static str) -> Self {
        Self { value: value.into(), expected }
    }

    fn flat() -> Self {
        Self::new("points that lie in one plane", "points on all sides of a volume")
    }

    fn close_to_flat() -> Self {
        Self::new("points that are too close to one plane", "points on all sides of a volume")
    }
}

impl fmt::Display for BadHull {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, expected {}", self.value, self.expected)
    }
}

/// A triangle of the growing hull: vertices counterclockwise from outside, and its plane.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    corners: [usize; 3],
    normal: DVec3,
    offset: f64,
}

impl Triangle {
    fn new(points: &[DVec3], corners: [usize; 3]) -> Self {
        let [p, q, r] = corners.map(|number| points[number]);
        let normal = (q - p).cross(r - p).normalize_or_zero();
        Self { corners, normal, offset: normal.dot((p + q + r) / 3.0) }
    }

    fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    fn edges(&self) -> [(usize, usize); 3] {
        let [p, q, r] = self.corners;
        [(p, q), (q, r), (r, p)]
    }
}

impl Hull {
    /// The convex hull of points, and its centre of mass in their coordinates. The vertices of the hull are relative to it.
    pub(crate) fn new(points: &[Vec3]) -> Result<(Self, Vec3), BadHull> {
        let (hull, centre, _) = Self::with_numbers(points)?;
        Ok((hull, centre))
    }

    /// As [`Hull::new`], with the numbers of the points that are its vertices, ascending.
    pub(crate) fn with_numbers(points: &[Vec3]) -> Result<(Self, Vec3, Vec<usize>), BadHull> {
        if let Some(number) = points.iter().position(|point| !point.is_finite()) {
            return Err(BadHull::new(format!("{:?} of point {number}", points[number].to_array()), "three finite numbers"));
        }
        if points.len() < 4 || points.len() > MOST_POINTS {
            return Err(BadHull::new(format!("{} points", points.len()), "4 to 100000 points"));
        }
        let middle = points.iter().map(|point| point.as_dvec3()).sum::<DVec3>() / points.len() as f64;
        let points: Vec<DVec3> = points.iter().map(|point| point.as_dvec3() - middle).collect();
        let size = points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
        let thickness = THICKNESS * size;
        let triangles = grow(&points, thickness)?;
        let sum = moments(triangles.iter().map(|triangle| triangle.corners.map(|number| points[number])));
        if sum.volume <= 0.0 {
            return Err(BadHull::flat());
        }
        let centre = sum.first / sum.volume;
        let faces = merge(&points, &triangles, thickness)?;
        let (hull, numbers) = assemble(&points, centre, faces)?;
        Ok((hull, (middle + centre).as_vec3(), numbers))
    }
}

/// Triangles around all points, up to the thickness of a plane.
fn grow(points: &[DVec3], thickness: f64) -> Result<Vec<Triangle>, BadHull> {
    let mut triangles = first(points, thickness)?;
    // Each round adds one point, so more rounds than points never end well.
    for _ in 0..points.len() {
        let Some(farthest) = farthest(points, &triangles, thickness) else {
            return Ok(triangles);
        };
        add(points, &mut triangles, farthest, thickness);
        if triangles.len() > MOST_TRIANGLES {
            let count = triangles.len() / 2 + 2;
            return Err(BadHull::new(format!("a hull of at least {count} vertices"), "a hull with at most 32 faces"));
        }
    }
    Ok(triangles)
}

/// A tetrahedron of points that are far from each other.
fn first(points: &[DVec3], thickness: f64) -> Result<Vec<Triangle>, BadHull> {
    let p = greatest(points, |point| -point.x);
    let q = greatest(points, |point| point.distance_squared(points[p]));
    let along = (points[q] - points[p]).try_normalize().ok_or_else(BadHull::flat)?;
    let r = greatest(points, |point| (point - points[p]).reject_from_normalized(along).length_squared());
    let normal = along.cross(points[r] - points[p]).try_normalize().ok_or_else(BadHull::flat)?;
    let s = greatest(points, |point| (point - points[p]).dot(normal).abs());
    let height = (points[s] - points[p]).dot(normal);
    if height.abs() <= 4.0 * thickness || (points[r] - points[p]).reject_from_normalized(along).length() <= 4.0 * thickness {
        return Err(BadHull::flat());
    }
    let (q, r) = if height > 0.0 { (r, q) } else { (q, r) };
    Ok([[p, q, r], [p, s, q], [q, s, r], [r, s, p]].map(|corners| Triangle::new(points, corners)).to_vec())
}

/// Index of the point with the greatest value; the first of equal ones.
fn greatest(points: &[DVec3], value: impl Fn(DVec3) -> f64) -> usize {
    let mut best = 0;
    for (index, point) in points.iter().enumerate() {
        if value(*point) > value(points[best]) {
            best = index;
        }
    }
    best
}

/// The point highest above any triangle; `None` if all are inside.
fn farthest(points: &[DVec3], triangles: &[Triangle], thickness: f64) -> Option<usize> {
    let mut best = (thickness, None);
    for (index, point) in points.iter().enumerate() {
        let height = triangles.iter().map(|triangle| triangle.height(*point)).fold(f64::NEG_INFINITY, f64::max);
        if height > best.0 {
            best = (height, Some(index));
        }
    }
    best.1
}

/// Replaces the triangles that a point sees. The seen ones are connected: the search starts at the one seen best.
fn add(points: &[DVec3], triangles: &mut Vec<Triangle>, point: usize, thickness: f64) {
    let height = |triangle: &Triangle| triangle.height(points[point]);
    let start = (0..triangles.len()).max_by(|a, b| height(&triangles[*a]).total_cmp(&height(&triangles[*b])));
    let Some(start) = start else { return };
    let mut seen = vec![false; triangles.len()];
    seen[start] = true;
    let mut open = vec![start];
    while let Some(current) = open.pop() {
        for (from, to) in triangles[current].edges() {
            let beside = triangles.iter().position(|triangle| triangle.edges().contains(&(to, from)));
            let Some(beside) = beside.filter(|beside| !seen[*beside]) else { continue };
            // A triangle in the plane of the point counts as seen: its edges would give slivers.
            if height(&triangles[beside]) > -1e-3 * thickness {
                seen[beside] = true;
                open.push(beside);
            }
        }
    }
    let mut horizon = Vec::new();
    for (index, triangle) in triangles.iter().enumerate().filter(|(index, _)| seen[*index]) {
        for (from, to) in triangle.edges() {
            let beside = triangles.iter().position(|other| other.edges().contains(&(to, from)));
            if beside.is_none_or(|beside| !seen[beside]) {
                horizon.push((from, to));
            }
        }
        debug_assert!(seen[index]);
    }
    let mut kept = seen.iter().map(|seen| !seen);
    triangles.retain(|_| kept.next().unwrap_or(true));
    triangles.extend(horizon.into_iter().map(|(from, to)| Triangle::new(points, [from, to, point])));
}

/// A face: its normal and vertices.
type Face = (DVec3, Vec<usize>);

/// Faces of triangles in one plane. The largest triangle decides on the plane.
fn merge(points: &[DVec3], triangles: &[Triangle], thickness: f64) -> Result<Vec<Face>, BadHull> {
    let area = |triangle: &Triangle| {
        let [p, q, r] = triangle.corners.map(|number| points[number]);
        (q - p).cross(r - p).length()
    };
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|a, b| area(&triangles[*b]).total_cmp(&area(&triangles[*a])).then(a.cmp(b)));
    let mut taken = vec![false; triangles.len()];
    let mut faces = Vec::new();
    for seed in order {
        if taken[seed] {
            continue;
        }
        taken[seed] = true;
        let plane = triangles[seed];
        let mut members = vec![seed];
        let mut next = 0;
        while next < members.len() {
            for (from, to) in triangles[members[next]].edges() {
                let beside = triangles.iter().position(|triangle| triangle.edges().contains(&(to, from)));
                let Some(beside) = beside.filter(|beside| !taken[*beside]) else { continue };
                let flat =
                    triangles[beside].corners.iter().all(|corner| plane.height(points[*corner]).abs() <= 2.0 * thickness);
                if flat && triangles[beside].normal.dot(plane.normal) > -0.5 {
                    taken[beside] = true;
                    members.push(beside);
                }
            }
            next += 1;
        }
        faces.push((plane.normal, outline(triangles, &members)?));
    }
    straighten(points, &mut faces, thickness);
    if faces.len() > MOST_FACES {
        return Err(BadHull::new(format!("a hull with {} faces", faces.len()), "a hull with at most 32 faces"));
    }
    Ok(faces)
}

/// The vertices around some triangles.
fn outline(triangles: &[Triangle], members: &[usize]) -> Result<Vec<usize>, BadHull> {
    let edges: Vec<(usize, usize)> = members.iter().flat_map(|member| triangles[*member].edges()).collect();
    let border: Vec<(usize, usize)> = edges.iter().copied().filter(|(from, to)| !edges.contains(&(*to, *from))).collect();
    let mut corners = Vec::new();
    let mut at = border.first().map_or(0, |edge| edge.0);
    for _ in 0..border.len() {
        corners.push(at);
        let next = border.iter().find(|edge| edge.0 == at);
        at = next.ok_or_else(BadHull::close_to_flat)?.1;
    }
    if border.is_empty() || at != corners[0] {
        return Err(BadHull::close_to_flat());
    }
    Ok(corners)
}

/// Removes vertices that lie on a line between two faces only: corners of a hull have at least three.
fn straighten(points: &[DVec3], faces: &mut Vec<Face>, _thickness: f64) {
    for number in 0..points.len() {
        let around = faces.iter().filter(|(_, corners)| corners.contains(&number)).count();
        if around < 3 {
            faces.iter_mut().for_each(|(_, corners)| corners.retain(|corner| *corner != number));
        }
    }
    faces.retain(|(_, corners)| corners.len() >= 3);
}

/// Vertices that are used, about the centre of mass; faces; edges with the faces beside them.
fn assemble(points: &[DVec3], centre: DVec3, faces: Vec<Face>) -> Result<(Hull, Vec<usize>), BadHull> {
    let used: Vec<usize> =
        (0..points.len()).filter(|number| faces.iter().any(|(_, corners)| corners.contains(number))).collect();
    let place = |number: usize| used.binary_search(&number).unwrap_or(0) as u8;
    let loops: Vec<Vec<u8>> = faces.iter().map(|(_, corners)| corners.iter().map(|corner| place(*corner)).collect()).collect();
    let directed = |face: usize| {
        let corners: &Vec<u8> = &loops[face];
        (0..corners.len()).map(move |k| (corners[k], corners[(k + 1) % corners.len()]))
    };
    let mut edges = Vec::new();
    for face in 0..loops.len() {
        for (from, to) in directed(face).filter(|(from, to)| from < to) {
            let beside = (0..loops.len()).find(|other| directed(*other).any(|edge| edge == (to, from)));
            let beside = beside.ok_or_else(BadHull::close_to_flat)?;
            edges.push([from, to, face as u8, beside as u8]);
        }
    }
    if used.len() + loops.len() != edges.len() + 2 {
        return Err(BadHull::close_to_flat());
    }
    let vertices = used.iter().map(|number| (points[*number] - centre).as_vec3()).collect();
    let faces = faces.iter().zip(loops).map(|((normal, _), corners)| (normal.as_vec3().normalize(), corners)).collect();
    Ok((Hull { vertices, faces, edges }, used))
}
