//! What a camera should have in its picture.

use rockfall::Scene;
use rockfall::glam::Vec3;

/// Least and greatest corner of what holds all spheres of a scene; of a scene without any, of its static objects.
pub fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let spheres = scene.spheres().iter().map(|sphere| (sphere.position - sphere.radius, sphere.position + sphere.radius));
    spheres.reduce(|(min, max), (low, high)| (min.min(low), max.max(high))).unwrap_or((-Vec3::ONE, Vec3::ONE))
}
