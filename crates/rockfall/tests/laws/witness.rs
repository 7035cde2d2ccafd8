//! Oblique impacts of two spheres, computed in f64 from docs/physics.md section 4.11 alone, against both backends.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Backend, ContactLaw, Scene, Sphere};

use crate::{pair, scene_with, simulation, soft};

/// A sphere of the witness.
#[derive(Clone, Copy)]
struct Body {
    x: DVec3,
    v: DVec3,
    w: DVec3,
    m: f64,
    r: f64,
}

/// Damping g for which a clipped impact rebounds with e, found independently: by bisection on an explicit integration.
fn damping(law: ContactLaw, e: f64) -> f64 {
    let rebound = |g: f64| {
        let (mut d, mut v, h) = (0.0_f64, 1.0_f64, 2e-5);
        loop {
            let s = if law == ContactLaw::Linear { 1.0 } else { d.max(0.0).sqrt() };
            let elastic = if law == ContactLaw::Linear { d } else { s * d / 1.5 };
            let f = elastic + g * s.sqrt() * v;
            if v < 0.0 && f <= 0.0 {
                return -v;
            }
            v -= h * f;
            d += h * v;
        }
    };
    let (mut low, mut high) = (0.0, 3.0);
    for _ in 0..24 {
        let g = 0.5 * (low + high);
        if rebound(g) > e { low = g } else { high = g }
    }
    0.5 * (low + high)
}

/// Runs an impact in f64 with the same integrator, for `steps` steps of `dt`.
fn run(law: ContactLaw, e: f64, mu: f64, mut bodies: [Body; 2], steps: u64, dt: f64) -> [Body; 2] {
    let g = damping(law, e);
    let young = 1e5 / (2.0 * (1.0 - 0.0625));
    let shear = 1e5 / (2.0 * 1.25) / (2.0 * (2.0 - 0.25));
    let (mut shift, mut old) = (DVec3::ZERO, 0.0);
    for _ in 0..steps {
        let [a, b] = bodies;
        let n = (b.x - a.x).normalize();
        let d = a.r + b.r - (b.x - a.x).length();
        let (mut force, mut torque) = (DVec3::ZERO, [DVec3::ZERO; 2]);
        if d > 0.0 {
            let (m, r) = (a.m * b.m / (a.m + b.m), a.r * b.r / (a.r + b.r));
            let (sn, st, elastic) = match law {
                ContactLaw::Linear => (1e4, 1e4 * 2.0 / 7.0, 1e4 * d),
                _ => {
                    let c = (r * d).sqrt();
                    (2.0 * young * c, 8.0 * shear * c, 4.0 / 3.0 * young * r.sqrt() * d.powf(1.5))
                }
            };
            let (ra, rb) = (a.r - 0.5 * d, b.r - 0.5 * d);
            let relative = a.v + a.w.cross(ra * n) - b.v - b.w.cross(-rb * n);
            let u = relative.dot(n);
            let slip = relative - u * n;
            let normal = (elastic + g * (sn * m).sqrt() * u).max(0.0);
            let flat = shift - shift.dot(n) * n;
            if flat.length() > 0.0 {
                shift = flat * (shift.length() / flat.length());
                if law == ContactLaw::HertzMindlin && d < old {
                    shift *= (d / old).sqrt();
                }
            }
            shift += dt * slip;
            let dashpot = g * (st * m).sqrt() * slip;
            let mut rub = -st * shift - dashpot;
            if rub.length() > mu * normal {
                rub *= mu * normal / rub.length();
                let elastic = rub + dashpot;
                shift = if elastic.dot(rub) > 0.0 { -elastic / st } else { DVec3::ZERO };
            }
            force = rub - normal * n;
            torque = [(ra * n).cross(rub), (-rb * n).cross(-rub)];
            old = d;
        } else {
            shift = DVec3::ZERO;
        }
        for (body, (push, turn)) in bodies.iter_mut().zip([(force, torque[0]), (-force, torque[1])]) {
            body.v += dt / body.m * push;
            body.w += dt / (0.4 * body.m * body.r * body.r) * turn;
            body.x += dt * body.v;
        }
    }
    bodies
}

fn oblique_impacts_agree_with_a_computation_in_f64(backend: Backend) {
    // Sliding, sticking, and in between; damped and elastic; either sphere is the smaller one.
    let cases = [(0.9, 0.1, [1.0, 0.8]), (0.5, 0.9, [1.0, 0.3]), (1.0, 0.4, [0.9, 0.2]), (0.3, 0.4, [0.5, -2.0])];
    for law in [ContactLaw::Linear, ContactLaw::HertzMindlin] {
        for (case, (e, mu, [closing, across])) in cases.into_iter().enumerate() {
            let mut scene: Scene = scene_with(law);
            let material = soft(&mut scene, "soft");
            pair(&mut scene, material, material, e, mu);
            let radii = if case % 2 == 0 { [0.5_f32, 0.3] } else { [0.3, 0.5] };
            let first = Sphere::new([0.0; 3], radii[0]).density(1.0).velocity([closing, 0.0, 0.3]).material(material);
            let second =
                Sphere::new([0.6404, 0.4803, 0.0], radii[1]).density(1.0).velocity([0.0, across, -0.2]).material(material);
            let spins = [[0.5_f32, -1.0, 2.0], [1.0, 0.0, -3.0]];
            let spheres = [first, second];
            let bodies: [Body; 2] = std::array::from_fn(|k| {
                let sphere = spheres[k];
                let w = Vec3::from(spins[k]).as_dvec3();
                Body {
                    x: sphere.position.as_dvec3(),
                    v: sphere.velocity.as_dvec3(),
                    w,
                    m: sphere.mass.into(),
                    r: sphere.radius.into(),
                }
            });
            let ids: [_; 2] = std::array::from_fn(|k| {
                let spin = Vec3::from(spins[k]) * spheres[k].inertia();
                scene.add_sphere(spheres[k].angular_momentum(spin)).expect("a valid sphere")
            });
            let (steps, dt) = crate::common::on(backend, (2500, 2e-5), (300, 1e-4));
            let expected = run(law, e.into(), mu.into(), bodies, steps, f64::from(dt));
            let mut simulation = simulation(scene, backend);
            simulation.run(steps, dt).expect("steps");
            let after = simulation.sync().expect("the state");
            for (id, body) in ids.into_iter().zip(expected) {
                let sphere = after.sphere(id).expect("a sphere");
                let error = (sphere.velocity.as_dvec3() - body.v).length();
                assert!(error < 1e-3, "{law}, case {case}: velocity {:?}, expected {:?}", sphere.velocity, body.v);
                let error = (sphere.spin().as_dvec3() - body.w).length();
                assert!(error < 5e-3, "{law}, case {case}: spin {:?}, expected {:?}", sphere.spin(), body.w);
            }
        }
    }
}

both!(oblique_impacts_agree_with_a_computation_in_f64);
