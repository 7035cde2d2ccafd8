//! Values that are sampled at intervals: energies, times of the phases, and the values of the picked body.
//!
//! Energies and contacts are evaluated on the host, which takes long in large scenes. The more a sample costs, the less often
//! it is taken. In the largest scenes samples are taken only on request.

use std::collections::VecDeque;

use rockfall::glam::Vec3;
use rockfall::step::schedule::Phase;
use rockfall::{Body, Energy, Profile, RodId, Scene, Simulation, SphereId};

use super::names::Names;
use crate::plot::{gauge_forces, motion};

/// Least time between two samples, in s.
const INTERVAL: f64 = 0.25;
/// Greatest fraction of the time that sampling may take.
const SHARE: f64 = 0.05;
/// Time of a sample, in s, above which no more samples are taken automatically.
const LONGEST: f64 = 0.2;
/// Number of objects above which no samples are taken automatically.
const LARGE: usize = 100_000;
/// Time between two measurements of the phases, in s.
const PHASES_INTERVAL: f64 = 0.5;
/// Number of samples that are kept.
const KEPT: usize = 600;

/// The energies at one time.
#[derive(Clone, Copy, Debug)]
pub struct EnergySample {
    /// Simulated time, in s.
    pub time: f64,
    /// The energies.
    pub energy: Energy,
}

/// The sizes of the forces on the walls of all gauges at one time.
#[derive(Clone, Debug)]
pub struct GaugeSample {
    /// Simulated time, in s.
    pub time: f64,
    /// Names of the gauges, and forces in mass units/s².
    pub forces: Vec<(String, f64)>,
}

/// Wall times of the four phases of one step.
#[derive(Clone, Copy, Debug)]
pub struct PhaseSample {
    /// Simulated time, in s.
    pub time: f64,
    /// Wall times in the order of [`Phase::STEP`], in s.
    pub seconds: [f64; 4],
}

/// Name and values of the picked body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Kind and index of the body.
    pub title: String,
    /// Names of the values, and the values with their units.
    pub values: Vec<(&'static str, String)>,
}

/// The samples.
#[derive(Clone, Debug)]
pub struct Watch {
    energies: VecDeque<EnergySample>,
    gauges: VecDeque<GaugeSample>,
    phases: VecDeque<PhaseSample>,
    facts: Option<Facts>,
    /// Number of steps at the last sample. Without a further step no sample is due.
    sampled_at: Option<u64>,
    next_at: f64,
    next_phases_at: f64,
    automatic: bool,
}

impl Default for Watch {
    fn default() -> Self {
        let (energies, gauges, phases) = Default::default();
        Self { energies, gauges, phases, facts: None, sampled_at: None, next_at: 0.0, next_phases_at: 0.0, automatic: true }
    }
}

impl Watch {
    /// Returns the energies over time.
    pub fn energies(&self) -> &VecDeque<EnergySample> {
        &self.energies
    }

    /// Returns the forces on the walls of gauges over time.
    pub fn gauges(&self) -> &VecDeque<GaugeSample> {
        &self.gauges
    }

    /// Returns the times of the phases over time.
    pub fn phases(&self) -> &VecDeque<PhaseSample> {
        &self.phases
    }

    /// Returns the values of the picked body.
    pub fn facts(&self) -> Option<&Facts> {
        self.facts.as_ref()
    }

    /// Whether samples are taken automatically; false if the scene is too large for that.
    pub fn is_unasked(&self) -> bool {
        self.automatic
    }

    /// Whether a sample is due.
    pub(super) fn due(&mut self, now: f64, simulation: &Simulation) -> bool {
        let counts = simulation.scene().counts();
        self.automatic &= counts.spheres + counts.rods + counts.boxes + counts.polygons <= LARGE;
        self.automatic && now >= self.next_at && self.sampled_at != Some(simulation.report().steps)
    }

    /// Whether a measurement of the phases is due; if so, schedules the next one.
    pub(super) fn phases_due(&mut self, now: f64) -> bool {
        let due = now >= self.next_phases_at;
        if due {
            self.next_phases_at = now + PHASES_INTERVAL;
        }
        due
    }

    /// Schedules the next sample after one that took `seconds`.
    pub(super) fn note_cost(&mut self, now: f64, seconds: f64) {
        self.next_at = now + (seconds / SHARE).max(INTERVAL);
        self.automatic &= seconds <= LONGEST;
    }

    /// Removes the samples after a simulated time, in s, because the simulation went back to it.
    pub(super) fn rewind(&mut self, time: f64) {
        self.energies.retain(|sample| sample.time <= time);
        self.gauges.retain(|sample| sample.time <= time);
        self.phases.retain(|sample| sample.time <= time);
        (self.sampled_at, self.next_at) = (None, 0.0);
    }

    /// Stops automatic sampling.
    pub(super) fn disable(&mut self) {
        self.automatic = false;
    }

    pub(super) fn note_phases(&mut self, profile: &Profile, time: f64) {
        let seconds = Phase::STEP.map(|phase| profile.phase_seconds(phase));
        keep(&mut self.phases, PhaseSample { time, seconds });
    }

    /// Takes a sample. A state of a trajectory (`is_recorded`) has no springs of contacts, so gauges are not read.
    pub(super) fn sample(
        &mut self,
        simulation: &mut Simulation,
        picked: Option<Body>,
        names: &Names,
        is_recorded: bool,
    ) -> rockfall::Result<()> {
        let energy = simulation.energy()?;
        let report = simulation.report();
        if self.sampled_at != Some(report.steps) {
            keep(&mut self.energies, EnergySample { time: report.time, energy });
            if !is_recorded && !simulation.scene().gauges().is_empty() {
                let forces = gauge_forces(simulation)?;
                keep(&mut self.gauges, GaugeSample { time: report.time, forces });
            }
        }
        self.sampled_at = Some(report.steps);
        let picked = picked.filter(|body| is_there(simulation, *body));
        self.facts = picked.map(|body| facts(simulation, body, names)).transpose()?;
        Ok(())
    }
}

/// Whether a body still exists in the scene.
fn is_there(simulation: &Simulation, body: Body) -> bool {
    let scene = simulation.scene();
    match body {
        Body::Sphere(id) => scene.sphere(id).is_ok(),
        Body::Rod(id) => scene.rod(id).is_ok(),
        Body::Box(id) => scene.cuboid(id).is_ok(),
        Body::Polygon(id) => scene.polygon(id).is_ok(),
        _ => false,
    }
}

fn keep<T>(samples: &mut VecDeque<T>, sample: T) {
    samples.push_back(sample);
    if samples.len() > KEPT {
        samples.pop_front();
    }
}

fn vector(v: Vec3, unit: &str) -> String {
    format!("{:.3} {:.3} {:.3} {unit}", v.x, v.y, v.z)
}

/// Returns the name and all values of a body.
fn facts(simulation: &mut Simulation, body: Body, names: &Names) -> rockfall::Result<Facts> {
    let (title, line) = names.name(simulation.scene(), body);
    let mut values = match body {
        Body::Sphere(id) => facts_of_sphere(simulation, id)?,
        Body::Rod(id) => facts_of_rod(simulation.scene(), id)?,
        Body::Box(id) => {
            let cuboid = simulation.scene().cuboid(id)?;
            let [i, j, k] = cuboid.edges.map(|edge| vector(edge, "units"));
            vec![("corner", vector(cuboid.corner, "units")), ("edge i", i), ("edge j", j), ("edge k", k)]
        }
        Body::Polygon(id) => {
            let polygon = simulation.scene().polygon(id)?;
            vec![
                ("corner", vector(polygon.corner, "units")),
                ("edge l", vector(polygon.left, "units")),
                ("edge r", vector(polygon.right, "units")),
                ("solid towards", vector(polygon.left.cross(polygon.right).normalize(), "")),
            ]
        }
        _ => Vec::new(),
    };
    if let Body::Rod(_) | Body::Box(_) | Body::Polygon(_) = body {
        let touching = simulation.contacts()?.iter().filter(|contact| contact.a == body || contact.b == body).count();
        values.push(("contacts", touching.to_string()));
    }
    values.extend(line.map(|line| ("line of the file", line.to_string())));
    Ok(Facts { title, values })
}

fn facts_of_sphere(simulation: &mut Simulation, id: SphereId) -> rockfall::Result<Vec<(&'static str, String)>> {
    let diagnostics = simulation.diagnostics()?;
    let scene = simulation.scene();
    let index = scene.sphere_ids().position(|other| other == id).unwrap_or(usize::MAX);
    let (sphere, known) = (scene.sphere(id)?, diagnostics.get(index));
    let mut values = vec![
        ("position", vector(sphere.position, "units")),
        ("velocity", vector(sphere.velocity, "units/s")),
        ("speed", format!("{:.3} units/s", sphere.velocity.length())),
        ("spin", vector(sphere.spin(), "rad/s")),
        ("angular momentum", vector(sphere.angular_momentum, "mass units²/s")),
        ("mass", format!("{}", sphere.mass)),
        ("radius", format!("{} units", sphere.radius)),
    ];
    if let Some(known) = known {
        values.push(("net force", vector(known.net_force, "mass units/s²")));
        values.push(("contacts", known.contacts.to_string()));
        values.push(("deepest overlap", format!("{:.5} units", known.deepest_overlap)));
    }
    Ok(values)
}

fn facts_of_rod(scene: &Scene, id: RodId) -> rockfall::Result<Vec<(&'static str, String)>> {
    let rod = scene.rod(id)?;
    let ends = [scene.sphere(rod.end1)?.position, scene.sphere(rod.end2)?.position];
    let mut values = Vec::new();
    if let Some((position, velocity)) = motion(scene, Body::Rod(id)) {
        values.push(("position", vector(position, "units")));
        values.push(("velocity", vector(velocity, "units/s")));
        values.push(("speed", format!("{:.3} units/s", velocity.length())));
    }
    values.push(("from", vector(ends[0], "units")));
    values.push(("to", vector(ends[1], "units")));
    values.push(("length", format!("{:.4} units", ends[0].distance(ends[1]))));
    values.push(("fixed length", rod.length.map_or("none".to_owned(), |length| format!("{length} units"))));
    values.push(("radius", format!("{} units", rod.radius)));
    Ok(values)
}
