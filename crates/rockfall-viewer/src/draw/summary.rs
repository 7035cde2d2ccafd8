//! Properties of a scene that the renderer needs in addition to the buffers.

use rockfall::Scene;

use crate::extent::{Extent, extent_of_spheres, extents_of_static_objects};

/// Properties of a scene that the renderer needs in addition to the buffers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SceneSummary {
    /// Height of the ground: the bottom of all static objects. Without static objects it is 0 if that is a short distance
    /// below the spheres, else the bottom of the spheres.
    pub(crate) ground: f32,
    /// Median radius of the spheres.
    pub(crate) typical_radius: f32,
}

impl Default for SceneSummary {
    fn default() -> Self {
        Self { ground: 0.0, typical_radius: 1.0 }
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
        let ground = match (extents_of_static_objects(scene).reduce(Extent::with), extent_of_spheres(scene)) {
            (Some(all), _) => all.min.y,
            (None, Some(spheres)) if spheres.min.y >= 0.0 && spheres.min.y <= 2.0 * spheres.size() => 0.0,
            (None, Some(spheres)) => spheres.min.y,
            (None, None) => 0.0,
        };
        Self { ground, typical_radius }
    }
}

#[cfg(test)]
mod tests {
    use rockfall::{Cuboid, Sphere};

    use super::*;
    use crate::bounds::tests::scene;

    #[test]
    fn the_ground_is_at_the_bottom_of_the_static_objects() {
        assert_eq!(SceneSummary::of(&scene(&[])).ground, 0.0);
        assert_eq!(SceneSummary::of(&scene(&[Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])])).ground, -1.0);
        let mut deep = Scene::new();
        deep.add_sphere(Sphere::new([0.0, -7.0, 0.0], 0.5)).unwrap();
        assert_eq!((SceneSummary::of(&deep).ground, SceneSummary::of(&deep).typical_radius), (-7.5, 0.5));
    }
}
