//! Bounding boxes of the parts of a scene.

use rockfall::glam::Vec3;
use rockfall::{Scene, Sphere};

/// Static objects larger than this times the extent of the spheres are surroundings and need not be in the picture.
const SURROUNDINGS: f32 = 0.6;
/// Spheres farther from the majority than this times its extent are outliers.
const OUTLIER_DISTANCE: f32 = 0.6;
/// Distance that the spheres may fall without leaving the picture, divided by their extent.
const FALL_DISTANCE: f32 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq)]
/// An axis-aligned bounding box.
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

pub(crate) fn extent_of_spheres(scene: &Scene) -> Option<Extent> {
    extent(scene.spheres().iter())
}

fn extent<'a>(spheres: impl Iterator<Item = &'a Sphere>) -> Option<Extent> {
    spheres
        .map(|sphere| Extent { min: sphere.position - sphere.radius, max: sphere.position + sphere.radius })
        .reduce(Extent::with)
}

/// Returns the extent of the spheres without outliers. The majority is what lies between the 5 % and the 95 % quantile of each
/// coordinate. An outlier is farther away from it than [`OUTLIER_DISTANCE`] times its size, or is below every static object.
fn extent_without_outliers(scene: &Scene) -> Option<Extent> {
    let spheres = scene.spheres();
    let few = spheres.len() / 20;
    if few == 0 {
        return extent_of_spheres(scene);
    }
    let mut quantiles = [Vec3::ZERO; 2];
    for axis in 0..3 {
        let mut places: Vec<f32> = spheres.iter().map(|sphere| sphere.position[axis]).collect();
        for (quantile, at) in quantiles.iter_mut().zip([few, spheres.len() - 1 - few]) {
            quantile[axis] = *places.select_nth_unstable_by(at, f32::total_cmp).1;
        }
    }
    let [low, high] = quantiles;
    let room = Vec3::splat((high - low).max_element()) * OUTLIER_DISTANCE;
    let lowest = extents_of_static_objects(scene).map(|object| object.min.y).reduce(f32::min).unwrap_or(f32::NEG_INFINITY);
    let near = |sphere: &&Sphere| {
        let place = sphere.position;
        place.cmpge(low - room).all() && place.cmple(high + room).all() && place.y >= lowest
    };
    extent(spheres.iter().filter(near)).or_else(|| extent_of_spheres(scene))
}

/// Extents of the boxes and polygons.
pub(crate) fn extents_of_static_objects(scene: &Scene) -> impl Iterator<Item = Extent> {
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

/// Returns the minimum and maximum corners of the part of a scene that a picture should show: the spheres without outliers, the
/// points of the tethers, nearby boxes and polygons that are not much larger than the spheres together, and a part of what the
/// spheres may fall onto.
pub fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let Some(spheres) = extent_without_outliers(scene) else {
        let all = extents_of_static_objects(scene).reduce(Extent::with).unwrap_or(Extent { min: -Vec3::ONE, max: Vec3::ONE });
        return (all.min, all.max);
    };
    let mut shown = spheres;
    let tethers = scene.tethers().iter().map(|tether| tether.point);
    shown = Extent::of(tethers).map_or(shown, |tethers| shown.with(tethers));
    let size = spheres.size();
    for object in extents_of_static_objects(scene) {
        let under = object.max.y <= spheres.min.y + 0.1 * size
            && object.min.x < spheres.max.x
            && object.max.x > spheres.min.x
            && object.min.z < spheres.max.z
            && object.max.z > spheres.min.z;
        if under {
            shown.min.y = shown.min.y.min(object.max.y.max(spheres.min.y - FALL_DISTANCE * size));
        } else if object.size() < SURROUNDINGS * size {
            let near = object.max.cmpge(spheres.min - 0.5 * size).all() && object.min.cmple(spheres.max + 0.5 * size).all();
            shown = if near { shown.with(object) } else { shown };
        }
    }
    (shown.min, shown.max)
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
    fn bounds_exclude_outliers() {
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
