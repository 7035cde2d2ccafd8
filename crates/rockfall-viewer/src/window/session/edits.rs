//! Undo and redo of what the user changes: constants, the time step, thrown and pulled bodies, resets and loaded scenes.

use std::collections::VecDeque;

use rockfall::{Checkpoint, Integrator, Joint, JointId, Settings};

use super::{Session, Source};
use crate::window::message::Level;
use crate::window::past::bytes_of;

/// Greatest number of edits that can be undone.
const MOST: usize = 100;
/// Memory that the states of undo may take, in bytes.
const BUDGET: usize = 256 << 20;
/// Changes of the same constant within this time, in s, are one edit: the movement of a slider makes many.
const ONE_EDIT: f64 = 1.0;

/// What an edit replaced.
#[derive(Clone, Debug)]
enum Before {
    Settings(Box<Settings>),
    TimeStep(f32),
    Joint(JointId, Box<Joint>),
    /// The state of the same scene.
    State(Box<Checkpoint>),
    /// The state of a scene that was replaced, and its revision that was opened or saved.
    Scene(Box<(Source, Checkpoint, Option<u64>)>),
}

impl Before {
    fn bytes(&self) -> usize {
        match self {
            Self::Settings(_) | Self::TimeStep(_) | Self::Joint(..) => 0,
            Self::State(state) => bytes_of(&state.scene),
            Self::Scene(scene) => bytes_of(&scene.0.scene) + bytes_of(&scene.1.scene),
        }
    }
}

#[derive(Clone, Debug)]
struct Edit {
    /// Name in messages.
    name: String,
    before: Before,
    /// The revision that the edit replaced.
    revision: u64,
    /// Wall time of its last change, in s.
    at: f64,
}

/// The revisions of the scene: every edit makes a new one, and undo goes back to an earlier one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Revisions {
    present: u64,
    newest: u64,
    /// The one that was opened or saved; `None` if undo cannot lead back to it.
    clean: Option<u64>,
}

impl Revisions {
    /// Makes a new revision, and returns the one that it replaces. An edit that cannot be undone stays whatever is undone.
    fn edit(&mut self, can_undo: bool) -> u64 {
        self.newest += 1;
        if !can_undo {
            self.clean = None;
        }
        std::mem::replace(&mut self.present, self.newest)
    }

    /// The present revision is that of a file.
    pub(super) fn opened_or_saved(&mut self) {
        self.clean = Some(self.present);
    }

    /// Whether the scene differs from the one that was opened or saved.
    pub(super) fn is_changed(&self) -> bool {
        self.clean != Some(self.present)
    }
}

/// The edits that can be undone and redone.
#[derive(Clone, Debug, Default)]
pub(super) struct Edits {
    done: VecDeque<Edit>,
    undone: Vec<Edit>,
}

impl Edits {
    fn push(&mut self, edit: Edit) {
        self.undone.clear();
        self.done.push_back(edit);
        while self.done.len() > MOST
            || self.done.len() > 1 && self.done.iter().map(|edit| edit.before.bytes()).sum::<usize>() > BUDGET
        {
            self.done.pop_front();
        }
    }

    /// Whether the last edit has this name and is recent, so that a further change belongs to it.
    fn continues(&mut self, name: &str, now: f64) -> bool {
        let last = self.done.back_mut().filter(|last| last.name == name && now - last.at < ONE_EDIT);
        let found = last.map(|last| last.at = now).is_some();
        if found {
            self.undone.clear();
        }
        found
    }
}

/// Returns the names of the constants that differ.
fn changed(one: &Settings, two: &Settings) -> String {
    let names = Settings::NAMES.iter().filter(|name| one.get(name) != two.get(name));
    names.map(|name| name.replace('_', " ")).collect::<Vec<_>>().join(", ")
}

impl Session {
    /// Changes the constants. Another kind of contact law needs another integrator, unless the command line or the scene has one that
    /// it allows.
    pub(super) fn apply_settings(&mut self, settings: Settings) -> rockfall::Result<()> {
        self.watch.outdate();
        let has_history = settings.contact_law.has_history();
        if self.simulation.settings().contact_law.has_history() == has_history {
            return self.simulation.set_settings(settings);
        }
        settings.validate()?;
        self.release();
        let mut state = self.simulation.checkpoint()?;
        state.scene.settings = settings;
        let run = &mut state.scene.run;
        run.integrator = run.integrator.filter(|own| !has_history || own.resolve(settings.contact_law) != Integrator::Rk4);
        let mut simulation = (self.opener)(state.scene.clone())?;
        simulation.restore(&state)?;
        let before = std::mem::replace(&mut self.simulation, simulation).integrator();
        self.objects_version += 1;
        self.simulation_version += 1;
        self.apply_time_step(self.pace.time_step);
        let now = self.simulation.integrator();
        if now != before {
            let law = settings.contact_law;
            self.tell(Level::Note, format!("integrator {now} instead of {before}, for the contact law {law}"));
        }
        Ok(())
    }

    /// Records a change of the constants.
    pub(super) fn edited_settings(&mut self, before: Settings) {
        let name = changed(&before, self.simulation.settings());
        if !name.is_empty() {
            self.edited_number(name, Before::Settings(Box::new(before)));
        }
    }

    /// Records a change of the time step.
    pub(super) fn edited_time_step(&mut self, before: f32) {
        if before != self.pace.time_step {
            self.edited_number("time step".to_owned(), Before::TimeStep(before));
        }
    }

    /// Records a change of the motor or the spring of a joint.
    pub(super) fn edited_joint(&mut self, id: JointId, before: Joint) {
        let place = self.simulation.scene().joint_ids().position(|other| other == id).unwrap_or_default();
        let name = format!("joint {}", before.name.clone().unwrap_or_else(|| place.to_string()));
        self.edited_number(name, Before::Joint(id, Box::new(before)));
    }

    fn edited_number(&mut self, name: String, before: Before) {
        let revision = self.revisions.edit(true);
        if !self.edits.continues(&name, self.now) {
            self.edits.push(Edit { name, before, revision, at: self.now });
        }
    }

    /// Returns the present state for [`Session::edited_state`]; `None`, with a message, if the scene is too large to keep it.
    pub(super) fn state_for_undo(&mut self) -> Option<Checkpoint> {
        if bytes_of(self.simulation.scene()) > BUDGET / 2 {
            self.tell(Level::Note, "the scene is too large to undo this");
            return None;
        }
        self.state()
    }

    /// Records a change of the bodies.
    pub(super) fn edited_state(&mut self, name: &str, before: Option<Checkpoint>) {
        let revision = self.revisions.edit(before.is_some());
        if let Some(before) = before {
            // Recorded states from here on do not have this edit.
            self.past.forget_from(self.simulation.report().steps);
            self.edits.push(Edit { name: name.to_owned(), before: Before::State(Box::new(before)), revision, at: self.now });
        }
    }

    /// Records the replacement of the scene by one from a file.
    pub(super) fn edited_scene(&mut self, name: &str, before: Option<(Source, Checkpoint)>) {
        let clean = self.revisions.clean;
        let revision = self.revisions.edit(before.is_some());
        self.revisions.opened_or_saved();
        if let Some((source, state)) = before {
            let before = Before::Scene(Box::new((source, state, clean)));
            self.edits.push(Edit { name: name.to_owned(), before, revision, at: self.now });
        }
    }

    /// Undoes the last edit. Constants change back at once. Where an edit changed bodies, the scene goes back to the moment
    /// before the edit.
    pub fn undo(&mut self) {
        self.release();
        let Some(edit) = self.edits.done.pop_back() else {
            self.tell(Level::Note, "there is nothing to undo");
            return;
        };
        let name = edit.name.clone();
        if let Some(inverse) = self.swap(edit) {
            self.edits.undone.push(inverse);
            self.tell(Level::Note, format!("undone: {name}"));
        }
    }

    /// Repeats the edit that was undone last.
    pub fn redo(&mut self) {
        self.release();
        let Some(edit) = self.edits.undone.pop() else {
            self.tell(Level::Note, "there is nothing to redo");
            return;
        };
        let name = edit.name.clone();
        if let Some(inverse) = self.swap(edit) {
            self.edits.done.push_back(inverse);
            self.tell(Level::Note, format!("redone: {name}"));
        }
    }

    /// Whether there is an edit to undo and one to redo.
    pub fn can_undo(&self) -> [bool; 2] {
        [!self.edits.done.is_empty(), !self.edits.undone.is_empty()]
    }

    /// Restores constants as they were in effect. With `resting_overlap`, the simulation has chosen some for the present positions.
    fn keep_settings(&mut self, settings: Settings) -> Option<()> {
        if *self.simulation.settings() == settings {
            return Some(());
        }
        let mut state = self.state()?;
        state.scene.settings = settings;
        let restored = self.simulation.restore(&state);
        self.ok_or_report(restored)?;
        self.objects_version += 1;
        self.apply_time_step(self.pace.time_step).then_some(())
    }

    /// Restores what an edit replaced, and returns the edit that reverts this.
    fn swap(&mut self, edit: Edit) -> Option<Edit> {
        let Edit { name, before, revision, .. } = edit;
        let inverse = match before {
            Before::Settings(before) => {
                let present = *self.simulation.settings();
                let set = self.apply_settings(*before);
                self.ok_or_report(set)?;
                self.keep_settings(*before)?;
                Before::Settings(Box::new(present))
            }
            Before::TimeStep(before) => {
                let present = self.pace.time_step;
                self.apply_time_step(before).then_some(())?;
                self.pace.time_step = before;
                self.pace.forget();
                Before::TimeStep(present)
            }
            Before::Joint(id, before) => {
                let present = self.simulation.scene().joint(id).ok()?.clone();
                let changed = self.simulation.update_joint(id, |joint| *joint = *before);
                self.ok_or_report(changed)?;
                Before::Joint(id, Box::new(present))
            }
            Before::State(mut before) => {
                let present = self.state()?;
                // Changes of constants are edits of their own.
                before.scene.settings = *self.simulation.settings();
                self.set_running(false);
                self.restore(&before).then_some(())?;
                self.past.forget_from(before.report.steps);
                Before::State(Box::new(present))
            }
            Before::Scene(before) => {
                let (source, state, clean) = *before;
                let present = (self.source.clone(), self.state()?, self.revisions.clean);
                self.set_running(false);
                self.restore(&state).then_some(())?;
                self.replaced(source);
                self.revisions.clean = clean;
                self.simulation_version += 1;
                Before::Scene(Box::new(present))
            }
        };
        let revision = std::mem::replace(&mut self.revisions.present, revision);
        // A later change of the same constant is another edit.
        Some(Edit { name, before: inverse, revision, at: f64::NEG_INFINITY })
    }
}
