//! Shaking of spheres of different sizes: a large one rises.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::{Cuboid, Integrator, Scene, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{NO_COLLISIONS, friction, mean, on_cpu, on_one_thread, support, with};
use crate::{Effort, Outcome, Result};

/// Amplitude of the acceleration of the box, over G.
const SHAKING: f64 = 4.0;
/// Period of the shaking, in s.
const PERIOD: f64 = 4.0;
/// Time step, in s. It is short because friction below many layers is stiff.
const STEP: f64 = 0.004;

/// A box with a sphere of radius `large` on its floor, and many of a radius of about 0.5 around and above it, in a plane.
fn shaken(large: f32) -> Result<Scene> {
    const HALF: f32 = 6.0;
    let mut scene = with(|settings| {
        settings.coulomb_friction = 0.5;
        (settings.collisions, settings.activation_threshold) = (false, NO_COLLISIONS);
    });
    scene.add_box(Cuboid::between([-20.0, -5.0, -5.0], [20.0, 0.0, 5.0]))?;
    scene.add_box(Cuboid::between([-20.0, 0.0, -5.0], [-HALF, 100.0, 5.0]))?;
    scene.add_box(Cuboid::between([HALF, 0.0, -5.0], [20.0, 100.0, 5.0]))?;
    scene.add_sphere(Sphere::new([0.0, large, 0.0], large).mass((2.0 * large).powi(3)))?;
    let mut random = Pcg64Mcg::seed_from_u64(5);
    for index in 0..160 {
        let place = [1.12 * ((index % 10) as f32 - 4.5), 0.6 + 1.12 * (index / 10) as f32];
        // Spheres at the position of the large one are moved up.
        let raised = if place[0].hypot(place[1] - large) < large + 0.56 { 20.0 } else { 0.0 };
        let radius = random.random_range(0.4_f32..0.56);
        let x = place[0] + random.random_range(-0.01_f32..0.01);
        scene.add_sphere(Sphere::new([x, place[1] + raised, 0.0], radius).mass((2.0 * radius).powi(3)))?;
    }
    Ok(scene)
}

/// Measurements of the shaken bed.
struct Bed {
    /// Force of the overlaps on the floor at rest, over the weight.
    floor: f64,
    /// Largest ratio of the friction on a sphere to the sum of its pressures, as the mean over the periods.
    friction: f64,
    /// Height after each period: of the marked sphere, over twice the mean height of the others; 0 at the floor, 1 at the top.
    heights: Vec<(f64, f64)>,
}

/// Shakes a bed with a marked sphere of radius `large`.
fn bed(large: f32, periods: u32) -> Result<Bed> {
    const PIECES: u32 = 25;
    let mut simulation = on_cpu(shaken(large)?, Integrator::SymplecticEuler)?;
    simulation.run(3_000, 0.01)?;
    let mass: f64 = simulation.spheres()?.iter().map(|sphere| f64::from(sphere.mass)).sum();
    let mut bed = Bed { floor: support(&mut simulation, 1_000.0)?.up / mass, friction: 0.0, heights: Vec::new() };
    for period in 0..=periods {
        let spheres = simulation.spheres()?;
        let others: Vec<f64> = spheres[1..].iter().map(|sphere| f64::from(sphere.position.y)).collect();
        bed.heights.push((f64::from(period), f64::from(spheres[0].position.y) / (2.0 * mean(&others))));
        bed.friction += friction(&mut simulation, STEP as f32)?.ratio / f64::from(periods + 1);
        for piece in 0..PIECES {
            let phase = (f64::from(piece) + 0.5) / f64::from(PIECES);
            let mut settings = *simulation.settings();
            settings.gravity = (1.0 + SHAKING * (TAU * phase).sin()) as f32;
            simulation.set_settings(settings)?;
            simulation.run((PERIOD / STEP) as u64 / u64::from(PIECES), STEP as f32)?;
        }
    }
    Ok(bed)
}

/// Mean over the second half of the heights.
fn last(heights: &[(f64, f64)]) -> f64 {
    mean(&heights[heights.len() / 2..].iter().map(|height| height.1).collect::<Vec<_>>())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    let periods = effort.pick(40, 120);
    on_one_thread(move || {
        let bed_of_large = bed(1.5, periods)?;
        let large = bed_of_large.heights;
        // Only for comparison in the plot, without a check.
        let small = bed(0.5, effort.pick(2, periods))?.heights;
        let mut outcome = Outcome::default();
        outcome.fact("periods", f64::from(periods));
        outcome.check("large sphere: initial height (0: floor, 1: top)", 0.15, large[0].1, 0.15);
        outcome.check("large sphere: mean height in the second half", 0.6, last(&large), 0.3);
        outcome.check("overlaps on the floor at rest, in force / weight", 1.0, bed_of_large.floor, 0.02);
        outcome.check("largest friction on a sphere / pressure", 0.5, bed_of_large.friction, 0.03);
        let axes = (Axis::linear("period of the shaking"), Axis::linear("height (0: floor, 1: top of the bed)"));
        outcome.charts.push(
            Chart::new("mixing", "A sphere in a shaken bed of spheres of radius 0.5", axes.0, axes.1)
                .add(1, Mark::Points, "radius 1.5", large)
                .add(0, Mark::Points, "radius 0.5, like the others", small),
        );
        Ok(outcome)
    })
}
