//! A pile on the CPU and on the GPU: the motion is chaotic, so that statistics are compared instead of trajectories.

use rockfall::generate::Kind;
use rockfall::{Backend, Options, Simulation, SphereState};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{mean, support};
use crate::{Effort, Outcome, Result};

/// Statistics of a pile.
struct Statistics {
    /// Mean height of the spheres, in units.
    height: f64,
    /// Contacts per sphere.
    contacts: f64,
    /// Overlaps of all contacts, sorted.
    overlaps: Vec<f64>,
    /// Force of the overlaps on the floor, over the weight.
    floor: f64,
    /// Virial of the overlaps of all contacts, over the virial of the weight.
    virial: f64,
}

fn settled(backend: Backend, stiffness: f32, spheres: u32, seed: u64, steps: u64) -> Result<Statistics> {
    let mut scene = Kind::Pile.generate(spheres, seed)?;
    scene.settings.contact_force = stiffness;
    let mut simulation = Simulation::with_options(scene, Options::new().backend(backend))?;
    simulation.run(steps, 0.02)?;
    let contacts = simulation.contacts()?;
    let mut overlaps: Vec<f64> = contacts.iter().map(|contact| f64::from(contact.overlap)).collect();
    overlaps.sort_by(f64::total_cmp);
    let states = simulation.spheres()?;
    let weighted = |of: fn(&SphereState) -> f32| states.iter().map(|sphere| f64::from(sphere.mass * of(sphere))).sum::<f64>();
    let (weight, moment) = (weighted(|_| 1.0), weighted(|sphere| sphere.position.y));
    let support = support(&mut simulation, f64::from(stiffness))?;
    Ok(Statistics {
        height: moment / weight,
        contacts: overlaps.len() as f64 / f64::from(spheres),
        overlaps,
        floor: support.up / weight,
        virial: support.virial / moment,
    })
}

/// Largest distance of two empirical distributions (Kolmogorov-Smirnov).
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let below = |sorted: &[f64], value: f64| sorted.partition_point(|x| *x <= value) as f64 / sorted.len() as f64;
    a.iter().chain(b).map(|value| (below(a, *value) - below(b, *value)).abs()).fold(0.0, f64::max)
}

/// Mean and standard deviation.
fn spread(values: &[f64]) -> (f64, f64) {
    let middle = mean(values);
    let squares: f64 = values.iter().map(|value| (value - middle).powi(2)).sum();
    (middle, (squares / (values.len() - 1) as f64).sqrt())
}

fn distribution(overlaps: &[f64]) -> Vec<(f64, f64)> {
    let n = overlaps.len();
    let part = |k: usize| (1e3 * overlaps[k], k as f64 / n as f64);
    (0..n).step_by((n / 60).max(1)).map(part).collect()
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    let spheres = effort.pick(150, 500);
    let steps = effort.pick(250, 600);
    let seeds = effort.pick(6, 10);
    let cpu: Vec<Statistics> =
        (0..seeds).map(|seed| settled(Backend::Cpu, 1000.0, spheres, seed, steps)).collect::<Result<_>>()?;
    let gpu = settled(Backend::Gpu, 1000.0, spheres, seeds, steps)?;
    let mut outcome = Outcome::default();
    outcome.fact("spheres", f64::from(spheres));
    outcome.fact("steps", steps as f64);
    outcome.fact("seeds", seeds as f64);
    // Four standard deviations of the difference between one value and the mean of `seeds` others.
    let widen = 4.0 * (1.0 + 1.0 / seeds as f64).sqrt();
    let mut compare = |name: &str, of: fn(&Statistics) -> f64| {
        let (middle, deviation) = spread(&cpu.iter().map(of).collect::<Vec<_>>());
        outcome.check(name, middle, of(&gpu), widen * deviation);
    };
    compare("mean height (units)", |pile| pile.height);
    compare("contacts per sphere", |pile| pile.contacts);
    compare("mean overlap (1e-3 units)", |pile| 1e3 * mean(&pile.overlaps));
    let mut all: Vec<f64> = cpu.iter().flat_map(|pile| pile.overlaps.clone()).collect();
    all.sort_by(f64::total_cmp);
    let (n, m) = (all.len() as f64, gpu.overlaps.len() as f64);
    let critical = 1.95 * ((n + m) / (n * m)).sqrt();
    outcome.check("overlaps: Kolmogorov-Smirnov distance, level 0.1 %", 0.0, distance(&all, &gpu.overlaps), critical);
    let bound = effort.pick(0.12, 0.05);
    let of_cpu = |of: fn(&Statistics) -> f64| mean(&cpu.iter().map(of).collect::<Vec<_>>());
    for (name, floor, virial) in
        [("CPU", of_cpu(|pile| pile.floor), of_cpu(|pile| pile.virial)), ("GPU", gpu.floor, gpu.virial)]
    {
        outcome.check(format!("{name}: overlaps on the floor, in force / weight"), 1.0, floor, bound);
        outcome.check(format!("{name}: virial of all overlaps / virial of the weight"), 1.0, virial, bound);
    }
    let soft = settled(Backend::Cpu, 600.0, spheres, seeds, steps)?;
    let differs = distance(&all, &soft.overlaps) > critical;
    outcome.check("overlaps distinguish a pile of Cc = 600 (1: yes)", 1.0, f64::from(u8::from(differs)), 0.0);
    let axes = (Axis::linear("overlap (1e-3 units)"), Axis::linear("fraction of the contacts with less"));
    outcome.charts.push(
        Chart::new("pile", "Overlaps in a pile", axes.0, axes.1).add(0, Mark::Line, "CPU, all seeds", distribution(&all)).add(
            1,
            Mark::Points,
            "GPU",
            distribution(&gpu.overlaps),
        ),
    );
    Ok(outcome)
}
