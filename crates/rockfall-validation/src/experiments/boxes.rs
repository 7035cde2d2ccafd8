//! Periodic boxes, and grains that come and go: a gas without walls, a packing between two plates, and the balance of an inlet and an outlet.

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::Vec3;
use rockfall::{
    ContactLaw, Cuboid, Gauge, GaugeReading, Inlet, Integrator, Material, Motion, MotionTerm, Outlet, Pair, Rate, Scene, Simulation,
    Sphere,
};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Spheres along an edge of the box, and the part of the volume that they fill.
const ALONG: usize = 10;
const FILLED: f64 = 0.1;
/// Time step of the gas.
const STEP: f32 = 0.01;

/// A gas of smooth spheres of diameter 1 and mass 1, with the mean square velocity 1, in a box that is periodic in all directions.
fn gas() -> Result<Scene> {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut scene = with(|settings| {
        (settings.gravity, settings.restitution, settings.activation_threshold) = (0.0, 1.0, 0.0);
        (settings.friction, settings.contact_damping) = (0.0, 0.0);
    });
    let length = (ALONG.pow(3) as f64 * PI / 6.0 / FILLED).cbrt() as f32;
    (0..3).try_for_each(|axis| scene.set_periodic(axis, Some([0.0, length])))?;
    let spacing = length / ALONG as f32;
    for index in 0..ALONG.pow(3) {
        let place = [index % ALONG, index / ALONG % ALONG, index / (ALONG * ALONG)].map(|place| (place as f32 + 0.5) * spacing);
        let velocity = loop {
            let found = Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0_f32)));
            if (0.01..1.0).contains(&found.length_squared()) {
                break found.normalize();
            }
        };
        scene.add_sphere(Sphere::new(place, 0.5).velocity(velocity))?;
    }
    Ok(scene)
}

/// Mean square and mean fourth power of the speeds.
fn moments(simulation: &mut Simulation) -> Result<[f64; 2]> {
    let squares: Vec<f64> =
        simulation.spheres()?.iter().map(|state| state.velocity.as_dvec3().length_squared()).collect();
    let count = squares.len() as f64;
    Ok([squares.iter().sum::<f64>() / count, squares.iter().map(|square| square * square).sum::<f64>() / count])
}

/// Collisions per sphere and unit of time at the temperature 1/3.
fn rate() -> f64 {
    let density = FILLED / (PI / 6.0);
    let at_contact = (1.0 - FILLED / 2.0) / (1.0 - FILLED).powi(3);
    4.0 * density * at_contact * (PI / 3.0).sqrt()
}

/// Rate of collisions, distribution of velocities, and cooling.
fn free_gas(outcome: &mut Outcome) -> Result<()> {
    let mut simulation = on_cpu(gas()?, Integrator::Rk4)?;
    simulation.run(1_000, STEP)?;
    let before = simulation.report().total_collisions;
    let (mut fourth, samples) = (0.0, 40);
    for _ in 0..samples {
        simulation.run(100, STEP)?;
        let [square, power] = moments(&mut simulation)?;
        fourth += power / (square * square) / f64::from(samples);
    }
    let [square, _] = moments(&mut simulation)?;
    let time = f64::from(samples) * 100.0 * f64::from(STEP);
    let collisions = (simulation.report().total_collisions - before) as f64;
    let measured = 2.0 * collisions / (ALONG.pow(3) as f64 * time);
    outcome.check("gas: mean square velocity after 50 units of time", 1.0, square, 0.01);
    outcome.check("gas: collisions per sphere and unit of time", rate(), measured, 0.03 * rate());
    outcome.check("gas: <v⁴>/<v²>²", 5.0 / 3.0, fourth, 0.03);

    let mut settings = *simulation.settings();
    settings.restitution = 0.9;
    simulation.set_settings(settings)?;
    let cooling = (1.0 - 0.9 * 0.9) * rate() / 3.0;
    let theory = |time: f64| (1.0 + 0.5 * cooling * time).powi(-2);
    let (mut measured, mut off) = (vec![(0.0, 1.0)], 0.0_f64);
    for sample in 1..=31 {
        simulation.run(100, STEP)?;
        let time = f64::from(sample);
        let now = moments(&mut simulation)?[0] / square;
        off = off.max((now / theory(time) - 1.0).abs());
        measured.push((time, now));
    }
    outcome.check("cooling gas, e = 0.9: largest departure from Haff's law, relative", 0.0, off, 0.08);
    outcome.charts.push(
        Chart::new("boxes-haff", "A gas that cools in a periodic box", Axis::linear("time"), Axis::linear("temperature"))
            .add(0, Mark::Line, "Haff's law", curve(0.0, 31.0, 100, theory))
            .add(1, Mark::Points, "measured", measured),
    );
    Ok(())
}

/// A simple cubic packing, periodic to the sides, between two plates that close in: the force on a plate against Hertz's law.
fn packing(outcome: &mut Outcome) -> Result<()> {
    const RADIUS: f32 = 0.05;
    const LAYERS: usize = 4;
    const YOUNG: f64 = 1e7;
    const POISSON: f64 = 0.3;
    let side = 2.0 * RADIUS * LAYERS as f32;
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::HertzMindlin, false, 0.0);
    });
    let rubber = scene.add_material(Material::new("rubber").density(1_000.0).young(YOUNG as f32).poisson(POISSON as f32))?;
    scene.set_pair(rubber, rubber, Pair::default().restitution(0.1).friction(0.0))?;
    [0, 2].into_iter().try_for_each(|axis| scene.set_periodic(axis, Some([0.0, side])))?;
    for index in 0..LAYERS.pow(3) {
        let place = [index % LAYERS, index / LAYERS % LAYERS, index / (LAYERS * LAYERS)];
        scene.add_sphere(Sphere::new(place.map(|place| (2 * place + 1) as f32 * RADIUS), RADIUS).material(rubber))?;
    }
    let down = MotionTerm::translation([0.0, -2e-3, 0.0]);
    let lid = scene.add_motion(Motion::new("lid", down))?;
    scene.add_box(Cuboid::between([0.0, -0.1, 0.0], [side, 0.0, side]).material(rubber))?;
    scene.add_box(Cuboid::between([0.0, side, 0.0], [side, side + 0.1, side]).material(rubber).motion(lid))?;
    scene.add_gauge(Gauge::wall("force", "lid"))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let modulus = YOUNG / (2.0 * (1.0 - POISSON * POISSON));
    // Overlap under a force, for an effective radius.
    let overlap = |force: f64, radius: f64| (0.75 * force / (modulus * radius.sqrt())).powf(2.0 / 3.0);
    let radius = f64::from(RADIUS);
    let closed = |force: f64| (LAYERS - 1) as f64 * overlap(force, 0.5 * radius) + 2.0 * overlap(force, radius);
    // Both overlaps grow with the same power of the force.
    let theory = |way: f64| (way / closed(1.0)).powf(1.5) * (LAYERS * LAYERS) as f64;
    let (mut measured, mut off) = (Vec::new(), 0.0_f64);
    for sample in 1..=20 {
        simulation.run(1_000, 1e-4)?;
        let way = 2e-3 * 0.1 * f64::from(sample);
        let [GaugeReading::Wall(load)] = simulation.gauges()?[..] else { return Err("expected the reading of a wall".into()) };
        // At first the plate presses only what it has reached.
        if sample > 8 {
            off = off.max((load.force.y / theory(way) - 1.0).abs());
        }
        measured.push((way, load.force.y));
    }
    outcome.check("packing: largest departure from Hertz's law, relative", 0.0, off, 0.03);
    outcome.charts.push(
        Chart::new("boxes-packing", "A simple cubic packing that is pressed", Axis::linear("way of the lid (m)"), Axis::linear("force on the lid (N)"))
            .add(0, Mark::Line, "Hertz's law", curve(0.0, 4e-3, 100, theory))
            .add(1, Mark::Points, "gauge", measured),
    );
    Ok(())
}

/// Grains that fall from an inlet through a periodic shaft into an outlet.
fn balance(outcome: &mut Outcome) -> Result<()> {
    let mut scene = with(|settings| settings.gravity = 9.81);
    [0, 2].into_iter().try_for_each(|axis| scene.set_periodic(axis, Some([-0.5, 0.5])))?;
    let inlet = Inlet::new("feed", [[-0.4, 3.0, -0.4], [0.4, 3.6, 0.4]], Rate::Mass(100.0), 0.05).density(1_000.0).seed(3);
    scene.add_inlet(inlet.radii("0.03..0.08".parse()?, "mass".parse()?))?;
    scene.add_outlet(Outlet::new("drain", [[-0.5, -1.0, -0.5], [0.5, 0.0, 0.5]]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let (mut off, mut came) = (0.0_f64, 0.0);
    for _ in 0..40 {
        simulation.run(50, 0.002)?;
        let flow = simulation.flow();
        came = flow.inlets[0].mass;
        off = off.max((came - flow.outlets[0].mass - flow.mass).abs());
    }
    let flow = simulation.flow();
    outcome.check("inlet and outlet: mass in, less out, less inside", 0.0, off, 0.0);
    outcome.check("inlet: mass that came in 4 s", 400.0, came, 12.0);
    outcome.check("outlet: 1 if spheres have left", 1.0, f64::from(u8::from(flow.outlets[0].spheres > 200)), 0.0);
    Ok(())
}

pub(super) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        free_gas(&mut outcome)?;
        packing(&mut outcome)?;
        balance(&mut outcome)?;
        Ok(outcome)
    })
}
