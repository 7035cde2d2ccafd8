//! Moments of a hull with a radius: the hull, a slab on each face, a wedge along each edge and a part of a ball at each vertex.

use glam::DVec3;

use crate::rigid::shape::Hull;
use crate::rigid::shape::moments::{Moments, moments};

/// Parts of a wedge, and of the edges of a triangle on a ball. The volume is exact for any number, the moments to about 1e-4.
const PARTS: usize = 8;

/// Volume, first and second moments about the origin of all points within the radius of a hull.
pub(super) fn rounded(hull: &Hull, radius: f64) -> Moments {
    let corners: Vec<DVec3> = hull.vertices.iter().map(|vertex| vertex.as_dvec3()).collect();
    let normals: Vec<DVec3> = hull.faces.iter().map(|(normal, _)| normal.as_dvec3().normalize()).collect();
    let mut sum = moments([]);
    let mut add = |part: Moments| {
        sum.volume += part.volume;
        sum.first += part.first;
        sum.second += part.second;
    };
    for ((_, face), normal) in hull.faces.iter().zip(&normals) {
        let base: Vec<DVec3> = face.iter().map(|corner| corners[*corner as usize]).collect();
        add(moments(fan(&base)));
        add(moments(prism(&base, *normal * radius)));
    }
    for [from, to, left, right] in &hull.edges {
        let (start, end) = (corners[*from as usize], corners[*to as usize]);
        let (first, last) = (normals[*left as usize], normals[*right as usize]);
        let step = first.angle_between(last) / PARTS as f64;
        let reach = radius * (step / step.sin()).sqrt();
        let ray = |k: usize| start + slerp(first, last, k as f64 / PARTS as f64) * reach;
        for k in 0..PARTS {
            let base = [start, ray(k), ray(k + 1)];
            let is_forward = (base[1] - start).cross(base[2] - start).dot(end - start) > 0.0;
            let base = if is_forward { base } else { turned(base) };
            add(moments(prism(&base, end - start)));
        }
    }
    for (number, corner) in corners.iter().enumerate() {
        let around = normals_around(hull, &normals, number as u8);
        for triangle in fan(&around) {
            for part in divided(triangle) {
                add(moments(cone(*corner, part, radius)));
            }
        }
    }
    sum
}

/// Triangles over a convex polygon.
fn fan(corners: &[DVec3]) -> impl Iterator<Item = [DVec3; 3]> {
    (1..corners.len().max(2) - 1).map(|k| [corners[0], corners[k], corners[k + 1]])
}

fn turned([p, q, r]: [DVec3; 3]) -> [DVec3; 3] {
    [p, r, q]
}

/// The surface of a prism on a base that runs counterclockwise as seen from the top.
fn prism(base: &[DVec3], height: DVec3) -> impl Iterator<Item = [DVec3; 3]> {
    let count = base.len();
    let floor = fan(base).map(turned);
    let top = fan(base).map(move |triangle| triangle.map(|corner| corner + height));
    let sides = (0..count).flat_map(move |k| {
        let (p, q) = (base[k], base[(k + 1) % count]);
        [[p, q, q + height], [p, q + height, p + height]]
    });
    floor.chain(top).chain(sides)
}

/// Between two unit vectors, along the arc.
fn slerp(first: DVec3, last: DVec3, part: f64) -> DVec3 {
    let angle = first.angle_between(last);
    if angle < 1e-9 {
        return first;
    }
    (first * ((1.0 - part) * angle).sin() + last * (part * angle).sin()) / angle.sin()
}

/// Normals of the faces at a vertex, counterclockwise from outside.
fn normals_around(hull: &Hull, normals: &[DVec3], corner: u8) -> Vec<DVec3> {
    let has_corner = |face: &usize| hull.faces[*face].1.contains(&corner);
    let mut around: Vec<DVec3> = (0..normals.len()).filter(has_corner).map(|face| normals[face]).collect();
    let middle = around.iter().sum::<DVec3>().normalize_or(DVec3::Y);
    let (u, v) = middle.any_orthonormal_pair();
    let angle = |normal: &DVec3| normal.dot(v).atan2(normal.dot(u));
    around.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    if u.cross(v).dot(middle) < 0.0 {
        around.reverse();
    }
    around
}

/// Smaller triangles of one on the unit ball.
fn divided([p, q, r]: [DVec3; 3]) -> Vec<[DVec3; 3]> {
    let size = PARTS as f64;
    let at = |i: usize, j: usize| (p + (q - p) * (i as f64 / size) + (r - p) * (j as f64 / size)).normalize();
    let mut parts = Vec::new();
    for i in 0..PARTS {
        for j in 0..PARTS - i {
            parts.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < PARTS {
                parts.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    parts
}

/// A tetrahedron with the volume of the part of a ball above a triangle of directions.
fn cone(tip: DVec3, [p, q, r]: [DVec3; 3], radius: f64) -> Vec<[DVec3; 3]> {
    let volume = p.dot(q.cross(r)) / 6.0;
    let angle = 2.0 * (6.0 * volume).atan2(1.0 + p.dot(q) + q.dot(r) + r.dot(p));
    if volume <= 1e-18 {
        return Vec::new();
    }
    let reach = radius * (angle / 3.0 / volume).cbrt();
    let [p, q, r] = [p, q, r].map(|direction| tip + direction * reach);
    vec![[p, q, r], [tip, q, p], [tip, r, q], [tip, p, r]]
}
