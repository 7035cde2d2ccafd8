//! Properties of a scene that the renderer needs in addition to the buffers.

use rockfall::Scene;
use rockfall::glam::Vec3;

use crate::extent::{Extent, extent_of_spheres, extents_of_static_objects};

/// Properties of a scene that the renderer needs in addition to the buffers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SceneSummary {
    /// Height of the ground: the bottom of all static objects. Without static objects it is 0 if that is a short distance
    /// below the spheres, else the bottom of the spheres.
    pub(crate) ground: f32,
    /// Whether the ground depends on the spheres, because there are no static objects.
    pub(crate) is_below_spheres: bool,
    /// Median radius of the spheres.
    pub(crate) typical_radius: f32,
    /// The point near which planes are shown, and half the edge of the squares that stand for them.
    pub(crate) stage: (Vec3, f32),
}

impl Default for SceneSummary {
    fn default() -> Self {
        Self { ground: 0.0, is_below_spheres: true, typical_radius: 1.0, stage: (Vec3::ZERO, 1.0) }
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
        let objects = extents_of_static_objects(scene).reduce(Extent::with);
        let below = || extent_of_spheres(scene).map_or(0.0, ground_below);
        let ground = objects.map_or_else(below, |objects| objects.min.y);
        Self { ground, is_below_spheres: objects.is_none(), typical_radius, stage: stage(scene) }
    }

    /// Moves a ground that depends on the spheres below this extent, which they have over the time of a film.
    pub(crate) fn lower_ground(&mut self, spheres: Extent) {
        if self.is_below_spheres {
            self.ground = ground_below(spheres);
        }
    }
}

impl SceneSummary {
    /// Moves the ground down to the lowest of the spheres, if one has fallen below it.
    pub(crate) fn keep_below(&mut self, scene: &Scene) {
        let bottoms = scene.spheres().iter().map(|sphere| sphere.position.y - sphere.radius);
        self.ground = bottoms.filter(|bottom| bottom.is_finite()).fold(self.ground, f32::min);
    }
}

/// Edge of the square that stands for a plane, divided by the extent of everything else.
const PLANE: f32 = 1.3;

/// The middle of everything but planes, and half the edge of the squares that stand for planes.
pub(crate) fn stage(scene: &Scene) -> (Vec3, f32) {
    let all = extent_of_spheres(scene).into_iter().chain(extents_of_static_objects(scene)).reduce(Extent::with);
    all.map_or((Vec3::ZERO, 1.0), |all| (0.5 * (all.min + all.max), 0.5 * PLANE * all.size().max(f32::MIN_POSITIVE)))
}

/// Height of the ground of a scene without static objects.
fn ground_below(spheres: Extent) -> f32 {
    let is_near = spheres.min.y >= 0.0 && spheres.min.y <= 2.0 * spheres.size();
    if is_near { 0.0 } else { spheres.min.y }
}

#[cfg(test)]
mod tests {
    use rockfall::glam::Vec3;
    use rockfall::{Cuboid, Sphere};

    use super::*;
    use crate::bounds::tests::scene;

    #[test]
    fn the_ground_stays_below_what_falls() {
        let mut scene = scene(&[Cuboid::between([0.0, -1.0, 0.0], [1.0, 0.0, 1.0])]);
        let mut summary = SceneSummary::of(&scene);
        summary.keep_below(&scene);
        assert_eq!(summary.ground, -1.0);
        scene.add_sphere(Sphere::new([9.0, -7.0, 0.0], 0.5)).unwrap();
        summary.keep_below(&scene);
        assert_eq!(summary.ground, -7.5);
    }

    #[test]
    fn the_ground_is_at_the_bottom_of_the_static_objects() {
        assert_eq!(SceneSummary::of(&scene(&[])).ground, 0.0);
        assert_eq!(SceneSummary::of(&scene(&[Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])])).ground, -1.0);
        let mut deep = Scene::new();
        deep.add_sphere(Sphere::new([0.0, -7.0, 0.0], 0.5)).unwrap();
        assert_eq!((SceneSummary::of(&deep).ground, SceneSummary::of(&deep).typical_radius), (-7.5, 0.5));
    }

    #[test]
    fn in_a_film_the_ground_is_below_all_places_of_the_bodies() {
        let film = Extent { min: Vec3::splat(-3.0), max: Vec3::ONE };
        let lowered = |boxes: &[Cuboid]| {
            let mut summary = SceneSummary::of(&scene(boxes));
            summary.lower_ground(film);
            summary.ground
        };
        assert_eq!(lowered(&[]), -3.0);
        assert_eq!(lowered(&[Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])]), -1.0);
    }
}
