//! A thrown, spinning capsule: the free motion of a symmetric top.

use rockfall::glam::{DQuat, DVec3};
use rockfall::{Capsule, Integrator, SphereState};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, line_fit, on_cpu, on_one_thread, power_fit, with};
use crate::{Effort, Outcome, Result};

const RADIUS: f64 = 0.25;
/// Moments of inertia along and across the axis. The two ends have mass 1 and are 1 apart.
const ALONG: f64 = 2.0 * 0.4 * RADIUS * RADIUS;
const ACROSS: f64 = ALONG + 0.5;
/// Initial spin about the axis, x, and across it, in rad/s.
const SPIN: DVec3 = DVec3::new(20.0, 0.0, 2.0);
const VELOCITY: DVec3 = DVec3::new(1.0, 3.0, -0.5);
const SECONDS: f64 = 10.0;

fn angular_momentum() -> DVec3 {
    DVec3::new(ALONG * SPIN.x, 0.0, ACROSS * SPIN.z)
}

/// Axis of a free symmetric top at time `t`.
fn exact(t: f64) -> DVec3 {
    let momentum = angular_momentum();
    DQuat::from_axis_angle(momentum.normalize(), momentum.length() / ACROSS * t) * DVec3::X
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Energy of rotation.
fn energy(momentum: DVec3, axis: DVec3) -> f64 {
    let along = momentum.dot(axis);
    0.5 * along * along / ALONG + 0.5 * (momentum - along * axis).length_squared() / ACROSS
}

struct Flight {
    /// Axis over time.
    axes: Vec<(f64, DVec3)>,
    /// Spin about the axis over time.
    spins: Vec<(f64, f64)>,
    /// Largest angle between the axis and the exact motion, in rad.
    worst: f64,
    /// Largest relative error of the angular momentum about the centre of mass.
    momentum: f64,
    /// Largest relative gain of the energy of rotation.
    gain: f64,
    /// Final distance of the centre of mass from its parabola.
    miss: f64,
}

fn thrown(steps_a_second: u32) -> Result<Flight> {
    let mut scene = with(|settings| settings.gravity = 1.0);
    let capsule = Capsule::new([-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], RADIUS as f32).mass(2.0);
    let id = scene.add_capsule(capsule)?;
    let parts = *scene.capsule(id)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    for (end, x) in [(parts.end1, -0.5), (parts.end2, 0.5)] {
        let velocity = VELOCITY + SPIN.cross(DVec3::X * x);
        simulation.set_velocity(end, velocity.as_vec3())?;
        simulation.set_angular_momentum(end, (0.5 * ALONG * SPIN).as_vec3())?;
    }
    let step = 1.0 / f64::from(steps_a_second);
    let mut flight =
        Flight { axes: Vec::new(), spins: vec![(0.0, SPIN.x)], worst: 0.0, momentum: 0.0, gain: f64::MIN, miss: 0.0 };
    let samples = 80;
    for sample in 1..=samples {
        simulation.run(u64::from(steps_a_second) * SECONDS as u64 / samples, step as f32)?;
        let t = simulation.report().time;
        let spheres = simulation.spheres()?;
        let place = |end: &SphereState| end.position.as_dvec3();
        let axis = (place(&spheres[1]) - place(&spheres[0])).normalize();
        let [one, two] = [spheres[0], spheres[1]];
        let spins = one.angular_momentum.as_dvec3() + two.angular_momentum.as_dvec3();
        let apart = place(&two) - place(&one);
        let momentum = spins + 0.5 * apart.cross(two.velocity.as_dvec3() - one.velocity.as_dvec3());
        let error = (momentum - angular_momentum()).length() / angular_momentum().length();
        flight.momentum = flight.momentum.max(error);
        flight.gain = flight.gain.max(energy(momentum, axis) / energy(angular_momentum(), DVec3::X) - 1.0);
        flight.worst = flight.worst.max(angle(axis, exact(t)));
        flight.spins.push((t, spins.dot(axis) / ALONG));
        flight.axes.push((t, axis));
        if sample == samples {
            let middle = 0.5 * (place(&spheres[0]) + place(&spheres[1]));
            flight.miss = middle.distance(VELOCITY * t - 0.5 * t * t * DVec3::Y);
        }
    }
    Ok(flight)
}

/// Rate at which a spin decays, in 1/s.
fn decay(spins: &[(f64, f64)]) -> f64 {
    -line_fit(&spins.iter().map(|(t, spin)| (*t, spin.ln())).collect::<Vec<_>>()).0
}

type Component = fn(DVec3) -> f64;

fn components(flight: &Flight) -> Chart {
    let axes = (Axis::linear("time (s)"), Axis::linear("component of the axis"));
    let mut chart = Chart::new("top", "The axis of a thrown capsule, h = 1/256 s", axes.0, axes.1);
    let parts: [(&str, Component); 3] = [("x", |v| v.x), ("y", |v| v.y), ("z", |v| v.z)];
    for (colour, (name, of)) in parts.into_iter().enumerate() {
        let measured = flight.axes.iter().map(|(t, axis)| (*t, of(*axis))).collect();
        chart = chart.add(colour, Mark::Line, format!("{name}, exact"), curve(0.0, SECONDS, 201, |t| of(exact(t)))).add(
            colour,
            Mark::Points,
            name,
            measured,
        );
    }
    chart
}

fn spins(flights: &[(u32, Flight)]) -> Chart {
    let axes = (Axis::linear("time (s)"), Axis::linear("spin about the axis (rad/s)"));
    let mut chart = Chart::new("top-spin", "Loss of spin due to the time step", axes.0, axes.1);
    for (colour, (steps, flight)) in flights.iter().enumerate() {
        let rate = loss(*steps);
        chart = chart
            .add(
                colour,
                Mark::Line,
                format!("h = 1/{steps} s, theory"),
                curve(0.0, SECONDS, 50, |t| SPIN.x * (-rate * t).exp()),
            )
            .add(colour, Mark::Points, format!("h = 1/{steps} s"), flight.spins.iter().step_by(4).copied().collect());
    }
    chart
}

/// Theoretical decay rate of the spin in 1/s: h^3 w^2 W^2 / 8, where w is the spin across and W the rate at which the axis
/// rotates about L.
fn loss(steps_a_second: u32) -> f64 {
    let round = angular_momentum().length() / ACROSS;
    (SPIN.z * round).powi(2) / (8.0 * f64::from(steps_a_second).powi(3))
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        let flights: Vec<(u32, Flight)> =
            [16, 32, 64, 256].into_iter().map(|steps| Ok((steps, thrown(steps)?))).collect::<Result<_>>()?;
        let [coarse @ .., (_, finest)] = &flights[..] else { unreachable!("four flights") };
        outcome.fact("turns", angular_momentum().length() / ACROSS * SECONDS / std::f64::consts::TAU);
        outcome.check("h = 1/256 s: axis, largest error (rad)", 0.0, finest.worst, 2e-3);
        let order =
            power_fit(&coarse.iter().map(|(steps, flight)| (1.0 / f64::from(*steps), flight.worst)).collect::<Vec<_>>());
        outcome.check("order of that error, from 1/16 to 1/64 s", 2.0, order, 0.1);
        outcome.check("centre of mass from its parabola after 10 s (units)", 0.0, finest.miss, 1e-3);
        for (steps, flight) in coarse {
            let name = format!("h = 1/{steps} s: decay of the axial spin (1e-6/s)");
            // Rounding changes the spin by about 1e-7 per step.
            let rounding = 1e-7 * f64::from(*steps);
            outcome.check(name, 1e6 * loss(*steps), 1e6 * decay(&flight.spins), 1e6 * (0.1 * loss(*steps) + rounding));
        }
        for (steps, flight) in &flights {
            let name = format!("h = 1/{steps} s: angular momentum, largest relative error");
            outcome.check(name, 0.0, flight.momentum, 1e-3);
            let name = format!("h = 1/{steps} s: energy of rotation, largest relative gain");
            outcome.check(name, 0.0, flight.gain.max(0.0), 5e-4);
        }
        outcome.charts.extend([components(finest), spins(coarse)]);
        Ok(outcome)
    })
}
