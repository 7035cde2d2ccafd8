//! Summary that a run prints at its end.

use std::fmt::Write as _;

use rockfall::{Energy, Flow, MaxOverlap, Scene, Settings, Simulation, short_number};
use serde_json::json;

use crate::check;
use crate::failure::Failure;
use crate::options::{self, InWords, counted};
use crate::picture;

/// Data for the summary that the simulation itself does not have.
pub(crate) struct Summary<'a> {
    pub(crate) name: &'a str,
    /// Number of lines of the scene that are comments.
    pub(crate) comments: usize,
    /// The precision of contacts, and why it was chosen.
    pub(crate) precision: &'a str,
    /// Number of whole steps done.
    pub(crate) steps: u64,
    /// Time simulated, in s.
    pub(crate) time: f64,
    pub(crate) dt: f32,
    /// Number of parts that a step is divided into.
    pub(crate) substeps: u32,
    /// Substeps of the solver of the contact law `rigid`.
    pub(crate) frame_substeps: Option<u32>,
    /// Wall time of the steps, in s.
    pub(crate) seconds: f64,
    /// Energy at the start and at the end.
    pub(crate) energies: [Energy; 2],
    /// Deepest overlaps at the end.
    pub(crate) overlap: MaxOverlap,
    /// Number of joints that are broken at the end.
    pub(crate) broken_joints: usize,
}

impl Summary<'_> {
    fn steps_per_second(&self, steps: u64) -> f64 {
        if steps == 0 { 0.0 } else { steps as f64 / self.seconds.max(1e-9) }
    }

    /// Describes the number and the length of the steps. Steps before a checkpoint may have had another length.
    fn length(&self, steps: u64, time: f64) -> String {
        let equal_steps = steps as f64 * options::as_written(self.dt);
        let (step, all) = (options::as_text(self.dt), short_number(time, 7));
        if (time - equal_steps).abs() <= 1e-5 * equal_steps {
            format!("{steps} of {step} s = {all} s{}", self.parts())
        } else {
            format!("{steps}, the last of {step} s{}, {all} s in all", self.parts())
        }
    }

    fn parts(&self) -> String {
        match self.frame_substeps {
            Some(substeps) => format!(" in {substeps} substeps each"),
            None if self.substeps > 1 => format!(" in {} parts each", self.substeps),
            None => String::new(),
        }
    }

    /// The summary as one JSON object, for programs. `energy_growth` is by how much the energy grew without a cause in the scene.
    pub(crate) fn json(&self, simulation: &Simulation, energy_growth: Option<f64>) -> String {
        let report = simulation.report();
        let backend = simulation.backend();
        let counts = simulation.scene().counts();
        let [start, end] = &self.energies;
        let object = json!({
            "scene": self.name,
            "comments": self.comments,
            "backend": backend.kind.to_string(),
            "device": backend.device,
            "integrator": simulation.integrator().to_string(),
            "broad_phase": simulation.broad_phase_method().to_string(),
            "precision": self.precision,
            "settings": options::settings_json(simulation.settings()),
            "steps": self.steps,
            "dt": options::as_written(self.dt),
            "time": self.time,
            "substeps": self.frame_substeps.unwrap_or(self.substeps),
            "seconds": self.seconds,
            "steps_per_second": self.steps_per_second(self.steps),
            "objects": options::counts_json(&counts),
            "energy_start": options::energy_json(start),
            "energy_end": options::energy_json(end),
            "energy_growth_without_cause": energy_growth,
            "max_overlap": options::as_written(self.overlap.units),
            "max_overlap_radii": options::as_written(self.overlap.radii),
            "contacts": report.contacts,
            "collisions": report.total_collisions,
            "replays": report.replays,
            "non_finite": report.non_finite,
            "passages": report.passages,
            "broken_joints": self.broken_joints,
            "flow": options::flow_json(&simulation.flow()),
        });
        format!("{object}\n")
    }

    /// The summary as a table, for people.
    pub(crate) fn table(&self, simulation: &mut Simulation) -> Result<String, Failure> {
        let report = simulation.report();
        let backend = simulation.backend();
        let mut text = format!("{}\n", self.name);
        let mut row = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {name:<11} {value}");
        };
        row("backend", format!("{}: {} ({})", backend.kind, backend.device, backend.reason));
        if self.frame_substeps.is_none() {
            row("pairs", format!("found by {}", simulation.broad_phase_method()));
            row("integrator", simulation.integrator().to_string());
        }
        row("settings", changed(simulation.settings()));
        row("precision", self.precision.to_owned());
        row("comments", counted(self.comments, "line of the scene", "lines of the scene"));
        row("objects", InWords(simulation.scene().counts()).to_string());
        if let Some(chosen) = check::chosen_contact(simulation.settings()) {
            row("constants", chosen);
        }
        let speed = self.steps_per_second(self.steps);
        let real_time = if self.seconds > 0.0 { self.time / self.seconds } else { 0.0 };
        let length = self.length(self.steps, self.time);
        let [wall, speed, real_time] = [self.seconds, speed, real_time].map(short);
        row("steps", format!("{length}, done in {wall} s: {speed} steps/s, {real_time} times real time"));
        let energies = |energy: &Energy| {
            let [kinetic, potential, spring, contact] =
                [energy.kinetic, energy.potential, energy.spring, energy.contact].map(short);
            let total = short(energy.total());
            format!("{total:>10} = {kinetic} kinetic + {potential} potential + {spring} spring + {contact} contact")
        };
        row("energy", format!("{} at the start", energies(&self.energies[0])));
        row("", format!("{} at the end", energies(&self.energies[1])));
        row("contacts", format!("{} in the last step", report.contacts));
        let MaxOverlap { units, radii, .. } = self.overlap;
        let resting = simulation.resting_overlap()?.radii;
        let [units, radii, resting] = [units, radii, resting].map(|number| short(number.into()));
        row("overlap", format!("{units} at the end, {radii} radii; {resting} radii between bodies at rest"));
        row("collisions", format!("{} in all, {} in the last step", report.total_collisions, report.collisions));
        if self.broken_joints > 0 {
            let joints = simulation.scene().joints().len();
            row("joints", format!("{} of {joints} broken", self.broken_joints));
        }
        flow_rows(simulation.scene(), &simulation.flow(), &mut row);
        if report.replays > 0 {
            let steps = if report.replays == 1 { "step" } else { "steps" };
            row("replays", format!("{} {steps} repeated, with new lists or more memory", report.replays));
        }
        if report.non_finite > 0 {
            row("not finite", format!("a body with non-finite values was stopped {} times", report.non_finite));
        }
        if report.passages > 0 {
            row("passages", format!("{} through polygons, triangles or planes", report.passages));
        }
        let scene: &Scene = simulation.sync()?;
        let left = picture::Left::of(scene);
        if let Some(told) = left.describe() {
            let _ = writeln!(text, "  {:<11} {told}", "left");
        }
        text.push_str(&picture::side_view(scene, &left));
        Ok(text)
    }
}

/// Rows about inlets and outlets, if there are any.
fn flow_rows(scene: &Scene, flow: &Flow, row: &mut impl FnMut(&str, String)) {
    let has_bodies = !scene.shapes().is_empty();
    let [one, many] = if has_bodies { ["sphere or body", "spheres and bodies"] } else { ["sphere", "spheres"] };
    let amount = |spheres: u64, mass: f64| format!("{} of mass {}", counted(spheres as usize, one, many), short(mass));
    for inlet in &flow.inlets {
        let waiting = if inlet.waiting > 0 { format!(", {} due and not in yet", inlet.waiting) } else { String::new() };
        row("in", format!("{} through {}{waiting}", amount(inlet.spheres, inlet.mass), inlet.name));
    }
    for outlet in &flow.outlets {
        row("out", format!("{} through {}", amount(outlet.spheres, outlet.mass), outlet.name));
    }
    if !(flow.inlets.is_empty() && flow.outlets.is_empty()) {
        row("inside", amount(flow.spheres, flow.mass));
    }
}

/// Lists the constants that do not have their default value.
fn changed(settings: &Settings) -> String {
    let defaults = Settings::default();
    let changed = |name: &str| settings.get(name).filter(|value| defaults.get(name).as_ref() != Some(value));
    // The precision has a line of its own.
    let names = Settings::NAMES.iter().filter(|name| **name != "precision");
    let list: Vec<String> = names.filter_map(|name| Some(format!("{name} {}", changed(name)?))).collect();
    if list.is_empty() { "the default values".to_owned() } else { format!("{}; else the default values", list.join(", ")) }
}

/// Formats a number with four significant digits.
fn short(number: f64) -> String {
    short_number(number, 4)
}
