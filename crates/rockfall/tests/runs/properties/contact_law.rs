//! Contact forces between two bodies and against static objects (docs/physics section 4), springs, free capsules,
//! and one-sided polygons.

use std::cell::Cell;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use rockfall::{Backend, Cuboid, Integrator, Options, Polygon, Simulation, Sphere, Spring};

use super::things::{Outcome, Thing, ball, capsule, check, direction, rod, simulation, sums, vector, weightless};

const DT: f32 = 0.001;
const STEPS: u64 = 40;

/// Two bodies whose centres are so close that they overlap. The first one is centred at the origin.
fn pair(one: impl Strategy<Value = Thing>, other: impl Strategy<Value = Thing>) -> impl Strategy<Value = [Thing; 2]> {
    (one, other, direction(), 0.05_f32..0.3).prop_map(|(one, other, direction, apart)| {
        let centre = |thing: &Thing| {
            let scene = weightless(std::slice::from_ref(thing));
            let places = scene.spheres().iter().map(|sphere| sphere.position);
            places.sum::<Vec3>() / scene.spheres().len() as f32
        };
        let to = |thing: Thing, place: Vec3| {
            let shift = place - centre(&thing);
            thing.map(|mut sphere| {
                sphere.position += shift;
                sphere
            })
        };
        [to(one, Vec3::ZERO), to(other, apart * direction)]
    })
}

/// Asserts that the angular momentum of a pair is constant. The arms of a contact end in one point, so forces and
/// torques cancel exactly in every stage state. What remains is the error of RK4 and rounding. Angular momentum is a
/// quadratic invariant, so the error of RK4 is (w dt)^5 with w = sqrt(Cc) = 32/s and dt = 1 ms, 3e-8 per step, and more
/// in a step in which a contact ends. Rounding is a few units in the last place in each of 40 steps.
fn assert_constant_angular_momentum(kind: &str, pairs: impl Strategy<Value = [Thing; 2]>) {
    let (touching, spun) = (Cell::new(0), Cell::new(0));
    check(40, pairs, |things| -> Outcome {
        let mut scene = weightless(&things);
        scene.settings.collisions = false;
        let mut simulation = simulation(scene, Backend::Cpu);
        let before = simulation.spheres().unwrap();
        touching.set(touching.get() + usize::from(!simulation.contacts().unwrap().is_empty()));
        simulation.run(STEPS, DT).unwrap();
        let after = simulation.spheres().unwrap();
        let (was, is) = (sums(&before), sums(&after));
        let size = was.angular_size + is.angular_size;
        prop_assert!((is.angular - was.angular).length() < 1e-4 * size, "{was:?} {is:?}");
        let size = was.momentum_size + is.momentum_size;
        prop_assert!((is.momentum - was.momentum).length() < 1e-5 * size, "{was:?} {is:?}");
        let turned = before.iter().zip(&after).any(|(a, b)| a.angular_momentum.distance(b.angular_momentum) > 1e-3);
        spun.set(spun.get() + usize::from(turned));
        Ok(())
    });
    // Without pairs that touch and spins that change, the test would prove nothing.
    assert!(touching.get() >= 30 && spun.get() >= 30, "{kind}: {} {}", touching.get(), spun.get());
}

fn sphere() -> impl Strategy<Value = Thing> {
    ball(0.1, 1.0).prop_map(Thing::Sphere)
}

#[test]
fn pairs_with_friction_keep_their_angular_momentum() {
    assert_constant_angular_momentum("sphere-sphere", pair(sphere(), sphere()));
    assert_constant_angular_momentum("sphere-rod", pair(sphere(), rod(0.1, 1.0, false)));
    assert_constant_angular_momentum("sphere-fixed rod", pair(sphere(), rod(0.1, 1.0, true)));
    assert_constant_angular_momentum("rod-rod", pair(rod(0.1, 1.0, false), rod(0.1, 1.0, false)));
    assert_constant_angular_momentum("fixed rods", pair(rod(0.1, 1.0, true), rod(0.1, 1.0, true)));
    assert_constant_angular_momentum("sphere-capsule", pair(sphere(), capsule(0.1, 1.0)));
    assert_constant_angular_momentum("capsule-rod", pair(capsule(0.1, 1.0), rod(0.1, 1.0, false)));
    assert_constant_angular_momentum("capsule-capsule", pair(capsule(0.1, 1.0), capsule(0.1, 1.0)));
}

/// Compares one step of symplectic Euler without gravity with the contact law. The sphere touches a static wall; `n` is
/// the unit normal into the wall.
fn assert_contact_law_at_wall(sphere: Sphere, overlap: f32, n: Vec3, mut simulation: Simulation) -> Outcome {
    let settings = *simulation.settings();
    simulation.step(DT).unwrap();
    let after = simulation.spheres().unwrap()[0];
    let (m, o, n) = (f64::from(sphere.mass), f64::from(overlap), n.as_dvec3());
    let arm = f64::from(sphere.radius) - o;
    let v = sphere.velocity.as_dvec3();
    let spin = sphere.angular_momentum.as_dvec3() / (0.4 * m * f64::from(sphere.radius).powi(2));
    // The wall is at rest, so the slip is minus the tangential velocity of the sphere's surface.
    let surface = v + spin.cross(arm * n);
    let t = -(surface - n * surface.dot(n));
    let strength = f64::from(settings.contact_force) * o + f64::from(settings.contact_damping) * v.dot(n);
    let normal = strength.max(0.0) * m;
    let dt = f64::from(DT);
    // Inverse mass of the slip: 1/m + s^2 / I.
    let slipping = 1.0 / m + arm * arm / (0.4 * m * f64::from(sphere.radius).powi(2));
    let size = if settings.coulomb_friction > 0.0 {
        // An impulse, applied before the contact force. It removes the whole slip where the limit allows.
        (f64::from(settings.coulomb_friction) * normal).min(t.length() / (slipping * dt))
    } else {
        (f64::from(settings.friction) * m * o * t.length().sqrt()).min(t.length() / (2.0 * slipping * dt))
    };
    let friction = size * t.normalize_or_zero();
    let force = friction - normal * n;
    let close = |name: &str, is: Vec3, was: DVec3, expected: DVec3| -> Outcome {
        let wrong = (is.as_dvec3() - was - expected).length();
        // Rounding of the overlap: one unit in the last place of a position of up to 3, times Cc and dt; and rounding
        // of the value that the change is added to.
        let allowed = 1e-3 * expected.length() + 1e-6 * (1.0 + was.length());
        prop_assert!(wrong < allowed, "{name}: {is} - {was}, not {expected}");
        Ok(())
    };
    close("velocity", after.velocity, v, dt * force / m)?;
    let spin = sphere.angular_momentum.as_dvec3();
    close("spin", after.angular_momentum, spin, dt * arm * n.cross(friction))
}

#[test]
fn a_sphere_on_a_static_object_obeys_the_contact_law() {
    // With mu_c = 0.05 the impulse is at its limit in nearly all cases.
    let spheres = (ball(1.0, 2.0), 0.05_f32..0.9, any::<bool>(), prop::sample::select(vec![0.0_f32, 0.05]));
    check(300, spheres, |(sphere, depth, on_box, coulomb)| -> Outcome {
        let overlap = depth * sphere.radius;
        let mut scene = weightless(&[Thing::Sphere(sphere)]);
        scene.settings.coulomb_friction = coulomb;
        scene.settings.collisions = false;
        // Slow enough not to count as separating from the polygon.
        let sphere = sphere.velocity(sphere.velocity.with_y(0.1 * sphere.velocity.y));
        let floor = sphere.position.y - sphere.radius + overlap;
        let exact = sphere.radius - (sphere.position.y - floor);
        if on_box {
            scene.add_box(Cuboid::between((-3.0, floor - 2.0, -3.0), (3.0, floor, 3.0))).unwrap();
        } else {
            let face = Polygon::new((-3.0, floor, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0);
            scene.add_polygon(face).unwrap();
        }
        let options = Options::new().backend(Backend::Cpu).integrator(Integrator::SymplecticEuler);
        let mut simulation = Simulation::with_options(scene, options).unwrap();
        let id = simulation.scene().sphere_ids().next().unwrap();
        simulation.set_velocity(id, sphere.velocity).unwrap();
        assert_contact_law_at_wall(sphere, exact, Vec3::NEG_Y, simulation)
    });
}

/// The forces of a spring on its two ends are opposite, so a net of springs keeps its momentum and angular momentum.
#[test]
fn spring_forces_are_internal() {
    let spring = (0..6_usize, 1..6_usize, 1.0_f32..50.0, 0.0_f32..2.0, 0.0_f32..3.0);
    let net = (prop::collection::vec(ball(1.5, 1.0), 6), prop::collection::vec(spring, 1..12));
    check(60, net, |(balls, springs)| -> Outcome {
        let mut scene = weightless(&[]);
        scene.settings.collisions = false;
        // The balls are in different groups, so only the springs act.
        let ids: Vec<_> = balls.iter().zip(0..).map(|(ball, group)| scene.add_sphere(ball.group(group)).unwrap()).collect();
        for (from, step, stiffness, length, damping) in springs {
            let spring = Spring::new(ids[from], ids[(from + step) % 6], stiffness, length);
            scene.add_spring(spring.damping(damping)).unwrap();
        }
        let mut simulation = simulation(scene, Backend::Cpu);
        let before = simulation.spheres().unwrap();
        simulation.run(50, 0.002).unwrap();
        let after = simulation.spheres().unwrap();
        let (was, is) = (sums(&before), sums(&after));
        prop_assert!((is.momentum - was.momentum).length() < 1e-5 * was.momentum_size, "{was:?} {is:?}");
        prop_assert!((is.angular - was.angular).length() < 1e-5 * was.angular_size, "{was:?} {is:?}");
        prop_assert!(before.iter().zip(&after).any(|(a, b)| a.velocity.distance(b.velocity) > 1e-3));
        Ok(())
    });
}

/// A free capsule with any spin keeps its angular momentum within 0.1 % (docs/physics section 5.5) and gains no
/// energy. A capsule that rolls about its axis while it tumbles loses a little, in proportion to the cube of the time
/// step.
#[test]
fn a_free_capsule_keeps_its_angular_momentum() {
    check(40, (capsule(1.0, 1.0), vector(0.5)), |(thing, spin)| -> Outcome {
        let thing = thing.map(|sphere| sphere.angular_momentum(spin * sphere.inertia() * 10.0));
        let mut simulation = simulation(weightless(&[thing]), Backend::Cpu);
        // The first step gives both ends a common spin.
        simulation.run(1, 0.005).unwrap();
        let was = sums(&simulation.spheres().unwrap());
        simulation.run(300, 0.005).unwrap();
        let is = sums(&simulation.spheres().unwrap());
        prop_assert!((is.angular - was.angular).length() < 1e-3 * was.angular_size, "{was:?} {is:?}");
        let gain = is.energy / was.energy - 1.0;
        prop_assert!(gain.abs() < 1e-4, "{was:?} {is:?}");
        prop_assert!((is.momentum - was.momentum).length() < 1e-4 * was.momentum_size.max(0.1), "{was:?} {is:?}");
        Ok(())
    });
}

/// A ball from behind a polygon is not affected by it; a ball from the front rebounds.
#[test]
fn polygons_are_one_sided() {
    let flight = (direction(), 2.0_f32..8.0, 0.25_f32..0.5, 0.5_f32..0.95, [0.3_f32..0.7, 0.3_f32..0.7]);
    check(100, flight, |(normal, speed, radius, e, [l, k])| -> Outcome {
        let left = 3.0 * normal.any_orthonormal_vector();
        let face = Polygon::new(l * -left - k * normal.cross(left), left, normal.cross(left));
        for side in [-1.0, 1.0] {
            let start = side * 0.8 * normal;
            let ball = Sphere::new(start, radius).velocity(-side * speed * normal);
            let fly = |with_face: bool| {
                let mut scene = weightless(&[Thing::Sphere(ball)]);
                scene.settings.restitution = e;
                if with_face {
                    scene.add_polygon(face).unwrap();
                }
                let mut simulation = simulation(scene, Backend::Cpu);
                simulation.run(120, 0.005).unwrap();
                simulation.spheres().unwrap()[0]
            };
            let (with, without) = (fly(true), fly(false));
            if side < 0.0 {
                prop_assert_eq!(with, without);
            } else {
                let back = with.velocity.dot(normal) / speed;
                prop_assert!((back - e).abs() < 1e-3, "{back} {e}");
            }
        }
        Ok(())
    });
}
