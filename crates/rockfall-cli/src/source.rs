//! Reads a scene from a file, from standard input, or from the built-in copy.

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
