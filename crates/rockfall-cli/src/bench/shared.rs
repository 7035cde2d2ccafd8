//! `mpirun rockfall bench drum`: measures a drum that several processes share (docs/cluster.md).

use std::fmt::Write as _;
use std::time::Instant;

use rockfall::Simulation;
use rockfall::cluster::{Cluster, Processes, Work};
use serde_json::{Value, json};

use crate::bench::drum::Arguments;
use crate::bench::spread::Spread;
use crate::failure::Failure;
use crate::output;
use crate::run::team::Starting;

/// What was measured with one number of grains.
struct Measured {
    grains: u32,
    device: String,
    /// Seconds of each run of the first process alone, before the grains are divided.
    alone: Spread,
    /// Seconds of each run.
    seconds: Spread,
    /// What every process had to do in all runs together.
    work: Vec<Work>,
}

/// Measures the drum if `mpirun` started this process. Returns whether it did.
pub(super) fn bench(arguments: &Arguments) -> Result<bool, Failure> {
    let mut starting = Starting::start()?;
    if !starting.is_shared() {
        return Ok(false);
    }
    let mut sizes = Vec::new();
    for grains in &arguments.grains {
        let begun = begin(arguments, *grains, &starting);
        sizes.push(measure(arguments, *grains, starting.all(begun)?)?);
    }
    let text = if arguments.json { object(arguments, &sizes) } else { table(arguments, &sizes) };
    if starting.is_first() {
        output::print(&text)?;
    }
    Ok(true)
}

/// What one process has before it shares the grains with others.
struct Begun {
    cluster: Cluster<Processes>,
    device: String,
    alone: Spread,
}

/// Every process takes the warm-up steps, and the timed steps for the comparison, alone: grains that fall would be divided very often.
fn begin(arguments: &Arguments, grains: u32, starting: &Starting) -> Result<Begun, Failure> {
    if !arguments.has_still_gravity() {
        let message = "MPI: processes cannot share a drum whose direction of gravity turns: expected --triangles or --rpm 0";
        return Err(Failure::usage(message));
    }
    let options = starting.options(arguments.options());
    let mut simulation = Simulation::with_options(arguments.scene(grains)?, options)?;
    let device = simulation.backend().device.clone();
    output::note(&format!("drum {grains}: {} warm-up steps on each process alone", arguments.warmup));
    simulation.run(arguments.warmup, arguments.dt)?;
    let alone = timed(arguments, grains, |steps| Ok(simulation.run(steps, arguments.dt).map(drop)?))?;
    let Some(cluster) = starting.cluster(&mut simulation)? else { unreachable!("mpirun started this process") };
    Ok(Begun { cluster, device, alone })
}

/// The seconds of each run.
fn timed(arguments: &Arguments, grains: u32, mut run: impl FnMut(u64) -> Result<(), Failure>) -> Result<Spread, Failure> {
    let mut seconds = Vec::new();
    for number in 1..=arguments.runs {
        output::note(&format!("drum {grains}: run {number} of {}", arguments.runs));
        let start = Instant::now();
        run(arguments.steps)?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    Ok(Spread::of(seconds))
}

fn measure(arguments: &Arguments, grains: u32, begun: Begun) -> Result<Measured, Failure> {
    let Begun { mut cluster, device, alone } = begun;
    // The first steps divide the grains and build lists.
    cluster.run(arguments.steps, arguments.dt)?;
    let before = cluster.work()?;
    let seconds = timed(arguments, grains, |steps| Ok(cluster.run(steps, arguments.dt)?))?;
    let work = cluster.work()?.into_iter().zip(before).map(|(after, before)| after - before).collect();
    Ok(Measured { grains, device, alone, seconds, work })
}

fn table(arguments: &Arguments, sizes: &[Measured]) -> String {
    let processes = sizes.first().map_or(0, |size| size.work.len());
    let device = sizes.first().map_or("", |size| &size.device);
    let mut text = format!(
        "rockfall bench drum, {}, {processes} processes: {device} and others\n{} steps of {} s after {} warm-up steps, median \
         (minimum to maximum) of {} runs\n",
        arguments.integrator, arguments.steps, arguments.dt, arguments.warmup, arguments.runs
    );
    let ms = 1e3 / arguments.steps as f64;
    for size in sizes {
        let Spread { median, min, max } = size.seconds;
        let rate = f64::from(size.grains) * arguments.steps as f64 / median;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "\n{} grains: {:.3} ms per step ({:.3} to {:.3}), {:.1} million grain-steps/s",
            size.grains,
            median * ms,
            min * ms,
            max * ms,
            rate / 1e6
        );
        let _ = writeln!(
            text,
            "one process alone: {:.3} ms per step ({:.3} to {:.3}), so {processes} are {:.2} times as fast",
            size.alone.median * ms,
            size.alone.min * ms,
            size.alone.max * ms,
            size.alone.median / median
        );
        let _ = writeln!(
            text,
            "{:>7} {:>11} {:>10} {:>10} {:>9} {:>9} {:>9} {:>10} {:>10}",
            "process", "grains", "ghosts", "steps, ms", "rows", "exchange", "waiting", "division", "divisions"
        );
        let ms = ms / f64::from(arguments.runs);
        for (process, work) in size.work.iter().enumerate() {
            let [steps, rows, exchange, waiting, division] =
                [work.steps, work.rows, work.exchange, work.waiting, work.division].map(|seconds| seconds * ms);
            let Work { own, ghosts, divisions, .. } = work;
            let _ = writeln!(
                text,
                "{process:>7} {own:>11} {ghosts:>10} {steps:>10.3} {rows:>9.3} {exchange:>9.3} {waiting:>9.3} {division:>10.3} \
                 {divisions:>10}"
            );
        }
    }
    text
}

fn object(arguments: &Arguments, sizes: &[Measured]) -> String {
    let work = |work: &Work| {
        let Work { own, ghosts, divisions, steps, rows, exchange, waiting, division } = *work;
        json!({
            "grains": own, "ghosts": ghosts, "divisions": divisions, "steps_s": steps, "rows_s": rows, "exchange_s": exchange,
            "waiting_s": waiting, "division_s": division,
        })
    };
    let size = |size: &Measured| {
        json!({
            "grains": size.grains,
            "seconds": size.seconds.json(),
            "alone": size.alone.json(),
            "processes": size.work.iter().map(work).collect::<Vec<Value>>(),
        })
    };
    let object = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": option_env!("ROCKFALL_COMMIT"),
        "scene": "drum",
        "device": sizes.first().map(|size| &size.device),
        "integrator": arguments.integrator.to_string(),
        "steps": arguments.steps,
        "warmup": arguments.warmup,
        "runs": arguments.runs,
        "sizes": sizes.iter().map(size).collect::<Vec<Value>>(),
    });
    format!("{object}\n")
}
