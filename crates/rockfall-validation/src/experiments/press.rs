//! Walls that seek a force or a torque: a cubic packing, the decay of the error, a shaft, and a random packing.

use rockfall::glam::DVec3;
use rockfall::{
    ContactLaw, Cuboid, Gauge, Integrator, Material, Meter, Motion, MotionId, Pair, Scene, Servo, Simulation, Sphere, Tether,
};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Columns along each side of the packing, and balls of a column.
const SIDE: u16 = 4;
const LAYERS: u16 = 3;
/// A quantity of a step.
type Theory = fn(i32) -> f64;

/// Stiffness of a contact, and the force that the plate seeks.
const STIFFNESS: f64 = 1_000.0;
const FORCE: f64 = 160.0;
const STEP: f32 = 1e-3;
/// Part of the error that a servo corrects within a step.
const GAIN: f64 = 0.25;

/// Balls of radius 0.5 between a floor and a plate that touches them.
fn packing(mass: f32, restitution: f32, speed: f64) -> Result<(Scene, MotionId)> {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::Linear, false, 0.0);
    });
    let rubber = scene.add_material(Material::new("rubber").density(1.0))?;
    let pair = Pair::default().stiffness(STIFFNESS as f32).restitution(restitution).friction(0.0);
    scene.set_pair(rubber, rubber, pair)?;
    let (reach, top) = (f32::from(SIDE), f32::from(LAYERS));
    scene.add_box(Cuboid::between([0.0, -1.0, 0.0], [reach, 0.0, reach]).material(rubber))?;
    let plate = scene.add_motion(Motion::servo("plate", Servo::force([0.0, -FORCE, 0.0], speed)))?;
    scene.add_box(Cuboid::between([0.0, top, 0.0], [reach, top + 1.0, reach]).material(rubber).motion(plate))?;
    for index in 0..SIDE * SIDE * LAYERS {
        let place = [index % SIDE, index / (SIDE * SIDE), index / SIDE % SIDE].map(|place| f32::from(place) + 0.5);
        scene.add_sphere(Sphere::new(place, 0.5).mass(mass).material(rubber))?;
    }
    Ok((scene, plate))
}

fn displacement(simulation: &mut Simulation, plate: MotionId) -> Result<f64> {
    let motion = simulation.sync()?.motion(plate)?;
    Ok(motion.servo.ok_or("expected a servo")?.displacement)
}

/// The plate comes to rest with its force.
fn cubic(outcome: &mut Outcome) -> Result<()> {
    let (mut scene, plate) = packing(1.0, 1.0, 0.5)?;
    scene.settings.linear_damping = 5.0;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    simulation.run(8_000, STEP)?;
    let overlap = FORCE / (f64::from(SIDE * SIDE) * STIFFNESS);
    let load = simulation.wall_load("plate")?;
    outcome.check("cubic packing: force of the plate", FORCE, load.force.y, 0.02);
    let contacts = simulation.contacts()?;
    let deepest = contacts.iter().map(|contact| f64::from(contact.overlap)).fold(0.0, f64::max);
    outcome.check("cubic packing: deepest overlap", overlap, deepest, 2e-3 * overlap);
    let way = displacement(&mut simulation, plate)?;
    outcome.check("cubic packing: way of the plate", f64::from(LAYERS + 1) * overlap, way, 2e-3 * overlap);
    Ok(())
}

/// The errors of the force, as parts of the target, after each step on balls that stand still.
fn errors(integrator: Integrator, steps: u32) -> Result<Vec<f64>> {
    let (scene, plate) = packing(1e9, 1.0, 1e4)?;
    let mut simulation = on_cpu(scene, integrator)?;
    let columns = f64::from(SIDE * SIDE);
    let start = 0.5 * FORCE / (columns * STIFFNESS);
    simulation.update_motion(plate, |motion| motion.servo.iter_mut().for_each(|servo| servo.displacement = start))?;
    let mut errors = Vec::new();
    for _ in 0..steps {
        simulation.run(1, STEP)?;
        errors.push(1.0 - columns * STIFFNESS * displacement(&mut simulation, plate)? / FORCE);
    }
    Ok(errors)
}

fn decay(outcome: &mut Outcome) -> Result<()> {
    let mut chart =
        Chart::new("press-decay", "Error of the force of a plate", Axis::linear("step"), Axis::logarithmic("error / force"));
    let theories: [(&str, Integrator, Theory); 2] = [
        ("velocity Verlet", Integrator::VelocityVerlet, |n| 0.5 * (1.0 - GAIN).powi(n)),
        ("symplectic Euler", Integrator::SymplecticEuler, |n| 0.5 * (1.0 + 0.5 * f64::from(n)) * 0.5_f64.powi(n)),
    ];
    for (number, (name, integrator, theory)) in theories.into_iter().enumerate() {
        let measured = errors(integrator, 12)?;
        let expected: Vec<f64> = (0..12).map(theory).collect();
        let off = measured.iter().zip(&expected).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
        outcome.check(format!("decay, {name}: largest departure / force"), 0.0, off, 2e-5);
        let points = |values: &[f64]| values.iter().enumerate().map(|(step, value)| (step as f64, *value)).collect::<Vec<_>>();
        chart = chart.add(2 * number, Mark::Line, format!("{name}, theory"), points(&expected));
        chart = chart.add(2 * number + 1, Mark::Points, name, points(&measured));
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Contacts with strong dashpots.
fn damping(outcome: &mut Outcome) -> Result<()> {
    let mass = 1.0;
    let (scene, plate) = packing(mass, 0.1, 0.2)?;
    // The damping of this restitution is about 1.2 sqrt(k m).
    let beta = 1.2 * (f64::from(mass) / STIFFNESS).sqrt() / f64::from(STEP);
    outcome.fact("beta", beta);
    let mut simulation = on_cpu(scene, Integrator::SymplecticEuler)?;
    let (mut before, mut growth) = (f64::INFINITY, 0.0_f64);
    for step in 0..1_300 {
        simulation.run(10, STEP)?;
        let error = (simulation.wall_load("plate")?.force.y - FORCE).abs();
        if step > 200 {
            growth = growth.max(error - before);
        }
        before = error;
    }
    outcome.check("damping: error of the force after 13 s", 0.0, before, 0.02);
    outcome.check("damping: greatest growth of the error in 10 ms after 2 s", 0.0, growth, 0.02);
    let way = displacement(&mut simulation, plate)?;
    let overlap = FORCE / (f64::from(SIDE * SIDE) * STIFFNESS);
    outcome.check("damping: way of the plate", f64::from(LAYERS + 1) * overlap, way, 2e-3 * overlap);
    Ok(())
}

fn shaft(outcome: &mut Outcome) -> Result<()> {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::HertzMindlin, false, 0.0);
    });
    scene.settings.linear_damping = 20.0;
    let rubber = scene.add_material(Material::new("rubber").density(1.0).young(1e5).poisson(0.3))?;
    scene.set_pair(rubber, rubber, Pair::default().restitution(0.5).friction(0.0))?;
    let motion = scene.add_motion(Motion::servo("shaft", Servo::torque(30.0, DVec3::Z, DVec3::ZERO, 1.0)))?;
    scene.add_box(Cuboid::between([1.0, -0.2, -1.0], [5.0, -0.1, 1.0]).material(rubber).motion(motion))?;
    let ball = scene.add_sphere(Sphere::new([3.0, 0.5, 0.0], 0.5).mass(1.0).material(rubber))?;
    scene.add_tether(Tether::new(ball, [3.0, 0.5, 0.0], 1e4).damping(50.0))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    simulation.run(3_000, STEP)?;
    let load = simulation.wall_load("shaft")?;
    outcome.check("shaft: torque on the ball", 30.0, -load.torque.z, 0.02);
    let stretch = simulation.spheres()?[0].position.distance([3.0, 0.5, 0.0].into());
    outcome.check("shaft: force of the spring that holds the ball", 10.0, 1e4 * f64::from(stretch), 0.1);
    Ok(())
}

/// Glass beads in a box under a plate.
fn beads(outcome: &mut Outcome) -> Result<()> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/press.txt");
    let mut scene = Scene::load(path)?.scene;
    let target = 5.0;
    scene.add_gauge(Gauge::wall("plate", "lid"))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let mut chart = Vec::new();
    let mut means = DVec3::ZERO;
    for sample in 0..35 {
        let mut meter = Meter::new(simulation.scene(), true, false);
        simulation.run_metered(400, 5e-5, &mut meter)?;
        let mean = meter.take_means()[0][0];
        chart.push((0.02 * f64::from(sample + 1), mean.y));
        if sample >= 30 {
            means += mean / 5.0;
        }
    }
    outcome.check("beads: mean force on the plate (N)", target, means.y, 0.01 * target);
    outcome.charts.push(
        Chart::new("press-beads", "A plate that presses beads with 5 N", Axis::linear("time (s)"), Axis::linear("force (N)"))
            .add(0, Mark::Line, "sought", vec![(0.0, target), (0.7, target)])
            .add(1, Mark::Points, "means over 0.02 s", chart),
    );
    Ok(())
}

pub(super) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        cubic(&mut outcome)?;
        decay(&mut outcome)?;
        damping(&mut outcome)?;
        shaft(&mut outcome)?;
        beads(&mut outcome)?;
        Ok(outcome)
    })
}
