//! Friction impulses of pressed contacts (docs/physics section 3.9). Each acts along the slip. It is as large
//! as needed to stop the slip, up to a limit that follows from the normal impulse and the normal force.
//!
//! All friction impulses are applied at once. The tangential inverse mass Gt of a contact counts every body as if it were split
//! evenly among the pressed contacts that touch it. Joining the parts again never adds energy.

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
use crate::physics::pairs::Surface;
use crate::physics::sides::sides;
use crate::physics::touch::{Touch, present_line};

/// Computes the friction impulses of a step from the state after its normal impulses.
pub(crate) struct FrictionImpulses<'a> {
    view: &'a View<'a>,
    lists: &'a Lists<'a>,
    impulses: &'a [Impulse],
    /// Number of pressed contacts in the list of each mover.
    pressed: Vec<u32>,
}

/// The friction impulse of a contact.
#[derive(Clone, Copy, Debug)]
struct FrictionImpulse {
    a: u32,
    b: u32,
    touch: Touch,
    /// Impulse on A. B gets the opposite.
    impulse: Vec3,
    arms: [f32; 2],
}

/// Impulse and torque that a friction impulse exerts on one side of its contact.
#[derive(Clone, Copy, Debug)]
struct Load {
    /// Parameter of the contact on a rod; 0 or 1 for an end sphere of a capsule; 0 for any other sphere.
    at: f32,
    impulse: Vec3,
    torque: Vec3,
}

impl<'a> FrictionImpulses<'a> {
    pub(crate) fn new(view: &'a View<'a>, lists: &'a Lists<'a>, impulses: &'a [Impulse]) -> Self {
        let movers = (0..view.step.movers()).into_par_iter().with_min_len(GRAIN);
        let pressed: Vec<u32> = movers.map(|mover| pressed(lists, mover).count() as u32).collect();
        Self { view, lists, impulses, pressed }
    }

    /// Returns the state of a sphere after the friction impulses of all its contacts.
    pub(crate) fn rubbed(&self, sphere: u32) -> Motion {
        let before = Motion::of(self.view, sphere);
        match Body::of(self.view, sphere) {
            None => before,
            Some(Body::Capsule(rod)) => self.end_after_friction(before, sphere, rod),
            Some(_) => self.sphere_after_friction(before, sphere),
        }
    }

    /// Returns the state of a single sphere, or of a sphere of a network. The correction of lengths removes the velocities
    /// along the rods of a network.
    fn sphere_after_friction(&self, before: Motion, sphere: u32) -> Motion {
        let view = self.view;
        let mut after = before;
        for row in sphere_rows(view, sphere) {
            for friction in pressed(self.lists, row).filter_map(|entry| self.friction_impulse(row, entry)) {
                let load = friction.load(view, row, friction.impulse);
                let share = match view.object(row) {
                    Object::Rod(rod) if view.rod(rod).ends[0] == sphere => 1.0 - load.at,
                    Object::Rod(_) => load.at,
                    _ => 1.0,
                };
                after.velocity += share * view.inverse_mass(sphere) * load.impulse;
                after.angular_momentum += share * load.torque;
            }
        }
        after
    }

    /// Returns the state of an end of a rigid capsule, which moves as one body.
    fn end_after_friction(&self, before: Motion, sphere: u32, rod: u32) -> Motion {
        let view = self.view;
        let capsule = Capsule::of(view, view, rod);
        let (mut velocity, mut spin, mut roll) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        Body::Capsule(rod).each_row(view, |row| {
            for friction in pressed(self.lists, row).filter_map(|entry| self.friction_impulse(row, entry)) {
                let load = friction.load(view, row, friction.impulse);
                let (across, along) = capsule_torques(&capsule, &load);
                velocity += load.impulse / capsule.mass;
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

    /// Returns the friction impulse of a pressed contact, or `None` when it has none.
    fn friction_impulse(&self, row: u32, entry: Entry) -> Option<FrictionImpulse> {
        let view = self.view;
        let (a, b) = view.ordered(row, entry.id());
        // The objects may be apart after their collision.
        let touch = present_line(view, a, b, entry.feature())?;
        let sides = sides(view, [a, b], &touch).map(|side| Sides::splat(&side));
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
        let key = (view.insertion_index(a), view.insertion_index(b), entry.feature());
        let normal_impulse = impulse_in(self.impulses, key).map_or(0.0, |known| known.size);
        let surface = Surface::of(view, a, b);
        let mut limit = surface.collision_friction * normal_impulse;
        if surface.coulomb_friction > 0.0 && touch.overlap > 0.0 {
            let force = normal_forces(view.step, of_a, of_b, overlap, &approach).max(Vec4::ZERO).x;
            limit += surface.coulomb_friction * view.step.constants.dt * force;
        }
        let unit = FrictionImpulse { a, b, touch, impulse: t / speed, arms: arms.map(|arm| arm.x) };
        let size = limit.min(speed / self.slip_inverse_mass(&unit));
        (size > 0.0).then(|| FrictionImpulse { impulse: size * unit.impulse, ..unit })
    }

    /// Gt: the change of slip by a unit impulse, with each body split among the pressed contacts that touch it.
    fn slip_inverse_mass(&self, unit: &FrictionImpulse) -> f32 {
        let view = self.view;
        let of_side = |id: u32| {
            let load = unit.load(view, id, unit.impulse);
            let single = |sphere: u32, share: f32| {
                let arm = if id == unit.a { unit.arms[0] } else { unit.arms[1] };
                let inverse_mass = view.inverse_mass(sphere) + arm * arm * view.mobility(sphere);
                self.pressed_count(sphere_rows(view, sphere)) * share * share * inverse_mass
            };
            let rigid_capsule = |rod: u32| {
                let capsule = Capsule::of(view, view, rod);
                let [one, two] = capsule.ends;
                let (across, along) = capsule_torques(&capsule, &load);
                let inverse_mass = 1.0 / capsule.mass
                    + across.length_squared() / capsule.inertia_across
                    + along.length_squared() / (capsule.inertia[0] + capsule.inertia[1]);
                self.pressed_count([one, two, view.step.layout.spheres + rod].into_iter()) * inverse_mass
            };
            match view.object(id) {
                Object::Sphere(sphere) => match view.capsule_of(sphere) {
                    Some(rod) => rigid_capsule(rod),
                    None => single(sphere, 1.0),
                },
                Object::Rod(rod) if view.is_capsule(rod) => rigid_capsule(rod),
                Object::Rod(rod) => {
                    let [one, two] = view.rod(rod).ends;
                    single(one, 1.0 - load.at) + single(two, load.at)
                }
                Object::Cuboid(_) | Object::Polygon(_) => 0.0,
            }
        };
        of_side(unit.a) + of_side(unit.b)
    }

    /// N: the number of pressed contacts of these movers.
    fn pressed_count(&self, rows: impl Iterator<Item = u32>) -> f32 {
        rows.map(|row| self.pressed[row as usize]).sum::<u32>() as f32
    }
}

impl FrictionImpulse {
    /// Returns what `impulse` on A exerts on the side of object `id`, which is A or B.
    fn load(&self, view: &View, id: u32, impulse: Vec3) -> Load {
        let torque = self.touch.normal.cross(impulse);
        let (impulse, torque, parameter) = if id == self.a {
            (impulse, self.arms[0] * torque, self.touch.a)
        } else {
            (-impulse, self.arms[1] * torque, self.touch.b)
        };
        let at = match view.object(id) {
            Object::Sphere(sphere) => {
                view.capsule_of(sphere).map_or(0.0, |rod| f32::from(u8::from(view.rod(rod).ends[1] == sphere)))
            }
            _ => parameter,
        };
        Load { at, impulse, torque }
    }
}

/// Returns the torque on a capsule about its centre of mass: the part across its axis and the part along it.
fn capsule_torques(capsule: &Capsule, load: &Load) -> (Vec3, Vec3) {
    let torque = capsule.torque(load.at, load.impulse) + load.torque;
    let across = capsule.across(torque);
    (across, torque - across)
}

/// The pressed contacts in the list of a mover.
fn pressed<'a>(lists: &Lists<'a>, mover: u32) -> impl Iterator<Item = Entry> + use<'a> {
    lists.row(mover).filter(|entry| entry.word & ENTRY_OVERLAPS != 0)
}
