//! Finds bodies that will fall for ever.

use glam::{DVec3, Vec3};

use crate::model::layout::UNBOUNDED;
use crate::scene::{Scene, SphereId};
use crate::stability::connected::{Bounds, NOTHING, Set, directions, sets, turned};

/// Largest number of comparisons. Beyond it, what can catch bodies counts as one large body, so fewer falling bodies are found.
const COMPARISONS: usize = 50_000_000;

impl Scene {
    /// One sphere of every set of connected bodies that will fall for ever.
    ///
    /// Bodies are connected by rods, springs, tethers and joints. A set of them falls for ever if nothing holds it and nothing is below
    /// it: no box, polygon, fixed sphere, held body or other body that does not fall for ever. What is below it is judged by
    /// bounding boxes along gravity, and for the whole direction in which it moves. So some bodies that fall for ever are not
    /// found, for example those that fall through a gap. Without gravity nothing falls.
    pub fn falling(&self) -> Vec<SphereId> {
        directions(self).map_or_else(Vec::new, |directions| falling(self, directions))
    }
}

fn falling(scene: &Scene, directions: [DVec3; 3]) -> Vec<SphereId> {
    let sets = sets(scene, directions);
    let mut catchers = statics(scene, directions);
    catchers.extend(sets.iter().filter(|set| set.held).map(|set| set.own));
    let mut candidates: Vec<Set> = sets.into_iter().filter(|set| !set.held).collect();
    // A body above another one that is caught may be caught by it.
    loop {
        let few = catchers.len().saturating_mul(candidates.len()) <= COMPARISONS;
        if !few {
            catchers = vec![catchers.iter().fold(NOTHING, |all, one| all.join(one))];
        }
        let caught = |set: &Set| catchers.iter().any(|catcher| set.path.meets(catcher));
        let (newly, left): (Vec<Set>, Vec<Set>) = candidates.into_iter().partition(caught);
        candidates = left;
        if newly.is_empty() || candidates.is_empty() {
            return candidates.iter().map(|set| set.first).collect();
        }
        // Only what was caught now can catch more in the next round.
        catchers = newly.iter().map(|set| set.own).collect();
    }
}

fn statics(scene: &Scene, directions: [DVec3; 3]) -> Vec<Bounds> {
    let hull = |corner: DVec3, edges: &[DVec3]| {
        let mut bounds = NOTHING;
        for chosen in 0..1_u32 << edges.len() {
            let edges = edges.iter().enumerate().filter(|(bit, _)| chosen >> bit & 1 == 1);
            bounds.add(turned(directions, corner + edges.map(|(_, edge)| *edge).sum::<DVec3>()), 0.0);
        }
        bounds
    };
    let boxes = scene.boxes().iter().map(|cuboid| hull(cuboid.corner.as_dvec3(), &cuboid.edges.map(|edge| edge.as_dvec3())));
    let polygons = scene.polygons().iter().map(|polygon| match (polygon.surface.is_smooth(), polygon.bounds()) {
        (false, _) => hull(polygon.corner.as_dvec3(), &[polygon.left, polygon.right].map(|edge| edge.as_dvec3())),
        (true, bounds) => {
            // A plane has no ends.
            let (min, max) = bounds.unwrap_or((Vec3::splat(-UNBOUNDED), Vec3::splat(UNBOUNDED)));
            let size = (max - min).as_dvec3();
            hull(min.as_dvec3(), &[DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z])
        }
    });
    boxes.chain(polygons).collect()
}
