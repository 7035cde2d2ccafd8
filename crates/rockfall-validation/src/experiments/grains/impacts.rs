//! The eight tests of Chung and Ooi, Granular Matter 13 (2011) 643.

use rockfall::glam::DVec3;
use rockfall::{Pair, Simulation, Sphere};

use super::{Grains, Solid};
use crate::chart::{Axis, Chart, Mark};
use crate::{Outcome, Result};

const GLASS: Solid = Solid(48e9, 0.20, 2800.0);
const LIMESTONE: Solid = Solid(20e9, 0.25, 2500.0);
const ALUMINIUM: Solid = Solid(70e9, 0.30, 2699.0);
const MAGNESIUM: Solid = Solid(40e9, 0.35, 1800.0);
const ALUMINA: Solid = Solid(380e9, 0.23, 4000.0);
const STEEL: Solid = Solid(208e9, 0.30, 7850.0);
const NYLON: Solid = Solid(2.5e9, 0.40, 1000.0);

/// Steps of a Hertzian impact.
const STEPS: f64 = 400.0;

/// Depth in m and duration in s of an elastic impact by Hertz, from E*, R*, m* and the closing speed.
fn hertz(solid: Solid, radius: f64, mass: f64, speed: f64) -> [f64; 2] {
    let depth = (15.0 * mass * speed * speed / (16.0 * solid.reduced_modulus() * radius.sqrt())).powf(0.4);
    [depth, 2.943_275 * depth / speed]
}

/// Runs until the bodies are apart again. Returns the deepest overlap and the duration.
fn impact(simulation: &mut Simulation, expected: f64) -> Result<[f64; 2]> {
    let step = expected / STEPS;
    let (mut steps, mut depth) = (0, 0.0_f64);
    for _ in 0..10 * STEPS as u32 {
        let report = simulation.run(1, step as f32)?;
        if report.contacts > 0 {
            steps += 1;
            depth = depth.max(report.max_overlap.into());
        } else if steps > 0 {
            return Ok([depth, f64::from(steps) * step]);
        }
    }
    Err("the impact does not end".into())
}

/// A ball with a velocity and a spin.
fn moving(ball: Sphere, velocity: DVec3, spin: DVec3) -> Sphere {
    let inertia = f64::from(ball.inertia());
    ball.velocity(velocity.as_vec3()).angular_momentum((spin * inertia).as_vec3())
}

fn velocity_and_spin(simulation: &mut Simulation, ball: usize) -> Result<[DVec3; 2]> {
    let sphere = simulation.sync()?.spheres()[ball];
    Ok([sphere.velocity, sphere.spin()].map(|vector| vector.as_dvec3()))
}

/// Velocity and spin after an impact of a ball on a plane.
fn on_plane(solid: Solid, radius: f64, pair: Pair, velocity: DVec3, spin: f64) -> Result<[DVec3; 2]> {
    let mut grains = Grains::new(solid, pair)?;
    grains.plane(40.0 * radius as f32)?;
    let ball = grains.ball([0.0, radius, 0.0], radius);
    grains.scene.add_sphere(moving(ball, velocity, DVec3::new(0.0, 0.0, spin)))?;
    let [_, duration] = hertz(solid, radius, solid.mass(radius), -velocity.y);
    let mut simulation = grains.simulation()?;
    impact(&mut simulation, duration)?;
    velocity_and_spin(&mut simulation, 0)
}

fn properties(e: f64, mu: f64) -> Pair {
    Pair::default().restitution(e as f32).friction(mu as f32)
}

fn elastic(outcome: &mut Outcome) -> Result<()> {
    for (test, name, solid, radius, speed, with_plane) in [
        (1, "glass", GLASS, 0.01, 10.0, false),
        (1, "limestone", LIMESTONE, 0.01, 10.0, false),
        (2, "aluminium alloy", ALUMINIUM, 0.1, 0.2, true),
        (2, "magnesium alloy", MAGNESIUM, 0.1, 0.2, true),
    ] {
        let mut grains = Grains::new(solid, properties(1.0, 0.0))?;
        let mut half = 1.0;
        let mut up = -speed;
        if with_plane {
            grains.plane(40.0 * radius as f32)?;
        } else {
            let above = grains.ball([0.0, 3.0 * radius, 0.0], radius);
            grains.scene.add_sphere(moving(above, DVec3::new(0.0, -speed, 0.0), DVec3::ZERO))?;
            (half, up) = (0.5, speed);
        }
        let ball = grains.ball([0.0, radius, 0.0], radius);
        grains.scene.add_sphere(moving(ball, DVec3::new(0.0, up, 0.0), DVec3::ZERO))?;
        let [depth, duration] = hertz(solid, half * radius, half * solid.mass(radius), speed / half);
        let found = impact(&mut grains.simulation()?, duration)?;
        let what = |quantity: &str| format!("test {test}, {name}: {quantity}");
        outcome.check(what("deepest overlap (µm)"), 1e6 * depth, 1e6 * found[0], 5e3 * depth);
        outcome.check(what("duration (µs)"), 1e6 * duration, 1e6 * found[1], 1e4 * duration);
    }
    Ok(())
}

fn restitution(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("coefficient of restitution"), Axis::linear("speed of rebound (m/s)"));
    let mut chart = Chart::new("grains-rebound", "Test 3: rebound of an aluminium oxide ball at 3.9 m/s", axes.0, axes.1);
    let mut points = Vec::new();
    for e in [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0] {
        let [velocity, _] = on_plane(ALUMINA, 0.0025, properties(e, 0.0), DVec3::new(0.0, -3.9, 0.0), 0.0)?;
        points.push((e, velocity.y));
    }
    let worst = points.iter().map(|(e, speed)| (speed / (3.9 * e) - 1.0).abs()).fold(0.0, f64::max);
    outcome.check("test 3: relative error of the worst rebound, e from 0.1 to 1", 0.0, worst, 0.01);
    chart = chart.add(0, Mark::Line, "e x 3.9 m/s", vec![(0.0, 0.0), (1.0, 3.9)]);
    outcome.charts.push(chart.add(0, Mark::Points, "measured", points));
    Ok(())
}

fn oblique(outcome: &mut Outcome) -> Result<()> {
    let (radius, e, mu) = (0.0025, 0.98, 0.092);
    let axes = (Axis::linear("angle of impact (degrees)"), Axis::linear("speed of the surface by the spin (m/s)"));
    let mut chart = Chart::new("grains-oblique", "Test 4: oblique impact at 3.9 m/s", axes.0, axes.1);
    let (mut points, mut line, mut worst) = (Vec::new(), Vec::new(), 0.0_f64);
    for degrees in (5..=85).step_by(5).map(f64::from) {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let [velocity, spin] =
            on_plane(ALUMINA, radius, properties(e, mu), DVec3::new(3.9 * sin, -3.9 * cos, 0.0), 0.0)?;
        points.push((degrees, -spin.z * radius));
        // Steeper impacts stick at first.
        if degrees >= 35.0 {
            let lost = mu * (1.0 + e) * 3.9 * cos;
            line.push((degrees, 2.5 * lost));
            worst = worst.max(((3.9 * sin - velocity.x) / lost - 1.0).abs());
        }
    }
    outcome.check("test 4: tangential velocity lost, relative error of the worst angle from 35 degrees on", 0.0, worst, 0.01);
    chart = chart.add(0, Mark::Line, "5/2 mu (1 + e) v_n", line);
    outcome.charts.push(chart.add(0, Mark::Points, "measured", points));
    let [velocity, spin] = on_plane(STEEL, 0.1, properties(1.0, 0.3), DVec3::new(20.0, -5.0, 0.0), 0.0)?;
    outcome.check("test 5, steel: tangential velocity after 20 m/s (m/s)", 17.0, velocity.x, 0.03);
    outcome.check("test 5, steel: spin (1/s)", -75.0, spin.z, 0.75);
    Ok(())
}

fn spinning(outcome: &mut Outcome) -> Result<()> {
    for (name, solid) in [("aluminium alloy", ALUMINIUM), ("nylon", NYLON)] {
        let [velocity, spin] = on_plane(solid, 0.1, properties(0.5, 0.4), DVec3::new(0.0, -0.2, 0.0), -20.0)?;
        outcome.check(format!("test 6, {name}: tangential velocity (m/s)"), 0.12, velocity.x, 0.0012);
        outcome.check(format!("test 6, {name}: spin (1/s)"), -17.0, spin.z, 0.17);
        for (test, radii) in [(7, [0.1, 0.1]), (8, [0.1, 0.05])] {
            let mut grains = Grains::new(solid, properties(0.5, 0.4))?;
            for (x, speed, radius) in [(-radii[0], 0.2, radii[0]), (radii[1], -0.2, radii[1])] {
                let ball = grains.ball([x, 0.0, 0.0], radius);
                let ball = moving(ball, DVec3::new(speed, 0.0, 0.0), DVec3::new(0.0, 0.0, 20.0));
                grains.scene.add_sphere(ball)?;
            }
            let [mass, other] = radii.map(|radius| solid.mass(radius));
            let reduced = mass * other / (mass + other);
            let reduced_radius = radii[0] * radii[1] / (radii[0] + radii[1]);
            let [_, duration] = hertz(solid, reduced_radius, reduced, 0.4);
            let mut simulation = grains.simulation()?;
            impact(&mut simulation, duration)?;
            // The impulse along the normal is (1 + e) m* u, and mu times as much across it.
            let across = 0.4 * 1.5 * reduced * 0.4;
            let [velocity, spin] = velocity_and_spin(&mut simulation, 1)?;
            let expected = across / other;
            outcome.check(format!("test {test}, {name}: tangential velocity (m/s)"), expected, velocity.y, 0.015 * expected);
            let slower = 20.0 - 2.5 * across / (other * radii[1]);
            outcome.check(format!("test {test}, {name}: spin (1/s)"), slower, spin.z, 0.01 * slower.abs());
        }
    }
    Ok(())
}

pub(super) fn run(outcome: &mut Outcome) -> Result<()> {
    elastic(outcome)?;
    restitution(outcome)?;
    oblique(outcome)?;
    spinning(outcome)
}
