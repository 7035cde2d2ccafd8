//! Contacts that begin and end within a step (docs/physics.md section 3.10).
//!
//! Such a contact is a crossing. It leaves no overlap, so it is found from the paths of the last step. The motion is taken as
//! straight. The time of a crossing is that of its first contact, in seconds before the present.

use glam::{Vec3, Vec4};

use crate::model::lists::Lists;
use crate::model::step::Step;
use crate::model::view::{BoxRecord, Object, PolygonRecord, View};
use crate::physics::collision::{Change, Collision, lone};
use crate::physics::geometry::{AT_END, point_box};
use crate::physics::touch::{Motions, ROUNDING, line};

/// Most iterations for the first contact with a box.
const ITERATIONS: u32 = 16;
/// A sphere touches a box when the iteration ends at most this far from it, in radii.
const NEAR: f32 = 1e-3;
/// In place of the low half of an id, where there is no crossing.
const NO_ID: f32 = -1.0;
/// Added to the high half of the id of an object that does not move.
const ALONE: u32 = 1 << 16;

/// The crossing that counts for a moving sphere, and what it does to that sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) other: u32,
    /// Whether the other object does not move.
    pub(crate) is_alone: bool,
    /// The change by the collision.
    pub(crate) change: Change,
}

impl Crossing {
    /// The crossing that counts for a sphere: the earliest one that collides.
    pub(crate) fn of(view: &View, lists: &Lists, sphere: u32) -> Option<Self> {
        if view.is_fixed(sphere) || !view.is_ball(sphere) {
            return None;
        }
        let mut first: Option<(f32, Collision)> = None;
        for entry in lists.row(sphere) {
            let found = colliding(view, sphere, entry.id());
            // Entries are in insertion order, so that of equal times the first one stays.
            if let Some(found) = found.filter(|found| first.is_none_or(|first| found.0 > first.0)) {
                first = Some(found);
            }
        }
        let (time, collision) = first?;
        let other = if collision.a == sphere { collision.b } else { collision.a };
        let outcome = lone::solve_crossing(view, &collision, time);
        let none = Change { sphere, ..Change::default() };
        let change = outcome.and_then(|outcome| outcome.changes().iter().find(|change| change.sphere == sphere).copied());
        let is_alone = other >= view.step.spheres || view.is_fixed(other);
        Some(Self { other, is_alone, change: change.unwrap_or(none) })
    }

    /// The rows that keep a crossing, or none, for the stages that follow: the changes of position and velocity, each with one
    /// half of the id of the other object. An id is too large for one float, and as the bits of a float it may be denormal.
    pub(crate) fn rows(crossing: Option<Self>) -> [Vec4; 2] {
        crossing.map_or([Vec3::ZERO.extend(NO_ID), Vec4::ZERO], |crossing| {
            let (low, high) = (crossing.other & 0xffff, (crossing.other >> 16) + if crossing.is_alone { ALONE } else { 0 });
            [crossing.change.position.extend(low as f32), crossing.change.velocity.extend(high as f32)]
        })
    }
}

/// The time and the contact of a crossing that collides.
fn colliding(view: &View, one: u32, other: u32) -> Option<(f32, Collision)> {
    let (a, b) = view.ordered(one, other);
    let found = begun_within_step(view, a, b)?;
    // A crossing of a polygon is known to be over. Its plane goes on beside and behind it.
    let is_polygon = matches!(view.object(b), Object::Polygon(_));
    let is_over = || {
        let now = contact_before(view, a, b, 0.0)?;
        Some(if now.is_pressed(view) { !now.collides(view) } else { separates(view, &now) })
    };
    (is_polygon || is_over()?).then_some(found)
}

/// The time and the contact of a pair that began to touch within the step and then approached fast enough to collide, whether or
/// not it still touches. A was added before B.
pub(super) fn begun_within_step(view: &View, a: u32, b: u32) -> Option<(f32, Collision)> {
    let time = time_of_crossing(view, a, b)?;
    let then = contact_before(view, a, b, time)?;
    (then.inverse_mass() > 0.0 && then.collides(view)).then_some((time, then))
}

/// Whether a pair that touches exerts no contact force, because it began to touch within the step (docs/physics.md section 3.10).
pub(crate) fn has_just_begun(view: &View, one: u32, other: u32) -> bool {
    let (a, b) = view.ordered(one, other);
    begun_within_step(view, a, b).is_some()
}

fn contact_before(view: &View, a: u32, b: u32, time: f32) -> Option<Collision> {
    let earlier = Earlier { view, time };
    let touch = line(view, &earlier, view.object(a), view.object(b), None)?;
    Some(Collision::of(view, &earlier, [a, b], 0, touch))
}

/// Whether the objects of a contact move apart. The motion of the surface of a fixed sphere does not count.
fn separates(view: &View, k: &Collision) -> bool {
    let velocity = |id: u32| if id < view.step.spheres { view.own_velocity(id) } else { Vec3::ZERO };
    k.touch.normal.dot(velocity(k.b) - velocity(k.a)) > 0.0
}

/// The time of the first contact of objects A and B, if they cross. A was added before B.
fn time_of_crossing(view: &View, a: u32, b: u32) -> Option<f32> {
    let dt = view.step.dt;
    match (view.object(a), view.object(b)) {
        (Object::Sphere(a), Object::Sphere(b)) => {
            let radii = [view.radius(a), view.radius(b)];
            let path = view.own_velocity(b) - view.own_velocity(a);
            let balls = view.is_ball(a) && view.is_ball(b);
            balls.then(|| sphere_sphere(view.position(b) - view.position(a), path, radii, dt)).flatten()
        }
        (Object::Sphere(a), Object::Cuboid(cuboid)) if view.is_ball(a) => {
            sphere_box(&view.cuboid(cuboid), view.position(a), view.own_velocity(a), view.radius(a), dt)
        }
        (Object::Sphere(a), Object::Polygon(polygon)) if view.is_ball(a) => {
            sphere_polygon(&view.polygon(polygon), view.position(a), view.own_velocity(a), view.radius(a), dt)
        }
        _ => None,
    }
}

/// `d` is the vector between the centres, `path` its rate of change.
fn sphere_sphere(d: Vec3, path: Vec3, radii: [f32; 2], dt: f32) -> Option<f32> {
    let (reach, least) = (radii[0] + radii[1], radii[0].min(radii[1]));
    let squared = path.length_squared();
    let nearest = d.dot(path) / squared;
    let chord = reach * reach - (d - nearest * path).length_squared();
    let was_apart = reach - (d - dt * path).length() <= ROUNDING * least;
    let time = nearest + (chord / squared).sqrt();
    // Without relative motion the times are not numbers.
    (nearest < dt && chord > 0.0 && was_apart && time > 0.0).then(|| time.min(dt))
}

fn sphere_box(cuboid: &BoxRecord, position: Vec3, velocity: Vec3, radius: f32, dt: f32) -> Option<f32> {
    let at = |time: f32| {
        let (normal, distance) = point_box(cuboid, position - time * velocity, radius);
        (radius - distance, velocity.dot(normal))
    };
    let mut time = dt;
    let (mut overlap, mut closing) = at(time);
    if overlap > ROUNDING * radius {
        return None;
    }
    for _ in 0..ITERATIONS {
        if overlap >= 0.0 || closing <= 0.0 {
            break;
        }
        time += overlap / closing;
        (overlap, closing) = at(time);
    }
    (overlap >= -NEAR * radius && closing > 0.0 && time > 0.0).then_some(time)
}

fn sphere_polygon(polygon: &PolygonRecord, position: Vec3, velocity: Vec3, radius: f32, dt: f32) -> Option<f32> {
    let normal = polygon.left.cross(polygon.right);
    let (squared, length) = (normal.length_squared(), normal.length());
    let coordinates = |v: Vec3| {
        let (l, k) = (v.cross(polygon.right).dot(normal) / squared, polygon.left.cross(v).dot(normal) / squared);
        Vec3::new(l, k, v.dot(normal) / length)
    };
    let (place, rate) = (coordinates(position - polygon.corner), coordinates(velocity));
    if rate.z >= 0.0 {
        return None;
    }
    let low = Vec3::new(-AT_END, -AT_END, 0.0);
    let high = Vec3::new(1.0 + AT_END, 1.0 + AT_END, (1.0 - ROUNDING) * radius);
    let (mut end, mut begin) = (f32::NEG_INFINITY, f32::INFINITY);
    for axis in 0..3 {
        if rate[axis] == 0.0 {
            if place[axis] < low[axis] || place[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let times = [(place[axis] - low[axis]) / rate[axis], (place[axis] - high[axis]) / rate[axis]];
        end = end.max(times[0].min(times[1]));
        begin = begin.min(times[0].max(times[1]));
    }
    (end > 0.0 && end < begin && begin < dt).then(|| ((place.z - radius) / rate.z).clamp(0.0, dt))
}

/// The spheres at an earlier time, moved back along straight lines. Fixed spheres are not moved.
struct Earlier<'a> {
    view: &'a View<'a>,
    time: f32,
}

impl Motions for Earlier<'_> {
    fn position(&self, sphere: u32) -> Vec3 {
        self.view.position(sphere) - self.time * self.view.own_velocity(sphere)
    }

    fn velocity(&self, sphere: u32) -> Vec3 {
        self.view.velocity(sphere)
    }
}

/// The crossings of a step, in regions 0 and 2 of a state (see [`Crossing::rows`]).
#[derive(Clone, Copy)]
pub(crate) struct Crossings<'a> {
    rows: &'a [Vec4],
    spheres: u32,
}

impl<'a> Crossings<'a> {
    pub(crate) fn new(step: &Step, rows: &'a [Vec4]) -> Self {
        Self { rows, spheres: step.spheres }
    }

    /// The crossing that counts for a sphere.
    fn counting(&self, sphere: u32) -> Option<Crossing> {
        let [position, velocity] = [0, 2].map(|region| self.rows[(region * self.spheres + sphere) as usize]);
        let (low, high) = ((position.w >= 0.0).then_some(position.w as u32)?, velocity.w as u32);
        let change = Change { sphere, position: position.truncate(), velocity: velocity.truncate(), ..Change::default() };
        Some(Crossing { other: low | (high % ALONE) << 16, is_alone: high >= ALONE, change })
    }

    /// The crossing of an object that is handled: it counts for each of its moving spheres.
    pub(crate) fn handled(&self, id: u32) -> Option<Crossing> {
        let own = (id < self.spheres).then(|| self.counting(id)).flatten()?;
        (own.is_alone || self.counting(own.other).is_some_and(|other| other.other == id)).then_some(own)
    }
}
