//! Order of accuracy: decrease of the error with the time step.

use std::f64::consts::TAU;

use rockfall::Integrator::{self, Rk4, SymplecticEuler, VelocityVerlet};
use rockfall::{Scene, Sphere, Spring};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{on_cpu, on_one_thread, power_fit, with};
use crate::{Effort, Outcome, Result};

/// Distance of the first two spheres after `steps` steps in `time` seconds.
fn distance(scene: Scene, integrator: Integrator, steps: u64, time: f64) -> Result<f64> {
    let mut simulation = on_cpu(scene, integrator)?;
    simulation.run(steps, (time / steps as f64) as f32)?;
    let spheres = simulation.spheres()?;
    Ok(spheres[0].position.as_dvec3().distance(spheres[1].position.as_dvec3()))
}

/// Error of two unit masses on a spring without damping, stretched by 1/2, with one oscillation per second.
fn spring_error(integrator: Integrator, steps: u64) -> Result<f64> {
    // A zero crossing, where errors of the phase and the first-order error of symplectic Euler are largest.
    const TIME: f64 = 1.25;
    let stiffness = (0.5 * TAU * TAU) as f32;
    let mut scene = with(|settings| settings.gravity = 0.0);
    let [a, b] = [-0.75_f32, 0.75].map(|x| Sphere::new([x, 0.0, 0.0], 0.1));
    let (a, b) = (scene.add_sphere(a)?, scene.add_sphere(b)?);
    scene.add_spring(Spring::new(a, b, stiffness, 1.0))?;
    let exact = 1.0 + 0.5 * ((2.0 * f64::from(stiffness)).sqrt() * TIME).cos();
    Ok((distance(scene, integrator, steps, TIME)? - exact).abs())
}

const DURATION: f64 = 0.0625;
const SPEED: f64 = 10.0;

/// Overlap after `t` by o'' = -Cc o - Cd o', as long as the contact force is repulsive.
fn overlap_after(overlap: f64, speed: f64, t: f64) -> f64 {
    let (stiffness, half_damping) = (1000.0_f64, 6.25);
    let frequency = (stiffness - half_damping * half_damping).sqrt();
    let (sin, cos) = (frequency * t).sin_cos();
    (-half_damping * t).exp() * (overlap * cos + (speed + half_damping * overlap) / frequency * sin)
}

/// Error of two spheres that approach each other at 10 units/s with an initial `overlap` (negative: a gap), with collisions
/// off.
fn contact_error(integrator: Integrator, steps: u64, overlap: f64) -> Result<f64> {
    let mut scene = with(|settings| (settings.gravity, settings.collisions) = (0.0, false));
    let half = (1.0 - 0.5 * overlap) as f32;
    let speed = 0.5 * SPEED as f32;
    scene.add_sphere(Sphere::new([-half, 0.0, 0.0], 1.0).velocity([speed, 0.0, 0.0]))?;
    scene.add_sphere(Sphere::new([half, 0.0, 0.0], 1.0).velocity([-speed, 0.0, 0.0]))?;
    // The overlap after rounding to f32.
    let overlap = 2.0 - 2.0 * f64::from(half);
    let flight = (-overlap / SPEED).max(0.0);
    let exact = 2.0 - overlap_after(overlap.max(0.0), SPEED, DURATION - flight);
    Ok((distance(scene, integrator, steps, DURATION)? - exact).abs())
}

/// Error for spheres that start apart: root mean square over 16 positions of the onset of contact within a step.
fn onset_error(steps: u64) -> Result<f64> {
    const PHASES: u32 = 16;
    let step = SPEED * DURATION / steps as f64;
    let mut squares = 0.0;
    for phase in 0..PHASES {
        let gap = 0.02 + step * (f64::from(phase) + 0.5) / f64::from(PHASES);
        squares += contact_error(Rk4, steps, -gap)?.powi(2);
    }
    Ok((squares / f64::from(PHASES)).sqrt())
}

type Points = Vec<(f64, f64)>;

fn errors(time: f64, steps: &[u64], error: impl Fn(u64) -> Result<f64>) -> Result<Points> {
    steps.iter().map(|steps| Ok((time / *steps as f64, error(*steps)?))).collect()
}

/// A line of the given power through the middle one of the measured points.
fn power_line(points: &Points, power: i32) -> Points {
    let middle = points[points.len() / 2];
    points.iter().map(|(h, _)| (*h, middle.1 * (h / middle.0).powi(power))).collect()
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let series = [
            ("spring, RK4", 4, 0.1, errors(1.25, &[16, 24, 36, 54, 81], |steps| spring_error(Rk4, steps))?),
            (
                "spring, symplectic Euler",
                1,
                0.1,
                errors(1.25, &[40, 80, 160, 320, 640], |steps| spring_error(SymplecticEuler, steps))?,
            ),
            (
                "spring, velocity Verlet",
                2,
                0.1,
                errors(1.25, &[20, 30, 45, 68, 102], |steps| spring_error(VelocityVerlet, steps))?,
            ),
            ("contact, RK4", 4, 0.3, errors(DURATION, &[2, 4, 8, 16], |steps| contact_error(Rk4, steps, 0.1))?),
            (
                "contact, symplectic Euler",
                1,
                0.15,
                errors(DURATION, &[8, 16, 32, 64, 128], |steps| contact_error(SymplecticEuler, steps, 0.1))?,
            ),
            ("contact from its onset, RK4", 1, 0.4, errors(DURATION, &[8, 16, 32, 64, 128], onset_error)?),
        ];
        let mut outcome = Outcome::default();
        let axes = || (Axis::logarithmic("time step h (s)"), Axis::logarithmic("error of the distance (units)"));
        let mut charts = [
            Chart::new("order-spring", "Error of a spring pair after 1.25 periods", axes().0, axes().1),
            Chart::new("order-contact", "Error of a contact after 0.0625 s", axes().0, axes().1),
        ];
        for (place, (name, power, bound, points)) in series.into_iter().enumerate() {
            outcome.check(format!("order, {name}"), f64::from(power), power_fit(&points), bound);
            let chart = &mut charts[usize::from(place > 2)];
            let line = power_line(&points, power);
            *chart = chart.clone().add(place, Mark::Line, format!("h^{power}"), line).add(place, Mark::Points, name, points);
        }
        outcome.charts.extend(charts);
        Ok(outcome)
    })
}
