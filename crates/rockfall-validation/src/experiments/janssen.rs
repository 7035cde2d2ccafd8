//! Load on the floor of a tube of grains whose contacts have static friction.

use std::collections::HashSet;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::{Body, ContactAction, ContactLaw, Cuboid, Pair, Simulation, SphereId};

use crate::chart::{Axis, Chart, Mark};
use crate::granular::{BED, DIAMETER, grain, grains, moving, simulation};
use crate::measure::{curve, janssen, janssen_fit, mean, on_one_thread};
use crate::{Effort, Outcome, Result};

/// Width of the square tube, in diameters.
const WIDTH: u32 = 4;
const FRICTION: f32 = 0.5;
/// Velocity of the floor while it sinks, in m/s.
const SINKING: f32 = 0.02;
/// Distance that the floor sinks, in m: half a diameter.
const DEPTH: f64 = 0.5 * DIAMETER;
/// Time in which the grains fall into place, in s.
const POURING: f64 = 0.35;
/// Time between the stop of the floor and the first measurement, in s.
const REST: f64 = 0.3;

/// A tube with grains in it.
struct Tube {
    simulation: Simulation,
    floor: Vec<SphereId>,
    /// Weight of the grains, in N.
    weight: f64,
}

/// Forces on the grains, in N.
#[derive(Clone, Copy, Default)]
struct Loads {
    /// Upward force of the floor.
    floor: f64,
    /// Upward force of the walls.
    walls: f64,
    /// Sum of the normal forces of the walls.
    pressed: f64,
}

impl Tube {
    fn new(layers: u32, law: ContactLaw, wall_friction: bool, seed: u64) -> Result<Self> {
        let pair = Pair::default().restitution(0.5).friction(FRICTION).rolling_friction(0.1);
        let (mut scene, material, smooth) = grains(BED, pair)?;
        scene.settings.contact_law = law;
        // For the law of the thesis: overlaps of a thousandth of the radius for each layer.
        (scene.settings.contact_force, scene.settings.contact_damping) = (2e6, 800.0);
        let place = |index: u32| f64::from(index) + 0.5 - 0.5 * f64::from(WIDTH);
        let mut floor = Vec::new();
        for index in 0..WIDTH * WIDTH {
            let position = [place(index % WIDTH), -0.5, place(index / WIDTH)].map(|part| 0.99 * part * DIAMETER);
            floor.push(scene.add_sphere(grain(material, position, 0.98).fixed())?);
        }
        let half = (0.5 * f64::from(WIDTH) * DIAMETER) as f32;
        for [from, to] in [[-1.0, -half], [half, 1.0]] {
            let material = if wall_friction { material } else { smooth };
            scene.add_box(Cuboid::between([from, -1.0, -1.0], [to, 2.0, 1.0]).material(material))?;
            scene.add_box(Cuboid::between([-1.0, -1.0, from], [1.0, 2.0, to]).material(material))?;
        }
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let across = WIDTH - 1;
        for index in 0..across * across * layers {
            let cell = f64::from(WIDTH) / f64::from(across);
            let mut at = |index: u32| cell * (f64::from(index) - 0.5 * f64::from(across - 1)) + random.random_range(-0.1..0.1);
            let (x, z) = (at(index % across), at(index / across % across));
            let y = 0.6 + 1.12 * f64::from(index / (across * across));
            let size = random.random_range(0.85..1.05);
            scene.add_sphere(grain(material, [x, y, z].map(|part| part * DIAMETER), size))?;
        }
        let mut simulation = simulation(scene)?;
        let gravity = f64::from(simulation.settings().gravity);
        let weight = moving(&mut simulation)?.iter().map(|sphere| gravity * f64::from(sphere.mass)).sum();
        Ok(Self { simulation, floor, weight })
    }

    fn run(&mut self, seconds: f64) -> Result<()> {
        self.simulation.run((seconds / f64::from(BED.step)).round() as u64, BED.step)?;
        Ok(())
    }

    fn loads(&mut self) -> Result<Loads> {
        let floor: HashSet<SphereId> = self.floor.iter().copied().collect();
        let on_floor = |body: Body| matches!(body, Body::Sphere(id) if floor.contains(&id));
        let mut loads = Loads::default();
        for contact in self.simulation.contacts()? {
            let ContactAction::Force(force) = contact.action else { continue };
            // The force is that on B. Statics are last, and the fixed spheres are the first ones.
            if on_floor(contact.a) && !on_floor(contact.b) {
                loads.floor += f64::from(force.y);
            } else if matches!(contact.b, Body::Box(_)) && !on_floor(contact.a) {
                loads.walls -= f64::from(force.y);
                loads.pressed += f64::from(contact.normal_force());
            }
        }
        Ok(loads)
    }

    /// Lets the floor sink, stops it, and waits until the grains are at rest.
    fn sink(&mut self) -> Result<()> {
        /// Steps between two moves of the floor. A move is a hundredth of the overlap of a contact.
        const STEPS: u64 = 5;
        let distance = SINKING * BED.step * STEPS as f32;
        for _ in 0..(DEPTH / f64::from(distance)).round() as u64 {
            for id in &self.floor {
                let position = self.simulation.scene().sphere(*id)?.position;
                self.simulation.set_position(*id, position - rockfall::glam::Vec3::Y * distance)?;
                self.simulation.set_velocity(*id, [0.0, -SINKING, 0.0])?;
            }
            self.simulation.run(STEPS, BED.step)?;
        }
        for id in &self.floor {
            self.simulation.set_velocity(*id, [0.0; 3])?;
        }
        self.run(REST)
    }
}

/// A column at rest, after it was poured and after the floor sank. Forces in N.
struct Column {
    weight: f64,
    /// Height over the width of the tube.
    height: f64,
    poured: Loads,
    sunk: Loads,
}

fn column(layers: u32, wall_friction: bool, seed: u64) -> Result<(Column, Tube)> {
    let mut tube = Tube::new(layers, ContactLaw::HertzMindlin, wall_friction, seed)?;
    tube.run(POURING)?;
    let poured = tube.loads()?;
    tube.sink()?;
    let sunk = tube.loads()?;
    let spheres = moving(&mut tube.simulation)?;
    let middle = mean(&spheres.iter().map(|sphere| f64::from(sphere.position.y)).collect::<Vec<_>>());
    let height = 2.0 * (middle + DEPTH) / (f64::from(WIDTH) * DIAMETER);
    Ok((Column { weight: tube.weight, height, poured, sunk }, tube))
}

/// Load on the floor over the weight, while a column stands, at times in s since the floor stopped.
fn standing(tube: &mut Tube, seconds: f64) -> Result<Vec<(f64, f64)>> {
    let mut points = Vec::new();
    let (mut time, mut next) = (REST, 0.02);
    while time < seconds - 1e-6 {
        let wait = f64::min(next, seconds - time);
        tube.run(wait)?;
        time += wait;
        next *= 1.25;
        points.push((time, tube.loads()?.floor / tube.weight));
    }
    Ok(points)
}

/// Mean of some columns of the same number of layers.
fn mean_of(columns: &[Column], of: impl Fn(&Column) -> f64) -> f64 {
    mean(&columns.iter().map(of).collect::<Vec<_>>())
}

/// The loads on the floors of columns with friction at the walls, and Janssen's law.
fn curve_of_loads(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    let layers = effort.pick(&[4_u32, 8, 14, 24][..], &[2, 4, 6, 9, 13, 18, 24, 32]);
    let seeds = effort.pick(2, 4);
    let (mut poured, mut sunk, mut worst) = (Vec::new(), Vec::new(), 0.0_f64);
    let (mut height, mut mobilised) = (0.0, 0.0);
    for layers in layers {
        let columns = (0..seeds).map(|seed| Ok(column(*layers, true, seed)?.0)).collect::<Result<Vec<_>>>()?;
        let weight = mean_of(&columns, |column| column.weight);
        poured.push((weight, mean_of(&columns, |column| column.poured.floor)));
        sunk.push((weight, mean_of(&columns, |column| column.sunk.floor)));
        let excess = columns.iter().map(|column| (column.sunk.floor + column.sunk.walls) / column.weight - 1.0);
        worst = excess.map(f64::abs).fold(worst, f64::max);
        height = mean_of(&columns, |column| column.height) / weight;
        mobilised = mean_of(&columns, |column| column.sunk.walls / (f64::from(FRICTION) * column.sunk.pressed));
    }
    outcome.check("(load on the floor + friction of the walls) / weight - 1, worst case", 0.0, worst, 0.03);
    let most = janssen_fit(&sunk);
    let departure = sunk.iter().map(|(weight, load)| (load - janssen(*weight, most)).abs() / most).fold(0.0, f64::max);
    outcome.check("(load on the floor - Janssen's) / W_max, worst case", 0.0, departure, 0.25);
    let (last, load) = sunk[sunk.len() - 1];
    outcome.check("load on the floor / weight of the highest column", most / last, load / last, 0.06);
    // W_max is the weight of a column of the height D / (4 m mu K); `height` is in D per newton.
    let ratio = 1.0 / (4.0 * mobilised * f64::from(FRICTION) * most * height);
    outcome.check("K from the fitted W_max", 1.0, ratio, 0.6);
    outcome.fact("most", most / last);
    outcome.fact("mobilised", mobilised);
    outcome.fact("poured", poured[poured.len() - 1].1 / last);
    let axes = (Axis::linear("weight of the grains (N)"), Axis::linear("load on the floor (N)"));
    outcome.charts.push(
        Chart::new("janssen", "Load on the floor of a square tube of grains", axes.0, axes.1)
            .add(2, Mark::Line, "the weight", vec![(0.0, 0.0), (last, last)])
            .add(2, Mark::Points, "poured", poured)
            .add(0, Mark::Line, "Janssen, fitted", curve(0.0, last, 60, |weight| janssen(weight, most)))
            .add(0, Mark::Points, "after the floor sank", sunk),
    );
    Ok(())
}

/// The load on the floor over a long time, with and without springs in the contacts.
fn long_wait(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    const LAYERS: u32 = 18;
    let seconds = effort.pick(2.0, 20.0);
    let (column, mut tube) = column(LAYERS, true, 0)?;
    let first = column.sunk.floor / column.weight;
    let springs = standing(&mut tube, seconds)?;
    let last = springs[springs.len() - 1].1;
    outcome.fact("seconds", seconds);
    outcome.fact("steps", (seconds / f64::from(BED.step)).round());
    outcome.check(format!("change of the load / load in {seconds} s"), 0.0, last / first - 1.0, 0.002);
    let mut tube = Tube::new(LAYERS, ContactLaw::Thesis, true, 0)?;
    tube.run(POURING)?;
    tube.sink()?;
    let thesis = standing(&mut tube, effort.pick(0.8, 4.0))?;
    outcome.check("law of the thesis: load on the floor / weight", 1.0, thesis[thesis.len() - 1].1, 0.03);
    let axes = (Axis::logarithmic("time since the floor stopped (s)"), Axis::linear("load on the floor / weight"));
    outcome.charts.push(
        Chart::new("janssen-time", "A column of grains that stands", axes.0, axes.1)
            .add(0, Mark::Points, "hertz-mindlin", springs)
            .add(1, Mark::Points, "law of the thesis, mu_c = 0.5", thesis),
    );
    Ok(())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let mut outcome = Outcome::default();
        let (smooth, mut tube) = column(14, false, 0)?;
        // Without friction at the walls, waves along the column take long to decay.
        tube.run(1.5)?;
        outcome.check("smooth walls: load on the floor / weight", 1.0, tube.loads()?.floor / smooth.weight, 0.01);
        curve_of_loads(&mut outcome, effort)?;
        long_wait(&mut outcome, effort)?;
        Ok(outcome)
    })
}
