//! `rockfall fields`: coarse-grained fields of a state.

use std::fmt::Write as _;
use std::path::PathBuf;

use rockfall::{Backend, Checkpoint, Integrator, Options, Simulation};
use rockfall_trajectory::fields::{Fields, Kernel, Smoothing, Sources};

use crate::failure::Failure;
use crate::files;
use crate::output;
use crate::source::{Source, is_checkpoint};

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Checkpoint or scene file, or - for a scene from standard input
    file: PathBuf,
    /// Width of the smoothing function, in units [default: the diameter of the largest moving sphere]
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    width: Option<f64>,
    /// Distance between points of the grid, in units [default: the width]
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    spacing: Option<f64>,
    /// Smoothing function: gaussian (up to 3 widths) or heaviside (the same everywhere up to 1 width)
    #[arg(long, default_value_t)]
    kernel: Kernel,
    /// File to write: .vti for ParaView, .npz for NumPy or .csv
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn fields(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.out {
        files::check("--out", path, files::FIELDS)?;
        Source::is_not(Some(&arguments.file), path)?;
    }
    let mut simulation = open(arguments)?;
    let sources = Sources::of(&mut simulation)?;
    let width = arguments.width.unwrap_or(sources.widest());
    if arguments.width.is_none() && width <= 0.0 {
        return Err(Failure::usage(format!("{}: it has no moving bodies, so it has no fields", arguments.file.display())));
    }
    let smoothing = Smoothing::new(arguments.kernel, width).map_err(|error| Failure::usage(format!("--{error}")))?;
    let grid =
        sources.grid(smoothing, arguments.spacing.unwrap_or(width)).map_err(|error| Failure::usage(format!("--{error}")))?;
    let fields = sources.fields(grid, smoothing);
    if let Some(path) = &arguments.out {
        fields.save(path)?;
    }
    output::print(&summary(&fields, &sources, smoothing, arguments.kernel))
}

/// Opens the state on the CPU, which computes its contacts.
fn open(arguments: &Arguments) -> Result<Simulation, Failure> {
    if is_checkpoint(&arguments.file) {
        let mut checkpoint = Checkpoint::load(&arguments.file).map_err(Failure::usage)?;
        checkpoint.options.backend = Backend::Cpu;
        return Ok(Simulation::resume(checkpoint)?);
    }
    let scene = Source::read(Some(&arguments.file))?.loaded.scene;
    // Every contact law allows this one. The state does not depend on it.
    let options = Options::new().backend(Backend::Cpu).integrator(Integrator::SymplecticEuler);
    Ok(Simulation::with_options(scene, options)?)
}

fn summary(fields: &Fields, sources: &Sources, smoothing: Smoothing, kernel: Kernel) -> String {
    let [x, y, z] = fields.grid.counts;
    let volume = fields.grid.spacing.powi(3);
    let greatest = |numbers: &mut dyn Iterator<Item = f64>| numbers.fold(0.0, f64::max);
    let mut text = format!("grid        {x} x {y} x {z} points, {} units apart\n", fields.grid.spacing as f32);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "smoothing   {kernel}, width {} units", smoothing.width() as f32);
    let _ = writeln!(text, "mass        {:.5e} (density times volume)", fields.density.iter().sum::<f64>() * volume);
    let _ = writeln!(text, "density     at most {:.4e} mass/units³", greatest(&mut fields.density.iter().copied()));
    let _ = writeln!(
        text,
        "speed       at most {:.4e} units/s",
        greatest(&mut fields.velocity.iter().map(|velocity| velocity.length()))
    );
    let _ = writeln!(text, "pressure    at most {:.4e} mass/(units s²)", greatest(&mut fields.pressure()));
    let _ = writeln!(text, "temperature at most {:.4e} units²/s²", greatest(&mut fields.temperature.iter().copied()));
    if let Some(share) = unbalanced(fields, sources, smoothing) {
        let _ = writeln!(
            text,
            "momentum    div(stress) + wall force + weight is {:.3} % of the weight (median of the dense points; 0 at rest)",
            100.0 * share
        );
    }
    text
}

/// Number of points at which the balance of momentum is evaluated.
const SAMPLES: usize = 15;

/// The median of |div(stress) + wall force + rho g| / |rho g| over some points in the dense part; `None` without gravity.
fn unbalanced(fields: &Fields, sources: &Sources, smoothing: Smoothing) -> Option<f64> {
    let densest = fields.density.iter().copied().fold(0.0, f64::max);
    let dense: Vec<usize> = (0..fields.grid.len()).filter(|index| fields.density[*index] > 0.3 * densest).collect();
    let every = (dense.len() / SAMPLES).max(1);
    let shares = dense.iter().step_by(every).map(|index| {
        let [sum, weight] = sources.balance(fields.grid.point(*index), smoothing);
        sum.length() / weight.length()
    });
    let mut shares: Vec<f64> = shares.filter(|share| share.is_finite()).collect();
    shares.sort_by(f64::total_cmp);
    shares.get(shares.len() / 2).copied()
}
