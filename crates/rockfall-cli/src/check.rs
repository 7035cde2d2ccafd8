//! `rockfall check`: is a scene well formed, and is the time step short enough for it?

use std::fmt::Write as _;

use rockfall::Settings;

use crate::failure::Failure;
use crate::options::{InWords, Physics, SceneArgument, counted};
use crate::output;
use crate::source::Source;

/// Warnings of a kind that are printed; the others are counted.
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
    let _ = writeln!(text, "{name}: {}", InWords(scene.counts()));
    let defaults = Settings::default();
    for setting in Settings::NAMES {
        let value = scene.settings.get(setting).filter(|value| defaults.get(setting).as_ref() != Some(value));
        if let Some(value) = value {
            let _ = writeln!(text, "set {setting} {value}");
        }
    }
    let odd = loaded.warnings.iter().map(|warning| format!("{name}:{}: {}", warning.line, warning.text));
    warnings(&mut text, odd);
    let stiff = scene.stability(dt, integrator);
    if stiff.is_empty() {
        let _ = writeln!(text, "stable at a time step of {dt} s ({integrator})");
    }
    warnings(&mut text, stiff.iter().map(|warning| format!("{name}: {warning}")));
    if scene.counts().spheres == 0 {
        warnings(&mut text, [format!("{name}: no spheres, so nothing will move")].into_iter());
    }
    output::print(&text)
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
