//! Pressure at the bottom of a column of grains: hydrostatic without friction, by Janssen's law with friction.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::{Body, ContactAction, Cuboid, Integrator, Scene, Simulation, Sphere, SphereId};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{NO_COLLISIONS, curve, friction, janssen, janssen_fit, on_cpu, on_one_thread, support, with};
use crate::{Effort, Outcome, Result};

const WIDTH: f32 = 8.0;
const STEP: f32 = 0.01;
/// Velocity of the sinking floor, which makes friction at the walls act upwards at its full strength.
const SINKING: f32 = 0.1;
/// Time step while the floor sinks, shorter because friction on the lowest grains is stiff.
const FINE: f32 = 0.002;

/// Creates `layers` of spheres in a plane between two boxes, on a floor of fixed spheres. Returns the scene and the floor.
fn tube(layers: u32, coulomb: f32) -> Result<(Scene, Vec<SphereId>)> {
    let mut scene = with(|settings| {
        (settings.friction, settings.coulomb_friction) = (0.0, coulomb);
        (settings.collisions, settings.activation_threshold) = (false, NO_COLLISIONS);
        // With less damping, the waves of a column that has fallen into place last for minutes.
        settings.contact_damping = 60.0;
    });
    let floor: Vec<SphereId> = (0..WIDTH as u32)
        .map(|place| {
            let x = place as f32 + 0.5 - 0.5 * WIDTH;
            // The outer spheres are slightly apart from the walls.
            Ok(scene.add_sphere(Sphere::new([0.99 * x, -0.5, 0.0], 0.49).velocity([0.0, -SINKING, 0.0]).fixed())?)
        })
        .collect::<Result<_>>()?;
    for (left, right) in [(-10.0 - WIDTH, -0.5 * WIDTH), (0.5 * WIDTH, 10.0 + WIDTH)] {
        scene.add_box(Cuboid::between([left, -20.0, -5.0], [right, 100.0, 5.0]))?;
    }
    let mut random = Pcg64Mcg::seed_from_u64(3);
    for index in 0..7 * layers {
        let place = [1.12 * ((index % 7) as f32 - 3.0), 0.6 + 1.12 * (index / 7) as f32, 0.0];
        let radius = random.random_range(0.42_f32..0.54);
        let jitter = random.random_range(-0.02_f32..0.02);
        let sphere = Sphere::new([place[0] + jitter, place[1], 0.0], radius).mass((2.0 * radius).powi(3));
        scene.add_sphere(sphere)?;
    }
    Ok((scene, floor))
}

/// Runs one step. Returns the vertical forces on the grains from the pressure of the floor and from friction, the load on the
/// floor by its overlaps, and the largest ratio of friction to pressure.
fn loads(simulation: &mut Simulation, floor: &[SphereId]) -> Result<[f64; 4]> {
    let on_floor = |body: Body| matches!(body, Body::Sphere(id) if floor.contains(&id));
    let mut pressure = 0.0;
    for contact in simulation.contacts()? {
        let ContactAction::Force(force) = contact.action else { continue };
        if on_floor(contact.a) && !on_floor(contact.b) {
            pressure += f64::from(force.y);
        }
    }
    // The default value of Cc.
    let overlaps = support(simulation, 1_000.0)?.up;
    let friction = friction(simulation, FINE)?;
    Ok([pressure, friction.up, overlaps, friction.ratio])
}

/// Measurements of a column while the floor sinks.
struct Column {
    weight: f64,
    /// Mean pressure on the floor.
    floor: f64,
    /// Mean upward friction of the walls and the floor.
    friction_up: f64,
    /// Mean load on the floor, from the depths of its overlaps.
    overlaps: f64,
    /// Largest ratio of the friction on a grain to the sum of its pressures, over all samples.
    friction_ratio: f64,
}

/// Measures a column while the floor sinks for `pieces` times 100 steps, over the second half of that time.
fn weighed(layers: u32, coulomb: f32, pieces: u32) -> Result<Column> {
    let (scene, floor) = tube(layers, coulomb)?;
    let mut simulation = on_cpu(scene, Integrator::SymplecticEuler)?;
    let weight = simulation.spheres()?.iter().filter(|sphere| !sphere.fixed).map(|sphere| f64::from(sphere.mass)).sum();
    // The grains fall into place, and their waves decay.
    simulation.run(3_000, STEP)?;
    let mut sums = [0.0; 4];
    let mut samples = 0.0;
    for piece in 0..pieces {
        for part in 0..20 {
            for id in &floor {
                let place = simulation.scene().sphere(*id)?.position;
                simulation.set_position(*id, place - rockfall::glam::Vec3::Y * (5.0 * SINKING * FINE))?;
            }
            // The number of steps between a move of the floor and the sample varies, with even and odd numbers.
            let before = part % 4;
            simulation.run(before, FINE)?;
            if piece >= pieces / 2 {
                let loads = loads(&mut simulation, &floor)?;
                for (sum, load) in sums.iter_mut().zip(&loads[..3]) {
                    *sum += load;
                }
                sums[3] = sums[3].max(loads[3]);
                samples += 1.0;
            }
            simulation.run(if piece >= pieces / 2 { 4 } else { 5 } - before, FINE)?;
        }
    }
    let [floor, friction_up, overlaps, _] = sums.map(|sum| sum / samples);
    Ok(Column { weight, floor, friction_up, overlaps, friction_ratio: sums[3] })
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let layers = effort.pick(&[5_u32, 12, 25][..], &[3, 6, 10, 15, 20, 30, 40, 50]);
        let pieces = effort.pick(70, 150);
        let all = |coulomb: f32| layers.iter().map(|layers| weighed(*layers, coulomb, pieces)).collect::<Result<Vec<_>>>();
        let (smooth, rough) = (all(0.0)?, all(0.5)?);
        let worst = |of: &dyn Fn(&Column) -> f64, columns: &[Column]| columns.iter().map(|c| of(c).abs()).fold(0.0, f64::max);
        let mut outcome = Outcome::default();
        let bare = worst(&|column| column.floor / column.weight - 1.0, &smooth);
        outcome.check("no friction: load on the floor / weight - 1, worst case", 0.0, bare, 0.05);
        let deep = worst(&|column| column.overlaps / column.weight - 1.0, &smooth);
        outcome.check("no friction: overlaps on the floor, in force / weight - 1, worst case", 0.0, deep, 0.05);
        let total = worst(&|column| (column.floor + column.friction_up) / column.weight - 1.0, &rough);
        outcome.check("mu_c = 0.5: pressure on the floor and friction / weight - 1, worst case", 0.0, total, 0.05);
        let points: Vec<(f64, f64)> = rough.iter().map(|column| (column.weight, column.floor)).collect();
        let most = janssen_fit(&points);
        let departure = worst(&|column| (column.floor - janssen(column.weight, most)) / most, &rough);
        outcome.check("mu_c = 0.5: (load on the floor - Janssen's) / W_max, worst case", 0.0, departure, 0.25);
        let (last, load) = points[points.len() - 1];
        outcome.check(
            "mu_c = 0.5: load on the floor / weight of the highest column",
            janssen(last, most) / last,
            load / last,
            0.15,
        );
        let excess = worst(&|column| (column.friction_ratio - 0.5).max(0.0), &rough);
        outcome.check("mu_c = 0.5: friction on a grain beyond mu_c times its pressures, worst case", 0.0, excess, 0.002);
        outcome.fact("most", most);
        outcome.fact("layers", most / (rough[0].weight / f64::from(layers[0])));
        let axes = (Axis::linear("weight of the grains (mass units/s²)"), Axis::linear("load on the floor (mass units/s²)"));
        let smooth = smooth.iter().map(|column| (column.weight, column.floor)).collect();
        outcome.charts.push(
            Chart::new("column", "A column of grains between two walls", axes.0, axes.1)
                .add(0, Mark::Line, "hydrostatic: the weight", vec![(0.0, 0.0), (last, last)])
                .add(0, Mark::Points, "no friction", smooth)
                .add(1, Mark::Line, "Janssen, fitted", curve(0.0, last, 60, |weight| janssen(weight, most)))
                .add(1, Mark::Points, "Coulomb, mu_c = 0.5", points),
        );
        Ok(outcome)
    })
}
