//! Where a scene comes from: a file, standard input, or the program itself.

use std::io::Read as _;
use std::path::Path;

use rockfall::{Loaded, Scene};

use crate::failure::Failure;

/// The scene that `run` takes when none is given.
const BUILT_IN: &str = include_str!("../../../scenes/soft-cube.txt");
const BUILT_IN_NAME: &str = "built-in soft-cube";
const STDIN_NAME: &str = "<stdin>";

/// A scene and what to call it.
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) loaded: Loaded,
}

impl Source {
    /// Reads a scene; no path stands for the built-in one, `-` for standard input.
    pub(crate) fn read(path: Option<&Path>) -> Result<Self, Failure> {
        let Some(path) = path else {
            return Self::new(BUILT_IN_NAME, Scene::parse(BUILT_IN, Path::new(BUILT_IN_NAME)));
        };
        if path != Path::new("-") {
            return Self::new(&path.display().to_string(), Scene::load(path));
        }
        let mut bytes = Vec::new();
        std::io::stdin().read_to_end(&mut bytes).map_err(|error| Failure::usage(format!("{STDIN_NAME}: {error}")))?;
        Self::new(STDIN_NAME, Scene::parse_bytes(&bytes, Path::new(STDIN_NAME)))
    }

    /// A scene must not be written over by what becomes of it.
    pub(crate) fn is_not(scene: Option<&Path>, file: &Path) -> Result<(), Failure> {
        let place = |path: &Path| path.canonicalize().ok();
        match scene.and_then(place) {
            Some(scene) if place(file).as_ref() == Some(&scene) && scene.is_file() => {
                Err(Failure::usage(format!("{}: the scene itself would be written over", file.display())))
            }
            _ => Ok(()),
        }
    }

    /// A scene that cannot be read is wrong usage, whatever the reason.
    fn new(name: &str, loaded: rockfall::Result<Loaded>) -> Result<Self, Failure> {
        Ok(Self { name: name.to_owned(), loaded: loaded.map_err(Failure::usage)? })
    }
}
