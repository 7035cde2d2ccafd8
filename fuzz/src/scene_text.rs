//! Any bytes as a scene text.

use std::path::Path;

use rockfall::{Integrator, Scene};

/// What a line may say of itself; words of the text are quoted in it.
const LONGEST_MESSAGE: usize = 400;

/// Reads any bytes as a scene. What is refused is named by its line; what is accepted is written and read again, and must
/// be the same objects, bit for bit.
///
/// # Panics
/// When the reader breaks one of these promises.
pub fn scene_text(bytes: &[u8]) {
    let read = match Scene::parse_bytes(bytes, Path::new("fuzz.txt")) {
        Ok(loaded) => loaded.scene,
        Err(error) => return is_told(&error.to_string(), bytes),
    };
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        for warning in read.stability(0.02, integrator) {
            assert!(!warning.largest_dt.is_nan() && warning.largest_dt < 0.02, "{warning:?}");
        }
    }
    let text = read.to_text();
    let again = match Scene::parse(&text, Path::new("again.txt")) {
        Ok(loaded) => loaded,
        Err(error) => panic!("what was written cannot be read: {error}\n{text}"),
    };
    assert_eq!(again.warnings, [], "{text}");
    assert_eq!(all(&again.scene), all(&read), "{text}");
    assert_eq!(again.scene.to_text(), text);
}

/// `fuzz.txt:LINE: FIELD: ...`, in a line of its own that a terminal can show.
fn is_told(message: &str, bytes: &[u8]) {
    let line = message.strip_prefix("fuzz.txt:").and_then(|rest| rest.split(':').next()?.parse::<usize>().ok());
    // A text without lines has nothing that could be wrong.
    let lines = bytes.split(|byte| *byte == b'\n').count();
    assert!(line.is_some_and(|line| (1..=lines).contains(&line)), "{message}");
    assert!(message.len() < LONGEST_MESSAGE, "{} bytes: {message}", message.len());
    assert!(!message.contains(char::is_control), "{message:?}");
}

/// All that there is to know of a scene, to the last bit: numbers are printed so that they read back. Handles tell slots,
/// which in a scene that was just read are places in order of addition.
fn all(scene: &Scene) -> String {
    let spheres = (scene.spheres(), scene.rods(), scene.capsules());
    format!(
        "{:?} {spheres:?} {:?} {:?} {:?} {:?}",
        scene.settings,
        scene.springs(),
        scene.tethers(),
        scene.boxes(),
        scene.polygons()
    )
}
