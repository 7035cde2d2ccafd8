//! Run-out of columns of grains that collapse on a plane, against their aspect ratio.

use std::f64::consts::{FRAC_PI_2, PI};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::{Cuboid, MaterialId, Pair, Polygon, PolygonId, Scene, Simulation};

use crate::chart::{Axis, Chart, Mark};
use crate::granular::{BED, DIAMETER, GRAVITY, grain, grains, moving, simulation};
use crate::measure::{curve, mean, on_one_thread, power_fit};
use crate::{Effort, Outcome, Result};

/// Friction and rolling friction of the grains.
#[derive(Clone, Copy)]
struct Surface(f32, f32);

const USUAL: Surface = Surface(0.5, 0.1);

/// Number of polygons of the quarter of a tube.
const FACETS: u32 = 8;

/// Aspect ratio of the column at rest, and what is left of it. Lengths are in radii of the column.
#[derive(Clone, Copy)]
struct Collapse {
    aspect: f64,
    runout: f64,
    /// Mean speed of the grains at the end, in m/s.
    speed: f64,
}

/// Run-out over the radius of the column, for axisymmetric columns (Lube et al. 2004).
fn lube(aspect: f64) -> f64 {
    if aspect < 1.7 { 1.24 * aspect } else { 1.6 * aspect.sqrt() }
}

fn metres(diameters: f64) -> f32 {
    (diameters * DIAMETER) as f32
}

/// A floor, two smooth walls that cut a quarter out of the plane, and a smooth quarter of a tube. Lengths in diameters.
fn vessel(scene: &mut Scene, materials: [MaterialId; 2], radius: f64, height: f64) -> Result<Vec<PolygonId>> {
    const THICK: f64 = 9.0;
    let [rough, smooth] = materials;
    let reach = 6.0 * radius + 3.0 * height;
    let corner = [metres(-THICK); 3];
    scene.add_box(Cuboid::between(corner, [metres(reach), 0.0, metres(reach)]).material(rough))?;
    for [x, z] in [[0.0, metres(reach)], [metres(reach), 0.0]] {
        let from = [metres(-THICK), 0.0, metres(-THICK)];
        scene.add_box(Cuboid::between(from, [x, metres(height), z]).material(smooth))?;
    }
    let edge = |number: u32| {
        let (sin, cos) = (FRAC_PI_2 * f64::from(number) / f64::from(FACETS)).sin_cos();
        rockfall::glam::Vec3::new(metres(radius * cos), 0.0, metres(radius * sin))
    };
    (0..FACETS)
        .map(|facet| {
            let up = [0.0, metres(height), 0.0];
            let polygon = Polygon::new(edge(facet), edge(facet + 1) - edge(facet), up);
            Ok(scene.add_polygon(polygon.material(smooth))?)
        })
        .collect()
}

/// Fills the quarter of a tube with grains in layers.
fn fill(scene: &mut Scene, material: MaterialId, count: u32, radius: f64) -> Result<()> {
    const CELL: f64 = 1.08;
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let inside = radius * (FRAC_PI_2 / f64::from(2 * FACETS)).cos() - 0.56;
    let wide = (radius / CELL) as u32 + 1;
    let places = (0..wide * wide).map(|index| [index % wide, index / wide].map(|part| 0.55 + CELL * f64::from(part)));
    let layer: Vec<[f64; 2]> = places.filter(|[x, z]| x.hypot(*z) <= inside).collect();
    for index in 0..count as usize {
        let [x, z] = layer[index % layer.len()];
        let y = 0.55 + CELL * (index / layer.len()) as f64;
        let jitter = random.random_range(-0.02_f64..0.02);
        let position = [x + jitter, y, z - jitter].map(|part| part * DIAMETER);
        scene.add_sphere(grain(material, position, random.random_range(0.85..1.05)))?;
    }
    Ok(())
}

/// Distance, in diameters, of the edge of the deposit: the largest distance at which grains cover a third of a ring of the
/// floor. Grains that rolled further on their own do not count.
fn edge(distances: &[f64]) -> f64 {
    let covered = |at: f64| {
        let [inner, outer] = [at - 0.5, at + 0.5];
        let area = 0.25 * PI * (outer * outer - inner * inner);
        distances.iter().filter(|r| (inner..outer).contains(*r)).count() as f64 * PI / 4.0 / area
    };
    let mut at = distances.iter().copied().fold(0.0, f64::max);
    while at > 1.0 && covered(at) < 1.0 / 3.0 {
        at -= 0.05;
    }
    at
}

/// Distances of the grains from the axis, in diameters.
fn distances(simulation: &mut Simulation) -> Result<Vec<f64>> {
    let spheres = moving(simulation)?;
    Ok(spheres.iter().map(|sphere| f64::from(sphere.position.x.hypot(sphere.position.z)) / DIAMETER).collect())
}

/// Lets `count` grains in the quarter of a cylinder collapse. `aspect` is the height over the radius, to within some per cent.
fn collapse(count: u32, aspect: f64, surface: Surface) -> Result<Collapse> {
    let pair = Pair::default().restitution(0.5).friction(surface.0).rolling_friction(surface.1);
    let (mut scene, rough, smooth) = grains(BED, pair)?;
    // A quarter of a cylinder of bulk density 0.58, in diameters.
    let radius = (f64::from(count) * PI / 6.0 / 0.58 * 4.0 / PI / aspect).cbrt();
    let tube = vessel(&mut scene, [rough, smooth], radius, 2.5 * aspect * radius + 10.0)?;
    fill(&mut scene, rough, count, radius)?;
    let mut simulation = simulation(scene)?;
    let steps = |seconds: f64| (seconds / f64::from(BED.step)) as u64;
    simulation.run(steps(0.25), BED.step)?;
    // The height of a cylinder is twice its mean height.
    let heights: Vec<f64> = moving(&mut simulation)?.iter().map(|sphere| f64::from(sphere.position.y)).collect();
    let height = 2.0 * mean(&heights);
    for polygon in tube {
        simulation.remove_polygon(polygon)?;
    }
    // The deposit is at rest after about three times the time of a fall from the top.
    let fall = (2.0 * height / GRAVITY).sqrt();
    simulation.run(steps(5.0 * fall + 0.15), BED.step)?;
    let speeds: Vec<f64> = moving(&mut simulation)?.iter().map(|sphere| f64::from(sphere.velocity.length())).collect();
    let runout = (edge(&distances(&mut simulation)?) - radius) / radius;
    Ok(Collapse { aspect: height / DIAMETER / radius, runout, speed: mean(&speeds) })
}

/// Run-outs of columns of some aspect ratios.
fn series(count: u32, aspects: &[f64], surface: Surface) -> Result<Vec<Collapse>> {
    aspects.iter().map(|aspect| collapse(count, *aspect, surface)).collect()
}

fn points(series: &[Collapse]) -> Vec<(f64, f64)> {
    series.iter().map(|collapse| (collapse.aspect, collapse.runout)).collect()
}

/// Geometric mean of the run-outs over those of experiments.
fn ratio(points: &[(f64, f64)]) -> f64 {
    mean(&points.iter().map(|(aspect, runout)| (runout / lube(*aspect)).ln()).collect::<Vec<_>>()).exp()
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let count = effort.pick(400, 1000);
        let aspects = effort.pick(&[0.5, 1.3, 2.2, 3.5, 6.0, 10.0][..], &[0.4, 0.7, 1.2, 2.0, 3.2, 5.0, 8.0]);
        let usual = series(count, aspects, USUAL)?;
        let (low, high): (Vec<_>, Vec<_>) = points(&usual).into_iter().partition(|point| point.0 < 1.7);
        let mut outcome = Outcome::default();
        outcome.fact("count", f64::from(count));
        outcome.check("a < 1.7: exponent of a in the run-out", 1.0, power_fit(&low), 0.25);
        outcome.check("a > 1.7: exponent of a in the run-out", 0.5, power_fit(&high), 0.25);
        outcome.check("a < 1.7: run-out / (1.24 a), mean", 1.0, ratio(&low), 0.45);
        outcome.check("a > 1.7: run-out / (1.6 a^(1/2)), mean", 1.0, ratio(&high), 0.35);
        let fastest = usual.iter().map(|collapse| collapse.speed).fold(0.0, f64::max);
        outcome.check("mean speed of the grains at the end, worst case (m/s)", 0.0, fastest, 0.02);
        let axes = (Axis::logarithmic("height / radius a"), Axis::logarithmic("run-out / radius"));
        let mut chart = Chart::new("runout", "Run-out of quarter-cylinders of grains", axes.0, axes.1)
            .add(0, Mark::Line, "Lube et al.: 1.24 a, 1.6 a^(1/2)", curve(0.35, 9.0, 120, lube))
            .add(0, Mark::Points, format!("mu = 0.5, mu_r = 0.1, {count} grains"), points(&usual));
        // Only for comparison in the plot and in the text, without a check.
        let small = effort.pick(None, Some(&[0.7, 2.0, 5.0][..]));
        let names = ["ratio_few", "ratio_weak", "ratio_plain", "ratio_strong"];
        let others = [
            (300, USUAL, "300 grains"),
            (count, Surface(0.25, 0.1), "mu = 0.25"),
            (count, Surface(0.5, 0.0), "mu_r = 0"),
            (count, Surface(0.9, 0.2), "mu = 0.9, mu_r = 0.2"),
        ];
        outcome.fact("ratio", ratio(&points(&usual)));
        for ((name, (count, surface, label)), colour) in names.into_iter().zip(others).zip(1..) {
            let found = points(&series(count, small.unwrap_or_default(), surface)?);
            outcome.fact(name, ratio(&found));
            if !found.is_empty() {
                chart = chart.add(colour, Mark::Points, label, found);
            }
        }
        outcome.charts.push(chart);
        Ok(outcome)
    })
}
