//! `rockfall generate`: writes a scene of any size.

use std::io::Write as _;
use std::path::PathBuf;

use rockfall::generate::Kind;
use rockfall::output::AtomicFile;
use rockfall::{ContactLaw, Scene};

use crate::failure::Failure;
use crate::files;
use crate::options::whole;
use crate::output;

/// Length of a frame of hard contacts, in s.
const FRAME: f32 = 1.0 / 60.0;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Kind of scene: pile, mixed, clumps, boxes, dominoes, bricks, arch, hulls, soft, chain, hopper, drum, column, vibrated, shear-cell, mixer or screw
    kind: Kind,
    /// Number of spheres, including those of rods, capsules and rigid bodies; dominoes round it down to whole ones and a ball
    #[arg(long, value_name = "N", value_parser = whole(0, u32::MAX), allow_negative_numbers = true)]
    spheres: u32,
    /// Seed of the random numbers; the same seed gives the same scene
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Give the scene hard contacts, in frames of 1/60 s; kinds with objects that the law does not take are refused
    #[arg(long, value_name = "LAW", value_parser = ["rigid"])]
    law: Option<String>,
    /// Scene file to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn generate(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { kind, spheres, seed, law, out } = arguments;
    if let Some(path) = out {
        files::check("--out", path, files::SCENE)?;
    }
    let file = out.as_ref().map(|path| AtomicFile::create(path).map_err(|error| Failure::file(path, &error)));
    let file = file.transpose()?;
    let mut scene = kind.generate(*spheres, *seed)?;
    let mut title = format!("# rockfall generate {kind} --spheres {spheres} --seed {seed}");
    if law.is_some() {
        harden(&mut scene)?;
        title += " --law rigid";
    }
    title.push('\n');
    if reduce_overlaps(*kind, &mut scene) {
        title += "# Gravity is so small that bodies at rest overlap by less than 5 % of their radius at a time step of 0.02 s.\n\
                  # For more gravity, use resting_overlap and a shorter time step (rockfall check suggests both).\n";
    }
    for line in kind.note(*spheres).lines() {
        title += &format!("# {line}\n");
    }
    title.push('\n');
    let text = title + &scene.to_text();
    let (Some(mut file), Some(path)) = (file, out) else {
        return output::print(&text);
    };
    file.write_all(text.as_bytes()).and_then(|()| file.commit()).map_err(|error| Failure::file(path, &error))
}

/// Makes the contacts of a scene hard. Scenes of the thesis's law get the gravity and friction of other scenes with hard contacts.
fn harden(scene: &mut Scene) -> Result<(), Failure> {
    if scene.contact_law() == ContactLaw::Rigid {
        return Ok(());
    }
    let settings = &mut scene.settings;
    if !settings.contact_law.has_history() {
        (settings.gravity, settings.restitution, settings.coulomb_friction) = (10.0, 0.0, 0.4);
    }
    settings.contact_law = ContactLaw::Rigid;
    let seconds = scene.run.dt.unwrap_or(FRAME) * scene.run.steps.unwrap_or_default() as f32;
    (scene.run.dt, scene.run.steps) = (Some(FRAME), Some((seconds / FRAME).round() as u64));
    scene.run.integrator = None;
    scene.hard_contacts(FRAME)?;
    Ok(())
}

/// Gravity of soft blobs as a share of [`Scene::gentle_gravity`], which is that of a pile: a blob stands on few of its spheres,
/// blobs lie on each other, and springs press the feet of a blob that lands.
const SOFT: f32 = 0.07;
/// Activation threshold of kinds in which bodies press others while they fall, in 1/s. A contact that is slower than the threshold
/// is not a collision, so it is cushioned by the contact force alone: at the default of 1 by up to 6 % of the radius.
const THRESHOLD: f32 = 0.5;

/// Chooses constants with which 100 to 5,000 spheres overlap by less than 5 % of their radius, without those that collide.
/// Grains, hard contacts and scenes with `resting_overlap` have constants of their own. Returns whether gravity was changed.
fn reduce_overlaps(kind: Kind, scene: &mut Scene) -> bool {
    if kind.has_grains() || scene.contact_law() == ContactLaw::Rigid || scene.settings.resting_overlap > 0.0 {
        return false;
    }
    if matches!(kind, Kind::Mixed | Kind::Soft | Kind::Hopper) {
        scene.settings.activation_threshold = THRESHOLD;
    }
    let share = if kind == Kind::Soft { SOFT } else { 1.0 };
    let gravity = rounded(share * scene.gentle_gravity());
    std::mem::replace(&mut scene.settings.gravity, gravity) != gravity
}

/// Rounds to three significant digits.
fn rounded(number: f32) -> f32 {
    format!("{number:.2e}").parse().unwrap_or(number)
}
