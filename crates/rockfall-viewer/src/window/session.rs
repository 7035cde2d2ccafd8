//! A session: opens a scene, runs it, changes it and saves it, independently of the window. Errors become messages and do not
//! end the session.

use std::path::PathBuf;
use std::rc::Rc;
use std::time::Instant;

use rockfall::{Body, Checkpoint, Error, Scene, Settings, Simulation};

use super::hold::Held;
use super::message::{Level, Message, Messages};
use super::names::Names;
use super::pace::Pace;
use super::past::Past;
use super::track::Track;
use super::watch::Watch;
use crate::plot::Plot;

pub(super) mod concerns;
mod edits;
mod files;
mod joints;
pub mod picked;
pub mod playback;
mod pointer;
mod rewind;

use concerns::Checked;
use edits::{Edits, Revisions};
use picked::Kept;

use playback::Playback;

/// Opens a scene as a simulation on the device of the window.
pub type Opener = Box<dyn Fn(Scene) -> rockfall::Result<Simulation>>;

/// A scene with its name and file.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name in messages and in the title of the window.
    pub name: String,
    /// The file that it was loaded from.
    pub path: Option<PathBuf>,
    /// The initial scene, which a reset restores.
    pub scene: Scene,
}

/// Changes a scene that was read.
pub type Prepare = Rc<dyn Fn(&mut Scene)>;

/// A scene that is opened, run, changed and saved.
pub struct Session {
    opener: Opener,
    source: Source,
    /// Constants set on the command line: name and value.
    overrides: Vec<(String, String)>,
    /// Changes every scene that is opened later.
    pub prepare: Option<Prepare>,
    /// The file of the command line, which Shift+R loads.
    command_line_file: Option<PathBuf>,
    simulation: Simulation,
    /// Decides when steps are due.
    pub pace: Pace,
    /// Whether scenes that are opened keep the time step of the window, whatever their own is.
    pub keeps_time_step: bool,
    running: bool,
    /// Messages to the user.
    pub messages: Messages,
    /// Values that are sampled at intervals.
    pub watch: Watch,
    /// Plots of joints in every scene that is opened.
    joint_plots: Vec<Plot>,
    held: Option<Held>,
    /// The state before a body was held, for undo.
    before_hold: Option<Checkpoint>,
    /// The body that was picked by a click.
    picked: Option<Body>,
    /// The motion of the picked body.
    track: Track,
    /// Bodies that stay in the plots.
    kept: Vec<Kept>,
    /// Names of the bodies in the file of the scene.
    names: Names,
    past: Past,
    edits: Edits,
    revisions: Revisions,
    /// Time at which the user will have stopped changing constants, in s, so that warnings about them are due.
    warn_at: Option<f64>,
    /// What the last warnings were about.
    checked: Option<Checked>,
    /// The last warnings about the scene.
    concerns: Vec<String>,
    /// Increases whenever objects are added, removed or replaced.
    objects_version: u64,
    /// Increases whenever the simulation is replaced.
    simulation_version: u64,
    /// Increases whenever another scene is opened.
    scene_version: u64,
    /// Whether the device has failed. Nothing runs until [`Session::reopen`].
    device_failed: bool,
    /// The trajectory that is played.
    playback: Option<Playback>,
    /// Time of the present frame, in s since the window opened.
    now: f64,
    /// Start of the present frame.
    frame_started: Instant,
}

impl Session {
    /// Opens a scene.
    ///
    /// # Errors
    /// Those of the opener. Later errors become messages, but a session needs a first scene.
    pub fn open(source: Source, overrides: Vec<(String, String)>, time_step: f32, opener: Opener) -> rockfall::Result<Self> {
        let mut simulation = opener(source.scene.clone())?;
        simulation.set_time_step(time_step)?;
        let (command_line_file, names) = (source.path.clone(), files::names_of(&source));
        let mut session = Self {
            opener,
            source,
            overrides,
            prepare: None,
            command_line_file,
            simulation,
            pace: Pace::new(time_step),
            keeps_time_step: false,
            running: false,
            messages: Messages::default(),
            watch: Watch::default(),
            joint_plots: Vec::new(),
            held: None,
            before_hold: None,
            picked: None,
            track: Track::default(),
            kept: Vec::new(),
            names,
            past: Past::default(),
            edits: Edits::default(),
            revisions: Revisions::default(),
            warn_at: None,
            checked: None,
            concerns: Vec::new(),
            objects_version: 0,
            simulation_version: 0,
            scene_version: 0,
            device_failed: false,
            playback: None,
            now: 0.0,
            frame_started: Instant::now(),
        };
        session.revisions.opened_or_saved();
        session.warn();
        Ok(session)
    }

    /// Returns the simulation for drawing and reading back; change it only through the session.
    pub fn simulation(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// Returns the simulation for what can be read without reading back.
    pub fn simulation_ref(&self) -> &Simulation {
        &self.simulation
    }

    /// Returns the messages that are shown at present, with their indices.
    pub fn shown_messages(&mut self) -> impl DoubleEndedIterator<Item = (usize, &Message)> {
        self.messages.shown(self.now)
    }

    /// Returns the initial scene.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Returns the time of the present frame, in s since the window opened.
    pub fn now(&self) -> f64 {
        self.now
    }

    /// Whether the simulation is running.
    pub fn running(&self) -> bool {
        self.running
    }

    /// Returns a number that increases whenever objects are added, removed or replaced.
    pub fn objects_version(&self) -> u64 {
        self.objects_version
    }

    /// Returns a number that increases whenever the simulation is replaced: by another scene, a reset, or after a lost device.
    pub fn simulation_version(&self) -> u64 {
        self.simulation_version
    }

    /// Returns a number that increases whenever another scene is opened, so that the camera has to be moved.
    pub fn scene_version(&self) -> u64 {
        self.scene_version
    }

    /// Whether the user has changed the scene since it was opened or saved. Steps and edits that were undone are no changes.
    pub fn is_changed(&self) -> bool {
        self.revisions.is_changed()
    }

    /// Returns the physical constants.
    pub fn settings(&self) -> &Settings {
        self.simulation.settings()
    }

    /// Whether the device has failed, so that [`Session::reopen`] is needed.
    pub fn device_failed(&self) -> bool {
        self.device_failed
    }

    /// Adds a message.
    pub fn tell(&mut self, level: Level, text: impl Into<String>) {
        self.messages.add(level, text, self.now);
    }

    /// Adds an error message, and records whether the error is a failure of the device.
    pub fn fail(&mut self, error: &Error) {
        self.device_failed |= matches!(error, Error::Device(_));
        self.tell(Level::Error, error.describe(self.simulation.scene()));
    }

    /// Returns the value, or adds an error message.
    fn ok_or_report<T>(&mut self, result: rockfall::Result<T>) -> Option<T> {
        result.map_err(|error| self.fail(&error)).ok()
    }

    /// Starts the simulation if it is stopped, else stops it.
    pub fn toggle_running(&mut self) {
        self.set_running(!self.running);
    }

    /// Starts or stops the simulation.
    pub fn set_running(&mut self, running: bool) {
        if running {
            self.warn();
        }
        self.running = running;
        self.pace.forget();
    }

    /// Stops the simulation and makes one step.
    pub fn single_step(&mut self) {
        self.set_running(false);
        self.before_steps();
        self.do_steps(1);
        self.follow(true);
    }

    /// Records the present state, and forgets the states after it if the user went back to it.
    fn before_steps(&mut self) {
        self.past.forget_after(self.simulation.report().steps);
        self.record(false);
    }

    /// Makes the steps that are due in a frame. `now` is the time in s since the window opened, `elapsed` the time in s since
    /// the last frame. `before_last` is called before the last step, so that the caller can blend between the last two
    /// states.
    pub fn frame(&mut self, now: f64, elapsed: f64, before_last: impl FnOnce(&mut Simulation)) {
        (self.now, self.frame_started) = (now, Instant::now());
        self.warn_if_settled();
        if !self.running || self.device_failed {
            return;
        }
        let due = self.pace.due(elapsed);
        if due == 0 {
            return;
        }
        self.before_steps();
        let start = Instant::now();
        if self.do_steps_of_frame(due - 1) {
            before_last(&mut self.simulation);
            if self.watch.phases_due(now) {
                self.do_profiled();
            } else {
                self.do_steps(1);
            }
        }
        self.settle_held(due);
        self.pace.note_cost(due, start.elapsed().as_secs_f64());
        self.follow(false);
    }

    /// Makes the steps of a frame before the last one. A slow frame has many: they are interrupted to record states.
    fn do_steps_of_frame(&mut self, steps: u64) -> bool {
        let interval = Past::interval(self.simulation.scene()) / f64::from(self.pace.time_step);
        let most = (interval.ceil() as u64).max(1);
        let mut left = steps;
        while left > most {
            if !self.do_steps(most) {
                return false;
            }
            left -= most;
            self.record(false);
            self.follow(false);
        }
        self.do_steps(left)
    }

    /// Returns the wall time in s since the window opened, also within a frame.
    fn wall_time(&self) -> f64 {
        self.now + self.frame_started.elapsed().as_secs_f64()
    }

    fn do_steps(&mut self, steps: u64) -> bool {
        if self.is_playing_back() {
            return self.play_frames(steps);
        }
        let result = if steps > 0 { self.simulation.run(steps, self.pace.time_step).map(drop) } else { Ok(()) };
        self.stop_on(result)
    }

    /// Makes one step and measures the time of its phases.
    fn do_profiled(&mut self) {
        // Devices without timestamps make the step without measuring.
        if self.is_playing_back() || self.simulation.clock().is_err() {
            self.do_steps(1);
            return;
        }
        match self.simulation.profile(1, self.pace.time_step) {
            Ok(profile) => self.watch.note_phases(&profile, self.simulation.report().time),
            Err(error) => drop(self.stop_on(Err(error))),
        }
    }

    fn stop_on(&mut self, result: rockfall::Result<()>) -> bool {
        if result.is_err() {
            self.set_running(false);
        }
        self.ok_or_report(result).is_some()
    }

    /// Samples the energies and the values of the picked body, if a sample is due or `forced`.
    pub fn sample(&mut self, forced: bool) {
        if self.device_failed || !(forced || self.watch.due(self.now, &self.simulation)) {
            return;
        }
        let start = Instant::now();
        let is_recorded = self.playback.is_some();
        let sampled = self.watch.sample(&mut self.simulation, self.picked, &self.names, is_recorded);
        if self.ok_or_report(sampled).is_none() {
            self.watch.disable();
        }
        self.watch.note_cost(self.now, start.elapsed().as_secs_f64());
    }

    /// Changes the physical constants from the next step on.
    pub fn change_settings(&mut self, change: impl FnOnce(&mut Settings)) {
        let before = *self.simulation.settings();
        let mut settings = before;
        change(&mut settings);
        let changed = self.apply_settings(settings);
        if self.ok_or_report(changed).is_some() {
            self.edited_settings(before);
            self.warn_soon();
        }
    }

    /// Changes the time step, in s.
    pub fn set_time_step(&mut self, time_step: f32) {
        let before = self.pace.time_step;
        if self.apply_time_step(time_step) {
            self.pace.time_step = time_step;
            self.pace.forget();
            self.edited_time_step(before);
            self.warn_soon();
        }
    }

    fn apply_time_step(&mut self, time_step: f32) -> bool {
        let set = self.simulation.set_time_step(time_step);
        self.ok_or_report(set).is_some()
    }

    /// Returns the scene in the state that was read back last, without the tether of a held body. Its muscles, moving walls
    /// and inlets go on where they are.
    fn scene_without_hold(&self) -> Scene {
        let mut scene = self.simulation.last_snapshot();
        if let Some(tether) = self.held.as_ref().and_then(Held::tether) {
            // The tether exists as long as a body is held.
            let _ = scene.remove_tether(tether);
        }
        scene
    }

    /// Continues on another device from the last state that was read back from the lost one.
    pub fn reopen(&mut self, opener: Opener) {
        self.opener = opener;
        let opened = (self.opener)(self.scene_without_hold());
        self.device_failed = false;
        let Some(simulation) = self.ok_or_report(opened) else {
            self.set_running(false);
            return;
        };
        self.simulation = simulation;
        self.forget_bodies();
        self.past = Past::default();
        let set = self.simulation.set_time_step(self.pace.time_step);
        self.ok_or_report(set);
        self.tell(
            Level::Warning,
            "the graphics device was lost and opened again; the scene continues from the last state that was read back",
        );
    }

    fn forget_bodies(&mut self) {
        self.held = None;
        self.picked = None;
        self.track = Track::default();
        self.kept.clear();
        self.objects_version += 1;
        self.simulation_version += 1;
    }

    /// Returns the held body.
    pub fn held(&self) -> Option<&Held> {
        self.held.as_ref()
    }
}
