//! `handle_collisions` on random crowds (docs/physics section 3).

use std::cell::Cell;

use proptest::prelude::*;
use rockfall::{Backend, ContactAction, Cuboid, Polygon, Rod, Scene, Simulation, Sphere, SphereState};

use super::things::{Outcome, Thing, ball, check, simulation, sums, thing, vector, weightless};

/// A crowd so dense that many bodies overlap many others.
fn crowd(most: usize) -> impl Strategy<Value = Vec<Thing>> {
    (0.5_f32..2.0).prop_flat_map(move |spread| prop::collection::vec(thing(spread, 3.0), 2..most))
}

/// The scene with rigid motions. A random state need not be one of rigid bodies: here the ends of rods of fixed length
/// get no relative velocity along the rod, and the ends of a capsule get a common spin. Not for frames: after so short
/// a step, the rounding errors of their lengths would be left in their velocities.
fn with_rigid_motions(scene: Scene) -> Scene {
    let settings = scene.settings;
    let mut simulation = simulation(scene, Backend::Cpu);
    let forceless = settings.with(|settings| {
        settings.contact_force = 0.0;
        settings.contact_damping = 0.0;
        settings.friction = 0.0;
        settings.coulomb_friction = 0.0;
    });
    simulation
        .set_settings(forceless.with(|settings| {
            settings.collisions = false;
            settings.collision_friction = 0.0;
        }))
        .unwrap();
    // Several steps, because the initial motion may be far from rigid.
    simulation.run(3, 1e-6).unwrap();
    simulation.set_settings(settings).unwrap();
    simulation.sync().unwrap().clone()
}

/// The spheres before and after the collisions, and the number of collisions.
fn collide(scene: Scene, backend: Backend) -> (Vec<SphereState>, Vec<SphereState>, usize) {
    let mut simulation = simulation(scene, backend);
    let before = simulation.spheres().unwrap();
    let collisions = count_impulses(&mut simulation);
    simulation.handle_collisions().unwrap();
    (before, simulation.spheres().unwrap(), collisions)
}

fn count_impulses(simulation: &mut Simulation) -> usize {
    let contacts = simulation.contacts().unwrap();
    let is_impulse = |action: &ContactAction| matches!(action, ContactAction::Impulse(_));
    contacts.iter().filter(|contact| is_impulse(&contact.action)).count()
}

/// Asserts that momentum, centre of mass and angular momentum are constant and that energy does not grow. Returns the
/// number of collisions. Every sum is of f32 numbers that were rounded a few times each: 2e-6 of the sum of magnitudes
/// is about sixteen units in the last place.
fn assert_conserved(scene: Scene, backend: Backend) -> Result<usize, TestCaseError> {
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

fn scene_of(things: &[Thing], restitution: f32, friction: f32) -> Scene {
    let mut scene = weightless(things);
    (scene.settings.restitution, scene.settings.collision_friction) = (restitution, friction);
    scene
}

fn assert_crowds_conserve(backend: Backend, cases: u32, most: usize) {
    let collisions = Cell::new(0);
    check(cases, (crowd(most), 0.0_f32..=1.0), |(things, restitution)| -> Outcome {
        collisions.set(collisions.get() + assert_conserved(with_rigid_motions(scene_of(&things, restitution, 0.0)), backend)?);
        Ok(())
    });
    assert!(collisions.get() > 5 * cases as usize, "only {} collisions", collisions.get());
}

#[test]
fn crowds_keep_momentum_and_centre_of_mass_and_gain_no_energy() {
    assert_crowds_conserve(Backend::Cpu, 400, 24);
}

#[cfg(feature = "gpu")]
#[test]
fn crowds_keep_momentum_and_centre_of_mass_and_gain_no_energy_on_the_gpu() {
    assert_crowds_conserve(Backend::Gpu, 4, 40);
}

/// The same with friction impulses. Those of a pair are opposite and act at one point.
#[test]
fn crowds_with_friction_gain_no_energy() {
    let settings = (0.0_f32..=1.0, 0.05_f32..2.0, prop::sample::select(vec![0.0_f32, 0.5]));
    check(300, (crowd(24), settings), |(things, (restitution, friction, coulomb))| -> Outcome {
        let mut scene = with_rigid_motions(scene_of(&things, restitution, friction));
        scene.settings.coulomb_friction = coulomb;
        assert_conserved(with_rigid_motions(scene), Backend::Cpu).map(drop)
    });
}

/// Spheres connected by rods of fixed length that move as one body: a chain, or a frame in which each sphere is
/// connected to the three before it.
fn network() -> impl Strategy<Value = (Vec<Sphere>, bool)> {
    let balls = prop::collection::vec(ball(0.8, 2.0), 3..6);
    (balls, vector(2.0), vector(3.0), any::<bool>()).prop_map(|(balls, velocity, spin, is_chain)| {
        let rigid = |mut ball: Sphere| {
            ball.radius = 0.15;
            ball.velocity(velocity + spin.cross(ball.position))
        };
        (balls.into_iter().map(rigid).collect(), is_chain)
    })
}

/// The same with chains and frames that loose bodies hit. Friction impulses treat the spheres of a network as single spheres.
#[test]
fn crowds_with_frames_gain_no_energy() {
    let collisions = Cell::new(0);
    check(200, (network(), crowd(8), 0.0_f32..=1.0), |((balls, is_chain), things, restitution)| -> Outcome {
        let mut scene = with_rigid_motions(scene_of(&things, restitution, 0.0));
        let ids: Vec<_> = balls.iter().map(|ball| scene.add_sphere(*ball).unwrap()).collect();
        for end in 1..ids.len() {
            for other in if is_chain { end - 1..end } else { end.saturating_sub(3)..end } {
                let length = balls[end].position.distance(balls[other].position);
                if length > 0.2 {
                    scene.add_rod(Rod::new(ids[other], ids[end], 0.05).length(length)).unwrap();
                }
            }
        }
        collisions.set(collisions.get() + assert_conserved(scene, Backend::Cpu)?);
        Ok(())
    });
    // Frames are rigid bodies, whose contacts are forces and no collisions.
    assert!(collisions.get() > 200, "only {} collisions", collisions.get());
}

/// Collisions with static objects do not add energy either.
#[test]
fn crowds_gain_no_energy_from_static_objects() {
    let lost = Cell::new(0);
    let friction = prop::sample::select(vec![0.0_f32, 0.5]);
    check(300, (crowd(16), 0.0_f32..=1.0, friction), |(things, restitution, friction)| -> Outcome {
        let mut scene = with_rigid_motions(scene_of(&things, restitution, friction));
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

/// The spheres of each body after phase 3, sorted by the body's number.
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

/// In another order the sums round differently, so the last digits differ. The normal of two bodies that almost
/// coincide has fewer accurate digits. No decision may differ.
#[test]
fn the_insertion_order_does_not_matter() {
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
