//! Rows of dominoes.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Integrator, Material, Pair, Placement, Simulation};

use super::{DENSITY, GRAVITY, block, bodies, floor, stage, step, tilt};
use crate::chart::{Axis, Chart, Mark};
use crate::measure::{line_fit, on_cpu};
use crate::{Outcome, Result};

/// Dominoes of a row, and how far apart they are, in their heights.
const COUNT: usize = 10;
const PITCH: f64 = 0.5;

/// Thickness of a domino, in its height.
const THICK: f64 = 0.2;
/// The angle by which a domino leans when the wave has reached it, rad.
const LEANS: f64 = 0.1;

/// The contacts of a row: of dominoes with each other, and with the floor.
type Pairs = [Pair; 2];

/// A row of dominoes of this height, with an overlap at rest of 5e-5 of it. The first one turns about an edge of its base.
fn row(height: f32, pairs: Pairs) -> Result<(Simulation, f32)> {
    const SUNK: f32 = 5e-5;
    let edges = height * Vec3::new(THICK as f32, 1.0, 0.5);
    let mass = DENSITY * edges.element_product();
    let stiffness = mass * GRAVITY / (4.0 * SUNK * height);
    let [among, below] = pairs.map(|pair| pair.stiffness(stiffness));
    let (mut scene, stuff) = stage(GRAVITY * Vec3::NEG_Y, among)?;
    let ground = scene.add_material(Material::new("ground"))?;
    scene.set_pair(stuff, ground, below)?;
    floor(&mut scene, ground)?;
    let shape = scene.add_shape(block(stuff, edges, 2e-3 * height))?;
    for number in 0..COUNT {
        let place = Placement::new(shape).at(f64::from(height) * DVec3::new(PITCH * number as f64, 0.5 - f64::from(SUNK), 0.0));
        let spin = if number == 0 { (GRAVITY / height).sqrt() * Vec3::NEG_Z } else { Vec3::ZERO };
        scene.add_body(place.velocity(spin.cross(Vec3::new(-0.5 * THICK as f32, 0.5, 0.0) * height)).spin(spin))?;
    }
    Ok((on_cpu(scene, Integrator::VelocityVerlet)?, step(mass, stiffness, 16.0)))
}

/// Angles of the dominoes that lean on the first one of the list, whose angle is `front`, and their rates over its own.
fn leaning(front: f64, count: usize) -> Vec<(f64, f64)> {
    let mut chain = vec![(front, 1.0)];
    while chain.len() < count {
        let (angle, rate) = chain[chain.len() - 1];
        // sin (θ - φ) = P cos φ - d, in heights.
        let apart = (PITCH * angle.cos() - THICK).asin();
        chain.push((angle + apart, rate * (1.0 - PITCH * angle.sin() / apart.cos())));
    }
    chain
}

/// The times at which smooth dominoes lean by 0.1 rad that do not slide on the floor and stay together after an impact, in √(l / g).
fn theory() -> Vec<f64> {
    const PARTS: u32 = 4_000;
    let inertia = (1.0 + THICK * THICK) / 3.0;
    let touch = (PITCH - THICK).asin();
    let potential = |chain: &[(f64, f64)]| chain.iter().map(|(angle, _)| 0.5 * (angle.cos() + THICK * angle.sin())).sum::<f64>();
    let weight = |chain: &[(f64, f64)]| chain.iter().map(|(_, rate)| rate * rate).sum::<f64>();
    let (mut time, mut rate, mut times) = (0.0, 1.0, Vec::new());
    for count in 1..=COUNT {
        let start = leaning(0.0, count);
        let energy = 0.5 * inertia * weight(&start) * rate * rate + potential(&start);
        let speed = |angle: f64| {
            let chain = leaning(angle, count);
            (2.0 * (energy - potential(&chain)) / (inertia * weight(&chain))).sqrt()
        };
        let mut leans = f64::NAN;
        for part in 0..PARTS {
            let angle = touch * (f64::from(part) + 0.5) / f64::from(PARTS);
            if leans.is_nan() && angle > LEANS {
                leans = time;
            }
            time += touch / f64::from(PARTS) / speed(angle);
        }
        times.push(leans);
        // The impulses do no work in the motions after the impact: projection of the velocities by the kinetic energy.
        let sum = weight(&leaning(touch, count));
        let ratio = leaning(0.0, 2)[1].1;
        rate = ratio * sum * speed(touch) / (1.0 + ratio * ratio * sum);
    }
    times
}

/// The times at which the dominoes of a row lean by 0.1 rad, s.
fn wave(height: f32, pairs: Pairs) -> Result<Vec<f64>> {
    const STEPS: u32 = 10;
    let (mut simulation, step) = row(height, pairs)?;
    let interval = f64::from(STEPS) * f64::from(step);
    let (mut times, mut before) = ([f64::NAN; COUNT], [0.0; COUNT]);
    for sample in 1..5_000 {
        simulation.run(u64::from(STEPS), step)?;
        for (number, body) in bodies(&mut simulation)?.iter().enumerate() {
            let now = tilt(body);
            if times[number].is_nan() && now > LEANS {
                times[number] = interval * (f64::from(sample) - (now - LEANS) / (now - before[number]));
            }
            before[number] = now;
        }
        if times[COUNT - 1].is_finite() {
            break;
        }
    }
    Ok(times.to_vec())
}

/// Waves in rows of dominoes of two sizes.
pub(super) fn dominoes(outcome: &mut Outcome) -> Result<()> {
    const HEIGHT: f32 = 0.2;
    let rough = [Pair::default().restitution(0.2).friction(0.3); 2];
    let [small, large] = [wave(HEIGHT, rough)?, wave(2.0 * HEIGHT, rough)?];
    let scale = 2_f64.sqrt();
    for (name, number) in [("fifth", 4), ("last", COUNT - 1)] {
        let ratio = large[number] / small[number];
        outcome.check(format!("dominoes: time until the {name} one leans, at twice the size over that at once"), scale, ratio, 0.005 * scale);
    }
    let points = |times: &[f64], height: f32| {
        let unit = f64::from(height / GRAVITY).sqrt();
        times.iter().enumerate().map(|(number, time)| (time / unit, PITCH * number as f64)).collect::<Vec<_>>()
    };
    let [small, large] = [points(&small, HEIGHT), points(&large, 2.0 * HEIGHT)];
    outcome.fact("speed", line_fit(&small[COUNT / 2..]).0);
    let smooth = [(0.05, 0.0), (0.05, 3.0)].map(|(restitution, friction)| Pair::default().restitution(restitution).friction(friction));
    let measured = points(&wave(HEIGHT, smooth)?, HEIGHT);
    let exact = theory();
    for (name, number) in [("fifth", 4), ("last", COUNT - 1)] {
        let [exact, measured] = [exact[number], measured[number].0];
        outcome.check(format!("smooth dominoes: time until the {name} one leans, √(l / g)"), exact, measured, 0.01 * exact);
    }
    let curve = exact.iter().enumerate().map(|(number, time)| (*time, PITCH * number as f64)).collect();
    outcome.charts.push(
        Chart::new("blocks-dominoes", "A wave in a row of dominoes", Axis::linear("time / √(l / g)"), Axis::linear("place / l"))
            .add(0, Mark::Line, "smooth, theory", curve)
            .add(1, Mark::Points, "smooth", measured)
            .add(2, Mark::Points, "μ = 0.3, l = 0.2 m", small)
            .add(3, Mark::Points, "μ = 0.3, l = 0.4 m", large),
    );
    Ok(())
}
