//! Runout of a column of grains that collapses.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::{Cuboid, Integrator, Sphere, SphereState};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, power_fit, with};
use crate::{Effort, Outcome, Result};

const STEP: f32 = 0.01;

/// Length of the wedge that has the same mean distance of the grains from the wall: three times that distance.
fn length(spheres: &[SphereState]) -> f64 {
    let distances: Vec<f64> =
        spheres.iter().filter(|sphere| !sphere.fixed).map(|sphere| f64::from(sphere.position.x)).collect();
    3.0 * distances.iter().sum::<f64>() / distances.len() as f64
}

/// Width and height of a column at rest, and the length of the heap after the collapse.
fn collapse(width: u32, layers: u32, seed: u64) -> Result<[f64; 3]> {
    let mut scene = with(|settings| {
        settings.coulomb_friction = 0.5;
        settings.collisions = false;
        settings.contact_damping = 25.0;
    });
    let reach = 12 * width + 6 * layers;
    for place in 0..reach {
        scene.add_sphere(Sphere::new([place as f32 + 0.5, -0.5, 0.0], 0.5).fixed())?;
    }
    let top = 2.0 * layers as f32 + 10.0;
    scene.add_box(Cuboid::between([-5.0, -5.0, -5.0], [0.0, top, 5.0]))?;
    let gate = scene.add_box(Cuboid::between([width as f32, 0.0, -5.0], [width as f32 + 5.0, top, 5.0]))?;
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let across = (f64::from(width) / 1.1) as u32;
    for index in 0..across * layers {
        let jitter = random.random_range(-0.02_f32..0.02);
        let place = [0.56 + 1.1 * (index % across) as f32 + jitter, 0.6 + 1.1 * (index / across) as f32, 0.0];
        let radius = random.random_range(0.42_f32..0.53);
        scene.add_sphere(Sphere::new(place, radius).mass((2.0 * radius).powi(3)))?;
    }
    let mut simulation = on_cpu(scene, Integrator::SymplecticEuler)?;
    simulation.run(1_500, STEP)?;
    let spheres = simulation.spheres()?;
    // The height is twice the mean height of the centres, the lowest of which are at about 0.4.
    let moving = spheres.iter().filter(|sphere| !sphere.fixed);
    let (sum, count) = moving.fold((0.0, 0.0), |(sum, count), sphere| (sum + f64::from(sphere.position.y), count + 1.0));
    let height = 2.0 * sum / count;
    simulation.remove_box(gate)?;
    simulation.run((4.0 * height.sqrt() / f64::from(STEP)) as u64, STEP)?;
    Ok([width.into(), height, length(&simulation.spheres()?)])
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let mut outcome = Outcome::default();
        let (mut low, mut high, mut all) = (Vec::new(), Vec::new(), Vec::new());
        let sizes = effort.pick(
            &[(16_u32, 8_u32), (12, 12), (8, 16), (6, 24), (6, 42)][..],
            &[(24, 12), (20, 16), (16, 18), (14, 24), (10, 24), (8, 30), (8, 45), (8, 64)],
        );
        for (width, layers) in sizes {
            let runs = effort.pick(1, 2);
            let mut mean = [0.0; 2];
            for seed in 0..runs {
                let [width, height, length] = collapse(*width, *layers, seed)?;
                mean[0] += height / width / runs as f64;
                mean[1] += (length - width) / width / runs as f64;
            }
            let point = (mean[0], mean[1]);
            if point.0 < 2.5 {
                low.push(point);
            } else {
                high.push(point);
            }
            all.push(point);
        }
        outcome.check("exponent of a in the runout, all a", 0.85, power_fit(&all), 0.25);
        let factor = |points: &[(f64, f64)], of: &dyn Fn(f64) -> f64| {
            (points.iter().map(|(a, runout)| (runout / of(*a)).ln()).sum::<f64>() / points.len() as f64).exp()
        };
        outcome.check("a < 2.5: runout / (1.2 a), mean", 1.0, factor(&low, &|a| 1.2 * a), 0.8);
        outcome.check("a > 2.5: runout / (1.9 a^(2/3)), mean", 1.0, factor(&high, &|a| 1.9 * a.powf(2.0 / 3.0)), 0.8);
        let axes = (Axis::logarithmic("height / width a"), Axis::logarithmic("runout / width"));
        outcome.charts.push(
            Chart::new("collapse", "Runout of a column that collapses", axes.0, axes.1)
                .add(0, Mark::Line, "1.2 a", curve(0.4, 2.5, 20, |a| 1.2 * a))
                .add(2, Mark::Line, "1.9 a^(2/3)", curve(2.5, 9.0, 20, |a| 1.9 * a.powf(2.0 / 3.0)))
                .add(1, Mark::Points, "measured", all),
        );
        Ok(outcome)
    })
}
