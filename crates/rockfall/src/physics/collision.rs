//! The collision phase: which contacts collide, and what their impulses do to the bodies (docs/physics section 3).
//!
//! [`Collision`] is a contact together with the effects of its impulse on the bodies of both sides. [`lone`] handles lone
//! collisions at their time of contact. [`cluster`] solves collisions that share bodies, by sweeps. [`all`] finds both
//! kinds and combines their results. [`crossing`] finds contacts that began and ended within the last step.

pub(crate) mod all;
pub(crate) mod body;
mod cluster;
pub(crate) mod crossing;
mod lone;
mod networks;
mod pair;

use glam::Vec3;

use crate::model::impulse::Key;
use crate::model::view::{Object, View};
use crate::physics::chain::touch;
use crate::physics::contact::{collision_velocity, smaller_radius};
use crate::physics::side::Side;
use crate::physics::sides::{sides, wall_of};
use crate::physics::touch::ROUNDING;
use crate::physics::touch::{Motions, Touch};
use body::{Body, Capsule, Part};

/// A contact as the collision phase sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collision {
    /// The object with the lower insertion index.
    pub(crate) a: u32,
    pub(crate) b: u32,
    pub(crate) feature: u32,
    pub(crate) touch: Touch,
    parts: [Part; 4],
    len: usize,
    /// Approach velocity u, positive when the sides approach each other.
    pub(crate) approach: f32,
}

impl Collision {
    /// The contact of two objects, in either order; `None` where they do not overlap.
    pub(crate) fn between(view: &View, one: u32, other: u32, feature: u32) -> Option<Self> {
        let (a, b) = view.ordered(one, other);
        Some(Self::with_touch(view, [a, b], feature, touch(view, a, b, feature)?))
    }

    /// The contact of two objects, in order of addition, with a known geometry.
    pub(crate) fn with_touch(view: &View, objects: [u32; 2], feature: u32, touch: Touch) -> Self {
        let wall = wall_of(view, view, objects, &touch).map_or(Vec3::ZERO, |(wall, point)| wall.velocity_at(point));
        Self::of(view, view, objects, feature, touch, wall)
    }

    /// The contact `touch` of two objects, with the velocities of the state `at`. `wall` is the velocity of B if it is a box or polygon.
    fn of(view: &View, at: &impl Motions, [a, b]: [u32; 2], feature: u32, touch: Touch, wall: Vec3) -> Self {
        let mut collision = Self { a, b, feature, touch, parts: [Part::NONE; 4], len: 0, approach: -wall.dot(touch.normal) };
        collision.add_side(view, at, a, touch.a, -1.0);
        collision.add_side(view, at, b, touch.b, 1.0);
        collision
    }

    /// Adds the bodies of the side of an object, and the velocity of that side.
    fn add_side(&mut self, view: &View, at: &impl Motions, id: u32, parameter: f32, sign: f32) {
        let n = self.touch.normal;
        let object = view.object(id);
        let capsule = match object {
            Object::Sphere(sphere) => view.capsule_of(sphere),
            Object::Rod(rod) => view.is_capsule(rod).then_some(rod),
            Object::Cuboid(_) | Object::Polygon(_) => return,
        };
        if let Some(rod) = capsule {
            let capsule = Capsule::of(view, at, rod);
            let place = match object {
                Object::Sphere(sphere) => f32::from(u8::from(capsule.ends[1] == sphere)),
                _ => parameter,
            };
            let torque = capsule.torque(place, n);
            self.approach -= sign * (n.dot(capsule.velocity) + torque.dot(capsule.spin));
            return self.add(Part { sign, torque, ..capsule.part(torque) });
        }
        match object {
            Object::Sphere(sphere) => {
                self.approach -= sign * n.dot(at.velocity(sphere));
                if let Some(body) = Body::of(view, sphere) {
                    self.add(Part::of_sphere(view, body, sphere, 1.0, sign));
                }
            }
            Object::Rod(rod) => {
                let [one, two] = view.rod(rod).ends;
                let shares = [(one, 1.0 - parameter), (two, parameter)];
                for (end, share) in shares.into_iter().filter(|(end, _)| !view.is_fixed(*end)) {
                    self.approach -= sign * share * n.dot(at.velocity(end));
                }
                self.add_ends(view, shares, sign);
            }
            Object::Cuboid(_) | Object::Polygon(_) => {}
        }
    }

    /// Adds the ends of a rod that does not belong to a capsule. Two ends in one network form one part. Otherwise each end
    /// is a part of its own.
    fn add_ends(&mut self, view: &View, shares: [(u32, f32); 2], sign: f32) {
        let [one, two] =
            shares.map(|(sphere, share)| Body::of(view, sphere).map(|body| Part::of_sphere(view, body, sphere, share, sign)));
        match (one, two) {
            (Some(one), Some(two)) if one.body == two.body => self.add(one.and(two)),
            (one, two) => one.into_iter().chain(two).for_each(|part| self.add(part)),
        }
    }

    fn add(&mut self, part: Part) {
        self.parts[self.len] = part;
        self.len += 1;
    }

    /// The effect of the impulse on each body. Both sides may be on one body.
    pub(crate) fn parts(&self) -> &[Part] {
        &self.parts[..self.len]
    }

    /// The inverse mass, summed over both sides. For networks it is the value before the projection.
    fn inverse_mass(&self) -> f32 {
        self.parts().iter().map(|part| part.inverse_mass).sum()
    }

    /// The smaller radius of the pair, which the thresholds refer to.
    fn smaller_radius(&self, view: &View) -> f32 {
        let [a, b] = self.sides(view);
        smaller_radius(&a, &b)
    }

    /// Whether the contact is pressed: it overlaps by more than a rounding error, and its inverse mass is not 0.
    pub(crate) fn is_pressed(&self, view: &View) -> bool {
        self.inverse_mass() > 0.0 && self.touch.overlap > ROUNDING * self.smaller_radius(view)
    }

    /// Whether a pressed contact collides: its approach velocity exceeds the threshold.
    pub(crate) fn collides(&self, view: &View) -> bool {
        self.approach > self.threshold(view)
    }

    /// The approach velocity above which the contact collides.
    fn threshold(&self, view: &View) -> f32 {
        let [a, b] = self.sides(view);
        collision_velocity(view.step, &a, &b)
    }

    fn sides(&self, view: &View) -> [Side; 2] {
        sides(view, [self.a, self.b], &self.touch)
    }

    /// The key by which collisions are sorted and found. It does not depend on the order in memory.
    pub(crate) fn key(&self, view: &View) -> Key {
        (view.insertion_index(self.a), view.insertion_index(self.b), self.feature)
    }
}

/// The changes of a sphere in the collision phase.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Change {
    pub(crate) sphere: u32,
    pub(crate) position: Vec3,
    pub(crate) velocity: Vec3,
    pub(crate) angular_momentum: Vec3,
}
