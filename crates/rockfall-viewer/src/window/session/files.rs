//! Opens, resets and saves scenes.

use std::path::{Path, PathBuf};

use rockfall::{Checkpoint, Loaded, Scene};

use super::playback::Playback;
use super::{Session, Source};
use crate::window::message::Level;
use crate::window::names::Names;
use crate::window::past::Past;
use crate::window::watch::Watch;

/// Name of the file that the key R loads (thesis section 2.12.1).
const INPUT: &str = "input.txt";
/// Number of warnings about a scene file that are shown; of the others only the number is shown.
const SHOWN_WARNINGS: usize = 3;

/// Time step of scenes that have none, in s.
const DEFAULT_TIME_STEP: f32 = 0.02;

/// Returns the names of the bodies in the file of a scene.
pub(super) fn names_of(source: &Source) -> Names {
    let text = source.path.as_deref().and_then(|path| std::fs::read(path).ok()).unwrap_or_default();
    let names = Names::of(&String::from_utf8_lossy(&text));
    // The file may have changed after the scene was read, and it may be no scene text.
    if names.fits(&source.scene) { names } else { Names::default() }
}

impl Session {
    /// Restores the initial scene.
    pub fn reset(&mut self) {
        let source = self.source.clone();
        if self.replace(source, "reset") {
            if self.is_playing_back() {
                self.show_frame(0);
            }
            self.tell(Level::Note, "the scene was reset");
        }
    }

    /// Opens a scene file, and returns whether it could be opened. If it has an error, this adds a message and keeps the
    /// present scene.
    pub fn load(&mut self, path: &Path) -> bool {
        let Some(Loaded { mut scene, warnings, .. }) = ({
            let loaded = Scene::load(path);
            self.ok_or_report(loaded)
        }) else {
            return false;
        };
        let name = path.display().to_string();
        for warning in warnings.iter().take(SHOWN_WARNINGS) {
            self.tell(Level::Warning, format!("{name}:{}: {}", warning.line, warning.text));
        }
        if warnings.len() > SHOWN_WARNINGS {
            self.tell(Level::Warning, format!("{name}: {} more warnings", warnings.len() - SHOWN_WARNINGS));
        }
        let changed = scene.settings.set_all(self.overrides.iter().map(|(name, value)| (name.as_str(), value.as_str())));
        if self.ok_or_report(changed).is_none() {
            return false;
        }
        if let Some(prepare) = &self.prepare {
            prepare(&mut scene);
        }
        let source = Source { name: name.clone(), path: Some(path.to_owned()), scene };
        let opened = self.replace(source, "opening of a scene");
        if opened {
            self.tell(Level::Note, format!("{name} was read"));
        }
        opened
    }

    /// Loads `input.txt` from the first of these folders that contains it (key R).
    pub fn load_input(&mut self, folders: &[PathBuf]) {
        let candidates: Vec<PathBuf> = folders.iter().map(|folder| folder.join(INPUT)).collect();
        match candidates.iter().find(|path| path.is_file()) {
            Some(path) => drop(self.load(path)),
            None => {
                let tried: Vec<String> = candidates.iter().map(|path| path.display().to_string()).collect();
                self.tell(Level::Error, format!("there is no {INPUT}; tried {}", tried.join(" and ")));
            }
        }
    }

    /// Loads the file of the command line again (key Shift+R).
    pub fn load_given(&mut self) {
        match self.command_line_file.clone() {
            Some(path) => drop(self.load(&path)),
            None => self.tell(Level::Error, "no scene file was given on the command line"),
        }
    }

    /// Replaces the simulation by that of another scene, and returns whether the scene could be opened.
    fn replace(&mut self, source: Source, name: &str) -> bool {
        let opened = (self.opener)(source.scene.clone());
        let Some(mut simulation) = self.ok_or_report(opened) else {
            return false;
        };
        if let Err(error) = simulation.set_time_step(self.pace.time_step) {
            self.fail(&error);
        }
        let before = self.scene_for_undo();
        self.simulation = simulation;
        self.replaced(source);
        self.edited_scene(name, before);
        true
    }

    fn scene_for_undo(&mut self) -> Option<(Source, Checkpoint)> {
        let unchanged = self.simulation.report().steps == 0 && !self.can_undo()[0];
        // An unchanged scene is still in its file.
        let state = if unchanged && self.source.path.is_some() { None } else { self.state_for_undo() };
        state.map(|state| (self.source.clone(), state))
    }

    /// Sets the source of a scene that has replaced another one.
    pub(super) fn replaced(&mut self, source: Source) {
        let another = (&source.name, &source.path) != (&self.source.name, &self.source.path);
        let played = self.played().is_some();
        self.take_time_step(&source.scene, another);
        self.source = source;
        let interval = self.played().and_then(Playback::time_step);
        if let Some(interval) = interval {
            self.pace.time_step = interval;
        } else if played && !self.keeps_time_step {
            // The time between two frames is not the time step of another scene.
            let time_step = self.source.scene.time_step().unwrap_or(DEFAULT_TIME_STEP);
            if self.apply_time_step(time_step) {
                self.pace.time_step = time_step;
            }
        }
        self.names = names_of(&self.source);
        self.forget_bodies();
        (self.past, self.watch) = (Past::default(), Watch::default());
        self.watch_joints();
        self.pace.forget();
        self.scene_version += u64::from(another);
        self.warn();
    }

    /// Takes the time step of a scene that replaces the present one. A scene without one keeps that of the window, unless it was that
    /// of the present scene. A reset keeps it too.
    fn take_time_step(&mut self, scene: &Scene, another: bool) {
        let [before, now] = [&self.source.scene, scene].map(|scene| scene.time_step());
        if before == now && !another {
            return;
        }
        let is_own = before.is_some_and(|before| before == self.pace.time_step);
        let time_step = if is_own { Some(now.unwrap_or(DEFAULT_TIME_STEP)) } else { now };
        if let Some(time_step) = time_step.filter(|_| !self.keeps_time_step)
            && self.apply_time_step(time_step)
        {
            self.pace.time_step = time_step;
        }
    }

    /// The present scene, without the tether of a held body. If it says how it is run, it has the time step of the window.
    fn scene_to_save(&self) -> Scene {
        let mut scene = self.scene_without_hold();
        if scene.time_step().is_some_and(|time_step| time_step != self.pace.time_step) {
            (scene.run.dt, scene.run.substeps) = (Some(self.pace.time_step), None);
        }
        scene
    }

    /// Writes the scene after the comment at the beginning of its file.
    fn write(&self, path: &Path) -> rockfall::Result<()> {
        let scene = self.scene_to_save();
        let loaded = self.source.path.as_deref().and_then(|path| Scene::load(path).ok());
        let title = loaded.map(|loaded| loaded.title).unwrap_or_default();
        scene.save_text(path, &scene.to_text_of_state(&title, None))
    }

    /// Writes the present state as a scene text, without the tether of a held body, and returns whether that was possible.
    pub fn save(&mut self, path: &Path) -> bool {
        let synced = self.simulation.sync().map(drop);
        let saved = synced.and_then(|()| self.write(path));
        let saved = self.ok_or_report(saved).is_some();
        if saved {
            self.revisions.opened_or_saved();
            self.tell(Level::Note, format!("saved as {}", path.display()));
        }
        saved
    }
}
