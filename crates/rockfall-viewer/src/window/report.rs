//! The state of the window as JSON, for tests and bug reports.

use rockfall::Settings;
use rockfall::glam::Vec3;
use serde_json::{Map, Value, json};

use super::viewer::Viewer;

fn vector(v: Vec3) -> Value {
    json!(v.to_array())
}

/// Returns everything that keys and the mouse can change.
pub(super) fn report(viewer: &mut Viewer, device: &str, run: &Value) -> Value {
    let following = viewer.is_following();
    let session = &mut viewer.session;
    let positions: Vec<Value> = match session.simulation().sync() {
        Ok(scene) => scene.spheres().iter().take(100).map(|sphere| vector(sphere.position)).collect(),
        Err(_) => Vec::new(),
    };
    let simulation = session.simulation_ref();
    let (report, counts, settings) = (simulation.report(), simulation.scene().counts(), *simulation.settings());
    let constants: Map<String, Value> =
        Settings::NAMES.iter().map(|name| ((*name).to_owned(), json!(settings.get(name).unwrap_or_default()))).collect();
    let messages: Vec<Value> = session
        .messages
        .all()
        .iter()
        .map(|message| json!({ "level": message.level.name(), "text": message.text, "at": message.at }))
        .collect();
    let asked = viewer.dialog.question().map(|path| path.display().to_string());
    let dialog = viewer.dialog.is_shown().then(|| json!({ "path": viewer.dialog.path, "overwrite": asked }));
    json!({
        "scene": session.source().name,
        "backend": simulation.backend().device,
        "device": device,
        "constants": constants,
        "running": session.running(),
        "real_time": session.pace.real_time,
        "speed": session.pace.speed(),
        "time_step": session.pace.time_step.to_string().parse::<f64>().unwrap_or_default(),
        "step_of_run": session.played().and_then(|playback| playback.step_of_run()),
        "keeps_up": session.pace.lag().is_none(),
        "steps": report.steps,
        "time": report.time,
        "contacts": report.contacts,
        "spheres": counts.spheres,
        "rods": counts.rods,
        "tethers": counts.tethers,
        "positions": positions,
        "picked": session.watch.facts().map(|facts| facts.title.clone()),
        "following": following,
        "changed": session.is_changed(),
        "leaving": viewer.leaving,
        "held": session.held().is_some(),
        "energy_samples": session.watch.energies().len(),
        "phase_samples": session.watch.phases().len(),
        "messages": messages,
        "camera": { "eye": vector(viewer.camera.eye), "target": vector(viewer.camera.target) },
        "picture": viewer.size().to_array(),
        "picture_origin": viewer.origin.to_array(),
        "controls": viewer.controls.name(),
        "dialog": dialog,
        "busy": viewer.busy,
        "track": viewer.session.track().points().len(),
        "past": viewer.session.past().times().len(),
        "can_undo": viewer.session.can_undo()[0],
        "recording": viewer.capture.is_recording(),
        "help": viewer.help,
        "panel": viewer.panel,
        "colour_by": format!("{:?}", viewer.style.colour_by).to_lowercase(),
        "frames_per_second": viewer.rates.frames,
        "steps_per_second": viewer.rates.steps,
        "run": run,
    })
}
