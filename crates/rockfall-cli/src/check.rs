//! `rockfall check`: reports whether a scene is well formed and whether the time step is short enough for it.

use std::fmt::Write as _;

use rockfall::stability::Suggestion;
use rockfall::{Body, ContactLaw, Integrator, Loaded, Scene, Settings, short_number};

use crate::failure::Failure;
use crate::options::{InWords, MAX_SUBSTEPS, Physics, SceneArgument, Substeps, as_text, counted, is_rigid};
use crate::output;
use crate::source::Source;

/// Number of warnings of one kind that are printed; the rest are only counted.
const SHOWN: usize = 10;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArgument,
    #[command(flatten)]
    physics: Physics,
}

pub(crate) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let Source { name, loaded } = Source::read(Some(&arguments.scene.scene))?;
    let mut scene = loaded.scene;
    arguments.physics.change(&mut scene.settings)?;
    let (dt, integrator) = (arguments.physics.part_for(&scene), arguments.physics.integrator_for(&scene));
    let mut text = String::new();
    // Writing to a string cannot fail.
    let comments = counted(loaded.comments, "comment", "comments");
    let doors = [(scene.inlets().len(), "inlet", "inlets"), (scene.outlets().len(), "outlet", "outlets")];
    let doors = doors.into_iter().filter(|(count, ..)| *count > 0);
    let doors: String = doors.map(|(count, one, many)| format!("{}, ", counted(count, one, many))).collect();
    let _ = writeln!(text, "{name}: {}, {doors}{comments}", InWords(scene.counts()));
    let defaults = Settings::default();
    for setting in Settings::NAMES {
        let value = scene.settings.get(setting).filter(|value| defaults.get(setting).as_ref() != Some(value));
        if let Some(value) = value {
            let _ = writeln!(text, "set {setting} {value}");
        }
    }
    let Settings { gravity, gravity_direction, .. } = scene.settings;
    if gravity < 0.0 {
        let up = if gravity_direction == defaults.gravity_direction { ", so bodies fall upwards" } else { "" };
        let _ = writeln!(text, "note: {name}: gravity is negative: it acts against gravity_direction{up}");
    }
    for (setting, reason) in scene.idle_settings() {
        let _ = writeln!(text, "note: {name}: {setting} has no effect: {reason}");
    }
    let suspicious_lines = loaded.warnings.iter().map(|warning| format!("{name}:{}: {}", warning.line, warning.text));
    warnings(&mut text, suspicious_lines);
    // Spheres that come in count, too.
    let judged = &*scene.with_grains();
    if let Some(chosen) = chosen_contact(&judged.resolved_settings()) {
        let _ = writeln!(text, "{chosen}");
    }
    let _ = writeln!(text, "precision {}", judged.chosen_precision());
    let frames = is_rigid(&scene).then(|| scene.hard_contacts(dt)).transpose();
    if let Ok(Some(frames)) = &frames {
        let _ = writeln!(text, "{frames}");
    }
    let refused = judged.check_contact_law(integrator).err().or(frames.err());
    let is_of_program = judged.settings.contact_law == ContactLaw::User;
    let (slow, in_time): (Vec<_>, Vec<_>) = judged.law_times().into_iter().partition(|time| time.is_exceeded_by(dt));
    for time in in_time {
        let _ = writeln!(text, "{}", time.describe(judged, dt));
    }
    let stiff = judged.stability(dt, integrator);
    if stiff.is_empty() && slow.is_empty() && refused.is_none() && !is_of_program && !is_rigid(&scene) {
        let _ = writeln!(text, "stable at a time step of {} s ({integrator})", as_text(dt));
    }
    text.push_str(&concerns(&name, &scene, dt, integrator));
    let parts = if is_rigid(&scene) { 1 } else { judged.substeps_for(dt, integrator) };
    if (2..=MAX_SUBSTEPS).contains(&parts) {
        let _ = writeln!(text, "rockfall run --substeps {parts} makes the time step short enough for springs and contacts");
    }
    text.push_str(&suggestion(judged, dt, integrator));
    text.push_str(&placement(&name, &scene)?);
    if is_still(&scene) {
        warnings(&mut text, [format!("{name}: no spheres, so nothing will move")].into_iter());
    }
    output::print(&text)?;
    // `run` refuses these scenes with the same exit code.
    if let Some(error) = refused {
        return Err(Failure::usage(format!("{name}: {error}")));
    }
    if is_of_program {
        let message =
            "contact law user: a program defines this law, so rockfall run refuses the scene; its time step is not known";
        return Err(Failure::usage(format!("{name}: {message}")));
    }
    Ok(())
}

/// Whether nothing can move.
fn is_still(scene: &Scene) -> bool {
    scene.counts().spheres == 0 && scene.inlets().is_empty()
}

/// Prints the warnings about a scene that is to be run, and applies the settings of the command line. Returns the scene and the
/// number of parts of a step.
pub(crate) fn prepare(
    name: &str,
    loaded: Loaded,
    physics: &Physics,
    substeps: Option<Substeps>,
) -> Result<(Scene, u32), Failure> {
    if is_still(&loaded.scene) {
        output::note(&format!("warning: {name}: no spheres, so nothing will move"));
    }
    for warning in &loaded.warnings {
        output::note(&format!("warning: {name}:{}: {}", warning.line, warning.text));
    }
    let mut scene = loaded.scene;
    physics.change(&mut scene.settings)?;
    let integrator = physics.integrator_for(&scene);
    let dt = physics.dt_for(&scene);
    let parts = if is_rigid(&scene) {
        Substeps::give(substeps, &mut scene);
        1
    } else {
        Substeps::or_of(substeps, &scene).of(&scene.with_grains(), dt, integrator)?
    };
    warn(name, &scene, dt / parts as f32, integrator);
    if let Some(concern) = scene.overlap_concern() {
        output::note(&format!("warning: {name}: {concern}"));
    }
    Ok((scene, parts))
}

/// Describes the contact constants that `resting_overlap` sets, if it is in use.
pub(crate) fn chosen_contact(settings: &Settings) -> Option<String> {
    let [force, damping, share] = [settings.contact_force, settings.contact_damping, settings.resting_overlap];
    (share > 0.0).then(|| {
        format!("contact_force {}, contact_damping {}, chosen for resting_overlap {share}", as_text(force), as_text(damping))
    })
}

/// Warnings, one per line: parts of the scene for which the time step is too long, bodies that sink into each other, and rods
/// that are likely mistakes.
pub(crate) fn concerns(name: &str, scene: &Scene, dt: f32, integrator: Integrator) -> String {
    let mut text = String::new();
    let judged = &*scene.with_grains();
    // Springs and tethers may cause thousands of warnings of one kind.
    let (stiff, others) = (judged.stability(dt, integrator), judged.concerns(dt, integrator));
    warnings(&mut text, stiff.iter().map(|warning| format!("{name}: {}", warning.describe(judged))));
    // Rods come last, and there may be thousands of them, too.
    let rods = judged.odd_rods().len();
    let (others, rods) = others[stiff.len()..].split_at(others.len() - stiff.len() - rods);
    for list in [others, rods] {
        warnings(&mut text, list.iter().map(|warning| format!("{name}: {warning}")));
    }
    warnings(&mut text, scene.inlet_concerns().into_iter().map(|warning| format!("{name}: {warning}")));
    text
}

/// Prints the warnings of [`concerns`] before a scene runs.
pub(crate) fn warn(name: &str, scene: &Scene, dt: f32, integrator: Integrator) {
    concerns(name, scene, dt, integrator).lines().for_each(output::note);
}

/// Options with which `run` has nothing to warn of, if that is not so now.
fn suggestion(scene: &Scene, dt: f32, integrator: Integrator) -> String {
    let Some(Suggestion { resting_overlap, contact_force, contact_damping, time_step, .. }) = scene.suggestion(dt, integrator)
    else {
        return String::new();
    };
    let contact = resting_overlap.map_or_else(String::new, |share| {
        let [force, damping] = [contact_force, contact_damping].map(as_text);
        format!(" --set resting_overlap={share} (contact_force {force} /s², contact_damping {damping} /s)")
    });
    format!("suggestion: --dt {} (s){contact}\n", as_text(time_step))
}

/// Reports bodies that overlap at the start and bodies that fall for ever.
fn placement(name: &str, scene: &Scene) -> Result<String, Failure> {
    let found = scene.placement()?;
    let mut text = match found.deepest {
        0.0 => "no overlaps at the start\n".to_owned(),
        deepest => format!("deepest overlap at the start: {} radii of the smaller body\n", short_number(deepest.into(), 3)),
    };
    warnings(&mut text, found.overlaps.iter().map(|overlap| format!("{name}: {} at the start", overlap.describe(scene))));
    // A note, because some scenes want it: the example of the thesis does.
    for sphere in found.falling.iter().take(SHOWN) {
        let body = scene.name_of(Body::Sphere(*sphere));
        let _ =
            writeln!(text, "note: {name}: {body} will fall for ever: nothing holds it, and nothing is below it along gravity");
    }
    if found.falling.len() > SHOWN {
        let _ = writeln!(text, "note: and {} like these", counted(found.falling.len() - SHOWN, "more", "more"));
    }
    Ok(text)
}

fn warnings(text: &mut String, warnings: impl ExactSizeIterator<Item = String>) {
    let count = warnings.len();
    for warning in warnings.take(SHOWN) {
        let _ = writeln!(text, "warning: {warning}");
    }
    if count > SHOWN {
        let _ = writeln!(text, "warning: and {} like these", counted(count - SHOWN, "more", "more"));
    }
}
