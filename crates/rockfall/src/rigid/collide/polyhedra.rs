//! Any two of box, hull and face, with radii.

use crate::rigid::collide::closest::closest;
use crate::rigid::collide::solid::Solid;
use crate::rigid::collide::{Manifold, ids};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;

pub(super) fn collide(_a: &Shape, _b: &Shape, _b_in_a: &Pose, _reach: f32) -> Option<Manifold> {
    None
}

/// One point between the closest points of two shapes apart; `None` beyond reach, or if their cores are nearer than `least`.
pub(super) fn nearest(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32, least: f32) -> Option<Manifold> {
    let (solid_a, solid_b) = (Solid::new(&a.core, &Pose::IDENTITY), Solid::new(&b.core, b_in_a));
    let found = closest(solid_a.vertices(), solid_b.vertices());
    let separation = found.distance as f32 - a.radius - b.radius;
    if separation > reach || found.distance <= least as f64 {
        return None;
    }
    let normal = ((found.on_b - found.on_a) / found.distance).as_vec3().normalize();
    let id = ids::nearest(found.features.0, found.features.1);
    Some(Manifold::single(normal, (found.on_a.as_vec3(), found.on_b.as_vec3()), (a.radius, b.radius), id))
}
