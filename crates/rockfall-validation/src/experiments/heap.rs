//! Heaps: the stability of three spheres, and the angle of repose.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::{Cuboid, Integrator, Scene, Simulation, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{mean, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// mu_c, and mu of the square-root law, which is used if mu_c is 0.
type Friction = (f32, f32);

/// Distance by which the top one of three spheres of radius 1 has sunk after 10 s.
fn sunk((coulomb, friction): Friction) -> Result<f64> {
    let mut scene = with(|settings| (settings.friction, settings.coulomb_friction) = (friction, coulomb));
    scene.add_box(Cuboid::between([-50.0, -1.0, -5.0], [50.0, 0.0, 5.0]))?;
    let top = 1.0 + 3.0_f32.sqrt();
    for place in [[-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, top, 0.0]] {
        scene.add_sphere(Sphere::new(place, 1.0))?;
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(5120, 1.0 / 512.0)?;
    Ok(f64::from(top - simulation.spheres()?[2].position.y))
}

/// Checks the heap of three spheres, which stands for mu_c above tan 15 degrees.
fn three(outcome: &mut Outcome) -> Result<()> {
    let limit = 15_f64.to_radians().tan();
    let mut points = Vec::new();
    for coulomb in [0.05_f32, 0.1, 0.15, 0.2, 0.24, 0.26, 0.28, 0.3, 0.35, 0.4] {
        points.push((f64::from(coulomb), sunk((coulomb, 0.0))?));
    }
    let falls = points.iter().filter(|point| point.1 > 0.5).map(|point| point.0).fold(0.0, f64::max);
    let stands = points.iter().filter(|point| point.1 < 0.05).map(|point| point.0).fold(f64::INFINITY, f64::min);
    outcome.check("three spheres: limit of mu_c", limit, 0.5 * (falls + stands), 0.02);
    outcome.check("three spheres: largest mu_c that falls / least that stands", 1.0, falls / stands, 0.15);
    outcome.fact("three_root", sunk((0.0, 50.0))?);
    let axes = (Axis::linear("mu_c"), Axis::linear("sinking of the top in 10 s (units)"));
    outcome.charts.push(
        Chart::new("heap-three", "Three spheres", axes.0, axes.1)
            .add(0, Mark::Line, "tan 15 degrees", vec![(limit, 0.0), (limit, 1.7)])
            .add(1, Mark::Points, "measured", points),
    );
    Ok(())
}

/// Creates a steep heap of spheres in a plane, on a row of fixed ones.
fn heap((coulomb, friction): Friction, rows: u32, seed: u64) -> Result<Scene> {
    let mut scene = with(|settings| {
        (settings.friction, settings.coulomb_friction) = (friction, coulomb);
        settings.collisions = false;
    });
    let reach = 8 * rows as i32;
    for place in -reach..=reach {
        scene.add_sphere(Sphere::new([place as f32, -0.5, 0.0], 0.5).fixed())?;
    }
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    for row in 0..rows {
        let wide = 2 * (rows - row) - 1;
        for place in 0..wide {
            let x = 1.2 * (place as f32 - 0.5 * (wide - 1) as f32) + random.random_range(-0.1_f32..0.1);
            let radius = random.random_range(0.4_f32..0.55);
            // The mass of a sphere of this size, with mass 1 at radius 0.5.
            let sphere = Sphere::new([x, 0.6 + 1.2 * row as f32, 0.0], radius).mass((2.0 * radius).powi(3));
            scene.add_sphere(sphere)?;
        }
    }
    Ok(scene)
}

/// Slope of the triangle that a heap fills, in degrees: three times its mean height over its half width. The half width is the
/// 80 % quantile of |x| over 1 - sqrt(0.2), so that a few spheres that rolled away do not matter.
fn slope(simulation: &mut Simulation) -> Result<f64> {
    let spheres = simulation.spheres()?;
    let places: Vec<_> = spheres.iter().filter(|sphere| !sphere.fixed).map(|sphere| sphere.position.as_dvec3()).collect();
    let height = mean(&places.iter().map(|place| place.y).collect::<Vec<_>>());
    let mut xs: Vec<f64> = places.iter().map(|place| place.x).collect();
    xs.sort_by(f64::total_cmp);
    let middle = xs[xs.len() / 2];
    let mut apart: Vec<f64> = xs.iter().map(|x| (x - middle).abs()).collect();
    apart.sort_by(f64::total_cmp);
    let half_width = apart[apart.len() * 4 / 5] / (1.0 - 0.2_f64.sqrt());
    Ok((3.0 * height / half_width).atan().to_degrees())
}

/// Slope over time, as the mean of several heaps.
fn settling(friction: Friction, rows: u32, seconds: u32, heaps: u32) -> Result<Vec<(f64, f64)>> {
    let mut slopes: Vec<(f64, f64)> = (1..=seconds / 5).map(|time| (5.0 * f64::from(time), 0.0)).collect();
    for seed in 0..heaps {
        let mut simulation = on_cpu(heap(friction, rows, seed.into())?, Integrator::SymplecticEuler)?;
        for sample in &mut slopes {
            simulation.run(500, 0.01)?;
            sample.1 += slope(&mut simulation)? / f64::from(heaps);
        }
    }
    Ok(slopes)
}

/// Last slope of a series.
fn last(slopes: &[(f64, f64)]) -> f64 {
    slopes[slopes.len() - 1].1
}

fn repose(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    let (rows, seconds, heaps) = effort.pick((16, 40, 1), (16, 60, 4));
    outcome.fact("spheres", f64::from(rows * rows));
    outcome.fact("seconds", f64::from(seconds));
    outcome.fact("heaps", f64::from(heaps));
    let smooth = settling((0.0, 0.0), rows, seconds, heaps)?;
    let root = settling((0.0, 50.0), rows, seconds, heaps)?;
    let rough = settling((0.5, 0.0), rows, seconds, heaps)?;
    let mut angles = vec![(0.0, last(&smooth)), (0.5, last(&rough))];
    for coulomb in effort.pick(&[0.1_f32][..], &[0.02, 0.05, 0.1, 0.2, 0.3, 0.8]) {
        angles.push((f64::from(*coulomb), last(&settling((*coulomb, 0.0), rows, seconds, heaps)?)));
    }
    outcome.check("without friction: angle of repose (degrees)", 5.8, last(&smooth), 5.0);
    outcome.check("mu_c = 0.5: angle of repose (degrees)", 15.0, last(&rough), 5.0);
    outcome.check(
        "mu_c = 0.1: position between these two angles",
        0.6,
        (angles[2 + effort.pick(0, 2)].1 - last(&smooth)) / (last(&rough) - last(&smooth)),
        0.5,
    );
    outcome.check("square root, mu = 50: angle over that without friction (degrees)", 0.0, last(&root) - last(&smooth), 3.0);
    let axes = (Axis::linear("mu_c"), Axis::linear("angle of repose (degrees)"));
    let chart = Chart::new("heap-repose", "Angle of repose of a heap in a plane", axes.0, axes.1);
    outcome.charts.push(chart.add(1, Mark::Points, "Coulomb", angles));
    let axes = (Axis::linear("time (s)"), Axis::linear("slope (degrees)"));
    outcome.charts.push(
        Chart::new("heap-creep", "A heap slides to rest", axes.0, axes.1)
            .add(0, Mark::Points, "square root, mu = 50", root)
            .add(1, Mark::Points, "Coulomb, mu_c = 0.5", rough)
            .add(2, Mark::Points, "no friction", smooth),
    );
    Ok(())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let mut outcome = Outcome::default();
        three(&mut outcome)?;
        repose(&mut outcome, effort)?;
        Ok(outcome)
    })
}
