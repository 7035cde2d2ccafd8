//! What of a scene decides how it is shown: where it is, where the ground lies, how large bodies are.

use rockfall::glam::Vec3;
use rockfall::{Scene, Sphere};

/// Static objects larger than this times the spheres' extent are what things stand on, not part of what is looked at.
const SURROUNDINGS: f32 = 0.6;
/// Spheres farther from most others than this times the extent of those have got away.
const NEAR_MOST: f32 = 0.6;
/// A body may fall this times the spheres' extent and stay in the picture.
const FALL: f32 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl Extent {
    fn of(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        points.into_iter().map(|point| Self { min: point, max: point }).reduce(Self::with)
    }

    pub(crate) fn with(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub(crate) fn size(self) -> f32 {
        (self.max - self.min).max_element()
    }
}

pub(crate) fn of_spheres(scene: &Scene) -> Option<Extent> {
    extent(scene.spheres().iter())
}

fn extent<'a>(spheres: impl Iterator<Item = &'a Sphere>) -> Option<Extent> {
    spheres
        .map(|sphere| Extent { min: sphere.position - sphere.radius, max: sphere.position + sphere.radius })
        .reduce(Extent::with)
}

/// The extent of the spheres but for a few that have got away: what is nearer to the middle nine tenths than these are large
/// counts, unless it fell below all that is static.
fn of_most_spheres(scene: &Scene) -> Option<Extent> {
    let spheres = scene.spheres();
    let few = spheres.len() / 20;
    if few == 0 {
        return of_spheres(scene);
    }
    let mut quantiles = [Vec3::ZERO; 2];
    for axis in 0..3 {
        let mut places: Vec<f32> = spheres.iter().map(|sphere| sphere.position[axis]).collect();
        for (quantile, at) in quantiles.iter_mut().zip([few, spheres.len() - 1 - few]) {
            quantile[axis] = *places.select_nth_unstable_by(at, f32::total_cmp).1;
        }
    }
    let [low, high] = quantiles;
    let room = Vec3::splat((high - low).max_element()) * NEAR_MOST;
    let lowest = of_static(scene).map(|object| object.min.y).reduce(f32::min).unwrap_or(f32::NEG_INFINITY);
    let near = |sphere: &&Sphere| {
        let place = sphere.position;
        place.cmpge(low - room).all() && place.cmple(high + room).all() && place.y >= lowest
    };
    extent(spheres.iter().filter(near)).or_else(|| of_spheres(scene))
}

/// The extents of boxes and polygons.
pub(crate) fn of_static(scene: &Scene) -> impl Iterator<Item = Extent> {
    let boxes = scene.boxes().iter().filter_map(|cuboid| {
        let [i, j, k] = cuboid.edges;
        let corner = |bits: u32| {
            let part = |bit: u32, edge: Vec3| if bits >> bit & 1 == 1 { edge } else { Vec3::ZERO };
            cuboid.corner + part(0, i) + part(1, j) + part(2, k)
        };
        Extent::of((0..8).map(corner))
    });
    let polygons = scene.polygons().iter().filter_map(|polygon| {
        let (corner, left, right) = (polygon.corner, polygon.left, polygon.right);
        Extent::of([corner, corner + left, corner + right, corner + left + right])
    });
    boxes.chain(polygons)
}

/// Least and greatest corner of what should be in a picture of a scene: its spheres but for a few that have got away, what of boxes and polygons is not much
/// larger than they are together, and a part of what they may fall on.
pub fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let Some(spheres) = of_most_spheres(scene) else {
        let all = of_static(scene).reduce(Extent::with).unwrap_or(Extent { min: -Vec3::ONE, max: Vec3::ONE });
        return (all.min, all.max);
    };
    let mut shown = spheres;
    let tethers = scene.tethers().iter().map(|tether| tether.point);
    shown = Extent::of(tethers).map_or(shown, |tethers| shown.with(tethers));
    let size = spheres.size();
    for object in of_static(scene) {
        let under = object.max.y <= spheres.min.y + 0.1 * size
            && object.min.x < spheres.max.x
            && object.max.x > spheres.min.x
            && object.min.z < spheres.max.z
            && object.max.z > spheres.min.z;
        if under {
            shown.min.y = shown.min.y.min(object.max.y.max(spheres.min.y - FALL * size));
        } else if object.size() < SURROUNDINGS * size {
            let near = object.max.cmpge(spheres.min - 0.5 * size).all() && object.min.cmple(spheres.max + 0.5 * size).all();
            shown = if near { shown.with(object) } else { shown };
        }
    }
    (shown.min, shown.max)
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
    fn spheres_are_in_the_picture_and_the_floor_below_them_only_in_height() {
        let (min, max) = bounds(&scene(&[]));
        assert_eq!((min, max), (Vec3::new(-0.5, 1.5, -0.5), Vec3::new(3.25, 2.5, 0.5)));
        let (min, max) = bounds(&scene(&[Cuboid::between([-500.0, -1.0, -500.0], [500.0, 0.0, 500.0])]));
        assert_eq!((min, max), (Vec3::new(-0.5, 0.0, -0.5), Vec3::new(3.25, 2.5, 0.5)));
    }

    #[test]
    fn a_small_box_beside_the_spheres_is_in_the_picture_and_a_far_one_is_not() {
        let beside = Cuboid::between([4.0, 1.6, 0.0], [4.5, 3.0, 1.0]);
        assert_eq!(bounds(&scene(&[beside])).1, Vec3::new(4.5, 3.0, 1.0));
        let far = Cuboid::between([40.0, 1.6, 0.0], [40.5, 3.0, 1.0]);
        assert_eq!(bounds(&scene(&[far])).1, Vec3::new(3.25, 2.5, 0.5));
    }

    #[test]
    fn a_few_that_got_away_are_left_out() {
        let mut scene = Scene::new();
        for k in 0..100 {
            scene.add_sphere(Sphere::new([k as f32 % 10.0, (k / 10) as f32, 0.0], 0.5)).unwrap();
        }
        let all = bounds(&scene);
        assert_eq!(all, (Vec3::splat(-0.5), Vec3::new(9.5, 9.5, 0.5)));
        scene.add_sphere(Sphere::new([4.0, -300.0, 0.0], 0.5)).unwrap();
        scene.add_sphere(Sphere::new([90.0, 4.0, 0.0], 0.5)).unwrap();
        assert_eq!(bounds(&scene), all);
    }
}
