use crate::rigid::collide::Manifold;
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;
pub(super) fn with_capsule(_a: &Shape, _b: &Shape, _b_in_a: &Pose, _reach: f32) -> Option<Manifold> {
    None
}
pub(super) fn with_polyhedron(_a: &Shape, _b: &Shape, _b_in_a: &Pose, _reach: f32) -> Option<Manifold> {
    None
}
