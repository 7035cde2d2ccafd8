//! A large grain in a bed that is shaken upwards and downwards.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::{Cuboid, Pair, Scene};

use crate::chart::{Axis, Chart, Mark};
use crate::granular::{BED, DIAMETER, GRAVITY, grain, grains, simulation};
use crate::measure::{mean, on_one_thread};
use crate::{Effort, Outcome, Result};

/// Period of the shaking, in s.
const PERIOD: f64 = 0.128;
/// Amplitudes of the acceleration, over G.
const STRONG: f64 = 4.0;
const WEAK: f64 = 0.8;
/// Radius of the large grain, in radii of the others.
const LARGE: f64 = 3.0;

fn shaken(friction: f32, seed: u64) -> Result<Scene> {
    const HALF: f64 = 6.0;
    let pair = Pair::default().restitution(0.5).friction(friction).rolling_friction(0.1 * friction);
    let (mut scene, material, _) = grains(BED, pair)?;
    let at = |part: f64| (part * DIAMETER) as f32;
    for [x, y, right, top] in [[-20.0, -5.0, 20.0, 0.0], [-20.0, 0.0, -HALF, 100.0], [HALF, 0.0, 20.0, 100.0]] {
        let cuboid = Cuboid::between([at(x), at(y), at(-5.0)], [at(right), at(top), at(5.0)]);
        scene.add_box(cuboid.material(material))?;
    }
    scene.add_sphere(grain(material, [0.0, 0.5 * LARGE * DIAMETER, 0.0], LARGE))?;
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    for index in 0..160 {
        let (x, y) = (1.12 * (f64::from(index % 10) - 4.5), 0.6 + 1.12 * f64::from(index / 10));
        // Grains at the position of the large one are moved up.
        let raised = if x.hypot(y - 0.5 * LARGE) < 0.5 * LARGE + 0.56 { 20.0 } else { 0.0 };
        let x = x + random.random_range(-0.01..0.01);
        scene.add_sphere(grain(material, [x * DIAMETER, (y + raised) * DIAMETER, 0.0], random.random_range(0.8..1.12)))?;
    }
    Ok(scene)
}

/// Height of the large grain over twice the mean height of the others, after each period: 0 at the floor, 1 at the top.
fn heights(friction: f32, shaking: f64, periods: u32, seed: u64) -> Result<Vec<(f64, f64)>> {
    const PIECES: u32 = 32;
    let steps = (PERIOD / f64::from(PIECES) / f64::from(BED.step)).round() as u64;
    let mut simulation = simulation(shaken(friction, seed)?)?;
    simulation.run(6_000, BED.step)?;
    let mut heights = Vec::new();
    for period in 0..=periods {
        let spheres = simulation.spheres()?;
        let others: Vec<f64> = spheres[1..].iter().map(|sphere| f64::from(sphere.position.y)).collect();
        heights.push((f64::from(period), f64::from(spheres[0].position.y) / (2.0 * mean(&others))));
        for piece in 0..PIECES {
            let phase = (f64::from(piece) + 0.5) / f64::from(PIECES);
            let mut settings = *simulation.settings();
            settings.gravity = (GRAVITY * (1.0 + shaking * (TAU * phase).sin())) as f32;
            simulation.set_settings(settings)?;
            simulation.run(steps, BED.step)?;
        }
    }
    Ok(heights)
}

/// Mean over the second half of the heights.
fn late(heights: &[(f64, f64)]) -> f64 {
    mean(&heights[heights.len() / 2..].iter().map(|height| height.1).collect::<Vec<_>>())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let periods = effort.pick(40, 100);
        let rough = heights(0.5, STRONG, periods, 1)?;
        let smooth = heights(0.0, STRONG, periods, 1)?;
        let weak = heights(0.5, WEAK, effort.pick(10, 40), 1)?;
        let mut outcome = Outcome::default();
        outcome.fact("periods", f64::from(periods));
        outcome.check("initial height (0: floor, 1: top)", 0.12, rough[0].1, 0.05);
        outcome.check("4 G, mu = 0.5: mean height in the second half", 0.75, late(&rough), 0.25);
        outcome.check("4 G, mu = 0: mean height in the second half", 0.25, late(&smooth), 0.2);
        let moved = weak.iter().map(|height| (height.1 - weak[0].1).abs()).fold(0.0, f64::max);
        outcome.check("0.8 G, mu = 0.5: largest change of the height", 0.0, moved, 0.01);
        let axes = (Axis::linear("period of the shaking"), Axis::linear("height (0: floor, 1: top of the bed)"));
        outcome.charts.push(
            Chart::new("brazil", "A grain of three times the radius in a shaken bed", axes.0, axes.1)
                .add(1, Mark::Points, "4 G, mu = 0.5", rough)
                .add(2, Mark::Points, "4 G, mu = 0", smooth)
                .add(0, Mark::Points, "0.8 G, mu = 0.5", weak),
        );
        Ok(outcome)
    })
}
