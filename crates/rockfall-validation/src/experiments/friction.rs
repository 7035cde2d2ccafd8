//! Friction by the square-root law and by Coulomb's: sliding until a sphere rolls, rolling and sliding on a slope.

use rockfall::{Capsule, Cuboid, Integrator, Scene, Simulation, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, power_fit, with};
use crate::{Effort, Outcome, Result};

const STIFFNESS: f64 = 1000.0;
const STEP: f64 = 1.0 / 64.0;

/// A law of friction; G = 1 throughout.
#[derive(Clone, Copy)]
struct Law {
    name: &'static str,
    friction: f64,
    coulomb: f64,
    /// Exponent of 1 - t/t_s in the sliding velocity, which falls to 0 at t_s.
    power: i32,
}

const ROOT: Law = Law { name: "square root", friction: 50.0, coulomb: 0.0, power: 2 };
const COULOMB: Law = Law { name: "Coulomb", friction: 0.0, coulomb: 0.05, power: 1 };

/// A long box as a floor. Gravity is tilted by `angle` towards +x.
fn slope(law: Law, angle: f64) -> Result<Scene> {
    let mut scene = with(|settings| {
        settings.friction = law.friction as f32;
        settings.coulomb_friction = law.coulomb as f32;
        settings.gravity_direction = [angle.sin() as f32, -angle.cos() as f32, 0.0].into();
    });
    scene.add_box(Cuboid::between([-10.0, -1.0, -2.0], [400.0, 0.0, 2.0]))?;
    Ok(scene)
}

/// 1 + m s²/I of a sphere of radius 1, where s is the radius less the overlap.
fn lever(overlap: f64) -> f64 {
    1.0 + 2.5 * (1.0 - overlap).powi(2)
}

/// Time until sliding ends.
fn slide_time(law: Law, speed: f64) -> f64 {
    let lever = lever(1.0 / STIFFNESS);
    match law.power {
        2 => 2.0 * speed.sqrt() * STIFFNESS / (lever * law.friction),
        _ => speed / (lever * law.coulomb),
    }
}

/// Velocity and distance after `t` (at most the slide time) of a sphere with the initial sliding velocity `speed`.
fn slide(law: Law, speed: f64, t: f64) -> (f64, f64) {
    let (lever, time) = (lever(1.0 / STIFFNESS), slide_time(law, speed));
    let left = 1.0 - t / time;
    let n = law.power;
    let slip_distance = speed * time / f64::from(n + 1) * (1.0 - left.powi(n + 1));
    (speed - speed / lever * (1.0 - left.powi(n)), speed * t - (speed * t - slip_distance) / lever)
}

/// Time, velocity and distance of a sphere of radius 1 that is thrown along the floor, until it slides at 1 % of its initial
/// velocity.
fn thrown(law: Law, speed: f64) -> Result<Vec<(f64, f64, f64)>> {
    let mut scene = slope(law, 0.0)?;
    let height = (1.0 - 1.0 / STIFFNESS) as f32;
    let ball = scene.add_sphere(Sphere::new([0.0, height, 0.0], 1.0).velocity([speed as f32, 0.0, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let mut samples = vec![(0.0, speed, 0.0)];
    for step in 1..100_000 {
        simulation.step(STEP as f32)?;
        let state = simulation.sphere(ball)?;
        let slip = f64::from(state.velocity.x) + f64::from(state.spin().z) * (1.0 - 1.0 / STIFFNESS);
        samples.push((f64::from(step) * STEP, state.velocity.x.into(), state.position.x.into()));
        if slip < 0.01 * speed {
            return Ok(samples);
        }
    }
    Err("friction: the sphere has not stopped sliding after 100,000 steps".into())
}

fn sliding(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("time (s)"), Axis::linear("velocity (units/s)"));
    let mut over_time = Chart::new("friction-velocity", "A sphere thrown along a floor at 1", axes.0, axes.1);
    let axes = (Axis::logarithmic("initial velocity (units/s)"), Axis::logarithmic("sliding distance (units)"));
    let mut distances =
        Chart::new("friction-distance", "Distance until a sphere slides at 1 % of its initial velocity", axes.0, axes.1);
    for (colour, law) in [ROOT, COULOMB].into_iter().enumerate() {
        let mut distances_found = Vec::new();
        // Fraction of the slide time after which 1 % of the sliding velocity is left.
        let part = 1.0 - 0.01_f64.powf(1.0 / f64::from(law.power));
        let distance = |speed: f64| slide(law, speed, part * slide_time(law, speed)).1;
        let mut worst: f64 = 0.0;
        for speed in [0.25, 0.5, 1.0, 2.0, 4.0] {
            let samples = thrown(law, speed)?;
            let last = samples[samples.len() - 1].2;
            worst = worst.max((last / distance(speed) - 1.0).abs());
            distances_found.push((speed, last));
            if speed == 1.0 {
                let time = slide_time(law, 1.0);
                let by = samples.len() / 25;
                let points = samples.iter().step_by(by).map(|sample| (sample.0, sample.1)).collect();
                let departure = samples.iter().map(|sample| (sample.1 - slide(law, 1.0, sample.0.min(time)).0).abs());
                let name = format!("{}, sliding at 1: velocity, largest departure (units/s)", law.name);
                outcome.check(name, 0.0, departure.fold(0.0, f64::max), 2e-3);
                over_time = over_time
                    .add(colour, Mark::Line, format!("{}, theory", law.name), curve(0.0, time, 40, |t| slide(law, 1.0, t).0))
                    .add(colour, Mark::Points, law.name, points);
            }
        }
        let power = 1.0 + 1.0 / f64::from(law.power);
        outcome.check(format!("{}: sliding distance / theory - 1, worst case", law.name), 0.0, worst, 0.01);
        outcome.check(format!("{}: exponent of v0 in the distance", law.name), power, power_fit(&distances_found), 0.02);
        distances = distances
            .add(
                colour,
                Mark::Line,
                format!("{}, theory", law.name),
                distances_found.iter().map(|(speed, _)| (*speed, distance(*speed))).collect(),
            )
            .add(colour, Mark::Points, law.name, distances_found);
    }
    outcome.charts.extend([over_time, distances]);
    Ok(())
}

/// Mean velocity of the spheres along x.
fn velocity(simulation: &mut Simulation) -> Result<f64> {
    let spheres = simulation.spheres()?;
    Ok(spheres.iter().map(|sphere| f64::from(sphere.velocity.x)).sum::<f64>() / spheres.len() as f64)
}

/// Acceleration of a body after its sliding velocity has become steady.
fn acceleration(scene: Scene) -> Result<f64> {
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(256, STEP as f32)?;
    let before = velocity(&mut simulation)?;
    simulation.run(256, STEP as f32)?;
    Ok((velocity(&mut simulation)? - before) / 4.0)
}

fn rolling_sphere(law: Law, angle: f64) -> Result<f64> {
    let mut scene = slope(law, angle)?;
    scene.add_sphere(Sphere::new([0.0, (1.0 - angle.cos() / STIFFNESS) as f32, 0.0], 1.0))?;
    acceleration(scene)
}

fn rolling_capsule(law: Law, angle: f64) -> Result<f64> {
    let mut scene = slope(law, angle)?;
    let height = (1.0 - angle.cos() / STIFFNESS) as f32;
    scene.add_capsule(Capsule::new([0.0, height, -1.5], [0.0, height, 1.5], 1.0))?;
    acceleration(scene)
}

fn rolling(outcome: &mut Outcome) -> Result<()> {
    let root = Law { friction: 2_000.0, ..ROOT };
    let coulomb = Law { coulomb: 0.2, ..COULOMB };
    let roll = |angle: f64| angle.sin() * (1.0 - 1.0 / lever(angle.cos() / STIFFNESS));
    // Rolling needs friction of (tan angle) / lever times the normal force.
    let with_coulomb = |angle: f64| {
        let sliding = angle.sin() - coulomb.coulomb * angle.cos();
        if angle.tan() > lever(angle.cos() / STIFFNESS) * coulomb.coulomb { sliding } else { roll(angle) }
    };
    let axes = (Axis::linear("slope (degrees)"), Axis::linear("acceleration (units/s²)"));
    let degrees = |of: &dyn Fn(f64) -> f64| curve(0.0, 70.0, 71, |degrees| of(degrees.to_radians()));
    let mut chart = Chart::new("friction-rolling", "A sphere on a slope, G = 1", axes.0, axes.1)
        .add(0, Mark::Line, "rolls: 5/7 G sin", degrees(&roll))
        .add(1, Mark::Line, "Coulomb, mu_c = 0.2", degrees(&with_coulomb));
    for (colour, (law, theory)) in [(root, &roll as &dyn Fn(f64) -> f64), (coulomb, &with_coulomb)].into_iter().enumerate() {
        let mut points = Vec::new();
        let mut worst: f64 = 0.0;
        for slope in [5.0_f64, 15.0, 25.0, 40.0, 50.0, 65.0] {
            let found = rolling_sphere(law, slope.to_radians())?;
            worst = worst.max((found - theory(slope.to_radians())).abs());
            points.push((slope, found));
        }
        outcome.check(format!("{}, sphere on a slope: acceleration, largest departure", law.name), 0.0, worst, 5e-3);
        chart = chart.add(colour, Mark::Points, law.name, points);
    }
    outcome.charts.push(chart);
    let angle = 20_f64.to_radians();
    for law in [root, coulomb] {
        let name = format!("{}, capsule across 20 degrees: acceleration (units/s²)", law.name);
        outcome.check(name, roll(angle), rolling_capsule(law, angle)?, 5e-3);
    }
    Ok(())
}

/// Time step for the capsule that slides along the slope.
const FINE: f64 = 1.0 / 512.0;

/// Velocity at the end of a step of a capsule that Coulomb's friction holds; `friction.md` has the formula.
fn held_velocity(angle: f64) -> f64 {
    // The capsule has the radius 1/4 and ends 2 apart; `across` is K, the square of the radius of gyration.
    let arm: f64 = 0.25 - angle.cos() / STIFFNESS;
    let across = 0.25 * 4.0 + 0.4 * 0.25 * 0.25;
    FINE * angle.sin() * (1.0 + arm * arm / across)
}

/// Velocity after `seconds` of a capsule that lies along the slope, so that it cannot roll.
fn slipping(law: Law, angle: f64, seconds: f64) -> Result<f64> {
    let mut scene = slope(law, angle)?;
    let height = (0.25 - angle.cos() / STIFFNESS) as f32;
    scene.add_capsule(Capsule::new([0.0, height, 0.0], [2.0, height, 0.0], 0.25))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run((seconds / FINE) as u64, FINE as f32)?;
    velocity(&mut simulation)
}

fn creeping(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    const SECONDS: f64 = 40.0;
    let root = Law { friction: 500.0, ..ROOT };
    let coulomb = Law { coulomb: 0.25, ..COULOMB };
    let creep = |angle: f64| (STIFFNESS * angle.tan() / root.friction).powi(2);
    let with_coulomb = |angle: f64| {
        let sliding = angle.sin() - coulomb.coulomb * angle.cos();
        if sliding > 0.0 { sliding * SECONDS } else { held_velocity(angle) }
    };
    let axes = (Axis::linear("slope (degrees)"), Axis::logarithmic("velocity after 40 s (units/s)"));
    let degrees = |of: &dyn Fn(f64) -> f64| curve(2.0, 30.0, 57, |degrees| of(degrees.to_radians()));
    let mut chart = Chart::new("friction-creep", "A capsule that slides along a slope, G = 1", axes.0, axes.1)
        .add(0, Mark::Line, "square root: (Cc tan / mu)²", degrees(&creep))
        .add(1, Mark::Line, "Coulomb, mu_c = 0.25", degrees(&with_coulomb));
    let laws = [(root, &creep as &dyn Fn(f64) -> f64), (coulomb, &with_coulomb)];
    for (colour, (law, theory)) in laws.into_iter().enumerate() {
        let mut points = Vec::new();
        let mut worst: f64 = 0.0;
        for slope in effort.pick(&[6.0_f64, 13.0, 25.0][..], &[3.0, 6.0, 10.0, 13.0, 17.0, 21.0, 25.0]).iter().copied() {
            let found = slipping(law, slope.to_radians(), SECONDS)?;
            worst = worst.max((found / theory(slope.to_radians())).ln().abs());
            points.push((slope, found));
        }
        let name = format!("{}, capsule along a slope: ln(velocity / theory), worst case", law.name);
        outcome.check(name, 0.0, worst, 0.05);
        chart = chart.add(colour, Mark::Points, law.name, points);
    }
    outcome.charts.push(chart);
    Ok(())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let mut outcome = Outcome::default();
        sliding(&mut outcome)?;
        rolling(&mut outcome)?;
        creeping(&mut outcome, effort)?;
        Ok(outcome)
    })
}
