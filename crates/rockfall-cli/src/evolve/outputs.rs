//! Files and messages of an evolution.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use rockfall::output::AtomicFile;
use rockfall::{Colour, Tag};
use rockfall_evolve::{Evolution, Genome, Ground, Niche, Outcome, Plan};

use super::Arguments;
use crate::failure::Failure;
#[cfg(feature = "view")]
use crate::files;

/// Colours of the masses and springs of a creature, and of the ground.
const BALLS: Colour = Colour([0xe0, 0x7b, 0x39]);
const SPRINGS: Colour = Colour([0x4f, 0x70, 0x8c]);
const GROUND: Colour = Colour([0xb5, 0xc2, 0xa6]);
/// Creatures in a gallery at most.
const GALLERY: usize = 12;

/// Writes the scene of the champion, the history and the checkpoint.
pub(super) fn write(evolution: &Evolution, arguments: &Arguments) -> Result<(), Failure> {
    if let Some(champion) = evolution.champion() {
        let title = format!("The champion of generation {}", champion.generation);
        write_text(&arguments.out, &scene_text(evolution, &champion.genome, &champion.outcome, &title)?)?;
    }
    if let Some(path) = &arguments.history {
        write_text(path, &history(evolution))?;
    }
    if let Some(path) = arguments.resume.as_ref().or(arguments.checkpoint.as_ref()) {
        evolution.save(path).map_err(|error| Failure::file(path, &error))?;
    }
    Ok(())
}

fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    let written = AtomicFile::create(path).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.commit()
    });
    written.map_err(|error| Failure::file(path, &error))
}

fn history(evolution: &Evolution) -> String {
    let mut text = "generation,champion,best,mean,niches,not_finite,exploded,unsteady,downhill,failed_audits\n".to_owned();
    for row in evolution.history() {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{}",
            row.number,
            row.champion,
            row.best,
            row.mean,
            row.niches,
            row.not_finite,
            row.exploded,
            row.unsteady,
            row.downhill,
            row.failed_audits
        );
    }
    text
}

/// ` --integrator NAME`, or nothing for the default.
fn integrator_option(plan: &Plan) -> String {
    if plan.integrator == "rk4" { String::new() } else { format!(" --integrator {}", plan.integrator) }
}

/// The command that evolved the creatures up to now. `GROUND` stands for the file with the ground, if there was one.
fn evolve_command(evolution: &Evolution) -> Result<String, Failure> {
    let plan = evolution.plan();
    let mut text = format!(
        "rockfall evolve --goal {} --body {} --population {} --generations {} --seconds {} --dt {} --seed {}{}",
        plan.goal,
        plan.body,
        plan.population,
        evolution.history().len(),
        plan.seconds,
        plan.dt,
        plan.seed,
        integrator_option(plan)
    );
    if plan.ground != Ground::level(plan.seconds)?.scene().to_text() {
        text += " --ground GROUND (its boxes, polygons and settings are those below)";
    }
    Ok(text)
}

/// The text of a creature on its ground, with the time step, the integrator and the number of steps of its trial.
fn scene_text(evolution: &Evolution, genome: &Genome, outcome: &Outcome, title: &str) -> Result<String, Failure> {
    let plan = evolution.plan();
    let mut scene = genome.scene(&evolution.trial().ground)?;
    (scene.run.dt, scene.run.steps) = (Some(plan.dt), Some(evolution.trial().steps()));
    if plan.integrator != "rk4" {
        scene.run.integrator = Some(plan.integrator.parse()?);
    }
    for id in scene.sphere_ids().collect::<Vec<_>>() {
        scene.set_tag(id, Tag::new().colour(BALLS))?;
    }
    for id in scene.spring_ids().collect::<Vec<_>>() {
        scene.set_tag(id, Tag::new().colour(SPRINGS))?;
    }
    for id in scene.box_ids().collect::<Vec<_>>() {
        if scene.tag(id)?.is_none() {
            scene.set_tag(id, Tag::new().colour(GROUND))?;
        }
    }
    let mut text = format!("# {title}: {}\n", evolve_command(evolution)?);
    let _ = writeln!(
        text,
        "# {}: {:.3} {}. Length {:.2} units. From step {} to step {} the centre moves {:.3} units along the ground.",
        plan.goal,
        outcome.fitness,
        plan.goal.unit(),
        genome.length(),
        evolution.trial().settling_steps(),
        evolution.trial().steps(),
        outcome.distance
    );
    text.push('\n');
    Ok(text + &scene.to_text())
}

/// Writes the fittest creatures of different kinds that pass an audit, and a table of them.
pub(super) fn write_gallery(evolution: &Evolution, folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::file(folder, &error))?;
    let mut table = "file,fitness,distance,nodes,frequency,bounce\n".to_owned();
    for (written, (niche, elite)) in (1..).zip(evolution.gallery(GALLERY)?) {
        let Niche { size, frequency, bounce } = niche;
        let name = format!("{written:02}-size{size}-frequency{frequency}-bounce{bounce}.txt");
        let text = scene_text(evolution, &elite.genome, &elite.outcome, &format!("Kind {written}"))?;
        write_text(&folder.join(&name), &text)?;
        let (genome, outcome) = (&elite.genome, &elite.outcome);
        let _ = writeln!(
            table,
            "{name},{},{},{},{},{}",
            outcome.fitness,
            outcome.distance,
            genome.nodes.len(),
            genome.frequency,
            outcome.bounce
        );
    }
    write_text(&folder.join("gallery.csv"), &table)
}

/// What the evolution found, for standard output.
pub(super) fn summary(evolution: &Evolution, arguments: &Arguments, seconds: f64) -> String {
    let plan = evolution.plan();
    let generations = evolution.history().len();
    let mut text = format!("evolved      {generations} generations of {} creatures, {seconds:.1} s\n", plan.population);
    let _ = writeln!(text, "kinds        {}", evolution.archive().len());
    let Some(champion) = evolution.champion() else {
        text += "champion     none: no creature counted and passed an audit; try more generations or another seed\n";
        return text;
    };
    let (genome, outcome, found) = (&champion.genome, &champion.outcome, &champion.audit);
    let length = f64::from(genome.length());
    let _ = writeln!(
        text,
        "champion     {} {:.3} {}, {:.1} body lengths along the ground, of generation {}",
        plan.goal,
        outcome.fitness,
        plan.goal.unit(),
        outcome.distance / length,
        champion.generation
    );
    let _ = writeln!(text, "body         {} masses, length {length:.2}, {:.2} Hz", genome.nodes.len(), genome.frequency);
    let _ = writeln!(
        text,
        "audit        {:.3} {unit} at half the time step, {:.3} {unit} at a quarter, {:.3} {unit} with disturbed starts",
        found.fitness_at_half_step,
        found.fitness_at_quarter_step,
        found.fitness_when_disturbed,
        unit = plan.goal.unit()
    );
    let _ = writeln!(text, "energy       work of the muscles {:.1}, energy from elsewhere {:.3}", found.work, found.excess);
    let name = arguments.out.display().to_string();
    let _ = writeln!(text, "written      {name}: rockfall run {name}");
    text
}

/// Returns an error for a film with an unknown extension.
#[cfg(feature = "view")]
pub(super) fn check_film(path: &Path) -> Result<(), Failure> {
    use rockfall_viewer::film::Format;
    let expected = "a name that ends in .gif, .apng, .mp4 or .webm, or a folder";
    Format::of(path).map(drop).ok_or_else(|| files::unknown("--film", path, expected))
}

/// Films the champion, by `rockfall render`.
#[cfg(feature = "view")]
pub(super) fn film(
    evolution: &Evolution,
    scene: &Path,
    film: &Path,
    interrupt: &'static crate::interrupt::Interrupt,
) -> Result<(), Failure> {
    use clap::{CommandFactory as _, FromArgMatches as _};
    let (plan, steps) = (evolution.plan(), evolution.trial().steps().to_string());
    let (dt, backend) = (plan.dt.to_string(), evolution.trial().options.backend.to_string());
    let mut line: Vec<std::ffi::OsString> = vec!["rockfall".into(), "render".into(), scene.into(), "--out".into(), film.into()];
    for (option, value) in [
        ("--steps", steps.as_str()),
        ("--dt", &dt),
        ("--integrator", &plan.integrator),
        ("--backend", &backend),
        ("--size", "640x360"),
        ("--fps", "25"),
    ] {
        line.extend([option.into(), value.into()]);
    }
    let wrong = |error: clap::Error| Failure::Run(error.to_string());
    let matches = crate::Arguments::command().try_get_matches_from(line).map_err(wrong)?;
    match crate::Arguments::from_arg_matches(&matches).map_err(wrong)?.command {
        crate::Command::Render(arguments) => {
            let given = crate::run::Given(matches.subcommand().map_or(&matches, |(_, matches)| matches));
            crate::render::render(&arguments, &given, interrupt)
        }
        _ => Ok(()),
    }
}
