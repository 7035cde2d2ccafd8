//! Properties of a scene that the renderer needs in addition to the buffers.

use rockfall::Scene;
use rockfall::glam::Vec3;

use crate::extent::{Extent, extent_of_spheres, extents_of_static_objects};
use crate::up::Up;

/// Properties of a scene that the renderer needs in addition to the buffers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SceneSummary {
    /// What the ground is below: all static objects, or the spheres if there are none; `None` without either.
    base: Option<Extent>,
    /// Whether the ground depends on the spheres, because there are no static objects.
    pub(crate) is_below_spheres: bool,
    /// Spheres that the ground also stays below.
    fallen: Option<Extent>,
    /// Median radius of the spheres.
    pub(crate) typical_radius: f32,
    /// The point near which planes are shown, and half the edge of the squares that stand for them.
    pub(crate) stage: (Vec3, f32),
}

impl Default for SceneSummary {
    fn default() -> Self {
        Self { base: None, is_below_spheres: true, fallen: None, typical_radius: 1.0, stage: (Vec3::ZERO, 1.0) }
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
        let base = objects.or_else(|| extent_of_spheres(scene));
        Self { base, is_below_spheres: objects.is_none(), fallen: None, typical_radius, stage: stage(scene) }
    }

    /// Moves a ground that depends on the spheres below this extent, which they have over the time of a film.
    pub(crate) fn lower_ground(&mut self, spheres: Extent) {
        if self.is_below_spheres {
            (self.base, self.fallen) = (Some(spheres), None);
        }
    }
}

impl SceneSummary {
    /// Moves the ground down to the lowest of the spheres, if one has fallen below it.
    pub(crate) fn keep_below(&mut self, scene: &Scene) {
        let spheres = scene.spheres().iter().map(|sphere| Extent::around(sphere.position, sphere.radius));
        let finite = spheres.filter(|extent| extent.min.is_finite() && extent.max.is_finite());
        self.fallen = finite.chain(self.fallen).reduce(Extent::with);
    }

    /// Height of the ground: the bottom of all static objects. Without static objects it is 0 if that is a short distance
    /// below the spheres, else the bottom of the spheres.
    pub(crate) fn ground(&self, up: Up) -> f32 {
        let ground = match self.base.map(|base| up.level_extent(base)) {
            Some(spheres) if self.is_below_spheres => ground_below(spheres),
            Some(objects) => objects.min.y,
            None => 0.0,
        };
        self.fallen.map_or(ground, |fallen| ground.min(up.bottom(fallen)))
    }
}

/// Edge of the square that stands for a plane, divided by the extent of everything else.
const PLANE: f32 = 1.3;

/// The middle of everything but planes, and half the edge of the squares that stand for planes.
pub(crate) fn stage(scene: &Scene) -> (Vec3, f32) {
    let all = extent_of_spheres(scene).into_iter().chain(extents_of_static_objects(scene)).reduce(Extent::with);
    all.map_or((Vec3::ZERO, 1.0), |all| (0.5 * (all.min + all.max), 0.5 * PLANE * all.size().max(f32::MIN_POSITIVE)))
}

/// Height of the ground of a scene without static objects, whose spheres have this extent in level coordinates.
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
        assert_eq!(summary.ground(Up::Y), -1.0);
        scene.add_sphere(Sphere::new([9.0, -7.0, 0.0], 0.5)).unwrap();
        summary.keep_below(&scene);
        assert_eq!(summary.ground(Up::Y), -7.5);
    }

    #[test]
    fn the_ground_is_at_the_bottom_of_the_static_objects() {
        assert_eq!(SceneSummary::of(&scene(&[])).ground(Up::Y), 0.0);
        assert_eq!(SceneSummary::of(&scene(&[Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])])).ground(Up::Y), -1.0);
        let mut deep = Scene::new();
        deep.add_sphere(Sphere::new([0.0, -7.0, 0.0], 0.5)).unwrap();
        assert_eq!((SceneSummary::of(&deep).ground(Up::Y), SceneSummary::of(&deep).typical_radius), (-7.5, 0.5));
    }

    #[test]
    fn in_a_film_the_ground_is_below_all_places_of_the_bodies() {
        let film = Extent { min: Vec3::splat(-3.0), max: Vec3::ONE };
        let lowered = |boxes: &[Cuboid]| {
            let mut summary = SceneSummary::of(&scene(boxes));
            summary.lower_ground(film);
            summary.ground(Up::Y)
        };
        assert_eq!(lowered(&[]), -3.0);
        assert_eq!(lowered(&[Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])]), -1.0);
    }
}
