//! Bounding boxes of the parts of a scene.

use rockfall::Scene;
use rockfall::glam::Vec3;

use crate::extent::{Extent, extents_of_static_objects};
use crate::survey::Survey;

/// Static objects larger than this times the extent of the spheres are surroundings and need not be in the picture.
const SURROUNDINGS: f32 = 0.6;
/// The same in a film, whose extent contains all that the spheres reach.
const SURROUNDINGS_OF_FILM: f32 = 0.2;
/// Distance that the spheres may fall without leaving the picture, divided by their extent.
const FALL_DISTANCE: f32 = 1.0;
/// Distance below the lowest place of the spheres in a film up to which the ground is shown, divided by their extent.
const GROUND_DISTANCE: f32 = 0.15;

/// Returns the minimum and maximum corners of the part of a scene that a picture should show: the spheres without outliers, the
/// points of the tethers, nearby boxes and polygons that are not much larger than the spheres together, and a part of what the
/// spheres may fall onto.
pub fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    bounds_of_survey(&Survey::new(scene), scene)
}

/// Returns what [`bounds`] returns, for all states of a survey of the scene.
pub(crate) fn bounds_of_survey(survey: &Survey, scene: &Scene) -> (Vec3, Vec3) {
    let parts = survey.extent().map(|spheres| surroundings(spheres, survey.moves(), scene).fold(spheres, Extent::with));
    let all = || extents_of_static_objects(scene).reduce(Extent::with);
    let shown = parts.or_else(all).unwrap_or(Extent { min: -Vec3::ONE, max: Vec3::ONE });
    (shown.min, shown.max)
}

/// Returns balls that a picture should show, with centre and radius: those of [`Survey::balls`], the places below them on what
/// they may fall onto, and the corners of nearby objects.
pub(crate) fn balls_to_show(survey: &Survey, scene: &Scene) -> Vec<(Vec3, f32)> {
    let Some(spheres) = survey.extent() else { return Vec::new() };
    let objects: Vec<Extent> = surroundings(spheres, survey.moves(), scene).collect();
    let bottom = objects.iter().map(|object| object.min.y).fold(spheres.min.y, f32::min);
    let mut balls = survey.balls();
    let below: Vec<_> = balls.iter().map(|(place, _)| (place.with_y(bottom), 0.0)).collect();
    balls.extend(below);
    balls.extend(objects.iter().flat_map(|object| object.corners()).map(|corner| (corner, 0.0)));
    balls
}

/// Extents of what a picture should show in addition to the spheres: the points of tethers, nearby objects that are not much
/// larger than the spheres together, and as a vertical line the distance to what the spheres may fall onto. In a film the
/// spheres have already fallen, so that is shown only if it is near.
fn surroundings(spheres: Extent, moves: bool, scene: &Scene) -> impl Iterator<Item = Extent> {
    let size = spheres.size();
    let (fall, most) = if moves { (GROUND_DISTANCE, SURROUNDINGS_OF_FILM) } else { (FALL_DISTANCE, SURROUNDINGS) };
    let objects = extents_of_static_objects(scene).filter_map(move |object| {
        let under = object.max.y <= spheres.min.y + 0.1 * size
            && object.min.x < spheres.max.x
            && object.max.x > spheres.min.x
            && object.min.z < spheres.max.z
            && object.max.z > spheres.min.z;
        if under {
            let middle = 0.5 * (spheres.min + spheres.max);
            return Extent::of([middle.with_y(object.max.y.max(spheres.min.y - fall * size)), middle]);
        }
        let near = object.max.cmpge(spheres.min - 0.5 * size).all() && object.min.cmple(spheres.max + 0.5 * size).all();
        (near && object.size() < most * size).then_some(object)
    });
    objects.chain(Extent::of(scene.tethers().iter().map(|tether| tether.point)))
}

#[cfg(test)]
pub(crate) mod tests {
    use rockfall::{Cuboid, Sphere};

    use super::*;

    /// Two spheres and some boxes.
    pub(crate) fn scene(boxes: &[Cuboid]) -> Scene {
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new([0.0, 2.0, 0.0], 0.5)).unwrap();
        scene.add_sphere(Sphere::new([3.0, 2.0, 0.0], 0.25)).unwrap();
        for cuboid in boxes {
            scene.add_box(*cuboid).unwrap();
        }
        scene
    }

    #[test]
    fn bounds_include_the_spheres_and_only_the_height_of_the_floor() {
        let (min, max) = bounds(&scene(&[]));
        assert_eq!((min, max), (Vec3::new(-0.5, 1.5, -0.5), Vec3::new(3.25, 2.5, 0.5)));
        let (min, max) = bounds(&scene(&[Cuboid::between([-500.0, -1.0, -500.0], [500.0, 0.0, 500.0])]));
        assert_eq!((min, max), (Vec3::new(-0.5, 0.0, -0.5), Vec3::new(3.25, 2.5, 0.5)));
    }

    #[test]
    fn bounds_include_a_small_box_near_the_spheres_but_no_distant_box() {
        let beside = Cuboid::between([4.0, 1.6, 0.0], [4.5, 3.0, 1.0]);
        assert_eq!(bounds(&scene(&[beside])).1, Vec3::new(4.5, 3.0, 1.0));
        let far = Cuboid::between([40.0, 1.6, 0.0], [40.5, 3.0, 1.0]);
        assert_eq!(bounds(&scene(&[far])).1, Vec3::new(3.25, 2.5, 0.5));
    }

    #[test]
    fn in_a_film_only_small_boxes_near_the_spheres_count() {
        let beside = Cuboid::between([4.0, 1.6, 0.0], [4.5, 3.0, 1.0]);
        let small = Cuboid::between([4.0, 1.6, 0.0], [4.5, 2.0, 0.5]);
        for (cuboid, right) in [(beside, 3.25), (small, 4.5)] {
            let scene = scene(&[cuboid]);
            let mut film = Survey::new(&scene);
            film.add(&scene);
            assert_eq!(bounds_of_survey(&film, &scene).1.x, right);
        }
    }

    #[test]
    fn bounds_exclude_outliers() {
        let mut scene = Scene::new();
        for k in 0..100 {
            scene.add_sphere(Sphere::new([k as f32 % 10.0, (k / 10) as f32, 0.0], 0.5)).unwrap();
        }
        let all = bounds(&scene);
        assert_eq!(all, (Vec3::splat(-0.5), Vec3::new(9.5, 9.5, 0.5)));
        for (place, velocity) in [([4.0, -300.0, 0.0], [0.0, -70.0, 0.0]), ([90.0, 4.0, 0.0], [8.0, 0.0, 0.0])] {
            let mut sphere = Sphere::new(place, 0.5);
            sphere.velocity = velocity.into();
            scene.add_sphere(sphere).unwrap();
        }
        assert_eq!(bounds(&scene), all);
    }
}
