//! Writes the scene text that [`Scene::parse`] reads back: the same objects, bitwise identical, in the same order.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Quat, Vec3};

use super::periodic::AXES;
use super::text::line_of;
use super::{
    Gauge, Gauged, Joint, Material, MaterialId, MotionId, MotionTerm, Pair, RigidBodyId, Rod, RunDefaults, Scene, Sphere, Tag,
};
use crate::error::{Error, Result};
use crate::output::AtomicFile;
use crate::settings::{Precision, Settings};

impl Scene {
    /// The scene as text. Spheres keep the references of the text that they were read from ([`Scene::reference`]) if these are
    /// distinct; in other scenes, references are the indices of the spheres in order of addition. A capsule becomes a C line if that
    /// expresses it completely, otherwise two S lines, an R line and an `@capsule` line.
    ///
    /// A rigid body is written as a whole, so that changes of single spheres and rods of it are left out, except for forces.
    ///
    /// The text reads back completely otherwise, unless a setting was given a value that [`Settings::validate`] refuses, or [`Scene::run`] one
    /// that [`RunDefaults::validate`] refuses.
    pub fn to_text(&self) -> String {
        let mut writer = Writer {
            scene: self,
            text: String::with_capacity(64 * (self.spheres.len() + self.springs.len()) + 64 * self.rods.len()),
            names: self.references.distinct(self.spheres.handles()),
            group: 0,
            material: None,
            motion: None,
            surface: Vec3::ZERO,
            tag: Tag::default(),
            rods_written: 0,
            capsules_written: 0,
            bodies_written: 0,
            shape_names: Vec::new(),
            body_names: joints::names_of_bodies(self),
            has_low_parts: self.chosen_precision().precision == Precision::Double,
        };
        writer.settings();
        writer.run();
        writer.periods();
        writer.materials();
        writer.motions();
        writer.groups();
        writer.shapes();
        writer.spheres_and_rods();
        writer.springs_and_tethers();
        writer.statics();
        writer.joints();
        writer.gauges();
        writer.doors();
        writer.text
    }

    /// Returns the scene as text for a run that goes on with this state. Comments come first: the title of the scene
    /// ([`Loaded::title`](crate::Loaded::title)), and the line `origin`, which says where the state is from. With
    /// [`Settings::resting_overlap`](crate::Settings::resting_overlap), other contact constants would be chosen for the present
    /// positions, and the motion would change, so the text has those in effect instead, and a comment.
    pub fn to_text_of_state(&self, title: &[String], origin: Option<&str>) -> String {
        let comment = |line: &str| format!("# {}", line.replace(char::is_control, "?")).trim_end().to_owned() + "\n";
        let mut scene = self.clone();
        let share = std::mem::take(&mut scene.settings.resting_overlap);
        let chosen =
            (share > 0.0).then(|| format!("contact_force and contact_damping were chosen for resting_overlap {share}"));
        let title: String = title.iter().map(|line| comment(line)).collect();
        let notes: String = origin.into_iter().chain(chosen.as_deref()).map(comment).collect();
        let parts = [title, notes].into_iter().filter(|part| !part.is_empty()).map(|part| part + "\n");
        parts.collect::<String>() + &scene.to_text()
    }

    /// Writes the scene to a file. On an error, nothing is written.
    ///
    /// # Errors
    /// [`Error::Invalid`] for settings and values of [`Scene::run`] that would not read back, [`Error::File`] when the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_text(path.as_ref(), &self.to_text())
    }

    /// Writes a text of the scene, as [`Scene::to_text_of_state`] returns it, to a file. On an error, nothing is written.
    ///
    /// # Errors
    /// As for [`Scene::save`].
    pub fn save_text(&self, path: &Path, text: &str) -> Result<()> {
        self.settings.validate()?;
        self.run.validate()?;
        let write = || {
            let mut file = AtomicFile::create(path)?;
            file.write_all(text.as_bytes())?;
            file.commit()
        };
        write().map_err(|source| Error::File { file: path.to_owned(), source })
    }
}

mod bodies;
mod doors;
mod joints;

/// The bits of a vector, which also distinguish 0 from -0.
fn bits(vector: Vec3) -> [u32; 3] {
    vector.to_array().map(f32::to_bits)
}

fn is_turned(orientation: Quat) -> bool {
    orientation.to_array().map(f32::to_bits) != Quat::IDENTITY.to_array().map(f32::to_bits)
}

struct Writer<'a> {
    scene: &'a Scene,
    text: String,
    /// Reference of every sphere.
    names: Vec<u32>,
    group: u16,
    material: Option<MaterialId>,
    motion: Option<MotionId>,
    surface: Vec3,
    tag: Tag,
    /// Rods, capsules and rigid bodies are written in insertion order, so these counts show which ones are still missing.
    rods_written: usize,
    capsules_written: usize,
    bodies_written: usize,
    /// Name of every shape.
    shape_names: Vec<String>,
    /// Names that mean one body, for joints.
    body_names: HashMap<RigidBodyId, String>,
    /// Whether positions are written with their low parts.
    has_low_parts: bool,
}

impl Writer<'_> {
    /// Adds a line: its first word, the references of spheres given by their indices, its numbers.
    fn line(&mut self, word: &str, spheres: &[usize], numbers: &[f32]) {
        self.text.push_str(word);
        // Writing to a string cannot fail.
        for sphere in spheres {
            let _ = write!(self.text, " {}", self.names[*sphere]);
        }
        for number in numbers {
            let _ = write!(self.text, " {number}");
        }
        self.text.push('\n');
    }

    /// Writes the groups that have a list of those that they meet.
    fn groups(&mut self) {
        for (group, met) in self.scene.groups.lists() {
            let met: Vec<String> = met.iter().map(u16::to_string).collect();
            let list = if met.is_empty() { "none".to_owned() } else { met.join(",") };
            let _ = writeln!(self.text, "@group {group} meets={list}");
            self.group = group;
        }
    }

    /// Writes lines that set the group and the material of the following objects, if they change.
    fn set_group(&mut self, group: u16, material: Option<MaterialId>) {
        if self.group != group {
            self.group = group;
            self.line("@group", &[], &[group.into()]);
        }
        if self.material != material {
            self.material = material;
            let name = material.and_then(|id| self.scene.material(id).ok()).map_or("-", |material| &material.name);
            let _ = writeln!(self.text, "@use {name}");
        }
    }

    /// Writes lines that set the name, colour, look and label of the following objects, if they change.
    fn set_tag(&mut self, tag: Option<&Arc<Tag>>) {
        let mut tag = tag.map(|tag| Tag::clone(tag)).unwrap_or_default();
        if tag.label.is_none() && self.tag.label.as_deref() == Some("") {
            // No line says that of an object among others which have none, and pictures do not distinguish the two.
            tag.label = Some(String::new());
        }
        let before = std::mem::replace(&mut self.tag, tag);
        let Tag { name, colour, look, label } = &self.tag;
        let colours = [before.colour, *colour].map(|colour| colour.map(|colour| colour.to_string()));
        let looks = [before.look, *look].map(|look| look.map(|look| look.to_string()));
        let lines = [
            ("@name", &before.name, name),
            ("@colour", &colours[0], &colours[1]),
            ("@look", &looks[0], &looks[1]),
            ("@label", &before.label, label),
        ];
        for (word, old, new) in lines {
            if old != new {
                let value = new.as_deref().filter(|value| !value.is_empty()).unwrap_or("-");
                let _ = writeln!(self.text, "{word} {value}");
            }
        }
    }

    fn settings(&mut self) {
        let defaults = Settings::default();
        for name in Settings::NAMES {
            let value = self.scene.settings.get(name);
            let is_decided = self.scene.settings.follows_law(name);
            if let Some(value) = value.filter(|value| is_decided || defaults.get(name).as_ref() != Some(value)) {
                let _ = writeln!(self.text, "set {name} {value}");
            }
        }
    }

    fn run(&mut self) {
        let RunDefaults { dt, integrator, steps, every, substeps, speed } = self.scene.run;
        if self.scene.run == RunDefaults::default() {
            return;
        }
        self.text.push_str("@run");
        let values = [
            ("dt", dt.map(|dt| dt.to_string())),
            ("integrator", integrator.map(|integrator| integrator.to_string())),
            ("steps", steps.map(|steps| steps.to_string())),
            ("every", every.map(|every| every.to_string())),
            ("substeps", substeps.map(|parts| parts.to_string())),
            ("speed", speed.map(|speed| speed.to_string())),
        ];
        for (key, value) in values {
            if let Some(value) = value {
                let _ = write!(self.text, " {key}={value}");
            }
        }
        self.text.push('\n');
    }

    fn materials(&mut self) {
        for material in self.scene.materials() {
            let mut copy = material.clone();
            let _ = write!(self.text, "@material {}", material.name);
            self.constants(&Material::KEYS, |key| copy.constant(key).copied().flatten());
        }
        let name = |index: &u16| &self.scene.materials()[usize::from(*index)].name;
        for ((one, other), pair) in &self.scene.pairs {
            let mut copy = *pair;
            let _ = write!(self.text, "@pair {} {}", name(one), name(other));
            if let Some(model) = pair.rolling_model {
                let _ = write!(self.text, " {}={model}", Pair::MODEL);
            }
            if let Some(model) = pair.cohesion {
                let _ = write!(self.text, " {}={model}", Pair::COHESION);
            }
            self.constants(&Pair::KEYS, |key| copy.property(key).copied().flatten());
        }
    }

    fn periods(&mut self) {
        for (axis, bounds) in self.scene.periodic().into_iter().enumerate() {
            let Some([from, to]) = bounds else { continue };
            let _ = write!(self.text, "@periodic {} {from} {to}", AXES[axis]);
            if let Some(shear) = self.scene.shear().filter(|shear| shear.gradient == axis) {
                let _ = write!(self.text, " shear={},{},{}", shear.rate, AXES[shear.flow], shear.turns());
            }
            self.text.push('\n');
        }
    }

    fn motions(&mut self) {
        for motion in self.scene.motions() {
            for term in &motion.terms {
                let _ = writeln!(self.text, "@motion {}{}", motion.name, values(term));
            }
            if let Some(servo) = motion.servo {
                let _ = writeln!(self.text, "@servo {}{}", motion.name, servo.words());
            }
        }
    }

    /// Writes a line that sets the motion of the following boxes and polygons, if it changes.
    fn set_motion(&mut self, motion: Option<MotionId>) {
        if self.motion != motion {
            self.motion = motion;
            let name = motion.and_then(|id| self.scene.motion(id).ok()).map_or("-", |motion| &motion.name);
            let _ = writeln!(self.text, "@move {name}");
        }
    }

    /// Writes a line that sets the surface velocity of the following boxes and polygons, if it changes.
    fn set_surface(&mut self, velocity: Vec3) {
        if self.surface != velocity {
            self.surface = velocity;
            let Vec3 { x, y, z } = velocity;
            let value = if velocity == Vec3::ZERO { "-".to_owned() } else { format!("velocity={x},{y},{z}") };
            let _ = writeln!(self.text, "@surface {value}");
        }
    }

    /// Ends a line with the constants that are known.
    fn constants(&mut self, keys: &[&str], mut value: impl FnMut(&str) -> Option<f32>) {
        for key in keys {
            if let Some(value) = value(key) {
                let _ = write!(self.text, " {key}={value}");
            }
        }
        self.text.push('\n');
    }

    /// Insertion index of a sphere of the scene.
    fn index(&self, id: super::SphereId) -> usize {
        self.scene.spheres.index(id).unwrap_or(usize::MAX)
    }

    fn spheres_and_rods(&mut self) {
        let uses = self.uses();
        let capsules = self.plain_capsules(&uses);
        let spheres = self.scene.spheres();
        let mut at = 0;
        while at < spheres.len() {
            if let Some(count) = self.body_at(at, &uses) {
                at += count;
                continue;
            }
            match capsules[at] {
                // A C line also adds a rod, so the rods before that one must be written first, after their spheres.
                Some(rod) if self.rods_before(rod, at) => {
                    self.write_rods_before(rod);
                    self.capsule(&spheres[at], &spheres[at + 1]);
                    at += 2;
                }
                _ => {
                    self.sphere(at, &spheres[at]);
                    at += 1;
                }
            }
        }
        self.write_rods_before(self.scene.rods.len());
    }

    /// Whether the unwritten rods before `rod` join only spheres before `sphere`.
    fn rods_before(&self, rod: usize, sphere: usize) -> bool {
        let ends_before = |rod: &Rod| self.index(rod.end1) < sphere && self.index(rod.end2) < sphere;
        let between = self.scene.rods().get(self.rods_written..rod);
        between.is_some_and(|rods| rods.iter().all(ends_before))
    }

    /// For each sphere, the number of rods, springs, tethers and joints that are attached to it by its reference.
    fn uses(&self) -> Vec<u32> {
        let scene = self.scene;
        let mut uses = vec![0_u32; scene.spheres.len()];
        let rods = scene.rods().iter().flat_map(|rod| [rod.end1, rod.end2]);
        let springs = scene.springs().iter().flat_map(|spring| [spring.a, spring.b]);
        let tethers = scene.tethers().iter().map(|tether| tether.sphere);
        for id in rods.chain(springs).chain(tethers) {
            uses[self.index(id)] += 1;
        }
        for sphere in scene.joints().iter().flat_map(Joint::anchors).filter_map(|anchor| self.sphere_of_end(anchor)) {
            uses[sphere] += 1;
        }
        uses
    }

    /// For each sphere that is end 1 of a capsule that a C line can express, the index of the capsule's rod.
    fn plain_capsules(&self, uses: &[u32]) -> Vec<Option<usize>> {
        let scene = self.scene;
        // The spheres of a C line have no references, so nothing else can be attached to them.
        let mut plain = vec![None; scene.spheres.len()];
        for (index, parts) in scene.capsules().iter().enumerate() {
            let (one, two) = (self.index(parts.end1), self.index(parts.end2));
            let Ok(rod) = scene.rods.index(parts.rod) else { continue };
            let alone = two == one + 1 && uses[one] == 1 && uses[two] == 1;
            let tag = scene.capsules.tag_at(index);
            let has_one_tag = [one, two].iter().all(|end| scene.spheres.tag_at(*end) == tag) && scene.rods.tag_at(rod) == tag;
            if alone && has_one_tag && is_plain(&scene.spheres()[one], &scene.spheres()[two], &scene.rods()[rod]) {
                plain[one] = Some(rod);
            }
        }
        plain
    }

    fn capsule(&mut self, first: &Sphere, second: &Sphere) {
        self.set_group(first.group, first.material);
        self.set_tag(self.scene.capsules.tag_at(self.capsules_written));
        let [a, b, v] = [first.position, second.position, first.velocity];
        let mass = first.mass * 2.0;
        self.line("C", &[], &[a.x, a.y, a.z, b.x, b.y, b.z, v.x, v.y, v.z, mass, first.radius]);
        self.rods_written += 1;
        self.capsules_written += 1;
    }

    fn sphere(&mut self, index: usize, sphere: &Sphere) {
        self.set_group(sphere.group, sphere.material);
        self.set_tag(self.scene.spheres.tag_at(index));
        let [p, v, l] = [sphere.position, sphere.velocity, sphere.angular_momentum];
        let fixed = if sphere.fixed { 1.0 } else { 0.0 };
        let rest = [v.x, v.y, v.z, l.x, l.y, l.z, sphere.mass, sphere.radius, fixed];
        if self.has_low_parts {
            let [x, y, z] = sphere.centre();
            let name = self.names[index];
            let _ = write!(self.text, "S {name} {x} {y} {z}");
            self.line("", &[], &rest);
        } else {
            let numbers: Vec<f32> = p.to_array().into_iter().chain(rest).collect();
            self.line("S", &[index], &numbers);
        }
        if is_turned(sphere.orientation) {
            let q = sphere.orientation;
            self.line("@orientation", &[index], &[q.w, q.x, q.y, q.z]);
        }
        self.force(index, sphere);
    }

    fn force(&mut self, index: usize, sphere: &Sphere) {
        if bits(sphere.force) != [0; 3] {
            self.line("@force", &[index], &sphere.force.to_array());
        }
    }

    /// Writes the unwritten rods before `end`, and marks those of capsules.
    fn write_rods_before(&mut self, end: usize) {
        let scene = self.scene;
        while self.rods_written < end {
            let rod = &scene.rods()[self.rods_written];
            let ends = [self.index(rod.end1), self.index(rod.end2)];
            self.set_group(rod.group, rod.material);
            self.set_tag(scene.rods.tag_at(self.rods_written));
            match rod.length {
                Some(length) => self.line("R", &ends, &[rod.radius, length]),
                None => self.line("R", &ends, &[rod.radius]),
            }
            let capsule = scene.capsules().get(self.capsules_written);
            if capsule.is_some_and(|parts| scene.rods.index(parts.rod).is_ok_and(|rod| rod == self.rods_written)) {
                self.set_tag(scene.capsules.tag_at(self.capsules_written));
                self.line("@capsule", &ends, &[]);
                self.capsules_written += 1;
            }
            self.rods_written += 1;
        }
    }

    fn springs_and_tethers(&mut self) {
        for (index, spring) in self.scene.springs().iter().enumerate() {
            self.set_tag(self.scene.springs.tag_at(index));
            let ends = [self.index(spring.a), self.index(spring.b)];
            self.line("K", &ends, &[spring.stiffness, spring.length, spring.damping]);
            if let Some(muscle) = spring.muscle {
                self.line("@muscle", &[], &[muscle.amplitude, muscle.frequency, muscle.phase]);
            }
        }
        for tether in self.scene.tethers() {
            let [x, y, z] = tether.point.to_array();
            let numbers = [x, y, z, tether.stiffness, tether.length, tether.damping];
            self.line("T", &[self.index(tether.sphere)], &numbers);
        }
    }

    fn statics(&mut self) {
        for (index, cuboid) in self.scene.boxes().iter().enumerate() {
            self.set_group(cuboid.group, cuboid.material);
            self.set_tag(self.scene.boxes.tag_at(index));
            self.set_motion(cuboid.motion);
            self.set_surface(cuboid.surface_velocity);
            let [i, j, k] = cuboid.edges;
            self.vectors("B", &[cuboid.corner, i, j, k]);
        }
        for (index, polygon) in self.scene.polygons().iter().enumerate() {
            self.set_group(polygon.group, polygon.material);
            self.set_tag(self.scene.polygons.tag_at(index));
            self.set_motion(polygon.motion);
            self.set_surface(polygon.surface_velocity);
            if let Some(line) = line_of(polygon) {
                let _ = writeln!(self.text, "{line}");
                continue;
            }
            let word = if polygon.is_triangle() { "@triangle" } else { "P" };
            self.vectors(word, &[polygon.corner, polygon.left, polygon.right]);
        }
    }

    fn gauges(&mut self) {
        for Gauge { name, of } in self.scene.gauges() {
            let of = match of {
                Gauged::Wall(wall) => format!("wall={wall}"),
                Gauged::Plane { point: DVec3 { x, y, z }, normal } => {
                    format!("plane={x},{y},{z},{},{},{}", normal.x, normal.y, normal.z)
                }
            };
            let _ = writeln!(self.text, "@gauge name={name} {of}");
        }
    }

    fn vectors(&mut self, word: &str, vectors: &[Vec3]) {
        let numbers: Vec<f32> = vectors.iter().flat_map(|vector| vector.to_array()).collect();
        self.line(word, &[], &numbers);
    }
}

/// The values of a term that are not those of a new one. At least one is written.
fn values(term: &MotionTerm) -> String {
    let MotionTerm { velocity, amplitude, frequency, phase, spin, axis, through, from, to } = *term;
    let vector = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    let oscillates = amplitude != DVec3::ZERO || frequency != 0.0 || phase != 0.0;
    let plain = MotionTerm::default();
    let turns = spin != 0.0 || axis != plain.axis || through != plain.through;
    let all = [
        (velocity != DVec3::ZERO || !(oscillates || turns), "velocity", vector(velocity)),
        (turns, "spin", spin.to_string()),
        (turns, "axis", vector(axis)),
        (turns, "through", vector(through)),
        (oscillates, "amplitude", vector(amplitude)),
        (oscillates, "frequency", frequency.to_string()),
        (oscillates, "phase", phase.to_string()),
        (from != 0.0, "from", from.to_string()),
        (to.is_finite(), "to", to.to_string()),
    ];
    all.iter()
        .filter(|(is_written, ..)| *is_written)
        .fold(String::new(), |line, (_, key, value)| line + &format!(" {key}={value}"))
}

/// Whether a C line expresses a capsule of these parts completely.
fn is_plain(first: &Sphere, second: &Sphere, rod: &Rod) -> bool {
    let at_rest = |sphere: &Sphere| {
        let still = bits(sphere.angular_momentum) == [0; 3] && bits(sphere.force) == [0; 3];
        still && !is_turned(sphere.orientation) && !sphere.fixed
    };
    let numbers = |sphere: &Sphere| (sphere.mass, sphere.radius, bits(sphere.velocity), sphere.group, sphere.material);
    at_rest(first)
        && at_rest(second)
        && numbers(first) == numbers(second)
        && (rod.radius, rod.group, rod.material) == (first.radius, first.group, first.material)
        && rod.length == Some(first.position.distance(second.position))
}

#[cfg(test)]
#[path = "write_tests.rs"]
mod tests;
