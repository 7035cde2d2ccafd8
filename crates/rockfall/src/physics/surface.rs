//! Which of the boxes and polygons that a sphere overlaps touch it (docs/physics.md section 2.11).

use std::cmp::Ordering;

use glam::Vec3;

use crate::model::lists::{Entry, Lists};
use crate::model::view::{Object, View};
use crate::physics::touch::touch;

/// A candidate counts as hidden if its nearest point is less than this times the radius in front of a tangent plane.
const SLACK: f32 = 1e-5;
/// The cosine of 0.01 rad. Normals that differ by less are one.
const ONE_NORMAL: f32 = 0.999_95;

/// A box or polygon that a sphere overlaps.
struct Candidate {
    id: u32,
    /// Shapes of different bodies do not hide each other.
    body: u32,
    /// Distance of the nearest point from the centre of the sphere; negative if the centre is inside a box.
    distance: f32,
    /// Unit vector from the centre to the nearest point, if the distance is positive.
    normal: Vec3,
}

impl Candidate {
    /// Whether a nearer candidate hides this one. A box that contains the centre hides only what is wholly behind its face.
    fn is_behind(&self, view: &View, sphere: u32, nearer: &Self) -> bool {
        let cosine = self.normal.dot(nearer.normal);
        let front = if nearer.distance < 0.0 {
            let (_, [corner, edges @ ..]) = geometry(view, self.id);
            let along = |vector: Vec3| vector.dot(nearer.normal);
            along(corner - view.position(sphere)) + edges.map(|edge| along(edge).min(0.0)).iter().sum::<f32>()
        } else {
            self.distance * cosine
        };
        front >= nearer.distance - SLACK * view.radius(sphere) || cosine >= ONE_NORMAL
    }
}

/// Whether an object is a polygon, and the corner and the edges of a box or polygon.
fn geometry(view: &View, id: u32) -> (bool, [Vec3; 4]) {
    match view.object(id) {
        Object::Cuboid(cuboid) => {
            let record = view.cuboid(cuboid);
            (false, [record.corner, record.edges[0], record.edges[1], record.edges[2]])
        }
        Object::Polygon(polygon) => {
            let record = view.polygon(polygon);
            (true, [record.corner, record.left, record.right, Vec3::ZERO])
        }
        Object::Sphere(_) | Object::Rod(_) => (true, [Vec3::ZERO; 4]),
    }
}

/// The order of two candidates. It depends on their geometry alone, unless they are identical.
fn order(view: &View, one: &Candidate, other: &Candidate) -> Ordering {
    let numbers = |id| {
        let (is_polygon, vectors) = geometry(view, id);
        (is_polygon, vectors.map(|vector| vector.to_array()))
    };
    let by_distance = one.distance.partial_cmp(&other.distance).unwrap_or(Ordering::Equal);
    by_distance.then_with(|| numbers(one.id).partial_cmp(&numbers(other.id)).unwrap_or(Ordering::Equal))
}

/// The boxes and polygons that a sphere overlaps but does not touch, because a nearer one hides them. In most cases there are none.
pub(crate) struct Hidden(Vec<u32>);

impl Hidden {
    /// The hidden objects in the list of a mover, of which `list` returns the `count` entries. Rods have none.
    pub(crate) fn of(view: &View, mover: u32, count: u32, list: impl Fn(u32) -> Entry) -> Self {
        let mut hidden = Self(Vec::new());
        let Object::Sphere(sphere) = view.object(mover) else {
            return hidden;
        };
        // Boxes and polygons are the last entries of a list.
        let is_static = |place: &u32| list(*place).id() >= view.step.movers();
        let first = (0..count).rev().take_while(is_static).last().unwrap_or(count);
        if count - first < 2 {
            return hidden;
        }
        let radius = view.radius(sphere);
        let candidate = |id| {
            let touch = touch(view, sphere, id, 0)?;
            Some(Candidate { id, body: view.body(view.object(id)), distance: radius - touch.overlap, normal: touch.normal })
        };
        let mut candidates: Vec<Candidate> = (first..count).filter_map(|place| candidate(list(place).id())).collect();
        if candidates.len() < 2 {
            return hidden;
        }
        candidates.sort_by(|one, other| order(view, one, other));
        let mut kept: Vec<Candidate> = Vec::new();
        for candidate in candidates {
            if kept.iter().any(|nearer| nearer.body == candidate.body && candidate.is_behind(view, sphere, nearer)) {
                hidden.0.push(candidate.id);
            } else {
                kept.push(candidate);
            }
        }
        hidden
    }

    /// Whether an object is hidden.
    pub(crate) fn has(&self, id: u32) -> bool {
        self.0.contains(&id)
    }
}

/// The list of a mover without hidden objects.
pub(crate) fn visible_row<'a>(view: &View, lists: &Lists<'a>, mover: u32) -> impl Iterator<Item = Entry> + use<'a> {
    let (count, list) = lists.list(mover);
    let hidden = Hidden::of(view, mover, count, &list);
    (0..count).map(list).filter(move |entry| !hidden.has(entry.id()))
}
