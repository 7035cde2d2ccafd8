//! Double precision of positions: grains far from the origin against theory, and against the same grains at the origin.

use rockfall::glam::Vec3;
use rockfall::{ContactLaw, Cuboid, Integrator, Material, MaterialId, Pair, Precision, Scene, Simulation, Sphere, SphereId};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Distance of the small grains from the origin, in m: each of their coordinates is about this.
const FAR: f64 = 10.0;
const PRECISIONS: [Precision; 2] = [Precision::Double, Precision::Single];

/// A scene of grains at `[origin; 3]` with one material.
struct Place {
    scene: Scene,
    material: MaterialId,
    density: f32,
    origin: f64,
}

impl Place {
    fn new(origin: f64, precision: Precision, [young, density]: [f32; 2], pair: Pair) -> Result<Self> {
        let mut scene = with(|settings| {
            (settings.contact_law, settings.precision) = (ContactLaw::HertzMindlin, precision);
            (settings.collisions, settings.gravity) = (false, 0.0);
        });
        let material = scene.add_material(Material::new("solid").young(young).poisson(0.25).density(density))?;
        scene.set_pair(material, material, pair)?;
        Ok(Self { scene, material, density, origin })
    }

    /// Adds a box. Its corners are f32 numbers.
    fn cuboid(&mut self, corners: [[f64; 3]; 2]) -> Result<()> {
        let [low, high] = corners.map(|corner| corner.map(|part| (self.origin + part) as f32));
        self.scene.add_box(Cuboid::between(low, high).material(self.material))?;
        Ok(())
    }

    fn ball(&mut self, position: [f64; 3], radius: f32, velocity: Vec3) -> Result<SphereId> {
        let ball = Sphere::new([0.0; 3], radius).density(self.density).material(self.material).velocity(velocity);
        Ok(self.scene.add_sphere(ball.centred_at(position.map(|part| self.origin + part)))?)
    }
}

/// Number of grains of the column.
const COLUMN: usize = 10;
const COLUMN_RADIUS: f32 = 1e-3;
/// Young's modulus in Pa and density in kg/m³ of the column.
const COLUMN_SOLID: [f32; 2] = [1e9, 2500.0];

/// Overlaps of the contacts of the column at rest, from below, in m. The contact below k grains carries k m g.
fn hertz_overlaps() -> [f64; COLUMN] {
    let [young, density] = COLUMN_SOLID.map(f64::from);
    let radius = f64::from(COLUMN_RADIUS);
    let weight = 9.81 * density * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    let modulus = young / (2.0 * (1.0 - 0.25 * 0.25));
    std::array::from_fn(|index| {
        let reduced: f64 = if index == 0 { radius } else { 0.5 * radius };
        (3.0 * (COLUMN - index) as f64 * weight / (4.0 * modulus * reduced.sqrt())).powf(2.0 / 3.0)
    })
}

/// Overlaps of the column after 0.08 s, in m, and the greatest speed then. The grains start in a row that touches the floor.
fn overlaps(precision: Precision) -> Result<([f64; COLUMN], f64)> {
    let mut place = Place::new(FAR, precision, COLUMN_SOLID, Pair::default().restitution(0.3).friction(0.3))?;
    (place.scene.settings.gravity, place.scene.settings.linear_damping) = (9.81, 3000.0);
    place.cuboid([[-0.5, -0.5, -0.5], [0.5, 0.0, 0.5]])?;
    let radius = f64::from(COLUMN_RADIUS);
    for index in 0..COLUMN {
        place.ball([0.0, (2 * index + 1) as f64 * radius, 0.0], COLUMN_RADIUS, Vec3::ZERO)?;
    }
    let mut simulation = on_cpu(place.scene, Integrator::VelocityVerlet)?;
    simulation.run(40_000, 2e-6)?;
    let spheres = simulation.spheres()?;
    let mut below = FAR - radius;
    let overlaps = std::array::from_fn(|index| {
        let height = spheres[index].centre()[1];
        2.0 * radius - (height - std::mem::replace(&mut below, height))
    });
    Ok((overlaps, spheres.iter().map(|sphere| f64::from(sphere.velocity.length())).fold(0.0, f64::max)))
}

fn column(outcome: &mut Outcome) -> Result<()> {
    let expected = hertz_overlaps();
    let axes = (Axis::linear("contact, from below"), Axis::linear("overlap at rest (µm)"));
    let points = |overlaps: [f64; COLUMN]| (1..).zip(overlaps).map(|(k, overlap)| (f64::from(k), 1e6 * overlap)).collect();
    let mut chart = Chart::new("precision-column", "Ten grains of radius 1 mm and 1 GPa, 10 m from the origin", axes.0, axes.1)
        .add(0, Mark::Line, "Hertz", points(expected));
    for (colour, precision) in PRECISIONS.into_iter().enumerate() {
        let (found, speed) = overlaps(precision)?;
        let worst = found.iter().zip(expected).map(|(found, expected)| (found / expected - 1.0).abs()).fold(0.0, f64::max);
        if precision == Precision::Double {
            outcome.check("column, double: relative error of the worst overlap", 0.0, worst, 0.01);
        } else {
            outcome.fact("column_single", worst);
            outcome.fact("column_speed", 1e3 * speed);
        }
        chart = chart.add(colour, Mark::Points, precision.to_string(), points(found));
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Tangential and normal velocity, and velocity of the surface by the spin, of a ball after an oblique impact on a plane: test 4 of
/// Chung and Ooi. An impact takes 6 to 11 µs.
fn rebound(origin: f64, precision: Precision, degrees: f64) -> Result<[f64; 3]> {
    const STEPS: u16 = 500;
    let pair = Pair::default().restitution(0.98).friction(0.092);
    let mut place = Place::new(origin, precision, [380e9, 4000.0], pair)?;
    place.cuboid([[-0.5, -0.5, -0.5], [0.5, 0.0, 0.5]])?;
    let radius = 0.0025_f32;
    let (sin, cos) = degrees.to_radians().sin_cos();
    let velocity = Vec3::new((3.9 * sin) as f32, (-3.9 * cos) as f32, 0.0);
    place.ball([0.0, radius.into(), 0.0], radius, velocity)?;
    let mut simulation = on_cpu(place.scene, Integrator::SymplecticEuler)?;
    simulation.run(STEPS.into(), 1.6e-5 / f32::from(STEPS))?;
    let ball = simulation.spheres()?[0];
    if precision == Precision::Double && simulation.report().contacts > 0 {
        return Err(format!("the impact at {degrees} degrees does not end").into());
    }
    Ok([ball.velocity.x, ball.velocity.y, -radius * ball.spin().z].map(f64::from))
}

fn impacts(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("angle of impact (degrees)"), Axis::linear("speed of the surface by the spin (m/s)"));
    let mut chart = Chart::new("precision-impact", "Test 4 of Chung and Ooi, 10 m from the origin", axes.0, axes.1);
    let (mut line, mut points, mut worst) = (Vec::new(), [Vec::new(), Vec::new()], [0.0_f64; 2]);
    for degrees in (5..=85).step_by(5).map(f64::from) {
        let here = rebound(0.0, Precision::Double, degrees)?;
        line.push((degrees, here[2]));
        for (index, precision) in PRECISIONS.into_iter().enumerate() {
            let there = rebound(FAR, precision, degrees)?;
            points[index].push((degrees, there[2]));
            let differences = here.into_iter().zip(there).map(|(here, there)| (there / here - 1.0).abs());
            worst[index] = differences.fold(worst[index], f64::max);
        }
    }
    outcome.check("impacts, double: relative difference of the worst velocity or spin", 0.0, worst[0], 1e-3);
    outcome.fact("impact_single", worst[1]);
    chart = chart.add(0, Mark::Line, "at the origin", line);
    for (colour, (points, precision)) in points.into_iter().zip(PRECISIONS).enumerate() {
        chart = chart.add(colour, Mark::Points, precision.to_string(), points);
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Time step of the pile, in s.
const PILE_STEP: f32 = 1e-3;
const BALLS: u32 = 60;
/// Number of samples of the energy, and steps between two of them.
const SAMPLES: u32 = 75;
const SAMPLE_STEPS: u64 = 200;

/// Balls of radius 0.5 above a floor with walls.
fn pile(origin: f64, precision: Precision) -> Result<Simulation> {
    let pair = Pair::default().restitution(0.2).friction(0.5).rolling_friction(0.05);
    let mut place = Place::new(origin, precision, [2e5, 1.0], pair)?;
    let settings = &mut place.scene.settings;
    (settings.gravity, settings.linear_damping, settings.angular_damping) = (10.0, 2.0, 2.0);
    place.cuboid([[-4.0, -1.0, -4.0], [4.0, 0.0, 4.0]])?;
    for side in [-4.0, 2.0] {
        place.cuboid([[side, 0.0, -4.0], [side + 2.0, 9.0, 4.0]])?;
        place.cuboid([[-4.0, 0.0, side], [4.0, 9.0, side + 2.0]])?;
    }
    for k in 0..BALLS {
        let (x, z, y) = (f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
        let position = [1.1 * x - 1.15 + 0.03 * z, 0.5 + 1.05 * y, 1.1 * z - 1.15 + 0.02 * y];
        place.ball(position, 0.5, Vec3::ZERO)?;
    }
    on_cpu(place.scene, Integrator::VelocityVerlet)
}

/// Kinetic energy over time.
fn settling(origin: f64, precision: Precision) -> Result<Vec<(f64, f64)>> {
    let mut simulation = pile(origin, precision)?;
    (1..=SAMPLES)
        .map(|sample| {
            simulation.run(SAMPLE_STEPS, PILE_STEP)?;
            Ok((f64::from(sample) * SAMPLE_STEPS as f64 * f64::from(PILE_STEP), simulation.energy()?.kinetic))
        })
        .collect()
}

/// Root mean square speed of the balls at the greatest kinetic energy of the last second, in last digits of a coordinate at
/// 1e5 per step. The low part of such a coordinate is at most 2^-8, and its last digit at most 2^-32.
fn digits_per_step(energies: &[(f64, f64)]) -> f64 {
    let mass = f64::from(BALLS) * 4.0 / 3.0 * std::f64::consts::PI * 0.125;
    let last = &energies[energies.len() - 5..];
    let greatest = last.iter().map(|energy| energy.1).fold(0.0, f64::max);
    (2.0 * greatest / mass).sqrt() * f64::from(PILE_STEP) * 2.0_f64.powi(32)
}

fn piles(outcome: &mut Outcome) -> Result<()> {
    let near = settling(0.0, Precision::Double)?;
    let [far, coarse] = PRECISIONS.map(|precision| settling(1e5, precision));
    let (far, coarse) = (far?, coarse?);
    let early = near.iter().zip(&far).take_while(|(near, _)| near.0 < 2.1);
    let difference = early.map(|(near, far)| (far.1 / near.1 - 1.0).abs()).fold(0.0, f64::max);
    outcome.check("pile at 1e5, double: relative difference of the kinetic energy in 2 s", 0.0, difference, 0.01);
    let what = |case: &str| format!("pile {case}, double: speed at rest (last digits per step)");
    outcome.check(what("at the origin"), 0.0, digits_per_step(&near), 5.0);
    outcome.check(what("at 1e5"), 0.0, digits_per_step(&far), 5.0);
    outcome.fact("pile_single", digits_per_step(&coarse));
    let axes = (Axis::linear("time (s)"), Axis::logarithmic("kinetic energy"));
    outcome.charts.push(
        Chart::new("precision-pile", "A pile of balls of radius 0.5 comes to rest", axes.0, axes.1)
            .add(0, Mark::Line, "at the origin, double", near)
            .add(0, Mark::Points, "at 1e5, double", far)
            .add(1, Mark::Points, "at 1e5, single", coarse),
    );
    Ok(())
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        column(&mut outcome)?;
        impacts(&mut outcome)?;
        piles(&mut outcome)?;
        Ok(outcome)
    })
}
