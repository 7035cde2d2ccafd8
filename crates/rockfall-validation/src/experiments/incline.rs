//! Grains that flow down a rough incline, and a drum that turns so fast that it takes its grains along.

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::Vec3;
use rockfall::{ContactLaw, Integrator, Material, MaterialId, Motion, MotionTerm, Pair, Polygon, Scene, Simulation, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Grains along the flow, across it and upwards. Their mean diameter, their mass and gravity are 1.
const BED: [usize; 3] = [6, 5, 8];
/// Time step.
const STEP: f32 = 1e-3;
/// Constants of Jop, Forterre and Pouliquen for glass beads.
const LEAST: f64 = 0.382;
const MOST: f64 = 0.643;
const SCALE: f64 = 0.279;

/// An empty scene with grains of a stiffness of 5,000.
fn empty() -> Result<(Scene, MaterialId)> {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::Linear, false, 1.0);
    });
    let glass = scene.add_material(Material::new("glass").density((6.0 / PI) as f32))?;
    scene.set_pair(glass, glass, Pair::default().stiffness(5e3).restitution(0.7).friction(0.5))?;
    Ok((scene, glass))
}

/// The inertial number at which grains flow down an incline, in degrees; 0 if they do not.
fn inertial(degrees: f64) -> f64 {
    let slope = degrees.to_radians().tan();
    if slope > LEAST { SCALE * (slope - LEAST) / (MOST - slope) } else { 0.0 }
}

/// The profile of Bagnold in a bed of the height h: h^(3/2) - (h - z)^(3/2) at the height z.
fn bagnold(height: f64, bed: f64) -> f64 {
    bed.powf(1.5) - (bed - height).max(0.0).powf(1.5)
}

/// Grains on a rough floor that is inclined along x, periodic along x and z. They begin as a flow with an inertial number.
fn bed(degrees: f64, start: f64) -> Result<Scene> {
    let mut random = Pcg64Mcg::seed_from_u64(8);
    let (mut scene, glass) = empty()?;
    let angle = degrees.to_radians();
    scene.settings.gravity_direction = Vec3::new(angle.sin() as f32, -angle.cos() as f32, 0.0);
    let [along, across, up] = BED;
    for (axis, length) in [(0, along), (2, across)] {
        scene.set_periodic(axis, Some([0.0, length as f32]))?;
    }
    let steady = 2.0 / 3.0 * start * (0.58 * angle.cos()).sqrt();
    for layer in 0..=up {
        for place in 0..along * across {
            let mut random = |width: f32| random.random_range(-width..width);
            let at = Vec3::new((place % along) as f32 + 0.5, 0.0, (place / along) as f32 + 0.5);
            let sphere = if layer == 0 {
                Sphere::new(at + Vec3::new(random(0.1), random(0.45), random(0.1)), 0.5).fixed()
            } else {
                let height = 0.5 + 1.02 * layer as f32;
                let speed = steady * bagnold(layer as f64 - 0.5, up as f64);
                let at = at + Vec3::new(random(0.03), height, random(0.03));
                Sphere::new(at, 0.5 + random(0.05)).density(6.0 / PI as f32).velocity([speed as f32, 0.0, 0.0])
            };
            scene.add_sphere(sphere.material(glass))?;
        }
    }
    Ok(scene)
}

/// The mean speed and height of the grains, and the mean speed in layers of a height of 1.
struct Flow {
    speed: f64,
    height: f64,
    layers: Vec<(f64, f64)>,
}

fn flow(degrees: f64, start: f64, settle: u64, samples: u32) -> Result<Flow> {
    let mut simulation = on_cpu(bed(degrees, start)?, Integrator::VelocityVerlet)?;
    simulation.run(1_000 * settle, STEP)?;
    let mut layers = vec![[0.0; 2]; BED[2] + 4];
    let (mut speed, mut height) = (0.0, 0.0);
    for _ in 0..samples {
        simulation.run(500, STEP)?;
        let states = simulation.spheres()?;
        let moving: Vec<_> = states.iter().filter(|state| !state.fixed).collect();
        let share = 1.0 / (moving.len() as f64 * f64::from(samples));
        for state in moving {
            let [x, y] = [state.velocity.x, state.position.y].map(f64::from);
            (speed, height) = (speed + share * x, height + share * y);
            if let Some(layer) = layers.get_mut(y.max(0.0) as usize) {
                layer[0] += 1.0;
                layer[1] += x;
            }
        }
    }
    let enough = 10.0 * f64::from(samples);
    let layers = layers.iter().enumerate().filter(|(_, layer)| layer[0] > enough);
    let layers = layers.map(|(number, [count, sum])| (number as f64 + 0.5, sum / count)).collect();
    Ok(Flow { speed, height, layers })
}

/// The inertial number of a flow, from its mean speed: 2/5 I h^(3/2) (φ cos θ)^(1/2).
fn measured(flow: &Flow, degrees: f64) -> (f64, f64) {
    // The floor is at the top of the fixed spheres.
    let bed = 2.0 * (flow.height - 0.5);
    let filled = (BED[2] as f64) * PI / 6.0 / bed;
    (2.5 * flow.speed / (bed.powf(1.5) * (filled * degrees.to_radians().cos()).sqrt()), bed)
}

fn inclines(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    let (settle, samples) = effort.pick((20, 20), (50, 160));
    let mut chart = Chart::new("incline", "Grains that flow down an incline", Axis::linear("height (diameters)"), Axis::linear("speed"));
    for (colour, degrees) in effort.pick(&[24.0][..], &[24.0, 26.0]).iter().enumerate() {
        let flow = flow(*degrees, inertial(*degrees), settle, samples)?;
        let (number, bed) = measured(&flow, *degrees);
        outcome.check(format!("{degrees} degrees: inertial number"), inertial(*degrees), number, 0.5 * inertial(*degrees));
        let scale = 2.5 * flow.speed / bed.powf(1.5) * 2.0 / 3.0;
        let theory = |height: f64| scale * bagnold(height - 0.5, bed);
        let top = theory(bed + 0.5);
        let inside = flow.layers.iter().filter(|(height, _)| (1.0..bed - 0.5).contains(height));
        let off = inside.map(|(height, speed)| (speed - theory(*height)).abs() / top).fold(0.0, f64::max);
        outcome.check(format!("{degrees} degrees: profile, largest departure / speed at the top"), 0.0, off, 0.25);
        chart = chart.add(colour, Mark::Line, format!("{degrees} degrees, Bagnold"), curve(0.5, bed + 0.5, 100, theory));
        chart = chart.add(colour, Mark::Points, format!("{degrees} degrees, measured"), flow.layers);
    }
    outcome.charts.push(chart);
    let stopped = flow(15.0, inertial(24.0), 20, 4)?;
    outcome.check("15 degrees: mean speed after 20 units of time", 0.0, stopped.speed, 0.005);
    Ok(())
}

/// Part of the grains in a drum that are above its axis, where all stay at the wall if they are taken along. `froude` is w² R / G.
fn above(froude: f64, effort: Effort) -> Result<f64> {
    const RADIUS: f32 = 10.0;
    let (mut scene, glass) = empty()?;
    scene.set_pair(glass, glass, Pair::default().stiffness(5e3).restitution(0.3).friction(1.0))?;
    scene.set_periodic(2, Some([-2.0, 2.0]))?;
    let turn = MotionTerm::turn((froude / f64::from(RADIUS)).sqrt(), [0.0, 0.0, 1.0], [0.0; 3]);
    let motion = scene.add_motion(Motion::new("drum", turn))?;
    let wall = Polygon::cylinder([0.0, 0.0, -2.0], [0.0, 0.0, 1.0], RADIUS, 4.0).inside(true);
    scene.add_polygon(wall.material(glass).motion(motion))?;
    for number in 0..60_u8 {
        let [x, y, z] = [number % 5, number / 20, number / 5 % 4].map(f32::from);
        scene.add_sphere(Sphere::new([1.1 * x - 2.2, 1.1 * y - 8.0, z - 1.5], 0.45).density(1.0).material(glass))?;
    }
    let mut simulation: Simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    simulation.run(effort.pick(40_000, 150_000), STEP)?;
    let (mut share, samples) = (0.0, 20);
    for _ in 0..samples {
        simulation.run(1_000, STEP)?;
        let states = simulation.spheres()?;
        let count = states.iter().filter(|state| state.position.y > 0.0).count();
        share += count as f64 / (states.len() as f64 * f64::from(samples));
    }
    Ok(share)
}

pub(super) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let mut outcome = Outcome::default();
        inclines(&mut outcome, effort)?;
        outcome.check("drum, Fr = 0.01: part of the grains above the axis", 0.0, above(0.01, effort)?, 0.02);
        outcome.check("drum, Fr = 4: part of the grains above the axis", 0.5, above(4.0, effort)?, 0.1);
        Ok(outcome)
    })
}
