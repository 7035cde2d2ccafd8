//! A capsule as a top on a smooth floor, and a frame of rods that flips.

use rockfall::glam::DVec3;
use rockfall::{Capsule, Cuboid, Integrator, Rod, Sphere, SphereState};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{line_fit, mean, on_cpu, on_one_thread, rises, with};
use crate::{Effort, Outcome, Result};

const RADIUS: f64 = 0.25;
/// Moments of inertia of the capsule along and across its axis. The two ends have mass 1 and are 1 apart.
const ALONG: f64 = 2.0 * 0.4 * RADIUS * RADIUS;
const ACROSS: f64 = ALONG + 0.5;
/// Spin about the axis, in rad/s.
const SPIN: f64 = 80.0;
/// Tilt of the axis, in rad.
const TILT: f64 = 0.35;
/// Duration of the measurement, in s.
const SECONDS: f64 = 24.0;

/// Rate of the slow steady precession: A W² cos - C s W + M G l = 0, l = 1/2, M = 2, G = 1.
fn precession() -> f64 {
    let cos = TILT.cos();
    let root = ((ALONG * SPIN).powi(2) - 4.0 * ACROSS * cos).sqrt();
    (ALONG * SPIN - root) / (2.0 * ACROSS * cos)
}

fn position(sphere: &SphereState) -> DVec3 {
    sphere.position.as_dvec3()
}

fn top(outcome: &mut Outcome) -> Result<()> {
    const STEPS: u32 = 512;
    let axis = DVec3::new(TILT.sin(), TILT.cos(), 0.0);
    let rate = precession();
    let spin = SPIN * axis + rate * (DVec3::Y - TILT.cos() * axis);
    // The lower end bears the whole weight, twice its own.
    let low = DVec3::Y * (RADIUS - 2.0 / 1000.0);
    let mut scene = with(|settings| (settings.friction, settings.gravity) = (0.0, 1.0));
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]))?;
    let id = scene.add_capsule(Capsule::new(low.as_vec3(), (low + axis).as_vec3(), RADIUS as f32).mass(2.0))?;
    let parts = *scene.capsule(id)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    for (end, side) in [(parts.end1, -0.5), (parts.end2, 0.5)] {
        simulation.set_velocity(end, (side * spin.cross(axis)).as_vec3())?;
        // Both ends have the spin of the body.
        simulation.set_angular_momentum(end, (0.5 * ALONG * spin).as_vec3())?;
    }
    let before = simulation.energy()?;
    let vertical = before.angular_momentum.y;
    let (mut turned, mut angles, mut tilts, mut last) = (0.0, vec![(0.0, 0.0)], Vec::new(), 0.0);
    for sample in 1..=96_u32 {
        simulation.run(u64::from(STEPS) / 4, 1.0 / STEPS as f32)?;
        let spheres = simulation.spheres()?;
        let axis = (position(&spheres[1]) - position(&spheres[0])).normalize();
        let heading = (-axis.z).atan2(axis.x);
        turned += (heading - last + 3.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        last = heading;
        angles.push((f64::from(sample) / 4.0, turned));
        tilts.push(axis.y.acos());
    }
    let after = simulation.energy()?;
    let kept = after.angular_momentum.y / vertical - 1.0;
    outcome.check("top: rate of precession (rad/s)", rate, line_fit(&angles).0, 0.01 * rate);
    let wobble = tilts.iter().map(|tilt| (tilt - TILT).abs()).fold(0.0, f64::max);
    outcome.check("top: largest departure of the tilt (rad)", 0.0, wobble, 0.01);
    outcome.check("top: vertical angular momentum, relative change in 24 s", 0.0, kept, 1e-3);
    let scale = before.kinetic;
    outcome.check("top: energy, relative change in 24 s", 0.0, (after.total() - before.total()) / scale, 1e-3);
    let axes = (Axis::linear("time (s)"), Axis::linear("angle of precession (rad)"));
    outcome.charts.push(
        Chart::new("spinning-top", "A capsule as a top on a smooth floor", axes.0, axes.1)
            .add(0, Mark::Line, "steady precession", vec![(0.0, 0.0), (SECONDS, rate * SECONDS)])
            .add(1, Mark::Points, "measured", angles.into_iter().step_by(4).collect()),
    );
    Ok(())
}

/// Semi-axes of an octahedron of unit masses.
const ARMS: [f64; 3] = [0.5, 1.0, 1.5];
/// Angular velocity of the frame, in rad/s, mostly about the intermediate axis y.
const TUMBLE: DVec3 = DVec3::new(0.05, 5.0, 0.02);
/// Duration of the flips, in s.
const FLIPPING: f64 = 20.0;

fn inertia() -> DVec3 {
    let [x, y, z] = ARMS.map(|arm| 2.0 * arm * arm);
    DVec3::new(y + z, x + z, x + y)
}

/// Cosine of the angle between the intermediate axis and the angular momentum over time, by Euler's equations with RK4 in f64.
fn euler_tumble() -> Vec<(f64, f64)> {
    let inertia = inertia();
    let slope = |spin: DVec3| (inertia * spin).cross(spin) / inertia;
    let (mut spin, mut samples) = (TUMBLE, Vec::new());
    let step = 1e-4;
    for n in 0..=(FLIPPING / step) as u32 {
        if n % 100 == 0 {
            let momentum = inertia * spin;
            samples.push((f64::from(n) * step, momentum.y / momentum.length()));
        }
        let k1 = slope(spin);
        let k2 = slope(spin + 0.5 * step * k1);
        let k3 = slope(spin + 0.5 * step * k2);
        let k4 = slope(spin + step * k3);
        spin += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    samples
}

/// Times and values.
type Samples = Vec<(f64, f64)>;

/// Cosine of the same angle in the engine, and the relative changes of angular momentum and energy.
fn frame_tumble(steps: u32) -> Result<(Samples, f64, f64)> {
    let mut scene = with(|settings| settings.gravity = 0.0);
    let mut ids = Vec::new();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for (axis, arm) in axes.into_iter().zip(ARMS) {
        for side in [-1.0, 1.0] {
            let place = side * arm * axis;
            ids.push((place, scene.add_sphere(Sphere::new(place.as_vec3(), 0.05).velocity(TUMBLE.cross(place).as_vec3()))?));
        }
    }
    for (index, (place, one)) in ids.iter().enumerate() {
        for (other, two) in &ids[..index] {
            // Rods are the twelve edges. They also hold opposite corners apart.
            if (*place + *other).length() > 1e-9 {
                scene.add_rod(Rod::new(*two, *one, 0.02).length((*place - *other).length() as f32))?;
            }
        }
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let before = simulation.energy()?;
    let mut samples = vec![(0.0, 1.0)];
    let by = u64::from(steps) / 64;
    for sample in 1..=(64.0 * FLIPPING) as u32 {
        simulation.run(by, 1.0 / steps as f32)?;
        let spheres = simulation.spheres()?;
        let axis = (position(&spheres[3]) - position(&spheres[2])).normalize();
        samples.push((f64::from(sample) / 64.0, axis.dot(before.angular_momentum.normalize())));
    }
    let after = simulation.energy()?;
    let momentum = (after.angular_momentum - before.angular_momentum).length() / before.angular_momentum.length();
    Ok((samples, momentum, after.kinetic / before.kinetic - 1.0))
}

/// Mean time between the zero crossings of a cosine.
fn flips(samples: &[(f64, f64)]) -> f64 {
    let falls: Vec<_> = samples.iter().map(|(t, cos)| (*t, -cos)).collect();
    let mut times = rises(samples);
    times.extend(rises(&falls));
    times.sort_by(f64::total_cmp);
    mean(&times.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>())
}

fn dzhanibekov(outcome: &mut Outcome) -> Result<()> {
    let exact = euler_tumble();
    let (found, momentum, energy) = frame_tumble(1024)?;
    let expected = flips(&exact);
    outcome.check("frame: time between flips (s)", expected, flips(&found), 0.02 * expected);
    outcome.check("frame: angular momentum, relative change in 20 s", 0.0, momentum, 1e-3);
    outcome.check("frame: kinetic energy, relative change in 20 s", 0.0, energy, 2e-3);
    let axes = (Axis::linear("time (s)"), Axis::linear("cosine of the intermediate axis and L"));
    outcome.charts.push(
        Chart::new("spinning-flips", "A frame of rods that turns about its intermediate axis", axes.0, axes.1)
            .add(0, Mark::Line, "Euler's equations", exact)
            .add(1, Mark::Points, "frame of twelve rods", found.into_iter().step_by(8).collect()),
    );
    Ok(())
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        top(&mut outcome)?;
        dzhanibekov(&mut outcome)?;
        Ok(outcome)
    })
}
