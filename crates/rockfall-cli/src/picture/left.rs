//! Finds bodies that fell or flew away from all others. They would make the others too small to see.

use rockfall::glam::Vec3;
use rockfall::{Scene, Sphere};

use crate::options::counted;

/// Distance of bodies from the others, divided by the extent of the others, from which on they have left.
const FAR: f32 = 10.0;
/// The same for a single other body, whose extent is its diameter.
const FAR_FROM_ONE: f32 = 100.0;
/// The same for bodies below everything that could stop them.
const FALLEN: f32 = 1.0;

/// The bodies that left the others: at most half of all.
pub(crate) struct Left {
    /// For every sphere, whether it left. Empty if none did.
    left: Vec<bool>,
    count: usize,
    /// Distance of the nearest one from the box around the others, in units.
    distance: f32,
}

impl Left {
    pub(crate) fn of(scene: &Scene) -> Self {
        let spheres = scene.spheres();
        let mut kept: Vec<usize> = (0..spheres.len()).filter(|index| spheres[*index].position.is_finite()).collect();
        let finite = kept.len();
        let least = finite.div_ceil(2);
        fallen(scene, &mut kept, least);
        // A body that is cut off along one axis may have hidden one that is cut off along another axis.
        while (0..3).any(|axis| cut(spheres, &mut kept, axis, least)) {}
        let count = finite - kept.len();
        if count == 0 {
            return Self { left: Vec::new(), count, distance: 0.0 };
        }
        let mut left: Vec<bool> = spheres.iter().map(|sphere| sphere.position.is_finite()).collect();
        kept.iter().for_each(|index| left[*index] = false);
        let (low, high) = bounds(spheres, &kept);
        let away = spheres.iter().zip(&left).filter(|(_, left)| **left).map(|(sphere, _)| sphere.position);
        let distance = away.map(|place| place.distance(place.clamp(low, high))).fold(f32::INFINITY, f32::min);
        Self { left, count, distance }
    }

    /// The spheres that did not leave.
    pub(crate) fn others<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = &'a Sphere> {
        let left = |index: usize| self.left.get(index).copied().unwrap_or(false);
        scene.spheres().iter().enumerate().filter(move |(index, _)| !left(*index)).map(|(_, sphere)| sphere)
    }

    /// A line for the summary; `None` if no body left.
    pub(crate) fn describe(&self) -> Option<String> {
        // Whole units, rounded down, unless the scene is small.
        let distance = if self.distance >= 10.0 { self.distance.floor() } else { self.distance };
        let bodies = counted(self.count, "body is", "bodies are");
        (self.count > 0).then(|| format!("{bodies} at least {distance} units away from all others and not in the picture"))
    }
}

/// Bounds of some spheres.
fn bounds(spheres: &[Sphere], which: &[usize]) -> (Vec3, Vec3) {
    which.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), index| {
        let Sphere { position, radius, .. } = spheres[*index];
        (low.min(position - radius), high.max(position + radius))
    })
}

/// Leaves out bodies below all boxes, polygons and fixed spheres, if they are far below the others.
fn fallen(scene: &Scene, kept: &mut Vec<usize>, least: usize) {
    let settings = &scene.settings;
    let down = settings.gravity_direction * settings.gravity.signum();
    let corners = scene.boxes().iter().flat_map(|cuboid| {
        let [i, j, k] = cuboid.edges;
        (0..8_u32).map(move |bits| {
            let part = |bit: u32, edge: Vec3| if bits >> bit & 1 == 1 { edge } else { Vec3::ZERO };
            cuboid.corner + part(0, i) + part(1, j) + part(2, k)
        })
    });
    let edges = scene.polygons().iter().flat_map(|polygon| {
        let sides = [Vec3::ZERO, polygon.left, polygon.right, polygon.left + polygon.right];
        sides.map(|side| polygon.corner + side)
    });
    let Some(lowest) = corners.chain(edges).map(|point| point.dot(down)).reduce(f32::max) else { return };
    let spheres = scene.spheres();
    let above: Vec<usize> = kept.iter().copied().filter(|index| spheres[*index].position.dot(down) <= lowest).collect();
    if settings.gravity == 0.0 || above.len() < least.max(1) {
        return;
    }
    let (low, high) = bounds(spheres, &above);
    let far = lowest + FALLEN * (high - low).max_element();
    kept.retain(|index| spheres[*index].position.dot(down) <= far);
}

/// Leaves out the bodies at one end of an axis, if they are far from the others. Returns whether it left out any.
fn cut(spheres: &[Sphere], kept: &mut Vec<usize>, axis: usize, least: usize) -> bool {
    let place = |index: &usize| spheres[*index].position[axis];
    kept.sort_unstable_by(|a, b| place(a).total_cmp(&place(b)));
    for _ in 0..2 {
        kept.reverse();
        // `end` bodies stay. The first gap from the inside that is wide enough counts.
        for end in least.max(1)..kept.len() {
            let gap = (place(&kept[end]) - place(&kept[end - 1])).abs();
            let span = (place(&kept[end - 1]) - place(&kept[0])).abs();
            if gap <= FAR * span {
                continue;
            }
            let (low, high) = bounds(spheres, &kept[..end]);
            let far = if end == 1 { FAR_FROM_ONE } else { FAR };
            if gap > far * (high - low).max_element() {
                kept.truncate(end);
                return true;
            }
        }
    }
    false
}
