//! `rockfall view`: shows a scene in a window.

use std::path::PathBuf;

use rockfall_viewer::window::controls::Controls;
use rockfall_viewer::window::{self, Launch};

use crate::failure::Failure;
use crate::options::{Engine, Physics};
use crate::source::Source;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene file, or - for standard input [default: a built-in scene]
    scene: Option<PathBuf>,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// What the mouse does: standard (left drag orbits, right drag pans), or thesis
    #[arg(long, default_value_t)]
    controls: Controls,
    /// Write the state of the window as JSON after every frame
    #[arg(long, value_name = "FILE", hide = true)]
    report: Option<PathBuf>,
    /// Destroy the graphics device after this number of frames, to test that the window recovers
    #[arg(long, value_name = "FRAMES", hide = true)]
    lose_device_after: Option<u64>,
}

pub(crate) fn view(arguments: &Arguments) -> Result<(), Failure> {
    let Source { name, loaded } = Source::read(arguments.scene.as_deref())?;
    let mut scene = loaded.scene;
    arguments.physics.change(&mut scene.settings)?;
    let warnings = loaded.warnings.iter().map(|warning| format!("{name}:{}: {}", warning.line, warning.text)).collect();
    let path = arguments.scene.clone().filter(|path| path.as_os_str() != "-");
    window::run(Launch {
        source: window::session::Source { name, path, scene },
        warnings,
        options: arguments.engine.options(&arguments.physics),
        time_step: arguments.physics.dt,
        overrides: arguments.physics.overrides(),
        controls: arguments.controls,
        report: arguments.report.clone(),
        lose_device_after: arguments.lose_device_after,
    })
    .map_err(|failure| match failure {
        window::Failure::Rockfall(error) => error.into(),
        other => Failure::Run(other.to_string()),
    })
}
