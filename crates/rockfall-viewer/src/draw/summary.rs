//! What the renderer has to know of a scene besides the buffers.

use rockfall::Scene;
use rockfall::glam::Vec3;

use crate::bounds::{Extent, of_spheres, of_static};

/// About so many places of spheres are kept.
const PLACES: usize = 100;

/// What the renderer has to know of a scene besides the buffers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SceneSummary {
    /// Where some of the spheres are, spread over all.
    pub(crate) places: Vec<Vec3>,
    /// Height of the ground: under all that is static, or at 0 where that is near below the spheres, else under them.
    pub(crate) ground: f32,
    /// The median of the spheres' radii.
    pub(crate) typical_radius: f32,
}

impl Default for SceneSummary {
    fn default() -> Self {
        Self { places: Vec::new(), ground: 0.0, typical_radius: 1.0 }
    }
}

impl SceneSummary {
    pub(crate) fn of(scene: &Scene) -> Self {
        let mut radii: Vec<f32> = scene.spheres().iter().map(|sphere| sphere.radius).collect();
        let middle = radii.len() / 2;
        let typical_radius = match radii.len() {
            0 => 1.0,
            _ => *radii.select_nth_unstable_by(middle, f32::total_cmp).1,
        };
        let ground = match (of_static(scene).reduce(Extent::with), of_spheres(scene)) {
            (Some(all), _) => all.min.y,
            (None, Some(spheres)) if spheres.min.y >= 0.0 && spheres.min.y <= 2.0 * spheres.size() => 0.0,
            (None, Some(spheres)) => spheres.min.y,
            (None, None) => 0.0,
        };
        let apart = (scene.spheres().len() / PLACES).max(1);
        let places = scene.spheres().iter().step_by(apart).map(|sphere| sphere.position).collect();
        Self { places, ground, typical_radius }
    }
}

#[cfg(test)]
mod tests {
    use rockfall::{Cuboid, Sphere};

    use super::*;

    fn scene(boxes: &[Cuboid]) -> Scene {
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new([0.0, 2.0, 0.0], 0.5)).unwrap();
        scene.add_sphere(Sphere::new([3.0, 2.0, 0.0], 0.25)).unwrap();
        for cuboid in boxes {
            scene.add_box(*cuboid).unwrap();
        }
        scene
    }

    #[test]
    fn the_ground_is_under_what_is_static() {
        assert_eq!(SceneSummary::of(&scene(&[])).ground, 0.0);
        assert_eq!(SceneSummary::of(&scene(&[Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])])).ground, -1.0);
        let mut deep = Scene::new();
        deep.add_sphere(Sphere::new([0.0, -7.0, 0.0], 0.5)).unwrap();
        assert_eq!((SceneSummary::of(&deep).ground, SceneSummary::of(&deep).typical_radius), (-7.5, 0.5));
    }
}
