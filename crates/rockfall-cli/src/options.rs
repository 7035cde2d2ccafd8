//! Arguments that several commands share.

use std::fmt;
use std::path::PathBuf;

use crate::failure::Failure;
use rockfall::settings::DEFAULT_FRAME;
use rockfall::{
    Backend, BroadPhase, ContactLaw, Integrator, IntegratorChoice, Optimization, Options, RunDefaults, Scene, Settings,
};

/// Options that determine the motion of a scene.
#[derive(Debug, clap::Args)]
pub(crate) struct Physics {
    /// Time step in seconds [default: that of the scene, else 0.02, 1/60 with the contact law rigid]
    #[arg(long, value_name = "S", value_parser = time_step, allow_negative_numbers = true)]
    dt: Option<f32>,
    /// Integrator: rk4, symplectic-euler or velocity-verlet; auto: that of the scene, else velocity-verlet with contact laws that do
    /// not allow rk4, else rk4
    #[arg(long, default_value_t)]
    integrator: IntegratorChoice,
    /// Set a constant, overriding the scene's own settings; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<Setting>,
}

/// Number of equal parts that every step is divided into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Substeps {
    /// The smallest number for which the springs and contacts of the scene are stable.
    Auto,
    Parts(u32),
}

impl Substeps {
    /// What is given, or else the number of parts that the scene has.
    pub(crate) fn or_of(given: Option<Self>, scene: &Scene) -> Self {
        given.unwrap_or(Self::Parts(scene.run.substeps.unwrap_or(1)))
    }

    /// Takes what is given over to a scene whose solver divides steps itself: that of the contact law `rigid`.
    pub(crate) fn give(given: Option<Self>, scene: &mut Scene) {
        match given {
            Some(Self::Auto) => scene.run.substeps = None,
            Some(Self::Parts(parts)) => scene.run.substeps = Some(parts),
            None => {}
        }
    }

    /// The number of parts of a step of `dt` seconds.
    ///
    /// # Errors
    /// Wrong usage when `auto` needs too many.
    pub(crate) fn of(self, scene: &Scene, dt: f32, integrator: Integrator) -> Result<u32, Failure> {
        match self {
            Self::Auto => {
                let parts = scene.substeps_for(dt, integrator);
                let message = format!(
                    "--substeps auto: a step of {} s needs {parts} parts, expected at most {MAX_SUBSTEPS}",
                    as_text(dt)
                );
                if parts > MAX_SUBSTEPS { Err(Failure::usage(message)) } else { Ok(parts) }
            }
            Self::Parts(parts) => Ok(parts),
        }
    }
}

impl std::str::FromStr for Substeps {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            _ => whole(1, MAX_SUBSTEPS)(text).map(Self::Parts).map_err(|message| format!("{message}, or auto")),
        }
    }
}

/// Limit on the parts of a step.
pub(crate) const MAX_SUBSTEPS: u32 = RunDefaults::MAX_SUBSTEPS;
/// Time step of scenes that have none, in s.
pub(crate) const DEFAULT_TIME_STEP: f32 = 0.02;

/// Whether a step of a scene is a frame, which the solver of the contact law `rigid` divides itself.
pub(crate) fn is_rigid(scene: &Scene) -> bool {
    scene.contact_law() == ContactLaw::Rigid
}

/// Options that select the device and the algorithms.
#[derive(Debug, clap::Args)]
pub(crate) struct Engine {
    /// Where to compute: auto, gpu or cpu
    #[arg(long, default_value_t)]
    backend: Backend,
    /// Number of the GPU, from 0, as `rockfall devices` lists them; by default the best one
    #[arg(long, value_name = "N")]
    device: Option<usize>,
    /// Method that finds overlapping AABBs: auto, brute-force, sort-and-skip or grid
    #[arg(long, default_value_t)]
    pub(crate) broad_phase: BroadPhase,
    /// Leave out optimizations, to measure what they are worth; results stay the same. Separated by commas: joined-steps,
    /// list-interval, lead, portions, spatial-order, large-spheres, long-movers, sweeps-at-once
    #[arg(long, value_name = "NAME", value_delimiter = ',', hide_short_help = true)]
    pub(crate) without: Vec<Optimization>,
}

impl Engine {
    pub(crate) fn options(&self, physics: &Physics) -> Options {
        self.with_integrator(physics.integrator)
    }

    pub(crate) fn with_integrator(&self, integrator: impl Into<IntegratorChoice>) -> Options {
        let options = Options::new().backend(self.backend).broad_phase(self.broad_phase).integrator(integrator);
        let options = self.device.into_iter().fold(options, Options::device);
        self.without.iter().fold(options, |options, optimization| options.without(*optimization))
    }
}

/// The scene argument.
#[derive(Debug, clap::Args)]
pub(crate) struct SceneArgument {
    /// Scene file, or - for standard input
    pub(crate) scene: PathBuf,
}

impl Physics {
    /// The integrator for a scene.
    pub(crate) fn integrator_for(&self, scene: &Scene) -> Integrator {
        scene.integrator(self.integrator)
    }

    /// The time step for a scene, in s, before it is divided.
    pub(crate) fn dt_for(&self, scene: &Scene) -> f32 {
        let default = if is_rigid(scene) { DEFAULT_FRAME } else { DEFAULT_TIME_STEP };
        self.dt.or(scene.run.dt).unwrap_or(default)
    }

    /// The time step that is given, in s, or else that of earlier steps.
    pub(crate) fn dt_or(&self, before: f32) -> f32 {
        self.dt.unwrap_or(before)
    }

    /// The time step of a simulation of a scene that its number of parts divides, in s.
    pub(crate) fn part_for(&self, scene: &Scene) -> f32 {
        let parts = if is_rigid(scene) { 1 } else { scene.run.substeps.unwrap_or(1) };
        self.dt_for(scene) / parts as f32
    }

    /// Applies `--set` to a scene's settings.
    pub(crate) fn change(&self, settings: &mut Settings) -> Result<(), rockfall::Error> {
        settings.set_all(self.set.iter().map(|setting| (setting.name.as_str(), setting.value.as_str())))
    }
}

#[cfg(feature = "window")]
impl Physics {
    /// Names and values of `--set`, for scenes that the window reads later.
    pub(crate) fn overrides(&self) -> Vec<(String, String)> {
        self.set.iter().map(|setting| (setting.name.clone(), setting.value.clone())).collect()
    }
}

/// A `--set` argument whose name and value are valid.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    pub(crate) name: String,
    pub(crate) value: String,
}

impl std::str::FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE, as in --set gravity=9.81")?;
        let tried = Settings::default().set(name, value);
        tried.map_err(|error| error.to_string())?;
        Ok(Self { name: name.to_owned(), value: value.to_owned() })
    }
}

/// Returns a parser of whole numbers from `least` to `most`.
pub(crate) fn whole<T>(least: T, most: T) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: std::str::FromStr + PartialOrd + fmt::Display + Copy + Send + Sync + 'static,
{
    move |text| {
        let number = text.parse().ok().filter(|number| (least..=most).contains(number));
        number.ok_or_else(|| format!("expected a whole number from {least} to {most}"))
    }
}

pub(crate) fn time_step(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(dt) if dt.is_finite() && dt > 0.0 => Ok(dt),
        _ => Err("expected a finite number of seconds greater than 0".to_owned()),
    }
}

/// Converts to the f64 with the same shortest decimal form: 0.02 does not become 0.019999999552965164.
pub(crate) fn as_written(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

/// A number as it is written, with a power of ten where it would be long. An f32 has at most nine digits.
pub(crate) fn as_text(number: f32) -> String {
    rockfall::short_number(as_written(number), 9)
}

/// All constants, as JSON: numbers as they are written, switches as true or false, directions as arrays.
pub(crate) fn settings_json(settings: &Settings) -> serde_json::Value {
    let number = |text: &str| serde_json::json!(text.parse::<f64>().ok());
    let value = |text: String| match text.as_str() {
        "on" => true.into(),
        "off" => false.into(),
        text if ContactLaw::ALL.iter().any(|law| law.name() == text) => text.into(),
        text if text.contains(',') => text.split(',').map(number).collect(),
        text => number(text),
    };
    let entries = Settings::NAMES.iter().map(|name| ((*name).to_owned(), settings.get(name).map_or(().into(), value)));
    serde_json::Value::Object(entries.collect())
}

/// Kinetic, potential, spring and contact energy and their sum, as JSON.
pub(crate) fn energy_json(energy: &rockfall::Energy) -> serde_json::Value {
    // Adding 0 turns -0, the value of an empty sum, into 0.
    serde_json::json!({
        "kinetic": energy.kinetic + 0.0,
        "potential": energy.potential + 0.0,
        "spring": energy.spring + 0.0,
        "contact": energy.contact + 0.0,
        "total": energy.total() + 0.0,
    })
}

/// Number of objects of every kind, as JSON.
pub(crate) fn counts_json(counts: &rockfall::Counts) -> serde_json::Value {
    serde_json::json!({
        "spheres": counts.spheres,
        "rods": counts.rods,
        "capsules": counts.capsules,
        "springs": counts.springs,
        "tethers": counts.tethers,
        "boxes": counts.boxes,
        "polygons": counts.polygons,
        "bodies": counts.bodies,
        "hulls": counts.hulls,
        "joints": counts.joints,
    })
}

/// What came in, left and is inside, as JSON.
pub(crate) fn flow_json(flow: &rockfall::Flow) -> serde_json::Value {
    let inlets = flow.inlets.iter().map(
        |inlet| serde_json::json!({"name": inlet.name, "spheres": inlet.spheres, "mass": inlet.mass, "waiting": inlet.waiting}),
    );
    let outlets = flow
        .outlets
        .iter()
        .map(|outlet| serde_json::json!({"name": outlet.name, "spheres": outlet.spheres, "mass": outlet.mass}));
    serde_json::json!({
        "inlets": inlets.collect::<Vec<_>>(),
        "outlets": outlets.collect::<Vec<_>>(),
        "spheres": flow.spheres,
        "mass": flow.mass,
    })
}

/// A count with its noun: `1 sphere`, `2 spheres`, `3 boxes`.
pub(crate) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Displays the number of objects of every kind that occurs, such as `2 spheres, 1 spring`.
pub(crate) struct InWords(pub(crate) rockfall::Counts);

impl fmt::Display for InWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = &self.0;
        let kinds = [
            (counts.spheres, "sphere", "spheres"),
            (counts.rods, "rod", "rods"),
            (counts.capsules, "capsule", "capsules"),
            (counts.springs, "spring", "springs"),
            (counts.tethers, "tether", "tethers"),
            (counts.boxes, "box", "boxes"),
            (counts.polygons, "polygon", "polygons"),
            (counts.bodies, "rigid body", "rigid bodies"),
            (counts.hulls, "hull", "hulls"),
            (counts.joints, "joint", "joints"),
        ];
        let present: Vec<String> =
            kinds.into_iter().filter(|(count, ..)| *count > 0).map(|(count, one, many)| counted(count, one, many)).collect();
        f.write_str(if present.is_empty() { "none" } else { "" })?;
        f.write_str(&present.join(", "))
    }
}
