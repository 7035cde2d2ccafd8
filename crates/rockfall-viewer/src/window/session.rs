//! A session: opens a scene, runs it, changes it and saves it, independently of the window. Errors become messages and do not
//! end the session.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rockfall::{Body, Error, Loaded, Scene, Settings, Simulation};

use super::hold::Held;
use super::message::{Level, Message, Messages};
use super::pace::Pace;
use super::watch::Watch;

mod pointer;

/// Opens a scene as a simulation on the device of the window.
pub type Opener = Box<dyn Fn(Scene) -> rockfall::Result<Simulation>>;

/// Name of the file that the key R loads (thesis section 2.12.1).
pub const INPUT: &str = "input.txt";
/// Number of warnings about a scene file that are shown; of the others only the number is shown.
const SHOWN_WARNINGS: usize = 3;

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

/// A scene that is opened, run, changed and saved.
pub struct Session {
    opener: Opener,
    source: Source,
    /// Constants set on the command line: name and value.
    overrides: Vec<(String, String)>,
    /// The file of the command line, which Shift+R loads.
    command_line_file: Option<PathBuf>,
    simulation: Simulation,
    /// Decides when steps are due.
    pub pace: Pace,
    running: bool,
    /// Messages to the user.
    pub messages: Messages,
    /// Values that are sampled at intervals.
    pub watch: Watch,
    held: Option<Held>,
    /// The body that was picked by a click.
    picked: Option<Body>,
    /// Increases whenever objects are added, removed or replaced.
    objects_version: u64,
    /// Increases whenever the simulation is replaced.
    simulation_version: u64,
    /// Increases whenever another scene is opened.
    scene_version: u64,
    /// Whether the device has failed. Nothing runs until [`Session::reopen`].
    device_failed: bool,
    /// Present time, in s since the window opened.
    now: f64,
}

impl Session {
    /// Opens a scene.
    ///
    /// # Errors
    /// Those of the opener. Later errors become messages, but a session needs a first scene.
    pub fn open(source: Source, overrides: Vec<(String, String)>, time_step: f32, opener: Opener) -> rockfall::Result<Self> {
        let mut simulation = opener(source.scene.clone())?;
        simulation.set_time_step(time_step)?;
        let command_line_file = source.path.clone();
        Ok(Self {
            opener,
            source,
            overrides,
            command_line_file,
            simulation,
            pace: Pace::new(time_step),
            running: false,
            messages: Messages::default(),
            watch: Watch::default(),
            held: None,
            picked: None,
            objects_version: 0,
            simulation_version: 0,
            scene_version: 0,
            device_failed: false,
            now: 0.0,
        })
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
    pub fn shown_messages(&self) -> impl DoubleEndedIterator<Item = (usize, &Message)> {
        self.messages.shown(self.now)
    }

    /// Returns the initial scene.
    pub fn source(&self) -> &Source {
        &self.source
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
        self.tell(Level::Error, error.to_string());
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
        self.running = running;
        self.pace.forget();
    }

    /// Stops the simulation and makes one step.
    pub fn single_step(&mut self) {
        self.set_running(false);
        self.do_steps(1);
    }

    /// Makes the steps that are due in a frame. `now` is the time in s since the window opened, `elapsed` the time in s since
    /// the last frame. `before_last` is called before the last step, so that the caller can blend between the last two
    /// states.
    pub fn frame(&mut self, now: f64, elapsed: f64, before_last: impl FnOnce(&mut Simulation)) {
        self.now = now;
        if !self.running || self.device_failed {
            return;
        }
        let due = self.pace.due(elapsed);
        if due == 0 {
            return;
        }
        let start = Instant::now();
        if self.do_steps(due - 1) {
            before_last(&mut self.simulation);
            if self.watch.phases_due(now) {
                self.do_profiled();
            } else {
                self.do_steps(1);
            }
        }
        self.pace.note_cost(due, start.elapsed().as_secs_f64());
    }

    fn do_steps(&mut self, steps: u64) -> bool {
        let result = if steps > 0 { self.simulation.run(steps, self.pace.time_step).map(drop) } else { Ok(()) };
        self.stop_on(result)
    }

    /// Makes one step and measures the time of its phases.
    fn do_profiled(&mut self) {
        // Devices without timestamps make the step without measuring.
        if self.simulation.clock().is_err() {
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
        let picked = self.picked;
        let sampled = self.watch.sample(&mut self.simulation, picked);
        if self.ok_or_report(sampled).is_none() {
            self.watch.disable();
        }
        self.watch.note_cost(self.now, start.elapsed().as_secs_f64());
    }

    /// Changes the physical constants from the next step on.
    pub fn change_settings(&mut self, change: impl FnOnce(&mut Settings)) {
        let mut settings = *self.simulation.settings();
        change(&mut settings);
        let changed = self.simulation.set_settings(settings);
        self.ok_or_report(changed);
    }

    /// Changes the time step, in s.
    pub fn set_time_step(&mut self, time_step: f32) {
        if self.apply_time_step(time_step) {
            self.pace.time_step = time_step;
            self.pace.forget();
        }
    }

    fn apply_time_step(&mut self, time_step: f32) -> bool {
        let set = self.simulation.set_time_step(time_step);
        self.ok_or_report(set).is_some()
    }

    /// Restores the initial scene.
    pub fn reset(&mut self) {
        let source = self.source.clone();
        if self.replace(source, false) {
            self.tell(Level::Note, "the scene was reset");
        }
    }

    /// Opens a scene file. If it has an error, this adds a message and keeps the present scene.
    pub fn load(&mut self, path: &Path) {
        let Some(Loaded { mut scene, warnings }) = ({
            let loaded = Scene::load(path);
            self.ok_or_report(loaded)
        }) else {
            return;
        };
        let name = path.display().to_string();
        for warning in warnings.iter().take(SHOWN_WARNINGS) {
            self.tell(Level::Warning, format!("{name}:{}: {}", warning.line, warning.text));
        }
        if warnings.len() > SHOWN_WARNINGS {
            self.tell(Level::Warning, format!("{name}: {} more warnings", warnings.len() - SHOWN_WARNINGS));
        }
        let changed = self.overrides.iter().try_for_each(|(name, value)| scene.settings.set(name, value));
        if self.ok_or_report(changed).is_none() {
            return;
        }
        for concern in scene.concerns(self.pace.time_step, self.simulation.integrator()).into_iter().take(SHOWN_WARNINGS) {
            self.tell(Level::Warning, format!("{name}: {concern}"));
        }
        let another = self.source.path.as_deref() != Some(path);
        let source = Source { name: name.clone(), path: Some(path.to_owned()), scene };
        if self.replace(source, another) {
            self.tell(Level::Note, format!("{name} was read"));
        }
    }

    /// Loads [`INPUT`] from the first of these folders that contains it (key R).
    pub fn load_input(&mut self, folders: &[PathBuf]) {
        let candidates: Vec<PathBuf> = folders.iter().map(|folder| folder.join(INPUT)).collect();
        match candidates.iter().find(|path| path.is_file()) {
            Some(path) => self.load(path),
            None => {
                let tried: Vec<String> = candidates.iter().map(|path| path.display().to_string()).collect();
                self.tell(Level::Error, format!("there is no {INPUT}; tried {}", tried.join(" and ")));
            }
        }
    }

    /// Loads the file of the command line again (key Shift+R).
    pub fn load_given(&mut self) {
        match self.command_line_file.clone() {
            Some(path) => self.load(&path),
            None => self.tell(Level::Error, "no scene file was given on the command line"),
        }
    }

    /// Replaces the simulation by that of another scene, and returns whether the scene could be opened.
    fn replace(&mut self, source: Source, another: bool) -> bool {
        let opened = (self.opener)(source.scene.clone());
        let Some(mut simulation) = self.ok_or_report(opened) else {
            return false;
        };
        if let Err(error) = simulation.set_time_step(self.pace.time_step) {
            self.fail(&error);
        }
        self.simulation = simulation;
        self.source = source;
        self.forget_bodies();
        self.watch = Watch::default();
        self.pace.forget();
        self.scene_version += u64::from(another);
        true
    }

    fn forget_bodies(&mut self) {
        self.held = None;
        self.picked = None;
        self.objects_version += 1;
        self.simulation_version += 1;
    }

    /// Writes the present state as a scene text, without the tether of a held body.
    pub fn save(&mut self, path: &Path) {
        let synced = self.simulation.sync().map(drop);
        let saved = synced.and_then(|()| self.scene_without_hold().save(path));
        if self.ok_or_report(saved).is_some() {
            self.tell(Level::Note, format!("saved as {}", path.display()));
        }
    }

    /// Returns the scene in the state that was read back last, without the tether of a held body.
    fn scene_without_hold(&self) -> Scene {
        let mut scene = self.simulation.scene().clone();
        if let Some(held) = &self.held {
            // The tether exists as long as a body is held.
            let _ = scene.remove_tether(held.tether);
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
        let set = self.simulation.set_time_step(self.pace.time_step);
        self.ok_or_report(set);
        self.tell(
            Level::Warning,
            "the graphics device was lost and opened again; the scene continues from the last state that was read back",
        );
    }

    /// Returns the body that was picked by a click.
    pub fn picked(&self) -> Option<Body> {
        self.picked
    }

    /// Returns the held body.
    pub fn held(&self) -> Option<&Held> {
        self.held.as_ref()
    }
}
