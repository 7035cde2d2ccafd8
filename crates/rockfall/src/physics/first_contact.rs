//! The first contact of two objects within the last step (docs/physics section 3.10).
//!
//! The motion is taken as straight. Times are in seconds before the present.

use glam::Vec3;

use crate::model::lists::Lists;
use crate::model::period::Periods;
use crate::model::view::{Object, View};
use crate::physics::sides::wall_of;
use crate::physics::surface::hid;
use crate::physics::touch::{Motions, ROUNDING, line};

/// Most iterations for the first contact with a box or polygon.
const ITERATIONS: u32 = 16;
/// A sphere touches it when the iteration ends at most this far from it, in radii.
const NEAR: f32 = 1e-3;

/// The time at which a pair began to touch, if that was within the step and it then approached at more than `threshold` (units/s). It
/// may touch still.
pub(crate) fn time_of_beginning(view: &View, one: u32, other: u32, threshold: f32) -> Option<f32> {
    let (a, b) = view.ordered(one, other);
    let time = time_of_first_contact(view, a, b)?;
    let earlier = Earlier::of(view, [a, b], time);
    let touch = line(view, &earlier, view.object(a), view.object(b), None)?;
    let normal = touch.normal;
    let wall = wall_of(view, &earlier, [a, b], &touch).map_or(0.0, |(wall, point)| normal.dot(wall.velocity_at(point)));
    let spheres = || [a, b].into_iter().filter(|id| *id < view.step.layout.spheres);
    let inverse_mass: f32 = spheres().map(|sphere| view.inverse_mass(sphere)).sum();
    let towards = |id: u32| if id < view.step.layout.spheres { normal.dot(view.velocity(id)) } else { wall };
    (inverse_mass > 0.0 && towards(a) - towards(b) > threshold).then_some(time)
}

/// The same, unless another shape of the same surface hid a box or polygon then (docs/physics section 2.11).
pub(crate) fn time_of_visible_beginning(view: &View, lists: &Lists, [a, b]: [u32; 2], threshold: f32) -> Option<f32> {
    let time = time_of_beginning(view, a, b, threshold)?;
    let is_static = |id: u32| id >= view.step.movers();
    if !is_static(b) {
        return Some(time);
    }
    let earlier = Earlier::of(view, [a, b], time);
    let touch = line(view, &earlier, view.object(a), view.object(b), None)?;
    let mut shapes = lists.row(a).map(|entry| entry.id()).filter(|id| is_static(*id) && *id != b);
    (!shapes.any(|id| hid(view, &earlier, a, id, (b, &touch)))).then_some(time)
}

/// The time of the first contact of objects A and B, if their paths touch. A was added before B.
fn time_of_first_contact(view: &View, a: u32, b: u32) -> Option<f32> {
    let dt = view.step.constants.dt;
    let relative = |a: u32| view.own_velocity(a) - wall_velocity(view, a, b);
    match (view.object(a), view.object(b)) {
        (Object::Sphere(a), Object::Sphere(b)) => {
            let radii = [view.radius(a), view.radius(b)];
            let path = view.own_velocity(b) - view.own_velocity(a);
            let balls = view.is_ball(a) && view.is_ball(b);
            balls.then(|| sphere_sphere(view.between(a, b), path, radii, dt)).flatten()
        }
        (Object::Sphere(a), Object::Cuboid(_) | Object::Polygon(_)) if view.is_ball(a) => {
            sphere_shape(view, a, b, relative(a), dt)
        }
        _ => None,
    }
}

/// The velocity of a moving wall at the centre of a sphere; 0 for other objects. The path of the sphere is taken relative to it.
pub(crate) fn wall_velocity(view: &View, sphere: u32, other: u32) -> Vec3 {
    let wall = view.wall(view.object(other));
    wall.map_or(Vec3::ZERO, |wall| wall.velocity_at(view.position(sphere)))
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

/// The time of the first contact of a sphere with a box or polygon. The distance is a convex function of the time.
fn sphere_shape(view: &View, sphere: u32, id: u32, velocity: Vec3, dt: f32) -> Option<f32> {
    let radius = view.radius(sphere);
    let at = |time: f32| {
        let earlier = Earlier::of(view, [sphere, id], time);
        let touch = line(view, &earlier, Object::Sphere(sphere), view.object(id), None)?;
        Some((touch.overlap, velocity.dot(touch.normal)))
    };
    let is_past = |time: f32| at(time).is_none_or(|(overlap, _)| overlap > ROUNDING * radius);
    let is_hollow = matches!(view.object(id), Object::Polygon(polygon) if view.polygon(polygon).surface.is_inside());
    if is_hollow && is_past(0.0) && !is_past(dt) {
        let time = halved(is_past, dt);
        return at(time).filter(|(overlap, closing)| *overlap >= -NEAR * radius && *closing > 0.0).map(|_| time);
    }
    let mut time = dt;
    let (mut overlap, mut closing) = at(time)?;
    if overlap > ROUNDING * radius {
        return None;
    }
    for _ in 0..ITERATIONS {
        if overlap >= 0.0 || closing <= 0.0 {
            break;
        }
        time += overlap / closing;
        (overlap, closing) = at(time)?;
    }
    (overlap >= -NEAR * radius && closing > 0.0 && time > 0.0).then_some(time)
}

/// The time up to which a sphere was apart from a cone or ball around it, from which the distance is a concave function of the time.
fn halved(is_past: impl Fn(f32) -> bool, dt: f32) -> f32 {
    let (mut past, mut apart) = (0.0, dt);
    for _ in 0..ITERATIONS {
        let middle = 0.5 * (past + apart);
        if is_past(middle) { past = middle } else { apart = middle }
    }
    apart
}

/// The spheres at an earlier time, moved back along straight lines, relative to the wall that they meet. Fixed spheres are not moved.
pub(crate) struct Earlier<'a> {
    view: &'a View<'a>,
    time: f32,
    /// Velocity of the wall.
    drift: Vec3,
}

impl<'a> Earlier<'a> {
    /// The objects A and B at an earlier time.
    pub(crate) fn of(view: &'a View<'a>, [a, b]: [u32; 2], time: f32) -> Self {
        let drift = if a < view.step.layout.spheres { wall_velocity(view, a, b) } else { Vec3::ZERO };
        Self { view, time, drift }
    }
}

impl Motions for Earlier<'_> {
    fn position(&self, sphere: u32) -> Vec3 {
        self.view.position(sphere) - self.time * (self.view.own_velocity(sphere) - self.drift)
    }

    fn velocity(&self, sphere: u32) -> Vec3 {
        self.view.velocity(sphere)
    }

    fn periods(&self) -> Option<Periods> {
        Periods::of(self.view.step)
    }
}
