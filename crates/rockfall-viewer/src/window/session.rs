//! A scene that is looked at: opened, moved, changed, saved. It knows nothing of windows; what goes wrong becomes a message, and
//! it goes on.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rockfall::{Body, Error, Loaded, Scene, Settings, Simulation};

use super::hold::Held;
use super::message::{Level, Message, Messages};
use super::pace::Pace;
use super::watch::Watch;

mod pointer;

/// Opens a scene on what the window draws with.
pub type Opener = Box<dyn Fn(Scene) -> rockfall::Result<Simulation>>;

/// The name of the file that R reads (thesis section 2.12.1).
pub const INPUT: &str = "input.txt";
/// Odd lines of a scene that are told; the others are counted.
const ODD_LINES: usize = 3;

/// A scene and what to call it.
#[derive(Clone, Debug)]
pub struct Source {
    /// Its name, for messages and the title.
    pub name: String,
    /// The file it came from.
    pub path: Option<PathBuf>,
    /// The scene as it was read, for a reset.
    pub scene: Scene,
}

/// A scene that is looked at.
pub struct Session {
    opener: Opener,
    source: Source,
    /// What the command line changed of the constants: name and value.
    overrides: Vec<(String, String)>,
    /// The file that Shift+R reads.
    given: Option<PathBuf>,
    simulation: Simulation,
    /// When steps are due.
    pub pace: Pace,
    running: bool,
    /// What there is to tell.
    pub messages: Messages,
    /// Values that are sampled now and then.
    pub watch: Watch,
    held: Option<Held>,
    /// The body that was clicked on.
    picked: Option<Body>,
    /// Grows whenever other objects are there.
    objects_version: u64,
    /// Grows whenever there is another simulation.
    simulation_version: u64,
    /// Grows whenever another scene is looked at.
    scene_version: u64,
    /// The device is gone: nothing runs until [`Session::reopen`].
    device_failed: bool,
    /// Present time, in s since the window opened.
    now: f64,
}

impl Session {
    /// Opens a scene.
    ///
    /// # Errors
    /// Those of the opener: later ones become messages, but without a first scene there is nothing to look at.
    pub fn open(source: Source, overrides: Vec<(String, String)>, time_step: f32, opener: Opener) -> rockfall::Result<Self> {
        let mut simulation = opener(source.scene.clone())?;
        simulation.set_time_step(time_step)?;
        let given = source.path.clone();
        Ok(Self {
            opener,
            source,
            overrides,
            given,
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

    /// The simulation, to draw and to read. Change it through the session.
    pub fn simulation(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// The simulation, to read what it knows without reading back.
    pub fn simulation_ref(&self) -> &Simulation {
        &self.simulation
    }

    /// The messages to be shown now.
    pub fn shown_messages(&self) -> impl DoubleEndedIterator<Item = (usize, &Message)> {
        self.messages.shown(self.now)
    }

    /// The scene as it was read.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Whether time goes on.
    pub fn running(&self) -> bool {
        self.running
    }

    /// Grows whenever objects were added, removed or replaced.
    pub fn objects_version(&self) -> u64 {
        self.objects_version
    }

    /// Grows whenever the simulation was replaced: by another scene, a reset, or on another device.
    pub fn simulation_version(&self) -> u64 {
        self.simulation_version
    }

    /// Grows whenever another scene was opened, which the camera should look at.
    pub fn scene_version(&self) -> u64 {
        self.scene_version
    }

    /// The physical constants.
    pub fn settings(&self) -> &Settings {
        self.simulation.settings()
    }

    /// Whether the device failed, so that [`Session::reopen`] must come before anything else happens.
    pub fn device_failed(&self) -> bool {
        self.device_failed
    }

    /// Tells something.
    pub fn tell(&mut self, level: Level, text: impl Into<String>) {
        self.messages.add(level, text, self.now);
    }

    /// Tells an error; of a failed device it is also remembered.
    pub fn fail(&mut self, error: &Error) {
        self.device_failed |= matches!(error, Error::Device(_));
        self.tell(Level::Error, error.to_string());
    }

    /// Gives the value, or tells the error.
    fn good<T>(&mut self, result: rockfall::Result<T>) -> Option<T> {
        result.map_err(|error| self.fail(&error)).ok()
    }

    /// Starts or stops.
    pub fn toggle_running(&mut self) {
        self.set_running(!self.running);
    }

    /// Starts or stops.
    pub fn set_running(&mut self, running: bool) {
        self.running = running;
        self.pace.forget();
    }

    /// A step alone; what was running stops.
    pub fn single_step(&mut self) {
        self.set_running(false);
        self.do_steps(1);
    }

    /// A frame at the time `now`, in s since the window opened, `elapsed` s after the last one: the steps that are due. `before_last`
    /// is called before the last of them, for drawing between the last two states.
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

    /// One step, with the time of its phases.
    fn do_profiled(&mut self) {
        // A device without timestamps steps all the same.
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
        self.good(result).is_some()
    }

    /// Samples energies and what is known of the picked body, if it is time for that or if `asked`.
    pub fn sample(&mut self, asked: bool) {
        if self.device_failed || !(asked || self.watch.due(self.now, &self.simulation)) {
            return;
        }
        let start = Instant::now();
        let picked = self.picked;
        let sampled = self.watch.sample(&mut self.simulation, picked);
        if self.good(sampled).is_none() {
            self.watch.give_up();
        }
        self.watch.rest(self.now, start.elapsed().as_secs_f64());
    }

    /// Changes the constants, from the next step on.
    pub fn change_settings(&mut self, change: impl FnOnce(&mut Settings)) {
        let mut settings = *self.simulation.settings();
        change(&mut settings);
        let changed = self.simulation.set_settings(settings);
        self.good(changed);
    }

    /// Changes the time step, in s.
    pub fn set_time_step(&mut self, time_step: f32) {
        if self.good_time_step(time_step) {
            self.pace.time_step = time_step;
            self.pace.forget();
        }
    }

    fn good_time_step(&mut self, time_step: f32) -> bool {
        let set = self.simulation.set_time_step(time_step);
        self.good(set).is_some()
    }

    /// The scene as it was read, once more.
    pub fn reset(&mut self) {
        let source = self.source.clone();
        if self.replace(source, false) {
            self.tell(Level::Note, "back to the start");
        }
    }

    /// Opens a scene file; a bad one is told, and the present scene stays.
    pub fn load(&mut self, path: &Path) {
        let Some(Loaded { mut scene, warnings }) = ({
            let loaded = Scene::load(path);
            self.good(loaded)
        }) else {
            return;
        };
        let name = path.display().to_string();
        for warning in warnings.iter().take(ODD_LINES) {
            self.tell(Level::Warning, format!("{name}:{}: {}", warning.line, warning.text));
        }
        if warnings.len() > ODD_LINES {
            self.tell(Level::Warning, format!("{name}: {} more odd lines", warnings.len() - ODD_LINES));
        }
        let changed = self.overrides.iter().try_for_each(|(name, value)| scene.settings.set(name, value));
        if self.good(changed).is_none() {
            return;
        }
        let another = self.source.path.as_deref() != Some(path);
        let source = Source { name: name.clone(), path: Some(path.to_owned()), scene };
        if self.replace(source, another) {
            self.tell(Level::Note, format!("{name} was read"));
        }
    }

    /// Reads [`INPUT`] from the first of these folders that has it: key R.
    pub fn load_input(&mut self, folders: &[PathBuf]) {
        let candidates: Vec<PathBuf> = folders.iter().map(|folder| folder.join(INPUT)).collect();
        match candidates.iter().find(|path| path.is_file()) {
            Some(path) => self.load(path),
            None => {
                let looked: Vec<String> = candidates.iter().map(|path| path.display().to_string()).collect();
                self.tell(Level::Error, format!("there is no {INPUT}: neither {}", looked.join(" nor ")));
            }
        }
    }

    /// Reads the file given on the command line again: key Shift+R.
    pub fn load_given(&mut self) {
        match self.given.clone() {
            Some(path) => self.load(&path),
            None => self.tell(Level::Error, "no scene file was given on the command line, so there is none to read again"),
        }
    }

    /// Takes another scene, if it opens.
    fn replace(&mut self, source: Source, another: bool) -> bool {
        let opened = (self.opener)(source.scene.clone());
        let Some(mut simulation) = self.good(opened) else {
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

    /// Writes the present state as a scene text, without what the pointer holds.
    pub fn save(&mut self, path: &Path) {
        let synced = self.simulation.sync().map(drop);
        let saved = synced.and_then(|()| self.scene_let_go().save(path));
        if self.good(saved).is_some() {
            self.tell(Level::Note, format!("saved as {}", path.display()));
        }
    }

    /// The scene as it was read back last, without the tether of what the pointer holds.
    fn scene_let_go(&self) -> Scene {
        let mut scene = self.simulation.scene().clone();
        if let Some(held) = &self.held {
            // It is there as long as it is held.
            let _ = scene.remove_tether(held.tether);
        }
        scene
    }

    /// Goes on with another device, from the last state that was read back from the lost one.
    pub fn reopen(&mut self, opener: Opener) {
        self.opener = opener;
        let opened = (self.opener)(self.scene_let_go());
        self.device_failed = false;
        let Some(simulation) = self.good(opened) else {
            self.set_running(false);
            return;
        };
        self.simulation = simulation;
        self.forget_bodies();
        let settled = self.simulation.set_time_step(self.pace.time_step);
        self.good(settled);
        self.tell(
            Level::Warning,
            "the graphics device was lost and opened again; the scene goes on from the last state read back",
        );
    }

    /// The body that was clicked on.
    pub fn picked(&self) -> Option<Body> {
        self.picked
    }

    /// What the pointer holds.
    pub fn held(&self) -> Option<&Held> {
        self.held.as_ref()
    }
}
