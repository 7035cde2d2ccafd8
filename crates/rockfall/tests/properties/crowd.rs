//! `handle_collisions` on random crowds (physics.md section 3).

use std::cell::Cell;

use proptest::prelude::*;
use rockfall::{Backend, ContactAction, Cuboid, Polygon, Scene, Simulation, Sphere, SphereState};

use crate::things::{Outcome, Thing, check, simulation, sums, thing, weightless};

/// A crowd so dense that many overlap many.
fn crowd(most: usize) -> impl Strategy<Value = Vec<Thing>> {
    (0.5_f32..2.0).prop_flat_map(move |spread| prop::collection::vec(thing(spread, 3.0), 2..most))
}

/// The spheres before and after the collisions, and how many there were.
fn collide(scene: Scene, backend: Backend) -> (Vec<SphereState>, Vec<SphereState>, usize) {
    let mut simulation = simulation(scene, backend);
    let before = simulation.spheres().unwrap();
    let collisions = impulses(&mut simulation);
    simulation.handle_collisions().unwrap();
    (before, simulation.spheres().unwrap(), collisions)
}

fn impulses(simulation: &mut Simulation) -> usize {
    let contacts = simulation.contacts().unwrap();
    let is_impulse = |action: &ContactAction| matches!(action, ContactAction::Impulse(_));
    contacts.iter().filter(|contact| is_impulse(&contact.action)).count()
}

/// Momentum and centre of mass stay, kinetic energy does not grow. Every sum is of f32 numbers that were rounded a few
/// times each: 2e-6 of the sizes added up is about sixteen units in the last place.
fn kept(things: &[Thing], restitution: f32, backend: Backend) -> Result<usize, TestCaseError> {
    let mut scene = weightless(things);
    scene.settings.restitution = restitution;
    let (before, after, collisions) = collide(scene, backend);
    let (was, is) = (sums(&before), sums(&after));
    let size = was.momentum_size + is.momentum_size;
    prop_assert!((is.momentum - was.momentum).length() <= 2e-6 * size, "{was:?} {is:?}");
    let size = was.centre_size + is.centre_size;
    prop_assert!((is.centre - was.centre).length() <= 2e-6 * size, "{was:?} {is:?}");
    prop_assert!(is.kinetic <= was.kinetic * (1.0 + 4e-6), "{was:?} {is:?}");
    prop_assert_eq!(
        after.iter().map(|sphere| sphere.angular_momentum).collect::<Vec<_>>(),
        before.iter().map(|sphere| sphere.angular_momentum).collect::<Vec<_>>()
    );
    Ok(collisions)
}

fn crowds_keep(backend: Backend, cases: u32, most: usize) {
    let collisions = Cell::new(0);
    check(cases, (crowd(most), 0.0_f32..=1.0), |(things, restitution)| -> Outcome {
        collisions.set(collisions.get() + kept(&things, restitution, backend)?);
        Ok(())
    });
    assert!(collisions.get() > 5 * cases as usize, "{} collisions prove little", collisions.get());
}

#[test]
fn crowds_keep_momentum_and_centre_of_mass_and_gain_no_energy() {
    crowds_keep(Backend::Cpu, 400, 24);
}

#[cfg(feature = "gpu")]
#[test]
fn crowds_keep_momentum_and_centre_of_mass_and_gain_no_energy_on_the_gpu() {
    crowds_keep(Backend::Gpu, 4, 40);
}

/// The one place where energy may be won is e > 1.
#[test]
fn a_restitution_above_one_adds_energy() {
    check(40, crowd(12), |things| -> Outcome {
        let mut scene = weightless(&things);
        scene.settings.restitution = 1.5;
        let (before, after, collisions) = collide(scene, Backend::Cpu);
        let (was, is) = (sums(&before).kinetic, sums(&after).kinetic);
        // Of one collision all the excess is left; of many weighted ones it may cancel.
        prop_assert!(collisions != 1 || is > was, "{was} {is}");
        Ok(())
    });
}

/// Against what stands still, energy does not grow either.
#[test]
fn crowds_gain_no_energy_from_what_is_static() {
    let lost = Cell::new(0);
    check(150, (crowd(16), 0.0_f32..=1.0), |(things, restitution)| -> Outcome {
        let mut scene = weightless(&things);
        scene.settings.restitution = restitution;
        scene.add_box(Cuboid::between((-1.0, -1.5, -1.0), (0.7, -0.1, 1.0))).unwrap();
        scene.add_polygon(Polygon::new((0.2, -2.0, -2.0), (0.0, 0.5, 4.0), (0.3, 4.0, 0.0))).unwrap();
        scene.add_sphere(Sphere::new((0.2, 0.6, 0.1), 0.5).fixed()).unwrap();
        let (before, after, _) = collide(scene, Backend::Cpu);
        let (was, is) = (sums(&before).kinetic, sums(&after).kinetic);
        lost.set(lost.get() + usize::from(is < 0.99 * was));
        prop_assert!(is <= was * (1.0 + 4e-6), "{was} {is}");
        Ok(())
    });
    assert!(lost.get() > 50);
}

/// The states of the spheres of each thing, whatever the order in which the things were added.
fn after_in_order(things: &[(usize, Thing)]) -> Vec<(usize, Vec<SphereState>)> {
    let mut scene = weightless(&[]);
    let ids: Vec<_> = things.iter().map(|(name, thing)| (*name, thing.add(&mut scene))).collect();
    let mut simulation = simulation(scene, Backend::Cpu);
    simulation.handle_collisions().unwrap();
    let mut all: Vec<_> =
        ids.into_iter().map(|(name, ids)| (name, ids.iter().map(|id| simulation.sphere(*id).unwrap()).collect())).collect();
    all.sort_by_key(|(name, _): &(usize, Vec<SphereState>)| *name);
    all
}

/// Sums are made in another order, so the last digits differ; the normal of two things that all but coincide has fewer
/// good digits than others. No decision may come out otherwise.
#[test]
fn the_order_of_addition_does_not_matter() {
    let shuffled = crowd(12).prop_flat_map(|things| {
        let named: Vec<_> = things.into_iter().enumerate().collect();
        (Just(named.clone()), Just(named).prop_shuffle())
    });
    check(200, shuffled, |(things, shuffled)| -> Outcome {
        for ((_, one), (_, other)) in after_in_order(&things).iter().zip(&after_in_order(&shuffled)) {
            for (a, b) in one.iter().zip(other) {
                prop_assert!(a.velocity.distance(b.velocity) < 1e-4, "{a:?} {b:?}");
                prop_assert!(a.position.distance(b.position) < 1e-5, "{a:?} {b:?}");
            }
        }
        Ok(())
    });
}
