//! Reads a scene from a file, from standard input, or from the built-in copy.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use rockfall::{Loaded, Scene};

use crate::failure::Failure;

/// Scene that `run` and `view` use when none is given: a copy of scenes/soft-cube.txt, which the package does not contain.
const BUILT_IN: &str = include_str!("soft-cube.txt");
const BUILT_IN_NAME: &str = "built-in soft-cube";
const STDIN_NAME: &str = "<stdin>";

/// A scene and its name in messages.
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) loaded: Loaded,
}

impl Source {
    /// Reads a scene. `None` selects the built-in scene, `-` standard input.
    pub(crate) fn read(path: Option<&Path>) -> Result<Self, Failure> {
        let Some(path) = path else {
            return Self::new(BUILT_IN_NAME, Scene::parse(BUILT_IN, Path::new(BUILT_IN_NAME)));
        };
        if path != Path::new("-") {
            refuse_other_files(path)?;
            return Self::new(&path.display().to_string(), Scene::load(path));
        }
        let mut bytes = Vec::new();
        let read = std::io::stdin().read_to_end(&mut bytes);
        read.map_err(|error| Failure::usage(format!("{STDIN_NAME}: cannot be read: {error}")))?;
        Self::new(STDIN_NAME, Scene::parse_bytes(&bytes, Path::new(STDIN_NAME)))
    }

    /// Returns an error if an output file is the scene file, which must not be overwritten.
    pub(crate) fn is_not(scene: Option<&Path>, file: &Path) -> Result<(), Failure> {
        let place = |path: &Path| path.canonicalize().ok();
        match scene.and_then(place) {
            Some(scene) if place(file).as_ref() == Some(&scene) && scene.is_file() => {
                Err(Failure::usage(format!("{}: this output would overwrite the scene file", file.display())))
            }
            _ => Ok(()),
        }
    }

    /// Treats every failure to read a scene as wrong usage.
    fn new(name: &str, loaded: rockfall::Result<Loaded>) -> Result<Self, Failure> {
        Ok(Self { name: name.to_owned(), loaded: loaded.map_err(Failure::usage)? })
    }
}

/// First bytes of a checkpoint.
const CHECKPOINT: &[u8] = b"\x89RKF";

/// Whether a file is a checkpoint. A pipe is none, because it can be read only once.
pub(crate) fn is_checkpoint(path: &Path) -> bool {
    let mut start = Vec::new();
    let file = File::open(path).ok().filter(|_| path != Path::new("-") && path.is_file());
    file.is_some_and(|file| file.take(CHECKPOINT.len() as u64).read_to_end(&mut start).is_ok()) && start == CHECKPOINT
}

/// Returns an error that says what a file is, if it is one that rockfall itself writes and not a scene.
fn refuse_other_files(path: &Path) -> Result<(), Failure> {
    // A pipe must not be read here. What cannot be opened is reported when the scene is read.
    let Some(file) = File::open(path).ok().filter(|file| file.metadata().is_ok_and(|found| found.is_file())) else {
        return Ok(());
    };
    let mut start = Vec::new();
    let name = path.display();
    if file.take(256).read_to_end(&mut start).is_err() {
        return Ok(());
    }
    let begins = |text: &str| start.starts_with(text.as_bytes());
    let contains = |text: &str| start.windows(text.len()).any(|window| window == text.as_bytes());
    let what = if start.starts_with(CHECKPOINT) {
        format!("a checkpoint, not a scene: continue its run with `rockfall run --resume {name}`")
    } else if start.starts_with(b"PK\x03\x04") {
        "an archive of arrays (.npz), not a scene".to_owned()
    } else if contains("<VTKFile") {
        "a file for ParaView and VTK, not a scene".to_owned()
    } else if begins("sphere,x,y,z,") || begins("step,time,") {
        "a table of results (.csv), not a scene: `rockfall run --save FILE.txt` writes the final state as a scene".to_owned()
    } else if start.starts_with(b"\x89PNG") || begins("GIF8") {
        "a picture, not a scene".to_owned()
    } else {
        return Ok(());
    };
    Err(Failure::usage(format!("{name}: this is {what}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_scene_is_the_shipped_one() {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/soft-cube.txt");
        let shipped = std::fs::read_to_string(shipped).expect("the shipped scene");
        assert!(shipped == BUILT_IN, "copy scenes/soft-cube.txt to crates/rockfall-cli/src/soft-cube.txt");
    }
}
