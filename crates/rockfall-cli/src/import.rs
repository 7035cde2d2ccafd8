//! `rockfall import`: writes the scene of a URDF or MJCF file.

use std::io::Write as _;
use std::path::PathBuf;

use rockfall::output::AtomicFile;

use crate::failure::Failure;
use crate::files;
use crate::output;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "What the file has and the scene does not is said on standard error, and is in comments of the scene. docs/robots.md \
                        describes what is taken over."
)]
pub(crate) struct Arguments {
    /// URDF file, or MJCF file of MuJoCo; its root element decides
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Scene file to write [default: standard output]
    #[arg(long, value_name = "SCENE")]
    out: Option<PathBuf>,
}

pub(crate) fn import(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { robot, out } = arguments;
    if let Some(path) = out {
        files::check("--out", path, files::SCENE)?;
    }
    let imported = rockfall_import::load(robot).map_err(Failure::usage)?;
    let name = robot.file_name().unwrap_or_default().to_string_lossy().replace(char::is_control, " ");
    let mut text = format!("# rockfall import {name}\n");
    for note in imported.notes {
        let note = note.replace(char::is_control, " ");
        output::note(&format!("note: {note}"));
        text += &format!("# note: {note}\n");
    }
    text += "\n";
    text += &imported.scene.to_text();
    let Some(path) = out else { return output::print(&text) };
    let failed = |error| Failure::file(path, &error);
    let mut file = AtomicFile::create(path).map_err(failed)?;
    file.write_all(text.as_bytes()).and_then(|()| file.commit()).map_err(failed)
}
