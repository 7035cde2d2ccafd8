//! Contacts and diagnostics of the current state, for finding out why a body behaves as it does.
//!
//! They are computed on a copy of the state ([`Simulation::observed`]).

use glam::Vec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::model::impulse::Impulse;
use crate::model::layout::{ENTRY_COLLIDES, FLAG_COLLISIONS, GRAIN, LAW_THESIS};
use crate::model::lists::{Entry, Lists};
use crate::model::view::{Object, View};
use crate::model::world::World;
use crate::physics::chain::touch;
use crate::physics::collision::Collision;
use crate::physics::collision::all::{impulse_in, solve};
use crate::physics::contact::{collision_velocity, contact_force};
use crate::physics::forces::sphere_rates;
use crate::physics::laws::before::spring_before;
use crate::physics::laws::contact::{LawForce, law_force, normal_energy};
use crate::physics::laws::history::Histories;
use crate::physics::laws::neck::contact;
use crate::physics::side::{Side, side};
use crate::physics::sides::sides;
use crate::physics::surface::visible_row;
use crate::physics::touch::Touch;
use crate::scene::{Body, Scene};
use crate::simulation::Simulation;
use crate::simulation::contact_springs::ContactSprings;
use crate::simulation::observed::{Detail, view_and_lists};

/// Effect of a contact on its body B. Body A receives the opposite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ContactAction {
    /// The normal impulse that the next collision phase applies, in mass units/s, if the bodies approach fast. It is along the
    /// normal at the time of contact if no other contact touches the bodies. It is zero if the impulses of other contacts
    /// already separate the bodies.
    Impulse(Vec3),
    /// A contact force with friction, in mass units/s². It is zero if the contact is too new or the bodies separate fast.
    /// Friction impulses (`coulomb_friction`) are not included.
    Force(Vec3),
}

/// Two bodies that overlap, or that a neck connects.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Contact {
    /// The first body, in the order spheres, rods, boxes, polygons.
    pub a: Body,
    /// The other body.
    pub b: Body,
    /// The contact point, in units: in the middle of the overlap, or on the surface of a static body.
    pub point: Vec3,
    /// Unit normal from A to B.
    pub normal: Vec3,
    /// Overlap depth, in units. It is negative, the distance of the bodies, where a neck connects bodies that are apart
    /// ([`CohesionModel::Jkr`](crate::CohesionModel::Jkr)).
    pub overlap: f32,
    /// Effect of the contact.
    pub action: ContactAction,
    /// The springs of the contact; `None` with the thesis's law and in a collision.
    pub springs: Option<ContactSprings>,
}

/// Diagnostics of a sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SphereDiagnostics {
    /// Number of contacts of the sphere itself, without those of its rods.
    pub contacts: u32,
    /// Net force including gravity, in mass units/s²; 0 for a fixed sphere.
    pub net_force: Vec3,
    /// Deepest overlap, in units; 0 without contacts.
    pub deepest_overlap: f32,
}

/// The deepest overlaps of a state, measured in units and in radii.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MaxOverlap {
    /// The deepest overlap, in units; 0 without contacts.
    pub units: f32,
    /// The largest ratio of an overlap to the smaller radius of its two bodies. The radius of a rod is that of its surface. Boxes
    /// and polygons have no radius, so the radius of the other body counts. 0 without contacts.
    pub radii: f32,
    /// The two bodies with the overlap `radii`, in the order spheres, rods, boxes, polygons; `None` without contacts.
    pub bodies: Option<[Body; 2]>,
}

impl Simulation {
    /// The deepest overlaps of the current state, over all pairs that touch and of which at least one can move.
    ///
    /// [`Report::max_overlap`](crate::Report::max_overlap) is the deepest overlap at the beginning of the last step.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn max_overlap(&mut self) -> Result<MaxOverlap> {
        if self.has_frames() {
            return self.rigid_overlap(false);
        }
        let (scene, world) = self.observed(Detail::Pairs)?;
        Ok(deepest(scene, world, |_, _, _, _| true))
    }

    /// Like [`Simulation::max_overlap`], over the contacts of bodies at rest: both are slower than the velocity above which they
    /// would collide (docs/physics section 3.1), or with the law `rigid` than what the field gives in a frame, and the contact exerts a
    /// force. A fast body may overlap another one for a step or two, as deep as it moves within a step.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn resting_overlap(&mut self) -> Result<MaxOverlap> {
        if self.has_frames() {
            return self.rigid_overlap(true);
        }
        let (scene, world) = self.observed(Detail::Collisions)?;
        let (_, lists) = view_and_lists(world);
        Ok(deepest(scene, world, |view, mover, entry, touch| {
            let [a, b] = [mover, entry.id()];
            let sides = sides(view, [a, b], touch);
            let threshold = collision_velocity(view.step, &sides[0], &sides[1]);
            let rests = sides.iter().all(|side| side.inverse_mass == 0.0 || side.velocity.length() <= threshold);
            let has_force =
                || view.step.layout.law != LAW_THESIS || contact_force(view, &lists, [a, b], touch).force != Vec3::ZERO;
            rests && entry.word & ENTRY_COLLIDES == 0 && has_force()
        }))
    }

    /// All contacts of the current state, with the force or impulse that each exerts at the beginning of the next step.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn contacts(&mut self) -> Result<Vec<Contact>> {
        if self.has_frames() {
            return self.rigid_contacts();
        }
        let (scene, world) = self.observed(Detail::Springs)?;
        let (view, lists) = view_and_lists(world);
        // Forces take the velocities of the integrator.
        let impulses = solve(&view.in_collisions(), &lists).impulses;
        let impulses = impulses.as_slice();
        let histories = Histories::of(world);
        let movers = 0..world.movers();
        let found: Vec<(Collision, ContactAction, Option<ContactSprings>)> = movers
            .into_par_iter()
            .flat_map_iter(|mover| {
                let own = visible_row(&view, &lists, mover).filter(move |entry| entry.id() > mover);
                own.filter_map(move |entry| action(&view, &lists, histories, impulses, mover, entry))
            })
            .collect();
        Ok(found
            .into_iter()
            .map(|(collision, action, springs)| Contact {
                a: body(scene, &view, collision.a),
                b: body(scene, &view, collision.b),
                point: contact_point(&view, &collision),
                normal: collision.touch.normal,
                overlap: collision.touch.overlap,
                action,
                springs,
            })
            .collect())
    }

    /// Number of contacts, net force and deepest overlap in the current state: one element per sphere, in order of addition.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn diagnostics(&mut self) -> Result<Vec<SphereDiagnostics>> {
        if self.has_frames() {
            return self.rigid_diagnostics();
        }
        let (_, world) = self.observed(Detail::Forces)?;
        let (view, lists) = view_and_lists(world);
        let histories = Histories::of(world);
        let of_sphere = |sphere: u32| {
            let mut values = SphereDiagnostics::default();
            for entry in visible_row(&view, &lists, sphere) {
                let (a, b) = (sphere.min(entry.id()), sphere.max(entry.id()));
                if let Some(touch) = contact(&view, &histories, a, b, entry.feature()) {
                    values.contacts += 1;
                    values.deepest_overlap = values.deepest_overlap.max(touch.overlap);
                }
            }
            if !view.is_fixed(sphere) {
                values.net_force = sphere_rates(&view, &world.wrenches, sphere).acceleration / view.inverse_mass(sphere);
            }
            values
        };
        Ok((0..world.step.layout.spheres).into_par_iter().map(of_sphere).collect())
    }

    /// Elastic energy of all contacts: sum of Cc m* o² / 2, or that of the normal forces of a law with history.
    pub(super) fn contact_energy(&mut self) -> Result<f64> {
        if self.has_frames() {
            // The caller reads the states of the bodies.
            self.sync()?;
            return Ok(0.0);
        }
        let (_, world) = self.observed(Detail::Pairs)?;
        let (view, lists) = view_and_lists(world);
        let stiffness = f64::from(world.step.constants.contact_force);
        let histories = Histories::of(world);
        let of_mover = |mover: u32| -> f64 {
            let own = visible_row(&view, &lists, mover).filter(|entry| entry.id() > mover);
            own.filter_map(|entry| {
                let touch = contact(&view, &histories, mover, entry.id(), entry.feature())?;
                if view.step.layout.law != LAW_THESIS {
                    let spring = histories.spring(&view, mover, entry.id(), entry.feature());
                    if spring.is_some_and(|spring| spring.is_passage()) {
                        return None;
                    }
                    return Some(normal_energy(&view, mover, entry.id(), &touch));
                }
                let inverse_mass = |side: &Side| f64::from(side.inverse_mass);
                let reduced_mass = 1.0 / sides(&view, [mover, entry.id()], &touch).iter().map(inverse_mass).sum::<f64>();
                Some(0.5 * stiffness * reduced_mass * f64::from(touch.overlap).powi(2))
            })
            .sum()
        };
        // The parts are collected before summing, so that the sum does not depend on the number of threads.
        let parts: Vec<f64> = (0..world.movers()).into_par_iter().with_min_len(GRAIN).map(of_mover).collect();
        Ok(parts.iter().sum())
    }
}

pub(crate) fn body(scene: &Scene, view: &View, id: u32) -> Body {
    match view.object(id) {
        Object::Sphere(sphere) => Body::Sphere(scene.spheres.handle_at(sphere as usize)),
        Object::Rod(rod) => Body::Rod(scene.rods.handle_at(rod as usize)),
        Object::Cuboid(cuboid) => Body::Box(scene.boxes.handle_at(cuboid as usize)),
        Object::Polygon(polygon) => Body::Polygon(scene.polygons.handle_at(polygon as usize)),
    }
}

/// The deepest overlaps of the contacts for which `counts` is true.
fn deepest(scene: &Scene, world: &World, counts: impl Fn(&View, u32, Entry, &Touch) -> bool + Sync) -> MaxOverlap {
    let (view, lists) = view_and_lists(world);
    let of_mover = |mover: u32| {
        let own = visible_row(&view, &lists, mover).filter(|entry| entry.id() > mover);
        own.fold((0.0, 0.0, [0; 2]), |(units, radii, ids): (f32, f32, [u32; 2]), entry| {
            let touch = touch(&view, mover, entry.id(), entry.feature()).filter(|touch| counts(&view, mover, entry, touch));
            let Some(touch) = touch else { return (units, radii, ids) };
            let ratio = touch.overlap / smaller_radius(&view, mover, entry.id());
            let units = units.max(touch.overlap);
            if ratio > radii { (units, ratio, [mover, entry.id()]) } else { (units, radii, ids) }
        })
    };
    // The first of equal overlaps counts, so the result does not depend on the number of threads.
    let all: Vec<_> = (0..world.movers()).into_par_iter().with_min_len(GRAIN).map(of_mover).collect();
    let mut most = MaxOverlap::default();
    for (units, radii, ids) in all {
        most.units = most.units.max(units);
        if radii > most.radii {
            (most.radii, most.bodies) = (radii, Some(ids.map(|id| body(scene, &view, id))));
        }
    }
    most
}

/// The smaller radius of two objects of which at least one is a sphere or a rod.
pub(crate) fn smaller_radius(view: &View, a: u32, b: u32) -> f32 {
    let radius = |id| side(view, view.object(id), 0.0).radius.unwrap_or(f32::INFINITY);
    radius(a).min(radius(b))
}

/// Effect of the contact of a list entry at the beginning of the next step.
fn action(
    view: &View,
    lists: &Lists,
    histories: Histories,
    impulses: &[Impulse],
    mover: u32,
    entry: Entry,
) -> Option<(Collision, ContactAction, Option<ContactSprings>)> {
    let (a, b) = view.ordered(mover, entry.id());
    let touch = contact(view, &histories, a, b, entry.feature())?;
    let collision = Collision::with_touch(view, [a, b], entry.feature(), touch);
    // With a law that has no impulses, the force acts in collisions too.
    let has_impulses = view.step.layout.law == LAW_THESIS || view.step.constants.flags & FLAG_COLLISIONS != 0;
    if entry.word & ENTRY_COLLIDES != 0 && has_impulses {
        let impulse = impulse_in(impulses, collision.key(view)).map_or(Vec3::ZERO, |known| known.size * known.direction);
        return Some((collision, ContactAction::Impulse(impulse), None));
    }
    let Collision { a, b, feature, touch, .. } = &collision;
    if view.step.layout.law == LAW_THESIS {
        let force = contact_force(view, lists, [*a, *b], touch).force;
        return Some((collision, ContactAction::Force(-force), None));
    }
    let before = spring_before(view, &histories, [*a, *b], *feature, touch);
    let LawForce { loads, spring, slips } = law_force(view, [*a, *b], touch, before);
    let springs = ContactSprings { displacement: spring.shift, moment: -spring.moment, slips };
    Some((collision, ContactAction::Force(-loads.force), Some(springs)))
}

/// The point at the end of A's arm: from A's centre or axis along the normal.
fn contact_point(view: &View, collision: &Collision) -> Vec3 {
    let (touch, static_b) = (&collision.touch, collision.b >= view.step.layout.spheres + view.step.layout.rods);
    let shared = if static_b { touch.overlap } else { 0.5 * touch.overlap };
    let (centre, radius) = match view.object(collision.a) {
        Object::Rod(rod) => {
            let rod = view.rod(rod);
            let [one, two] = rod.ends.map(|end| view.position(end));
            (one.lerp(two, touch.a), rod.radius)
        }
        Object::Sphere(sphere) => (view.position(sphere), view.radius(sphere)),
        Object::Cuboid(_) | Object::Polygon(_) => (Vec3::ZERO, 0.0),
    };
    centre + (radius - shared) * touch.normal
}
