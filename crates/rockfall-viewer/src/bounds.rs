//! Bounding boxes of the parts of a scene.

use rockfall::glam::Vec3;
use rockfall::{Scene, Sphere};

use crate::block::Block;
use crate::extent::{Extent, extents_of_static_objects};
use crate::joints::fixed_ends;
use crate::survey::Survey;
use crate::up::Up;

/// Static objects larger than this times the extent of the spheres are surroundings and need not be in the picture. A bin around the
/// spheres is smaller.
const SURROUNDINGS: f32 = 1.5;
/// The same in a film, whose extent contains all that the spheres reach, and for objects on which a sphere lies.
const SURROUNDINGS_OF_FILM: f32 = 0.2;
const CARRIERS_OF_FILM: f32 = 1.5;
/// All static objects but low ones are shown, such as the box that the spheres fall into, if the picture then has to show less than
/// this times the extent of the spheres. In a film, that extent contains all that the spheres reach.
const ROOM_FOR_ALL: f32 = 2.25;
const ROOM_FOR_ALL_OF_FILM: f32 = 1.6;
/// The top of a floor or of its rims is at most this far above the lowest point of the spheres, divided by their extent.
const FLOOR: f32 = 0.1;
/// Objects beside the spheres run out of the picture farther away from the spheres than this, divided by their extent.
const BESIDE: f32 = 0.4;
/// Greatest number of tests whether a sphere lies on an object.
const MOST_TESTS: usize = 2_000_000;
/// Distance that the spheres may fall without leaving the picture, divided by their extent, if the ground is farther below than
/// [`FALL_TO_GROUND`], or if there are many spheres.
const FALL_DISTANCE: f32 = 1.0;
/// Distance up to which the ground below a few spheres is in the picture, divided by their extent, and the number of few spheres.
const FALL_TO_GROUND: f32 = 30.0;
const FEW: usize = 20;
/// Distance below the lowest place of the spheres in a film up to which the ground is shown, divided by their extent.
const GROUND_DISTANCE: f32 = 0.15;

/// Returns the minimum and maximum corners of the part of a scene that a picture should show: the spheres without outliers, the
/// points of the tethers and distance joints, nearby boxes and polygons that are not much larger than the spheres together, and
/// a part of what the spheres may fall onto.
pub fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    bounds_of_survey(&Survey::new(scene), scene)
}

/// Returns what [`bounds`] returns, for all states of a survey of the scene.
pub(crate) fn bounds_of_survey(survey: &Survey, scene: &Scene) -> (Vec3, Vec3) {
    let parts = survey.extent().map(|spheres| {
        let carriers = carriers(survey, spheres, scene).into_iter().filter_map(Extent::of);
        surroundings(spheres, survey, scene).into_iter().chain(carriers).fold(spheres, Extent::with)
    });
    let all = || extents_of_static_objects(scene).reduce(Extent::with);
    let shown = parts.or_else(all).unwrap_or(Extent { min: -Vec3::ONE, max: Vec3::ONE });
    (shown.min, shown.max)
}

/// Returns balls that a picture should show, with centre and radius: those of [`Survey::balls`], the places below them on what
/// they may fall onto, and the corners of nearby objects.
pub(crate) fn balls_to_show(survey: &Survey, scene: &Scene) -> Vec<(Vec3, f32)> {
    let Some(spheres) = survey.extent() else { return Vec::new() };
    let up = survey.up();
    let objects = surroundings(spheres, survey, scene);
    let bottom = objects.iter().map(|object| up.bottom(*object)).fold(up.bottom(spheres), f32::min);
    let mut balls = survey.balls();
    let below: Vec<_> = balls.iter().map(|(place, _)| (*place + (bottom - up.height(*place)) * up.vector(), 0.0)).collect();
    balls.extend(below);
    balls.extend(objects.iter().flat_map(|object| object.corners()).map(|corner| (corner, 0.0)));
    balls.extend(carriers(survey, spheres, scene).into_iter().flatten().map(|corner| (corner, 0.0)));
    balls
}

/// Corners of the objects on which spheres lie in a film, if these are not much larger than all that the spheres reach. A level
/// floor may be cut off, a slope may not.
fn carriers(survey: &Survey, spheres: Extent, scene: &Scene) -> Vec<[Vec3; 8]> {
    if !survey.moves() {
        return Vec::new();
    }
    let up = survey.up();
    let is_under = |extent: Extent| is_under(up.level_extent(extent), up.level_extent(spheres));
    let is_candidate = |extent: Extent| extent.size() < CARRIERS_OF_FILM * spheres.size() && !is_under(extent);
    let extents = extents_of_static_objects(scene);
    let blocks: Vec<Block> =
        Block::all(scene).zip(extents).filter(|(_, extent)| is_candidate(*extent)).map(|(block, _)| block).collect();
    let balls = survey.balls();
    let stride = (blocks.len() * balls.len()).div_ceil(MOST_TESTS) | 1;
    let carries =
        |block: &&Block| balls.iter().step_by(stride).any(|(place, radius)| block.carries(*place, *radius, up.vector()));
    blocks.iter().filter(carries).map(Block::corners).collect()
}

/// Whether an object is not higher than the ground that the spheres reach: a floor, or a low rim of it, which may run out of the
/// picture. Extents are in level coordinates, as in the next function.
fn is_low(object: Extent, spheres: Extent) -> bool {
    object.max.y <= spheres.min.y + FLOOR * spheres.size()
}

/// Whether an object is below all that the spheres reach.
fn is_under(object: Extent, spheres: Extent) -> bool {
    is_low(object, spheres)
        && object.min.x < spheres.max.x
        && object.max.x > spheres.min.x
        && object.min.z < spheres.max.z
        && object.max.z > spheres.min.z
}

/// Extents of what a picture should show in addition to the spheres: the points of tethers and distance joints, nearby objects that are not
/// much larger than the spheres together, and as a vertical line the distance to what the spheres may fall onto. In a film the
/// spheres have already fallen, so that is shown only if it is near.
fn surroundings(spheres: Extent, survey: &Survey, scene: &Scene) -> Vec<Extent> {
    let (up, moves) = (survey.up(), survey.moves());
    let spheres = up.level_extent(spheres);
    let size = spheres.size();
    let beside = spheres.grown(BESIDE * size);
    let (fall, most, room) = match moves {
        true => (GROUND_DISTANCE, SURROUNDINGS_OF_FILM, ROOM_FOR_ALL_OF_FILM),
        false => (FALL_DISTANCE, SURROUNDINGS, ROOM_FOR_ALL),
    };
    let ground = if moves || scene.spheres().len() > FEW { fall } else { FALL_TO_GROUND };
    let extents = || extents_of_static_objects(scene).map(|object| up.level_extent(object));
    let objects = extents().filter_map(|object| {
        if is_under(object, spheres) {
            let middle = 0.5 * (spheres.min + spheres.max);
            let depth = spheres.min.y - object.max.y;
            let shown = if depth <= ground * size { depth } else { depth.min(fall * size) };
            let below = Extent::of([middle.with_y(spheres.min.y - shown), middle]);
            // The top of a floor that is not wider than the way of the spheres.
            let whole = !moves && shown == depth && object.size() < size + depth;
            let top = Extent { min: object.min.with_y(object.max.y), max: object.max };
            return if whole { below.map(|below| below.with(top)) } else { below };
        }
        let near = object.max.cmpge(spheres.min - 0.5 * size).all() && object.min.cmple(spheres.max + 0.5 * size).all();
        (near && object.size() < most * size).then(|| object.within(beside))
    });
    let all = extents().filter(|object| !is_low(*object, spheres)).reduce(Extent::with);
    let all = all.filter(|all| all.with(spheres).size() < room * size).map(|all| all.within(beside));
    let points = scene.tethers().iter().map(|tether| tether.point);
    let points = Extent::of(points.chain(fixed_ends(scene)));
    objects.chain(all).map(|extent| up.scene_extent(extent)).chain(points).collect()
}

/// Extents of the places to which bodies may swing that rods, springs and tethers hold: their places mirrored at the middle of all
/// that holds them, because a cradle swings to both sides, and the lowest point of every pendulum.
pub(crate) fn room_to_swing(scene: &Scene, up: Up) -> impl Iterator<Item = Extent> {
    let sets = scene.bonded_sets(|_| true);
    let spheres = scene.spheres().iter().enumerate().filter(|(body, _)| sets.is_held(*body)).map(|(_, sphere)| sphere);
    let extent = |sphere: &Sphere| Extent::around(sphere.position, sphere.radius);
    let (fixed, bodies): (Vec<&Sphere>, Vec<&Sphere>) = spheres.partition(|sphere| sphere.fixed);
    let points = scene.tethers().iter().map(|tether| Extent::around(tether.point, 0.0));
    let holders = fixed.into_iter().map(extent).chain(points).reduce(Extent::with);
    let bodies = bodies.into_iter().map(extent).reduce(Extent::with);
    let swung = bodies
        .zip(holders)
        .map(|(bodies, holders)| up.scene_extent(mirrored(up.level_extent(bodies), up.level_extent(holders))));
    let lowest = scene.rods().iter().filter_map(move |rod| {
        let [one, two] = [scene.sphere(rod.end1).ok()?, scene.sphere(rod.end2).ok()?];
        let (pivot, bob) = if one.fixed { (one, two) } else { (two, one) };
        let length = pivot.position.distance(bob.position);
        (pivot.fixed && !bob.fixed).then(|| Extent::around(pivot.position - length * up.vector(), bob.radius))
    });
    swung.into_iter().chain(lowest)
}

/// An extent of level coordinates, mirrored at the vertical line through the middle of another one.
fn mirrored(extent: Extent, at: Extent) -> Extent {
    let both = at.min + at.max;
    let [min, max] = [extent.max, extent.min].map(|corner| both - corner);
    Extent { min: min.with_y(extent.min.y), max: max.with_y(extent.max.y) }
}

#[cfg(test)]
pub(crate) mod tests {
    use rockfall::{Cuboid, Rod};

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
    fn the_ground_below_a_few_spheres_is_shown_also_if_it_is_far() {
        let ground = |top: f32| Cuboid::between([-500.0, top - 1.0, -500.0], [500.0, top, 500.0]);
        assert_eq!(bounds(&scene(&[ground(-50.0)])).0.y, -50.0);
        assert_eq!(bounds(&scene(&[ground(-200.0)])).0.y, 1.5 - 3.75);
        // All of a floor that is not too wide is shown.
        let floor = |width: f32| bounds(&scene(&[Cuboid::between([0.0, -9.0, -width], [width, -8.0, 0.0])])).1.x;
        assert_eq!([floor(6.0), floor(20.0)], [6.0, 3.25]);
    }

    #[test]
    fn bounds_include_a_small_box_near_the_spheres_but_no_distant_box() {
        let beside = Cuboid::between([4.0, 1.6, 0.0], [4.5, 3.0, 1.0]);
        assert_eq!(bounds(&scene(&[beside])).1, Vec3::new(4.5, 3.0, 1.0));
        let far = Cuboid::between([40.0, 1.6, 0.0], [40.5, 3.0, 1.0]);
        assert_eq!(bounds(&scene(&[far])).1, Vec3::new(3.25, 2.5, 0.5));
    }

    #[test]
    fn the_box_around_the_spheres_is_shown_near_them_unless_it_is_much_larger() {
        // The spheres extend over 3.75 units.
        for (width, right, right_of_film) in [(4.5, 4.5, 4.5), (7.0, 4.75, 3.25), (12.0, 3.25, 3.25)] {
            let wall = |from: f32, to: f32| Cuboid::between([from, -1.0, -1.0], [to, 4.0, 1.0]);
            let scene = scene(&[wall(-1.0, -0.6), wall(width - 0.4, width)]);
            let mut film = Survey::new(&scene);
            assert_eq!(bounds_of_survey(&film, &scene).1.x, right);
            film.add(&scene);
            assert_eq!(bounds_of_survey(&film, &scene).1.x, right_of_film);
        }
    }

    #[test]
    fn a_floor_with_low_rims_runs_out_of_the_picture() {
        let tray = |top: f32| {
            let floor = Cuboid::between([-1.0, 1.0, -2.0], [4.5, 1.5, 2.0]);
            scene(&[floor, Cuboid::between([4.5, 1.0, -2.0], [4.6, top, 2.0])])
        };
        for (top, right) in [(1.8, 3.25), (2.5, 4.6)] {
            let scene = tray(top);
            let mut film = Survey::new(&scene);
            film.add(&scene);
            assert_eq!(bounds_of_survey(&film, &scene).1.x, right);
        }
    }

    #[test]
    fn in_a_film_only_small_boxes_near_the_spheres_count() {
        let beside = Cuboid::between([4.0, 1.6, 0.0], [4.5, 3.0, 1.0]);
        let small = Cuboid::between([4.0, 1.6, 0.0], [4.5, 2.0, 0.5]);
        let wall = Cuboid::between([-500.0, -1.0, -500.0], [500.0, 30.0, -400.0]);
        for (cuboid, right) in [(beside, 3.25), (small, 4.5)] {
            let scene = scene(&[cuboid, wall]);
            let mut film = Survey::new(&scene);
            film.add(&scene);
            assert_eq!(bounds_of_survey(&film, &scene).1.x, right);
        }
    }

    #[test]
    fn in_a_film_a_slope_on_which_a_sphere_rolls_counts() {
        let along = Vec3::new(4.0, 2.0, 0.0);
        let slope = Cuboid::new([0.0, 0.0, -1.0], along, [-0.05, 0.1, 0.0], [0.0, 0.0, 2.0]);
        let scene = |part: f32| {
            let mut scene = Scene::new();
            let up = Vec3::new(-1.0, 2.0, 0.0).normalize();
            let foot = slope.corner + slope.edges[1] + Vec3::Z;
            scene.add_sphere(Sphere::new(foot + part * along + 0.2 * up, 0.2)).unwrap();
            scene.add_box(slope).unwrap();
            scene
        };
        let mut film = Survey::new(&scene(0.9));
        film.add(&scene(0.2));
        let (min, max) = bounds_of_survey(&film, &scene(0.9));
        assert_eq!((min.z, max.z, max.x), (-1.0, 1.0, 4.0));
    }

    #[test]
    fn a_cradle_has_room_to_swing_to_both_sides() {
        let mut scene = Scene::new();
        for (pivot, ball) in [(0.0, Vec3::new(-3.0, 4.0, 0.0)), (1.0, Vec3::X), (2.0, 2.0 * Vec3::X)] {
            let pivot = scene.add_sphere(Sphere::new([pivot, 4.0, 0.0], 0.1).fixed()).unwrap();
            let ball = scene.add_sphere(Sphere::new(ball, 0.5)).unwrap();
            scene.add_rod(Rod::new(pivot, ball, 0.03)).unwrap();
        }
        let room = room_to_swing(&scene, Up::Y).reduce(Extent::with).unwrap();
        assert!((room.max.x - 5.5).abs() < 1e-5 && (room.min.y + 0.5).abs() < 1e-5, "{room:?}");
        // A pendulum that begins level swings down.
        assert!(room_to_swing(&scene, Up::Y).any(|extent| extent.min.abs_diff_eq(Vec3::new(-0.5, 0.5, -0.5), 1e-5)));
        assert_eq!(room_to_swing(&tests::scene(&[]), Up::Y).count(), 0);
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
