//! Files for the tests.

use std::path::PathBuf;

use rockfall::{Joint, MassProperties, RigidBody, Scene};
use rockfall_import::{Imported, Result};
use tempfile::TempDir;

/// A folder with a file.
pub(crate) fn file(name: &str, text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

/// Imports a text.
pub(crate) fn import(text: &str) -> Result<Imported> {
    let (_folder, path) = file("robot.xml", text);
    rockfall_import::load(path)
}

/// The message of a text that is refused.
pub(crate) fn refused(text: &str) -> String {
    import(text).expect_err("the text is refused").to_string()
}

pub(crate) fn body<'a>(scene: &'a Scene, name: &str) -> &'a RigidBody {
    let mut ids = scene.body_ids();
    let named = |id: &rockfall::RigidBodyId| scene.tag(*id).unwrap().and_then(|tag| tag.name.as_deref()) == Some(name);
    let id = ids.find(named).unwrap_or_else(|| panic!("no body {name}"));
    scene.body(id).unwrap()
}

pub(crate) fn mass(scene: &Scene, name: &str) -> MassProperties {
    let body = body(scene, name);
    scene.shape(body.shape).unwrap().mass_properties_of().unwrap()
}

pub(crate) fn joint<'a>(scene: &'a Scene, name: &str) -> &'a Joint {
    scene.joint(scene.joint_named(name).unwrap()).unwrap()
}

pub(crate) fn close(found: impl IntoIterator<Item = f64>, expected: impl IntoIterator<Item = f64>) {
    let (found, expected): (Vec<f64>, Vec<f64>) = (found.into_iter().collect(), expected.into_iter().collect());
    let is_close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
    assert!(found.len() == expected.len() && found.iter().zip(&expected).all(is_close), "{found:?}, expected {expected:?}");
}
