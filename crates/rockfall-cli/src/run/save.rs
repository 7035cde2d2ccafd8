//! The file of `--save`: the final state as a scene file.

use std::io::Write as _;
use std::path::Path;

use rockfall::Simulation;
use rockfall::output::AtomicFile;

use super::past::Past;
use crate::failure::Failure;
use crate::options::{counted, is_rigid};
use crate::output;

pub(super) fn open(path: &Path) -> Result<AtomicFile, Failure> {
    AtomicFile::create(path).map_err(|error| Failure::file(path, &error))
}

/// Writes the present state, with the present phases of muscles. The title of the scene comes first. After it, comments name where
/// the state comes from, and the line `@run` how to go on. A note says what the text leaves out.
pub(super) fn write(path: &Path, mut file: AtomicFile, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
    let step = past.step(simulation.report().steps);
    let integrator = simulation.integrator();
    let mut scene = simulation.snapshot()?;
    let broken = simulation.joints()?.into_iter().map(|joint| joint.broken);
    let broken: Vec<_> = scene.joint_ids().zip(broken).filter(|(_, broken)| *broken).map(|(id, _)| id).collect();
    scene.remove_joints(&broken)?;
    let is_rigid = is_rigid(&scene);
    let run = &mut scene.run;
    (run.dt, run.integrator) = (Some(past.dt), Some(integrator.into()));
    if !is_rigid {
        run.substeps = (past.parts() > 1).then(|| past.parts());
    }
    let origin = format!("{} after {step} steps, at {} s", past.scene, past.time(step));
    let text = scene.to_text_of_state(&past.title, Some(&origin));
    file.write_all(text.as_bytes()).and_then(|()| file.commit()).map_err(|error| Failure::file(path, &error))?;
    note_springs(path, simulation)
}

/// Notes that a text leaves out the springs of contacts (docs/physics section 4.11), if there are any.
fn note_springs(path: &Path, simulation: &mut Simulation) -> Result<(), Failure> {
    let kept = simulation.contacts()?.iter().filter(|contact| contact.springs.is_some()).count();
    if kept > 0 {
        let contacts = counted(kept, "contact", "contacts");
        output::note(&format!(
            "note: {}: a scene text leaves out the springs of {contacts}, so bodies at rest move when it is run; --checkpoint \
             FILE.ckpt keeps them",
            path.display()
        ));
    }
    Ok(())
}
