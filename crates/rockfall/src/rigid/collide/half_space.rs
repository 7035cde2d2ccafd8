//! A half-space against everything that has vertices.

use crate::rigid::collide::clip::{Candidate, reduce};
use crate::rigid::collide::solid::{MOST_VERTICES, Solid};
use crate::rigid::collide::{Manifold, ids};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;
use glam::Vec3;

/// The half-space a and the vertices of b.
pub(super) fn collide(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32) -> Option<Manifold> {
    let solid = Solid::new(&b.core, b_in_a);
    let most = reach + a.radius + b.radius;
    let mut found = [Candidate::default(); MOST_VERTICES];
    let mut count = 0;
    for (number, vertex) in solid.vertices().iter().enumerate().filter(|(_, vertex)| vertex.y <= most) {
        let foot = Vec3::new(vertex.x, 0.0, vertex.z);
        found[count] = Candidate { on_a: foot, on_b: *vertex, separation: vertex.y, id: ids::vertex(number) };
        count += 1;
    }
    reduce(&found[..count], Vec3::Y, Vec3::X, (a.radius, b.radius))
}
