//! The target `robot`: any bytes as a URDF or MJCF file. Its own file, because the other targets do not need the crate that reads robots.

use std::path::Path;

use rockfall::{Backend, Options, Scene, Simulation};

/// Upper bound of the length of an error message and of a note, in bytes. Messages quote names of the input.
const LONGEST: usize = 1_000;
/// Most bodies of a robot that is run.
const FEW: usize = 20;
/// Files that the robot names are looked for here, where there are none.
const NOWHERE: &str = "nowhere/robot.xml";

fn assert_short(message: &str) {
    assert!(message.len() < LONGEST, "{} bytes: {message}", message.len());
    assert!(!message.contains(char::is_control), "{message:?}");
}

/// Reads bytes as a robot. A refused text gets a short error, and notes are short, too. The scene of an accepted one is written and read
/// again. A small robot is checked and runs two frames, or a short error says why it cannot.
///
/// # Panics
/// When the reader breaks one of these promises.
pub fn robot(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let imported = match rockfall_import::parse(text, NOWHERE) {
        Ok(imported) => imported,
        Err(error) => return assert_short(&error.to_string()),
    };
    // The names of many joints may be in one note.
    imported.notes.iter().filter(|note| !note.contains("that a control gives")).for_each(|note| assert_short(note));
    let text = imported.scene.to_text();
    let again = match Scene::parse(&text, Path::new("again.txt")) {
        Ok(loaded) => loaded.scene,
        Err(error) => panic!("the text of the scene cannot be read: {error}\n{text}"),
    };
    assert_eq!(again.to_text(), text);
    if imported.scene.bodies().len() <= FEW {
        run(imported.scene);
    }
}

fn run(mut scene: Scene) {
    scene.run.substeps = Some(4);
    let options = Options::new().backend(Backend::Cpu).keep_going(true);
    let ended = Simulation::with_options(scene, options).and_then(|mut simulation| {
        simulation.run(2, 1.0 / 60.0)?;
        simulation.joints()?;
        simulation.sync().cloned()
    });
    match ended {
        Ok(scene) => {
            assert!(scene.bodies().iter().all(|body| body.position.is_finite() && body.angular_momentum.is_finite()));
        }
        Err(error) => assert_short(&error.to_string()),
    }
}
