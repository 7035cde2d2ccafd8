//! Friction impulses of contacts that press (docs/physics.md section 3.9): along the slip, as large as takes it away or as the limit lets.
//!
//! All act at once. Gt of a contact is what its unit impulse changes the slip by, with every body counted once for each contact that presses
//! on it: as if it were split among them. Putting the parts together again never adds energy.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::model::impulse::Impulse;
use crate::model::layout::ENTRY_OVERLAPS;
use crate::model::layout::GRAIN;
use crate::model::lists::{Entry, Lists};
use crate::model::state::Motion;
use crate::model::view::{Object, View};
use crate::physics::collision::all::impulse_in;
use crate::physics::collision::body::{Body, Capsule, sphere_rows};
use crate::physics::contact::{Approach, Sides, Slip, Touches, arms, normal_forces};
use crate::physics::side::side;
use crate::physics::touch::{Feature, Touch, line};

/// What is needed to find the friction impulses of a step, from the state after its normal impulses.
pub(crate) struct FrictionImpulses<'a> {
    view: &'a View<'a>,
    lists: &'a Lists<'a>,
    impulses: &'a [Impulse],
    /// By mover: how many of its contacts press.
    pressed: Vec<u32>,
}

/// The friction impulse of a contact.
#[derive(Clone, Copy, Debug)]
struct Rub {
    a: u32,
    b: u32,
    touch: Touch,
    /// On A; B gets the opposite.
    impulse: Vec3,
    arms: [f32; 2],
}

/// How a contact's unit tangential impulse meets a body: by an impulse p at a place of weight g, and a couple K.
#[derive(Clone, Copy, Debug)]
struct Grip {
    /// The place on a capsule's axis; the share of any other sphere.
    place: f32,
    push: Vec3,
    couple: Vec3,
}

impl<'a> FrictionImpulses<'a> {
    pub(crate) fn new(view: &'a View<'a>, lists: &'a Lists<'a>, impulses: &'a [Impulse]) -> Self {
        let movers = (0..view.step.movers()).into_par_iter().with_min_len(GRAIN);
        let pressed = movers.map(|mover| pressed(lists, mover).count() as u32).collect();
        Self { view, lists, impulses, pressed }
    }

    /// The state of a sphere after the friction impulses of all its contacts.
    pub(crate) fn rubbed(&self, sphere: u32) -> Motion {
        let before = Motion::of(self.view, sphere);
        match Body::of(self.view, sphere) {
            None => before,
            Some(Body::Capsule(rod)) => self.end_after_friction(before, sphere, rod),
            Some(_) => self.sphere_after_friction(before, sphere),
        }
    }

    /// A sphere by itself; one of a network, too, for its rods take what they do not let through when lengths are put right.
    fn sphere_after_friction(&self, before: Motion, sphere: u32) -> Motion {
        let view = self.view;
        let mut after = before;
        for row in sphere_rows(view, sphere) {
            for rub in pressed(self.lists, row).filter_map(|entry| self.rub(row, entry)) {
                let grip = rub.grip(view, row, rub.impulse);
                let share = match view.object(row) {
                    Object::Rod(rod) if view.rod(rod).ends[0] == sphere => 1.0 - grip.place,
                    Object::Rod(_) => grip.place,
                    _ => 1.0,
                };
                after.velocity += share * view.inverse_mass(sphere) * grip.push;
                after.angular_momentum += share * grip.couple;
            }
        }
        after
    }

    /// An end of a capsule, which turns as one body.
    fn end_after_friction(&self, before: Motion, sphere: u32, rod: u32) -> Motion {
        let view = self.view;
        let capsule = Capsule::of(view, view, rod);
        let (mut velocity, mut spin, mut roll) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        Body::Capsule(rod).each_row(view, |row| {
            for rub in pressed(self.lists, row).filter_map(|entry| self.rub(row, entry)) {
                let grip = rub.grip(view, row, rub.impulse);
                let (across, along) = couples(&capsule, &grip);
                velocity += grip.push / capsule.mass;
                spin += across / capsule.inertia_across;
                roll += along / (capsule.inertia[0] + capsule.inertia[1]);
            }
        });
        let end = usize::from(capsule.ends[1] == sphere);
        Motion {
            velocity: before.velocity + capsule.end_velocities(velocity, spin)[end],
            angular_momentum: before.angular_momentum + capsule.inertia[end] * (spin + roll),
            ..before
        }
    }

    /// The friction impulse of a contact that presses, or `None` where there is none.
    fn rub(&self, row: u32, entry: Entry) -> Option<Rub> {
        let view = self.view;
        let (a, b) = view.ordered(row, entry.id());
        let (object_a, object_b) = (view.object(a), view.object(b));
        let feature = match (object_a, object_b) {
            (Object::Rod(rod), Object::Cuboid(cuboid)) => Some(Feature::of(view, rod, cuboid, entry.feature())),
            _ => None,
        };
        // It may have been moved apart by its collision.
        let touch = line(view, view, object_a, object_b, feature)?;
        let sides = [side(view, object_a, touch.a), side(view, object_b, touch.b)].map(|side| Sides::splat(&side));
        let [of_a, of_b] = &sides;
        let Touches { normal, overlap } = Touches::splat(&touch);
        let approach = Approach::of(view.step, of_a, of_b, normal);
        let arms = arms(of_a, of_b, overlap);
        let slip = Slip::of(of_a, of_b, normal, arms, approach.velocity);
        let t = slip.velocity.to_rows()[0];
        let speed = t.length();
        if speed.is_nan() || speed * speed <= slip.rounded.x {
            return None;
        }
        let pushed = impulse_in(self.impulses, (view.user(a), view.user(b), entry.feature())).map_or(0.0, |known| known.size);
        let mut limit = view.step.collision_friction * pushed;
        if view.step.coulomb_friction > 0.0 && touch.overlap > 0.0 {
            let force = normal_forces(view.step, of_a, of_b, overlap, &approach).max(Vec4::ZERO).x;
            limit += view.step.coulomb_friction * view.step.dt * force;
        }
        let rub = Rub { a, b, touch, impulse: t / speed, arms: arms.map(|arm| arm.x) };
        let size = limit.min(speed / self.yielding(&rub));
        (size > 0.0).then(|| Rub { impulse: size * rub.impulse, ..rub })
    }

    /// Gt: what the unit impulse of a contact changes its slip by, were each of its bodies split among all that press on it.
    fn yielding(&self, rub: &Rub) -> f32 {
        let view = self.view;
        let of_side = |id: u32| {
            let grip = rub.grip(view, id, rub.impulse);
            let single = |sphere: u32, share: f32| {
                let arm = if id == rub.a { rub.arms[0] } else { rub.arms[1] };
                let inverse_mass = view.inverse_mass(sphere) + arm * arm * view.mobility(sphere);
                self.pressing(sphere_rows(view, sphere)) * share * share * inverse_mass
            };
            let whole = |rod: u32| {
                let capsule = Capsule::of(view, view, rod);
                let [one, two] = capsule.ends;
                let (across, along) = couples(&capsule, &grip);
                let inverse_mass = 1.0 / capsule.mass
                    + across.length_squared() / capsule.inertia_across
                    + along.length_squared() / (capsule.inertia[0] + capsule.inertia[1]);
                self.pressing([one, two, view.step.spheres + rod].into_iter()) * inverse_mass
            };
            match view.object(id) {
                Object::Sphere(sphere) => match view.capsule_of(sphere) {
                    Some(rod) => whole(rod),
                    None => single(sphere, 1.0),
                },
                Object::Rod(rod) if view.is_capsule(rod) => whole(rod),
                Object::Rod(rod) => {
                    let [one, two] = view.rod(rod).ends;
                    single(one, 1.0 - grip.place) + single(two, grip.place)
                }
                Object::Cuboid(_) | Object::Polygon(_) => 0.0,
            }
        };
        of_side(rub.a) + of_side(rub.b)
    }

    /// N: how many contacts of these movers press.
    fn pressing(&self, rows: impl Iterator<Item = u32>) -> f32 {
        rows.map(|row| self.pressed[row as usize]).sum::<u32>() as f32
    }
}

impl Rub {
    /// What `impulse` on A does on the side of one of the two objects.
    fn grip(&self, view: &View, id: u32, impulse: Vec3) -> Grip {
        let couple = self.touch.normal.cross(impulse);
        let (push, couple, parameter) = if id == self.a {
            (impulse, self.arms[0] * couple, self.touch.a)
        } else {
            (-impulse, self.arms[1] * couple, self.touch.b)
        };
        let place = match view.object(id) {
            Object::Sphere(sphere) => {
                view.capsule_of(sphere).map_or(0.0, |rod| f32::from(u8::from(view.rod(rod).ends[1] == sphere)))
            }
            _ => parameter,
        };
        Grip { place, push, couple }
    }
}

/// The couple on a capsule about its centre, across and along its axis.
fn couples(capsule: &Capsule, grip: &Grip) -> (Vec3, Vec3) {
    let couple = capsule.torque(grip.place, grip.push) + grip.couple;
    let across = capsule.across(couple);
    (across, couple - across)
}

/// The contacts of a mover that press.
fn pressed<'a>(lists: &Lists<'a>, mover: u32) -> impl Iterator<Item = Entry> + use<'a> {
    lists.row(mover).filter(|entry| entry.word & ENTRY_OVERLAPS != 0)
}
