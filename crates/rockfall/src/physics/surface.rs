//! Which of the boxes and polygons that a sphere or a rod overlaps touch it (docs/physics section 2.11).

use std::cmp::Ordering;

use glam::Vec3;

use crate::fine::Fine;
use crate::model::lists::{Entry, Lists};
use crate::model::view::{BoxRecord, Object, RodRecord, View};
use crate::physics::chain::touch;
use crate::physics::geometry::{box_contains, box_parameters};
use crate::physics::rod_polygon::Edges;
use crate::physics::smooth;
use crate::physics::touch::{Feature, Motions, Touch, box_from, ends, is_over_face, line, origin_of};

/// A candidate counts as hidden if its nearest point is less than this times the radius in front of a tangent plane.
const SLACK: f32 = 1e-5;
/// Part of the distance by which an edge comes later than a face.
const EDGE: f32 = 2e-6;
/// The cosine of 0.01 rad. Normals that differ by less are one. Those of two triangles may differ by more.
const ONE_NORMAL: f32 = 0.999_95;

/// Distance, as a part of the radius of a rod, at which another box is looked for beside an edge.
const BESIDE: f32 = 1e-3;

/// A box or polygon that a sphere overlaps.
struct Candidate {
    id: u32,
    /// Distance of the nearest point from the centre of the sphere; negative if the centre is inside a box.
    distance: f32,
    /// Unit vector from the centre to the nearest point, if the distance is positive.
    normal: Vec3,
}

impl Candidate {
    fn of(view: &View, sphere: u32, id: u32, touch: &Touch) -> Self {
        Self { id, distance: view.radius(sphere) - touch.overlap, normal: touch.normal }
    }

    /// The distance by which candidates are ordered: a face comes before an edge. The sphere is where it is in the view.
    fn rank(&self, view: &View, sphere: u32) -> f32 {
        let is_face = self.distance < 0.0 || is_over_face(view, Object::Sphere(sphere), view.object(self.id));
        if is_face { self.distance } else { self.distance + EDGE * self.distance }
    }

    /// Whether a nearer candidate hides this one. A box that contains the centre hides only what is wholly behind its face.
    /// `centre` and `radius` are those of the sphere.
    fn is_behind(&self, view: &View, (centre, radius): (Vec3, f32), nearer: &Self) -> bool {
        let [own_body, their_body] = [self.id, nearer.id].map(|id| view.body(view.object(id)));
        if own_body != their_body {
            return false;
        }
        let cosine = self.normal.dot(nearer.normal);
        let front = if nearer.distance < 0.0 {
            let centre = view.near_shape(view.object(self.id), Fine { high: centre, low: Vec3::ZERO }).high;
            front(view, self.id, centre, nearer.normal)
        } else {
            self.distance * cosine
        };
        let are_triangles = [self.id, nearer.id].iter().all(|id| is_triangle(view, *id));
        let one_normal = if are_triangles { view.step.constants.mesh_cosine } else { ONE_NORMAL };
        front >= nearer.distance - SLACK * radius || cosine >= one_normal
    }
}

/// The least product of a unit vector with the vector from a place to a point of a box or polygon.
fn front(view: &View, id: u32, place: Vec3, n: Vec3) -> f32 {
    if let Object::Polygon(polygon) = view.object(id) {
        let record = view.polygon(polygon);
        if record.surface.is_smooth() {
            return smooth::front(&record, place, n, ONE_NORMAL);
        }
    }
    let (_, [corner, edges @ ..]) = geometry(view, id);
    let low = edges.map(|edge| edge.dot(n).min(0.0));
    (corner - place).dot(n) + if is_triangle(view, id) { low[0].min(low[1]) } else { low.iter().sum() }
}

fn is_triangle(view: &View, id: u32) -> bool {
    matches!(view.object(id), Object::Polygon(polygon) if view.polygon(polygon).is_triangle())
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
fn order(view: &View, (one_rank, one): &(f32, Candidate), (other_rank, other): &(f32, Candidate)) -> Ordering {
    let numbers = |id| {
        let (is_polygon, vectors) = geometry(view, id);
        (is_polygon, vectors.map(|vector| vector.to_array()))
    };
    let by_rank = one_rank.partial_cmp(other_rank).unwrap_or(Ordering::Equal);
    by_rank.then_with(|| numbers(one.id).partial_cmp(&numbers(other.id)).unwrap_or(Ordering::Equal))
}

/// The boxes and polygons that a sphere overlaps but does not touch, because a nearer one hides them, and the edges of boxes that are no
/// edges of the surface, for a rod: ids and features. In most cases there are none.
pub(crate) struct Hidden(Vec<(u32, u32)>);

impl Hidden {
    /// The hidden objects in the list of a mover, of which `list` returns the `count` entries.
    pub(crate) fn of(view: &View, mover: u32, count: u32, list: impl Fn(u32) -> Entry) -> Self {
        // Boxes and polygons are the last entries of a list.
        let is_static = |place: &u32| list(*place).id() >= view.step.movers();
        let first = (0..count).rev().take_while(is_static).last().unwrap_or(count);
        // Of one box or polygon, only edges of a polygon hide each other.
        if count - first < 2 || (list(first).id() == list(count - 1).id() && !is_polygon(view, &list(first))) {
            return Self(Vec::new());
        }
        let statics = (first..count).map(list);
        match view.object(mover) {
            Object::Sphere(_) => Self::from_sphere(view, mover, statics),
            Object::Rod(rod) => Self::from_rod(view, rod, statics),
            Object::Cuboid(_) | Object::Polygon(_) => Self(Vec::new()),
        }
    }

    /// The hidden ones of boxes and polygons near a sphere.
    fn from_sphere(view: &View, sphere: u32, statics: impl Iterator<Item = Entry>) -> Self {
        let mut hidden = Self(Vec::new());
        let candidate = |id| Some(Candidate::of(view, sphere, id, &touch(view, sphere, id, 0)?));
        let candidates: Vec<Candidate> = statics.filter_map(|entry| candidate(entry.id())).collect();
        if candidates.len() < 2 {
            return hidden;
        }
        let ranked = candidates.into_iter().map(|candidate| (candidate.rank(view, sphere), candidate));
        let mut candidates: Vec<(f32, Candidate)> = ranked.collect();
        candidates.sort_by(|one, other| order(view, one, other));
        let ball = (view.position(sphere), view.radius(sphere));
        let mut kept: Vec<Candidate> = Vec::new();
        for (_, candidate) in candidates {
            if kept.iter().any(|nearer| candidate.is_behind(view, ball, nearer)) {
                hidden.0.push((candidate.id, 0));
            } else {
                kept.push(candidate);
            }
        }
        hidden
    }

    /// The edges and vertices of boxes that a rod touches where another box continues a face, and those of polygons that are no edges of the
    /// surface.
    fn from_rod(view: &View, rod: u32, statics: impl Iterator<Item = Entry>) -> Self {
        let id = view.step.layout.spheres + rod;
        let (polygons, statics): (Vec<Entry>, Vec<Entry>) = statics.partition(|entry| is_polygon(view, entry));
        let edges = Edges::of(view, view.rod(rod), &polygons);
        let hidden_edges = polygons.iter().filter(|entry| edges.hides(entry.id(), entry.feature()));
        let origin = origin_of(view, view.rod(rod));
        let cuboid = |entry: &Entry| box_from(view, &view.cuboid(entry.id() - view.step.movers()), origin);
        let continues = |entry: &Entry, points: &[Vec3]| {
            let body = |entry: &Entry| view.body(view.object(entry.id()));
            let is_other = |other: &&Entry| other.id() != entry.id() && other.feature() == 0 && body(other) == body(entry);
            let others = statics.iter().filter(is_other).map(cuboid);
            others.into_iter().any(|other| points.iter().any(|point| box_contains(&other, *point, 0.0)))
        };
        let is_hidden = |entry: &&Entry| {
            touch(view, id, entry.id(), entry.feature()).is_some_and(|touch| {
                let is_edge = matches!(part_of_box(view, id, entry), Some(Feature::Edge(_)));
                let along = is_edge.then_some(entry.feature() / 4);
                continues(entry, &points_outside(view, view.rod(rod), &cuboid(entry), &touch, along))
            })
        };
        let hidden = statics.iter().filter(is_hidden).chain(hidden_edges);
        Self(hidden.map(|entry| (entry.id(), entry.feature())).collect())
    }

    /// Whether the object of an entry is hidden.
    pub(crate) fn has(&self, entry: &Entry) -> bool {
        self.0.contains(&(entry.id(), entry.feature()))
    }
}

/// Whether the contact of a sphere with a box or polygon hides another one, which the sphere overlaps.
pub(crate) fn hides(view: &View, sphere: u32, (id, nearer): (u32, &Touch), other: u32) -> bool {
    let nearer = Candidate::of(view, sphere, id, nearer);
    let ball = (view.position(sphere), view.radius(sphere));
    touch(view, sphere, other, 0).is_some_and(|found| Candidate::of(view, sphere, other, &found).is_behind(view, ball, &nearer))
}

/// Whether a box or polygon hides another one from a sphere at an earlier time. `found` is the contact of the sphere with the other one.
pub(crate) fn hid(view: &View, at: &impl Motions, sphere: u32, id: u32, (other, found): (u32, &Touch)) -> bool {
    let own = Candidate::of(view, sphere, other, found);
    let touch = line(view, at, Object::Sphere(sphere), view.object(id), None).filter(|touch| touch.overlap > 0.0);
    touch.map(|touch| Candidate::of(view, sphere, id, &touch)).is_some_and(|nearer| {
        nearer.distance < own.distance && own.is_behind(view, (at.position(sphere), view.radius(sphere)), &nearer)
    })
}

fn is_polygon(view: &View, entry: &Entry) -> bool {
    matches!(view.object(entry.id()), Object::Polygon(_))
}

fn part_of_box(view: &View, rod: u32, entry: &Entry) -> Option<Feature> {
    Feature::of(view, view.object(rod), view.object(entry.id()), entry.feature())
}

/// Points near the place where a rod touches a box, outside of the box, in every direction in which another box may continue one of its
/// faces. `along` is the axis of the edge, and `None` at a vertex.
fn points_outside(view: &View, rod: RodRecord, cuboid: &BoxRecord, touch: &Touch, along: Option<u32>) -> Vec<Vec3> {
    let [one, two] = ends(view, rod, origin_of(view, rod));
    let place = one + touch.a * (two - one) + (rod.radius - touch.overlap) * touch.normal;
    let t = box_parameters(cuboid, place).to_array();
    let step = |axis: usize| {
        let outward = if t[axis] < 0.5 { -1.0 } else { 1.0 };
        BESIDE * rod.radius * outward * cuboid.edges[axis].normalize()
    };
    let axes: Vec<usize> = (0..3).filter(|axis| along != Some(*axis as u32)).collect();
    let point = |signs: u32| {
        let way = (0..).zip(&axes).map(|(bit, axis)| if signs >> bit & 1 == 1 { step(*axis) } else { -step(*axis) });
        place + way.sum::<Vec3>()
    };
    (1..1 << axes.len()).map(point).collect()
}

/// The list of a mover without hidden objects.
pub(crate) fn visible_row<'a>(view: &View, lists: &Lists<'a>, mover: u32) -> impl Iterator<Item = Entry> + use<'a> {
    let (count, list) = lists.list(mover);
    let hidden = Hidden::of(view, mover, count, &list);
    (0..count).map(list).filter(move |entry| !hidden.has(entry))
}
