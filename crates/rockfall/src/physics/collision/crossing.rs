//! Contacts that begin and end within a step (docs/physics section 3.10).
//!
//! Such a contact is a crossing. It leaves no overlap, so it is found from the paths of the last step (`physics/first_contact.rs`).
//! The time of a crossing is that of its first contact, in seconds before the present.

use glam::{Vec3, Vec4};

use crate::model::lists::Lists;
use crate::model::step::Step;
use crate::model::view::View;
use crate::physics::collision::{Change, Collision, lone};
use crate::physics::contact::collision_velocity;
use crate::physics::first_contact::{Earlier, time_of_visible_beginning, wall_velocity};
use crate::physics::sides::{sides, wall_of};
use crate::physics::touch::{Touch, line};

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
            let found = colliding(view, lists, sphere, entry.id());
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
        let is_alone = other >= view.step.layout.spheres || view.is_fixed(other);
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
fn colliding(view: &View, lists: &Lists, one: u32, other: u32) -> Option<(f32, Collision)> {
    let (a, b) = view.ordered(one, other);
    let [side_a, side_b] = sides(view, [a, b], &Touch { normal: Vec3::ZERO, overlap: 0.0, a: 0.0, b: 0.0 });
    let threshold = collision_velocity(view.step, &side_a, &side_b);
    let time = time_of_visible_beginning(view, lists, [a, b], threshold)?;
    let found = (time, contact_before(view, a, b, time)?);
    // A sphere that is behind a polygon has passed it.
    let is_over = contact_before(view, a, b, 0.0)
        .is_none_or(|now| if now.is_pressed(view) { !now.collides(view) } else { separates(view, &now) });
    is_over.then_some(found)
}

fn contact_before(view: &View, a: u32, b: u32, time: f32) -> Option<Collision> {
    let earlier = Earlier::of(view, [a, b], time);
    let touch = line(view, &earlier, view.object(a), view.object(b), None)?;
    let wall = wall_of(view, &earlier, [a, b], &touch).map_or(Vec3::ZERO, |(wall, point)| wall.velocity_at(point));
    Some(Collision::of(view, &earlier, [a, b], 0, touch, wall))
}

/// Whether the objects of a contact move apart. The motion of the surface of a fixed sphere does not count.
fn separates(view: &View, k: &Collision) -> bool {
    let velocity = |id: u32| if id < view.step.layout.spheres { view.own_velocity(id) } else { wall_velocity(view, k.a, id) };
    k.touch.normal.dot(velocity(k.b) - velocity(k.a)) > 0.0
}

/// The crossings of a step, in regions 0 and 2 of a state (see [`Crossing::rows`]).
#[derive(Clone, Copy)]
pub(crate) struct Crossings<'a> {
    rows: &'a [Vec4],
    spheres: u32,
}

impl<'a> Crossings<'a> {
    pub(crate) fn new(step: &Step, rows: &'a [Vec4]) -> Self {
        Self { rows, spheres: step.layout.spheres }
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
