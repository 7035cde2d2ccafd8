//! `rockfall check`: reports whether a scene is well formed and whether the time step is short enough for it.

use std::fmt::Write as _;

use rockfall::{Integrator, Scene, Settings};

use crate::failure::Failure;
use crate::options::{InWords, Physics, SceneArgument, counted};
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
    let (dt, integrator) = (arguments.physics.dt, arguments.physics.integrator);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let comments = counted(loaded.comments, "comment", "comments");
    let _ = writeln!(text, "{name}: {}, {comments}", InWords(scene.counts()));
    let defaults = Settings::default();
    for setting in Settings::NAMES {
        let value = scene.settings.get(setting).filter(|value| defaults.get(setting).as_ref() != Some(value));
        if let Some(value) = value {
            let _ = writeln!(text, "set {setting} {value}");
        }
    }
    let suspicious_lines = loaded.warnings.iter().map(|warning| format!("{name}:{}: {}", warning.line, warning.text));
    warnings(&mut text, suspicious_lines);
    if let Some(chosen) = chosen_contact(&scene.resolved_settings()) {
        let _ = writeln!(text, "{chosen}");
    }
    let stiff = scene.stability(dt, integrator);
    if stiff.is_empty() {
        let _ = writeln!(text, "stable at a time step of {dt} s ({integrator})");
    }
    text.push_str(&concerns(&name, &scene, dt, integrator));
    if !stiff.is_empty() {
        let parts = scene.substeps_for(dt, integrator);
        let _ = writeln!(text, "rockfall run --substeps {parts} makes the time step short enough for springs and contacts");
    }
    if scene.counts().spheres == 0 {
        warnings(&mut text, [format!("{name}: no spheres, so nothing will move")].into_iter());
    }
    output::print(&text)
}

/// Describes the contact constants that `resting_overlap` sets, if it is in use.
pub(crate) fn chosen_contact(settings: &Settings) -> Option<String> {
    let [force, damping, share] = [settings.contact_force, settings.contact_damping, settings.resting_overlap];
    (share > 0.0).then(|| format!("contact_force {force}, contact_damping {damping}, chosen for resting_overlap {share}"))
}

/// Warnings, one per line: parts of the scene for which the time step is too long, and bodies that sink into each other.
pub(crate) fn concerns(name: &str, scene: &Scene, dt: f32, integrator: Integrator) -> String {
    let mut text = String::new();
    let stiff = scene.stability(dt, integrator);
    warnings(&mut text, stiff.iter().map(|warning| format!("{name}: {warning}")));
    let sinking = scene.sinking(integrator).map(|sinking| format!("{name}: {sinking}"));
    let tunnelling = scene.tunnelling(dt).map(|tunnelling| format!("{name}: {tunnelling}"));
    for warning in [sinking, tunnelling].into_iter().flatten() {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
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
