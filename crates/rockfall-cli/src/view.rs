//! `rockfall view`: shows a scene in a window.

use std::path::PathBuf;

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
    /// Write the state of the window as JSON after every frame
    #[arg(long, value_name = "FILE", hide = true)]
    report: Option<PathBuf>,
    /// Destroy the graphics device after this number of frames, to test that the window recovers
    #[arg(long, value_name = "FRAMES", hide = true)]
    lose_device_after: Option<u64>,
}

/// Number of warnings about the time step and the overlaps of a scene that the window shows.
const CONCERNS: usize = 3;

pub(crate) fn view(arguments: &Arguments) -> Result<(), Failure> {
    let Source { name, loaded } = Source::read(arguments.scene.as_deref())?;
    let mut scene = loaded.scene;
    arguments.physics.change(&mut scene.settings)?;
    let lines = loaded.warnings.iter().map(|warning| format!("{name}:{}: {}", warning.line, warning.text));
    // Springs may cause thousands of warnings of one kind.
    let concerns = scene.concerns(arguments.physics.dt, arguments.physics.integrator).into_iter().take(CONCERNS);
    let warnings = lines.chain(concerns.map(|concern| format!("{name}: {concern}"))).collect();
    let path = arguments.scene.clone().filter(|path| path.as_os_str() != "-");
    window::run(Launch {
        source: window::session::Source { name, path, scene },
        warnings,
        options: arguments.engine.options(&arguments.physics),
        time_step: arguments.physics.dt,
        overrides: arguments.physics.overrides(),
        report: arguments.report.clone(),
        lose_device_after: arguments.lose_device_after,
    })
    .map_err(|failure| match failure {
        window::Failure::Rockfall(error) => error.into(),
        other => Failure::Run(other.to_string()),
    })
}
