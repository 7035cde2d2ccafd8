//! Values that are sampled at intervals: energies, times of the phases, and the values of the picked body.
//!
//! Energies and contacts are evaluated on the host, which takes long in large scenes. The more a sample costs, the less often
//! it is taken. In the largest scenes samples are taken only on request.

use std::collections::VecDeque;

use rockfall::glam::Vec3;
use rockfall::step::schedule::Phase;
use rockfall::{Body, Energy, JointReading, Polygon, Profile, RodId, Scene, Simulation, SphereId, Surface};

use super::names::Names;
use crate::draw::net_force;
use crate::plot::{Graph, gauge_forces};
use crate::whole::{mass, motion, rigid_of, size, spheres};

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

/// The values of all lines of the plots of joints at one time.
#[derive(Clone, Debug)]
pub struct PlottedSample {
    /// Simulated time, in s.
    pub time: f64,
    /// The values, in the order of the plots and of their lines.
    pub values: Vec<f64>,
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
    /// What the joints do, in order of addition.
    joints: Vec<JointReading>,
    /// Plots of joints.
    graphs: Vec<Graph>,
    plotted: VecDeque<PlottedSample>,
    facts: Option<Facts>,
    /// Number of steps at the last sample. Without a further step no sample is due.
    sampled_at: Option<u64>,
    /// Whether constants have changed since the last sample, and with them forces.
    is_outdated: bool,
    next_at: f64,
    next_phases_at: f64,
    automatic: bool,
}

impl Default for Watch {
    fn default() -> Self {
        let (energies, gauges, phases) = Default::default();
        Self {
            energies,
            gauges,
            phases,
            joints: Vec::new(),
            graphs: Vec::new(),
            plotted: VecDeque::new(),
            facts: None,
            sampled_at: None,
            is_outdated: false,
            next_at: 0.0,
            next_phases_at: 0.0,
            automatic: true,
        }
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

    /// Returns what the joints of the scene do, in order of addition; empty before the first sample.
    pub fn joints(&self) -> &[JointReading] {
        &self.joints
    }

    /// Returns the plots of joints.
    pub(super) fn graphs(&self) -> &[Graph] {
        &self.graphs
    }

    /// Sets the plots of joints, and forgets what the ones before have seen.
    pub(super) fn set_graphs(&mut self, graphs: Vec<Graph>) {
        self.graphs = graphs;
        self.plotted.clear();
        (self.sampled_at, self.next_at) = (None, 0.0);
    }

    /// Returns the values of the plots of joints over time.
    pub fn plotted(&self) -> &VecDeque<PlottedSample> {
        &self.plotted
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
        self.automatic && now >= self.next_at && (self.is_outdated || self.sampled_at != Some(simulation.report().steps))
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
        self.plotted.retain(|sample| sample.time <= time);
        (self.sampled_at, self.next_at) = (None, 0.0);
    }

    /// Makes the values of the picked body be read again, because constants have changed.
    pub(super) fn outdate(&mut self) {
        self.is_outdated = true;
    }

    /// Stops automatic sampling.
    pub(super) fn disable(&mut self) {
        self.automatic = false;
    }

    pub(super) fn note_phases(&mut self, profile: &Profile, time: f64) {
        let seconds = Phase::STEP.map(|phase| profile.phase_seconds(phase));
        keep(&mut self.phases, PhaseSample { time, seconds });
    }

    /// Takes a sample. A state of a trajectory (`is_recorded`) has no springs of contacts and no values of joints: they are not read.
    pub(super) fn sample(
        &mut self,
        simulation: &mut Simulation,
        picked: Option<Body>,
        names: &Names,
        is_recorded: bool,
    ) -> rockfall::Result<()> {
        let energy = simulation.energy()?;
        let report = simulation.report();
        if !is_recorded {
            self.joints = simulation.joints()?;
        }
        if self.sampled_at != Some(report.steps) {
            keep(&mut self.energies, EnergySample { time: report.time, energy });
            if !is_recorded && !simulation.scene().gauges().is_empty() {
                let forces = gauge_forces(simulation)?;
                keep(&mut self.gauges, GaugeSample { time: report.time, forces });
            }
            if !is_recorded && !self.graphs.is_empty() {
                let values: rockfall::Result<Vec<_>> = self.graphs.iter_mut().map(|graph| graph.values(simulation)).collect();
                keep(&mut self.plotted, PlottedSample { time: report.time, values: values?.concat() });
            }
        }
        (self.sampled_at, self.is_outdated) = (Some(report.steps), false);
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
        _ if rigid_of(simulation.scene(), body).is_some() => facts_of_rigid(simulation, body)?,
        Body::Sphere(id) => facts_of_sphere(simulation, id)?,
        Body::Rod(id) => facts_of_rod(simulation, id)?,
        Body::Box(id) => {
            let cuboid = simulation.scene().cuboid(id)?;
            let [i, j, k] = cuboid.edges.map(|edge| vector(edge, "units"));
            vec![("corner", vector(cuboid.corner, "units")), ("edge i", i), ("edge j", j), ("edge k", k)]
        }
        Body::Polygon(id) => facts_of_polygon(simulation.scene().polygon(id)?),
        _ => Vec::new(),
    };
    if let Body::Rod(_) | Body::Box(_) | Body::Polygon(_) = body {
        let touching = simulation.contacts()?.iter().filter(|contact| contact.a == body || contact.b == body).count();
        values.push(("contacts", touching.to_string()));
    }
    values.extend(line.map(|line| ("line of the file", line.to_string())));
    Ok(Facts { title, values })
}

fn facts_of_polygon(polygon: &Polygon) -> Vec<(&'static str, String)> {
    let side = if polygon.surface.is_inside() { "inside" } else { "outside" };
    let normal = || vector(polygon.left.cross(polygon.right).normalize(), "");
    let corner = ("corner", vector(polygon.corner, "units"));
    match (polygon.surface, polygon.cone_axis()) {
        (_, Some(axis)) => {
            let [start, end] = axis.radii;
            let radii = format!("{start:.3} {end:.3} units");
            vec![corner, ("axis", vector(axis.along.as_vec3(), "units")), ("radii", radii), ("touched from", side.to_owned())]
        }
        (Surface::Ball { .. }, None) => {
            let radius = format!("{:.3} units", polygon.left.length());
            vec![("centre", corner.1), ("radius", radius), ("touched from", side.to_owned())]
        }
        (Surface::Plane, None) => vec![("point", corner.1), ("solid towards", normal())],
        (_, None) => {
            let [left, right] = [polygon.left, polygon.right].map(|edge| vector(edge, "units"));
            vec![corner, ("edge l", left), ("edge r", right), ("solid towards", normal())]
        }
    }
}

fn facts_of_sphere(simulation: &mut Simulation, id: SphereId) -> rockfall::Result<Vec<(&'static str, String)>> {
    let diagnostics = net_force::diagnostics(simulation)?;
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

/// Position and velocity of the centre of mass.
fn facts_of_motion(scene: &Scene, body: Body) -> Vec<(&'static str, String)> {
    motion(scene, body).map_or_else(Vec::new, |(position, velocity)| {
        vec![
            ("position", vector(position, "units")),
            ("velocity", vector(velocity, "units/s")),
            ("speed", format!("{:.3} units/s", velocity.length())),
        ]
    })
}

/// The mass of a body of several spheres, and the net force on it.
fn facts_of_force(simulation: &mut Simulation, body: Body) -> rockfall::Result<Vec<(&'static str, String)>> {
    let known = net_force::diagnostics(simulation)?;
    let scene = simulation.scene();
    let force = |id: SphereId| Some(known.get(Body::Sphere(id).index(scene).ok()?)?.net_force);
    let force: Vec3 = spheres(scene, body).filter_map(force).sum();
    Ok(vec![("mass", format!("{}", mass(scene, body) as f32)), ("net force", vector(force, "mass units/s²"))])
}

fn facts_of_rigid(simulation: &mut Simulation, body: Body) -> rockfall::Result<Vec<(&'static str, String)>> {
    let contacts = simulation.contacts()?;
    let scene = simulation.scene();
    let mut values = facts_of_motion(scene, body);
    let Some(rigid) = rigid_of(scene, body) else { return Ok(values) };
    let own = |other: Body| rigid_of(scene, other) == Some(rigid);
    let touching = contacts.iter().filter(|contact| own(contact.a) != own(contact.b));
    let (count, overlap) = touching.fold((0, 0.0_f32), |(count, most), contact| (count + 1, most.max(contact.overlap)));
    values.push(("spin", vector(scene.body_spin(rigid)?, "rad/s")));
    values.push(("angular momentum", vector(scene.body(rigid)?.angular_momentum, "mass units²/s")));
    values.extend(size(scene, rigid).map(|size| ("size", vector(size, "units"))));
    values.extend(facts_of_force(simulation, body)?);
    values.push(("contacts", count.to_string()));
    values.push(("deepest overlap", format!("{overlap:.5} units")));
    Ok(values)
}

fn facts_of_rod(simulation: &mut Simulation, id: RodId) -> rockfall::Result<Vec<(&'static str, String)>> {
    let scene = simulation.scene();
    let rod = scene.rod(id)?;
    let ends = [scene.sphere(rod.end1)?.position, scene.sphere(rod.end2)?.position];
    let mut values = facts_of_motion(scene, Body::Rod(id));
    values.push(("from", vector(ends[0], "units")));
    values.push(("to", vector(ends[1], "units")));
    values.push(("length", format!("{:.4} units", ends[0].distance(ends[1]))));
    values.push(("fixed length", rod.length.map_or("none".to_owned(), |length| format!("{length} units"))));
    values.push(("radius", format!("{} units", rod.radius)));
    if scene.capsules().iter().any(|parts| parts.rod == id) {
        values.extend(facts_of_force(simulation, Body::Rod(id))?);
    }
    Ok(values)
}
