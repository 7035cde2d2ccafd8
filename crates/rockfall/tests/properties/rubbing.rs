//! The contact law between two bodies, and against what is static (docs/physics.md section 4).

use std::cell::Cell;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use rockfall::{Backend, Cuboid, Integrator, Options, Polygon, Simulation, Sphere, Spring};

use crate::things::{Outcome, Thing, ball, capsule, check, direction, rod, simulation, sums, vector, weightless};

const DT: f32 = 0.001;
const STEPS: u64 = 40;

/// Two things whose middles are so close that they overlap, the first about the origin.
fn pair(one: impl Strategy<Value = Thing>, other: impl Strategy<Value = Thing>) -> impl Strategy<Value = [Thing; 2]> {
    (one, other, direction(), 0.05_f32..0.3).prop_map(|(one, other, direction, apart)| {
        let centre = |thing: &Thing| {
            let scene = weightless(std::slice::from_ref(thing));
            let places = scene.spheres().iter().map(|sphere| sphere.position);
            places.sum::<Vec3>() / scene.spheres().len() as f32
        };
        let to = |thing: Thing, place: Vec3| {
            let shift = place - centre(&thing);
            thing.map(|sphere| Sphere { position: sphere.position + shift, ..sphere })
        };
        [to(one, Vec3::ZERO), to(other, apart * direction)]
    })
}

/// Angular momentum stays as it is. The arms of a contact meet in one point, so in every stage state forces and torques
/// cancel exactly; what is left is the error of RK4 (angular momentum is a quadratic invariant: (w dt)^5 with
/// w = sqrt(Cc) = 32/s and dt = 1 ms, 3e-8 a step; more in a step in which a contact ends) and rounding, 40 steps of a few
/// units in the last place.
fn keep_angular_momentum(kind: &str, pairs: impl Strategy<Value = [Thing; 2]>) {
    let (rubbed, spun) = (Cell::new(0), Cell::new(0));
    check(40, pairs, |things| -> Outcome {
        let mut scene = weightless(&things);
        scene.settings.collisions = false;
        let mut simulation = simulation(scene, Backend::Cpu);
        let before = simulation.spheres().unwrap();
        rubbed.set(rubbed.get() + usize::from(!simulation.contacts().unwrap().is_empty()));
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
    // Friction did turn something, or nothing was tested.
    assert!(rubbed.get() >= 30 && spun.get() >= 30, "{kind}: {} {}", rubbed.get(), spun.get());
}

fn sphere() -> impl Strategy<Value = Thing> {
    ball(0.1, 1.0).prop_map(Thing::Sphere)
}

#[test]
fn rubbing_pairs_keep_their_angular_momentum() {
    keep_angular_momentum("sphere-sphere", pair(sphere(), sphere()));
    keep_angular_momentum("sphere-rod", pair(sphere(), rod(0.1, 1.0, false)));
    keep_angular_momentum("sphere-fixed rod", pair(sphere(), rod(0.1, 1.0, true)));
    keep_angular_momentum("rod-rod", pair(rod(0.1, 1.0, false), rod(0.1, 1.0, false)));
    keep_angular_momentum("fixed rods", pair(rod(0.1, 1.0, true), rod(0.1, 1.0, true)));
    keep_angular_momentum("sphere-capsule", pair(sphere(), capsule(0.1, 1.0)));
    keep_angular_momentum("capsule-rod", pair(capsule(0.1, 1.0), rod(0.1, 1.0, false)));
    keep_angular_momentum("capsule-capsule", pair(capsule(0.1, 1.0), capsule(0.1, 1.0)));
}

/// One step of symplectic Euler without gravity against a static wall whose unit normal into it is `n`: the law itself.
fn against_a_wall(sphere: Sphere, overlap: f32, n: Vec3, mut simulation: Simulation) -> Outcome {
    let settings = *simulation.settings();
    simulation.step(DT).unwrap();
    let after = simulation.spheres().unwrap()[0];
    let (m, o, n) = (f64::from(sphere.mass), f64::from(overlap), n.as_dvec3());
    let arm = f64::from(sphere.radius) - o;
    let v = sphere.velocity.as_dvec3();
    let spin = sphere.angular_momentum.as_dvec3() / (0.4 * m * f64::from(sphere.radius).powi(2));
    // The wall rests: the sliding velocity of its surface past that of the sphere.
    let surface = v + spin.cross(arm * n);
    let t = -(surface - n * surface.dot(n));
    let push = f64::from(settings.contact_force) * o + f64::from(settings.contact_damping) * v.dot(n);
    let normal = push.max(0.0) * m;
    let dt = f64::from(DT);
    // The inverse mass of the slip: 1/m + s^2 / I.
    let slipping = 1.0 / m + arm * arm / (0.4 * m * f64::from(sphere.radius).powi(2));
    let size = if settings.coulomb_friction > 0.0 {
        // An impulse, given before the contact force acts: it takes all of the slip away where the limit lets it.
        (f64::from(settings.coulomb_friction) * normal).min(t.length() / (slipping * dt))
    } else {
        (f64::from(settings.friction) * m * o * t.length().sqrt()).min(t.length() / (2.0 * slipping * dt))
    };
    let friction = size * t.normalize_or_zero();
    let force = friction - normal * n;
    let close = |name: &str, is: Vec3, was: DVec3, expected: DVec3| -> Outcome {
        let wrong = (is.as_dvec3() - was - expected).length();
        // Rounding of the overlap: an ulp of a place of up to 3 units, times Cc and dt; and of what it is added to.
        let allowed = 1e-3 * expected.length() + 1e-6 * (1.0 + was.length());
        prop_assert!(wrong < allowed, "{name}: {is} - {was}, not {expected}");
        Ok(())
    };
    close("velocity", after.velocity, v, dt * force / m)?;
    let spin = sphere.angular_momentum.as_dvec3();
    close("spin", after.angular_momentum, spin, dt * arm * n.cross(friction))
}

#[test]
fn friction_of_a_sphere_on_what_is_static() {
    // With mu_c = 0.05 the impulse is the limit's in nearly all cases.
    let spheres = (ball(1.0, 2.0), 0.05_f32..0.9, any::<bool>(), prop::sample::select(vec![0.0_f32, 0.05]));
    check(300, spheres, |(sphere, depth, on_box, coulomb)| -> Outcome {
        let overlap = depth * sphere.radius;
        let mut scene = weightless(&[Thing::Sphere(sphere)]);
        scene.settings.coulomb_friction = coulomb;
        scene.settings.collisions = false;
        // Slow enough not to count as leaving a polygon.
        let sphere = Sphere { velocity: sphere.velocity.with_y(0.1 * sphere.velocity.y), ..sphere };
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
        against_a_wall(sphere, exact, Vec3::NEG_Y, simulation)
    });
}

/// Springs act on both ends alike, whatever hangs on them.
#[test]
fn spring_forces_are_internal() {
    let spring = (0..6_usize, 1..6_usize, 1.0_f32..50.0, 0.0_f32..2.0, 0.0_f32..3.0);
    let net = (prop::collection::vec(ball(1.5, 1.0), 6), prop::collection::vec(spring, 1..12));
    check(60, net, |(balls, springs)| -> Outcome {
        let mut scene = weightless(&[]);
        scene.settings.collisions = false;
        // In groups of their own: nothing but the springs acts.
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

/// A capsule alone, spinning any way: L within 0.1 % (docs/physics.md section 5.5), and no energy out of nothing. One that rolls
/// about its axis while it tumbles loses a little, in proportion to the step's cube.
#[test]
fn a_free_capsule_keeps_its_spin() {
    check(40, (capsule(1.0, 1.0), vector(0.5)), |(thing, spin)| -> Outcome {
        let thing = thing.map(|sphere| sphere.angular_momentum(spin * sphere.inertia() * 10.0));
        let mut simulation = simulation(weightless(&[thing]), Backend::Cpu);
        // The first step gives both ends one spin.
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

/// What comes from behind a polygon does not notice it; what comes from the front is turned back.
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
