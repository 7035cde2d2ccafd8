//! The contact of the axis of a rod with an edge or vertex of a polygon, or with a cone or ball from outside, and which of them are no edges
//! of the surface (docs/physics section 2.19).

use glam::Vec3;

use crate::fine::Fine;
use crate::model::lists::Entry;
use crate::model::view::{Object, PolygonRecord, RodRecord, TINY, View};
use crate::physics::geometry::{Face, on_segment, point_segment, segment_segment, unrounded};
use crate::physics::motions::{Motions, Touch, ends, origin_of};
use crate::physics::smooth::{lowest_point, point_round, round_parameter};
use crate::scene::Surface;

/// Distance, as a part of the radius of a rod, at which the surface beside an edge is looked for, and up to which places are one.
const BESIDE: f32 = 1e-3;
/// Room along the edges of a polygon, as a part of that distance.
const ROOM: f32 = 0.3;
/// The sine of the angle up to which a bent surface has no edge.
const BENT: f32 = 0.01;
/// Another polygon goes on at an edge if the cosine of the angle between both is at most this.
const FOLDED: f32 = 0.5;
/// An edge leads towards a rod if the cosine of its angle with the normal is less than this.
const NEARER: f32 = -1e-3;

/// Number of entries that a polygon makes in the list of a rod.
pub(crate) fn features(surface: Surface) -> u32 {
    match surface {
        Surface::Parallelogram => 4,
        Surface::Triangle => 3,
        Surface::Cone { inside: false } | Surface::Ball { inside: false } => 1,
        _ => 0,
    }
}

/// An edge of a polygon.
#[derive(Clone, Copy)]
struct Edge {
    start: Vec3,
    vector: Vec3,
}

impl Edge {
    fn of(polygon: &PolygonRecord, feature: u32) -> Self {
        let PolygonRecord { corner, left, right, .. } = *polygon;
        let (start, vector) = match (polygon.is_triangle(), feature) {
            (_, 0) => (corner, left),
            (false, 1) => (corner + right, left),
            (true, 1) | (false, 2) => (corner, right),
            (true, _) => (corner + left, right - left),
            (false, _) => (corner + left, right),
        };
        Self { start, vector }
    }

    fn ends(&self) -> [Vec3; 2] {
        [self.start, self.start + self.vector]
    }

    /// The point of the edge that is nearest to a place.
    fn nearest(&self, place: Vec3) -> Vec3 {
        let t = (place - self.start).dot(self.vector) / self.vector.length_squared();
        self.start + t.clamp(0.0, 1.0) * self.vector
    }

    /// The vector from the point of an axis to the nearest point of the edge, the parameter of that point, and whether it is a vertex.
    fn nearest_to_axis(&self, axis: [Vec3; 2], radius: f32) -> Option<(Vec3, f32, bool)> {
        let along = axis[1] - axis[0];
        let squared = along.length_squared() + self.vector.length_squared();
        if let Some(pair) = segment_segment(axis, self.ends(), radius) {
            return pair.normal.map(|_| (unrounded(pair.d, squared, radius), pair.a, false));
        }
        let normal = along.normalize_or_zero().cross(self.vector.normalize_or_zero());
        if normal.length_squared() <= 1e-8 {
            return None;
        }
        // The parameter on the edge of the point that is nearest to the line of the axis.
        let from_axis = self.start - axis[0];
        let b = from_axis.dot(along.normalize().cross(normal)) / (normal.length_squared() * self.vector.length());
        if on_segment(b) {
            return None;
        }
        let vertex = self.ends()[usize::from(b > 0.5)];
        let (a, to_axis) = point_segment(vertex, axis, radius)?;
        Some((unrounded(-to_axis, squared, radius), a, true))
    }
}

/// A polygon as seen from an origin.
pub(crate) fn polygon_from(at: &impl Motions, polygon: &PolygonRecord, origin: Fine) -> PolygonRecord {
    let origin = at.near(polygon.middle().as_dvec3(), origin);
    PolygonRecord { corner: Fine { high: polygon.corner, low: Vec3::ZERO }.minus(origin), ..*polygon }
}

/// Returns the contact of the axis of a rod with a feature of a polygon, also where they are apart. `None` where they have no contact line.
pub(crate) fn line(at: &impl Motions, rod: RodRecord, polygon: &PolygonRecord, feature: u32) -> Option<Touch> {
    let origin = origin_of(at, rod);
    Contact::of(&polygon_from(at, polygon, origin), ends(at, rod, origin), rod.radius, feature).map(|contact| contact.touch)
}

/// Returns the contact of a rod with a feature of a polygon that it overlaps, unless its end spheres carry it.
pub(crate) fn overlapping(view: &View, rod: RodRecord, polygon: &PolygonRecord, feature: u32) -> Option<Touch> {
    let origin = origin_of(view, rod);
    Contact::carried(&polygon_from(view, polygon, origin), ends(view, rod, origin), rod.radius, feature)
        .map(|contact| contact.touch)
}

/// A contact of the axis of a rod.
#[derive(Clone, Copy)]
struct Contact {
    touch: Touch,
    is_vertex: bool,
    /// The point of the polygon.
    place: Vec3,
}

impl Contact {
    fn of(polygon: &PolygonRecord, axis: [Vec3; 2], radius: f32, feature: u32) -> Option<Self> {
        if features(polygon.surface) <= feature {
            return None;
        }
        if polygon.surface.is_round() {
            return Self::of_round(polygon, axis, radius);
        }
        let (d, a, is_vertex) = Edge::of(polygon, feature).nearest_to_axis(axis, radius)?;
        let face = Face::of(polygon).normal;
        if !polygon.is_triangle() && d.dot(face) > 0.0 {
            return None;
        }
        let distance = d.length();
        let is_zero = d.length_squared() <= TINY;
        let (normal, overlap) = if is_zero { (-face, radius) } else { (d / distance, radius - distance) };
        let place = axis[0] + a * (axis[1] - axis[0]) + d;
        Some(Self { touch: Touch { normal, overlap, a, b: 0.0 }, is_vertex, place })
    }

    fn of_round(polygon: &PolygonRecord, axis: [Vec3; 2], radius: f32) -> Option<Self> {
        let [start, end] = axis.map(|end| (end - polygon.corner).as_dvec3());
        let a = lowest_point(polygon, start, end - start)?;
        let point = start + a * (end - start);
        if !on_segment(a as f32) || !on_segment(round_parameter(polygon, point)) {
            return None;
        }
        let (normal, distance) = point_round(polygon, point, radius)?;
        let touch = Touch { normal, overlap: (f64::from(radius) - distance) as f32, a: a as f32, b: 0.0 };
        Some(Self { touch, is_vertex: false, place: polygon.corner + point.as_vec3() + distance as f32 * normal })
    }

    /// The contact of a rod that overlaps the feature and does not lie along it.
    fn carried(polygon: &PolygonRecord, axis: [Vec3; 2], radius: f32, feature: u32) -> Option<Self> {
        let contact = Self::of(polygon, axis, radius, feature).filter(|contact| contact.touch.overlap > 0.0)?;
        let is_on_end = |end: Vec3| {
            if polygon.surface.is_round() {
                return point_round(polygon, (end - polygon.corner).as_dvec3(), radius)
                    .is_some_and(|(_, distance)| distance < f64::from(radius));
            }
            Edge::of(polygon, feature).nearest(end).distance(end) < radius
        };
        (!axis.into_iter().all(is_on_end)).then_some(contact)
    }
}

/// The polygons of a list of a rod, as seen from its origin.
pub(super) struct Edges {
    axis: [Vec3; 2],
    radius: f32,
    /// The id, the body and the record of each polygon.
    polygons: Vec<(u32, u32, PolygonRecord)>,
}

impl Edges {
    /// `statics` are the boxes and polygons of the list.
    pub(super) fn of(view: &View, rod: RodRecord, statics: &[Entry]) -> Self {
        let origin = origin_of(view, rod);
        let polygon = |entry: &Entry| match view.object(entry.id()) {
            Object::Polygon(polygon) if entry.feature() == 0 => {
                let record = polygon_from(view, &view.polygon(polygon), origin);
                Some((entry.id(), view.body(view.object(entry.id())), record))
            }
            _ => None,
        };
        let polygons = statics.iter().filter_map(polygon).filter(|(.., record)| !record.surface.is_round()).collect();
        Self { axis: ends(view, rod, origin), radius: rod.radius, polygons }
    }

    /// Whether a contact with a feature of one of the polygons is with no edge of the surface, or counts elsewhere.
    pub(super) fn hides(&self, id: u32, feature: u32) -> bool {
        let Some((_, body, polygon)) = self.polygons.iter().find(|polygon| polygon.0 == id) else { return false };
        let Some(own) = Contact::carried(polygon, self.axis, self.radius, feature) else { return false };
        let mut surface = self.polygons.iter().filter(|(_, other, _)| other == body);
        let edge = Edge::of(polygon, feature).vector.normalize();
        let inward = into(polygon, edge, own.place);
        surface.any(|(other, _, record)| {
            (*other != id && self.goes_on(record, &own, edge, inward))
                || (0..features(record.surface)).any(|their| {
                    self.counts_first(&own, (id, feature), record, (*other, their)) || self.leads_nearer(&own, record, their)
                })
        })
    }

    /// Whether another polygon goes on at an edge, so that the surface is flat or hollow there.
    fn goes_on(&self, other: &PolygonRecord, own: &Contact, edge: Vec3, inward: Vec3) -> bool {
        let step = BESIDE * self.radius;
        let face = Face::of(other);
        let along = edge.cross(face.normal);
        if along.length_squared() < 1e-6 {
            return false;
        }
        let belongs = |place: Vec3| {
            let t = place - other.corner;
            let [l, k] = face.along_edges(t);
            let [l_room, k_room] = [other.left, other.right].map(|edge| ROOM * step / edge.length());
            let is_in = |value: f32, room: f32| (-room..=1.0 + room).contains(&value);
            let is_beside = other.is_triangle() && l + k > 1.0 + l_room.max(k_room);
            t.dot(face.normal).abs() <= step && is_in(l, l_room) && is_in(k, k_room) && !is_beside
        };
        [along.normalize(), -along.normalize()].into_iter().any(|way| {
            way.dot(inward) <= FOLDED && own.touch.normal.dot(inward + way) <= BENT && belongs(own.place + step * way)
        })
    }

    /// Whether the rod touches another edge at the same place, and that contact comes first.
    fn counts_first(&self, own: &Contact, key: (u32, u32), other: &PolygonRecord, their_key: (u32, u32)) -> bool {
        Contact::carried(other, self.axis, self.radius, their_key.1).is_some_and(|their| {
            their.place.distance(own.place) <= BESIDE * self.radius && (their.is_vertex, their_key) < (own.is_vertex, key)
        })
    }

    /// Whether an edge leads from a vertex towards the rod.
    fn leads_nearer(&self, own: &Contact, other: &PolygonRecord, feature: u32) -> bool {
        let (edge, near) = (Edge::of(other, feature), BESIDE * self.radius);
        if !own.is_vertex || edge.nearest(own.place).distance(own.place) > near {
            return false;
        }
        edge.ends().into_iter().any(|end| {
            let way = end - own.place;
            way.length() > near && own.touch.normal.dot(way.normalize()) < NEARER
        })
    }
}

/// The unit vector in the plane of a polygon across an edge and into it.
fn into(polygon: &PolygonRecord, edge: Vec3, place: Vec3) -> Vec3 {
    let middle = polygon.corner
        + if polygon.is_triangle() { (polygon.left + polygon.right) / 3.0 } else { 0.5 * (polygon.left + polygon.right) };
    let way = middle - place;
    (way - way.dot(edge) * edge).normalize()
}
