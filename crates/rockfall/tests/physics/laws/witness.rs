//! Oblique impacts of two spheres, computed in f64 from docs/physics section 4.11 alone, against both backends.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Backend, CohesionModel, ContactLaw, Pair, RollingModel, Scene, Sphere};

use super::jkr::Jkr;
use super::{scene_with, simulation, soft};

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
pub(crate) fn damping(law: ContactLaw, e: f64) -> f64 {
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

/// Rolling and twisting resistance: mu_r, whether it is model A, mu_q. The damping ratio is 0.3.
type Resistance = (f64, bool, f64);

/// Moment on A of docs/physics section 4.12, and the elastic part that is kept.
struct Turning {
    n: DVec3,
    /// R*, overlap, overlap before, N, time step.
    r: f64,
    d: f64,
    old: f64,
    press: f64,
    dt: f64,
    /// S_n, S_t, g sqrt(S_t m*).
    sn: f64,
    st: f64,
    dashpot: f64,
    rescales: bool,
}

fn moment(turning: &Turning, [a, b]: [Body; 2], (mu, is_a, mu_q): Resistance, kept: DVec3) -> [DVec3; 2] {
    let Turning { n, r, d, old, press, dt, sn, st, dashpot, rescales } = *turning;
    let ratio = if d < old { d / old } else { 1.0 };
    let f_r = if rescales { ratio.sqrt() } else { 1.0 };
    let w = a.w - b.w;
    let (wq, wr) = (w.dot(n), w - w.dot(n) * n);
    let inertia = |body: Body| 0.4 * body.m * body.r * body.r;
    let (mut roll, mut roll_kept) = (DVec3::ZERO, DVec3::ZERO);
    if mu > 0.0 && is_a {
        let stop = 0.5 / (dt * (1.0 / inertia(a) + 1.0 / inertia(b)));
        roll = -wr.normalize_or_zero() * (mu * r * press).min(stop * wr.length());
    } else if mu > 0.0 {
        let k = 2.25 * sn * (mu * r).powi(2);
        roll_kept = f_r * (kept - kept.dot(n) * n) - k * dt * wr;
        if roll_kept.length() > mu * r * press {
            roll_kept *= mu * r * press / roll_kept.length();
            roll = roll_kept;
        } else {
            let about = |body: Body| inertia(body) + body.m * body.r * body.r;
            let i = 1.0 / (1.0 / about(a) + 1.0 / about(b));
            roll = roll_kept - 2.0 * 0.3 * (i * k).sqrt() * wr;
        }
    }
    let (mut q, mut q_kept) = (0.0, 0.0);
    if mu_q > 0.0 {
        let limit = 2.0 / 3.0 * (r * d).sqrt() * mu_q * press;
        q_kept = f_r * ratio * kept.dot(n) - 0.5 * st * r * d * dt * wq;
        q = q_kept - 0.5 * dashpot * r * d * wq;
        if q_kept.abs() > limit {
            q_kept = limit * q_kept.signum();
            q = q_kept;
        }
    }
    [roll + q * n, roll_kept + q_kept * n]
}

/// Runs an impact in f64 with the same integrator, for `steps` steps of `dt`. With a surface energy there is JKR cohesion.
fn run(
    (law, gamma): (ContactLaw, f64),
    [e, mu]: [f64; 2],
    resistance: Resistance,
    mut bodies: [Body; 2],
    steps: u64,
    dt: f64,
) -> [Body; 2] {
    let g = damping(law, e);
    let young = 1e5 / (2.0 * (1.0 - 0.0625));
    let shear = 1e5 / (2.0 * 1.25) / (2.0 * (2.0 - 0.25));
    let (mut shift, mut kept, mut old) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for _ in 0..steps {
        let [a, b] = bodies;
        let n = (b.x - a.x).normalize();
        let d = a.r + b.r - (b.x - a.x).length();
        let (mut force, mut torque) = (DVec3::ZERO, [DVec3::ZERO; 2]);
        let (m, r) = (a.m * b.m / (a.m + b.m), a.r * b.r / (a.r + b.r));
        let jkr = Jkr { gamma, radius: r };
        if d > 0.0 || gamma > 0.0 && old > 0.0 && d > -jkr.tearing() {
            let (ra, rb) = (a.r - 0.5 * d, b.r - 0.5 * d);
            let (mut attraction, mut grip) = (0.0, 0.0);
            // Everything but the arms follows from the contact radius.
            let d = if gamma > 0.0 {
                let radius = jkr.contact_radius(d);
                attraction = 2.0 * std::f64::consts::PI * radius * radius;
                attraction *= (4.0 * gamma * young / (std::f64::consts::PI * radius)).sqrt();
                grip = 2.0 * jkr.pull_off();
                radius * radius / r
            } else {
                d
            };
            let (sn, st, elastic) = match law {
                ContactLaw::Linear => (1e4, 1e4 * 2.0 / 7.0, 1e4 * d),
                _ => {
                    let c = (r * d).sqrt();
                    (2.0 * young * c, 8.0 * shear * c, 4.0 / 3.0 * young * r.sqrt() * d.powf(1.5))
                }
            };
            let relative = a.v + a.w.cross(ra * n) - b.v - b.w.cross(-rb * n);
            let u = relative.dot(n);
            let slip = relative - u * n;
            let push = (elastic + g * (sn * m).sqrt() * u).max(0.0);
            let normal = (push - attraction + grip).max(0.0);
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
            force = rub - (push - attraction) * n;
            let rescales = law == ContactLaw::HertzMindlin;
            let dashpot = g * (st * m).sqrt();
            let turning = Turning { n, r, d, old, press: normal, dt, sn, st, dashpot, rescales };
            let turned = moment(&turning, bodies, resistance, kept);
            kept = turned[1];
            torque = [(ra * n).cross(rub) + turned[0], (-rb * n).cross(-rub) - turned[0]];
            old = d;
        } else {
            (shift, kept, old) = (DVec3::ZERO, DVec3::ZERO, 0.0);
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
    // The second resistance is so small that its springs yield.
    let resistances = [(0.0, false, 0.0), (0.05, false, 0.1), (0.6, false, 0.9), (0.2, true, 0.0)];
    let laws = [(ContactLaw::Linear, 0.0), (ContactLaw::HertzMindlin, 0.0), (ContactLaw::HertzMindlin, 2.0_f32)];
    for ((law, gamma), resistance) in laws.into_iter().flat_map(|law| resistances.map(|resistance| (law, resistance))) {
        for (case, (e, mu, [closing, across])) in cases.into_iter().enumerate() {
            let mut scene: Scene = scene_with(law);
            let material = soft(&mut scene, "soft");
            let model = if resistance.1 { RollingModel::ConstantTorque } else { RollingModel::SpringDashpot };
            let properties = Pair::default().restitution(e).friction(mu).stiffness(1e4).rolling_friction(resistance.0 as f32);
            let properties = properties.rolling_model(model).twisting_friction(resistance.2 as f32);
            let properties = properties.surface_energy(gamma).cohesion(CohesionModel::Jkr);
            scene.set_pair(material, material, properties).expect("a valid pair");
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
            let expected = run((law, f64::from(gamma)), [e.into(), mu.into()], resistance, bodies, steps, f64::from(dt));
            let mut simulation = simulation(scene, backend);
            simulation.run(steps, dt).expect("steps");
            let after = simulation.sync().expect("the state");
            for (id, body) in ids.into_iter().zip(expected) {
                let sphere = after.sphere(id).expect("a sphere");
                let error = (sphere.velocity.as_dvec3() - body.v).length();
                assert!(
                    error < 1e-3,
                    "{law}, {gamma}, case {case}, {resistance:?}: velocity {:?}, expected {:?}",
                    sphere.velocity,
                    body.v
                );
                let error = (sphere.spin().as_dvec3() - body.w).length();
                assert!(
                    error < 5e-3,
                    "{law}, {gamma}, case {case}, {resistance:?}: spin {:?}, expected {:?}",
                    sphere.spin(),
                    body.w
                );
            }
        }
    }
}

both!(oblique_impacts_agree_with_a_computation_in_f64);
