//! `handle_collisions` on random crowds (docs/physics.md section 3).

use std::cell::Cell;

use proptest::prelude::*;
use rockfall::{Backend, ContactAction, Cuboid, Polygon, Rod, Scene, Settings, Simulation, Sphere, SphereState};

use crate::things::{Outcome, Thing, ball, check, simulation, sums, thing, vector, weightless};

/// A crowd so dense that many overlap many.
fn crowd(most: usize) -> impl Strategy<Value = Vec<Thing>> {
    (0.5_f32..2.0).prop_flat_map(move |spread| prop::collection::vec(thing(spread, 3.0), 2..most))
}

/// The scene with bodies made rigid, for a random state need not be that of one: the ends of a rod of fixed length do not part, both ends of a
/// capsule turn as one. Not for frames: in a step so short they would be left with the rounding of their lengths in their velocities.
fn settled(scene: Scene) -> Scene {
    let settings = scene.settings;
    let mut simulation = simulation(scene, Backend::Cpu);
    let forceless = Settings { contact_force: 0.0, contact_damping: 0.0, friction: 0.0, coulomb_friction: 0.0, ..settings };
    simulation.set_settings(Settings { collisions: false, collision_friction: 0.0, ..forceless }).unwrap();
    // Again and again: what was given may be far from rigid.
    simulation.run(3, 1e-6).unwrap();
    simulation.set_settings(settings).unwrap();
    simulation.sync().unwrap().clone()
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

/// Momentum, centre of mass and angular momentum stay, energy does not grow. Every sum is of f32 numbers that were rounded a few
/// times each: 2e-6 of the sizes added up is about sixteen units in the last place.
fn kept(scene: Scene, backend: Backend) -> Result<usize, TestCaseError> {
    let (before, after, collisions) = collide(scene, backend);
    let (was, is) = (sums(&before), sums(&after));
    let size = was.momentum_size + is.momentum_size;
    prop_assert!((is.momentum - was.momentum).length() <= 2e-6 * size, "{was:?} {is:?}");
    let size = was.centre_size + is.centre_size;
    prop_assert!((is.centre - was.centre).length() <= 2e-6 * size, "{was:?} {is:?}");
    let size = was.angular_size + is.angular_size;
    prop_assert!((is.angular - was.angular).length() <= 4e-6 * size, "{was:?} {is:?}");
    prop_assert!(is.energy <= was.energy * (1.0 + 4e-6), "{was:?} {is:?}");
    Ok(collisions)
}

fn of_things(things: &[Thing], restitution: f32, friction: f32) -> Scene {
    let mut scene = weightless(things);
    (scene.settings.restitution, scene.settings.collision_friction) = (restitution, friction);
    scene
}

fn crowds_keep(backend: Backend, cases: u32, most: usize) {
    let collisions = Cell::new(0);
    check(cases, (crowd(most), 0.0_f32..=1.0), |(things, restitution)| -> Outcome {
        collisions.set(collisions.get() + kept(settled(of_things(&things, restitution, 0.0)), backend)?);
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

/// The same with friction impulses: those of pairs are opposite and meet in one point.
#[test]
fn crowds_with_friction_gain_no_energy() {
    let settings = (0.0_f32..=1.0, 0.05_f32..2.0, prop::sample::select(vec![0.0_f32, 0.5]));
    check(300, (crowd(24), settings), |(things, (restitution, friction, coulomb))| -> Outcome {
        let mut scene = settled(of_things(&things, restitution, friction));
        scene.settings.coulomb_friction = coulomb;
        kept(settled(scene), Backend::Cpu).map(drop)
    });
}

/// Spheres joined by rods of fixed length, which move as one: a chain, or a frame where each of them is joined to the three before it.
fn network() -> impl Strategy<Value = (Vec<Sphere>, bool)> {
    let balls = prop::collection::vec(ball(0.8, 2.0), 3..6);
    (balls, vector(2.0), vector(3.0), any::<bool>()).prop_map(|(balls, velocity, spin, is_chain)| {
        let rigid = |ball: Sphere| Sphere { radius: 0.15, velocity: velocity + spin.cross(ball.position), ..ball };
        (balls.into_iter().map(rigid).collect(), is_chain)
    })
}

/// The same with networks, which loose things hit; friction impulses on them are worked out as if they were loose, too.
#[test]
fn crowds_with_frames_gain_no_energy() {
    let collisions = Cell::new(0);
    check(200, (network(), crowd(8), 0.0_f32..=1.0), |((balls, is_chain), things, restitution)| -> Outcome {
        let mut scene = settled(of_things(&things, restitution, 0.0));
        let ids: Vec<_> = balls.iter().map(|ball| scene.add_sphere(*ball).unwrap()).collect();
        for end in 1..ids.len() {
            for other in if is_chain { end - 1..end } else { end.saturating_sub(3)..end } {
                let length = balls[end].position.distance(balls[other].position);
                if length > 0.2 {
                    scene.add_rod(Rod::new(ids[other], ids[end], 0.05).length(length)).unwrap();
                }
            }
        }
        collisions.set(collisions.get() + kept(scene, Backend::Cpu)?);
        Ok(())
    });
    assert!(collisions.get() > 500, "{} collisions prove little", collisions.get());
}

/// The one place where energy may be won is e > 1.
#[test]
fn a_restitution_above_one_adds_energy() {
    check(40, crowd(12), |things| -> Outcome {
        let mut scene = settled(weightless(&things));
        scene.settings.restitution = 1.5;
        let (before, after, collisions) = collide(scene, Backend::Cpu);
        let (was, is) = (sums(&before).energy, sums(&after).energy);
        // Of one collision all the excess is left; of many weighted ones it may cancel.
        prop_assert!(collisions != 1 || is > was, "{was} {is}");
        Ok(())
    });
}

/// Against what stands still, energy does not grow either.
#[test]
fn crowds_gain_no_energy_from_what_is_static() {
    let lost = Cell::new(0);
    let friction = prop::sample::select(vec![0.0_f32, 0.5]);
    check(300, (crowd(16), 0.0_f32..=1.0, friction), |(things, restitution, friction)| -> Outcome {
        let mut scene = settled(of_things(&things, restitution, friction));
        scene.add_box(Cuboid::between((-1.0, -1.5, -1.0), (0.7, -0.1, 1.0))).unwrap();
        scene.add_polygon(Polygon::new((0.2, -2.0, -2.0), (0.0, 0.5, 4.0), (0.3, 4.0, 0.0))).unwrap();
        scene.add_sphere(Sphere::new((0.2, 0.6, 0.1), 0.5).fixed()).unwrap();
        let (before, after, _) = collide(scene, Backend::Cpu);
        let (was, is) = (sums(&before).energy, sums(&after).energy);
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
