//! Writes shapes and rigid bodies.

use std::collections::HashSet;
use std::fmt::Write as _;

use glam::{DVec3, Vec3};

use super::{Writer, bits, is_turned};
use crate::fine::Fine;
use crate::scene::{RigidBody, ShapeId, ShapeMass, Tag};

/// The words of a position: as many digits as it needs.
fn words([x, y, z]: [String; 3]) -> String {
    format!("{x},{y},{z}")
}

fn vector(v: Vec3) -> String {
    words(v.to_array().map(|x| x.to_string()))
}

impl Writer<'_> {
    /// Writes the shapes, each as a block.
    pub(super) fn shapes(&mut self) {
        let scene = self.scene;
        let mut names: HashSet<String> = scene.shapes().iter().filter_map(|shape| shape.name.clone()).collect();
        let mut next = 1;
        for shape in scene.shapes() {
            let name = shape.name.clone().unwrap_or_else(|| {
                while !names.insert(format!("shape{next}")) {
                    next += 1;
                }
                format!("shape{next}")
            });
            let words = match shape.mass {
                ShapeMass::Mass(mass) => format!("mass={mass}"),
                ShapeMass::Density(density) => format!("density={density}"),
                ShapeMass::Given { mass, centre, inertia } => {
                    let inertia = inertia.map(|element| element.to_string()).join(",");
                    format!("mass={mass} centre={} inertia={inertia}", vector(centre))
                }
            };
            let rounding = shape.rounding;
            let rounded = if rounding > 0.0 { format!(" rounding={rounding}") } else { String::new() };
            let _ = writeln!(self.text, "@body {name} {words}{rounded}");
            self.shape_names.push(name);
            let (group, material) = (self.group, self.material);
            for (number, sphere) in shape.spheres.iter().enumerate() {
                self.set_group(sphere.group, sphere.material);
                self.set_tag(sphere.tag.as_ref());
                let [x, y, z] = sphere.centre.to_array();
                let _ = writeln!(self.text, "S {number} {x} {y} {z} 0 0 0 0 0 0 - {}", sphere.radius);
            }
            for rod in &shape.rods {
                self.set_group(rod.group, rod.material);
                self.set_tag(rod.tag.as_ref());
                let _ = writeln!(self.text, "R {} {} {}", rod.end1, rod.end2, rod.radius);
            }
            for part in &shape.boxes {
                self.set_group(part.cuboid.group, part.cuboid.material);
                self.set_tag(part.tag.as_ref());
                let vectors = [part.cuboid.corner].into_iter().chain(part.cuboid.edges);
                let numbers: Vec<String> = vectors.flat_map(|v| v.to_array()).map(|x| x.to_string()).collect();
                let _ = writeln!(self.text, "B {}", numbers.join(" "));
            }
            for hull in &shape.hulls {
                self.set_group(hull.group(), hull.material());
                self.set_tag(hull.tag.as_ref());
                let points: Vec<String> = hull.points().iter().map(|point| vector(*point)).collect();
                let _ = writeln!(self.text, "@hull {}", points.join(" "));
            }
            self.text.push_str("@end\n");
            (self.group, self.material, self.tag) = (group, material, Tag::default());
        }
    }

    /// Writes the body whose first sphere has an index. Returns the number of its spheres.
    pub(super) fn body_at(&mut self, at: usize, uses: &[u32]) -> Option<usize> {
        let scene = self.scene;
        let body = scene.bodies().get(self.bodies_written)?;
        if self.index(body.spheres[0]) != at {
            return None;
        }
        if let Some(rod) = body.rods.first() {
            // The rods before it join spheres before those of this body.
            self.write_rods_before(scene.rods.index(*rod).unwrap_or_default());
        }
        self.set_tag(scene.bodies.tag_at(self.bodies_written));
        self.body(body, at, uses);
        self.bodies_written += 1;
        self.rods_written += body.rods.len();
        let spheres = &scene.spheres()[at..at + body.spheres.len()];
        for (index, sphere) in (at..).zip(spheres) {
            self.force(index, sphere);
        }
        Some(spheres.len())
    }

    /// The name under which a shape was written.
    pub(super) fn name_of_shape(&self, shape: ShapeId) -> String {
        scene_name(&self.shape_names, self.scene.shapes.index(shape)).to_owned()
    }

    fn body(&mut self, body: &RigidBody, at: usize, uses: &[u32]) {
        let name = self.name_of_shape(body.shape);
        let _ = write!(self.text, "@place {name} {}", self.position(body));
        if is_turned(body.orientation) {
            let q = body.orientation;
            let _ = write!(self.text, " orientation={},{},{},{}", q.w, q.x, q.y, q.z);
        }
        let motion = [("velocity", body.velocity), ("momentum", body.angular_momentum)];
        for (key, value) in motion.into_iter().chain([("force", body.force), ("torque", body.torque)]) {
            if bits(value) != [0; 3] {
                let _ = write!(self.text, " {key}={}", vector(value));
            }
        }
        if self.has_references(body, at, uses) {
            let _ = write!(self.text, " first={}", self.names[at]);
        }
        self.text.push('\n');
    }

    /// Whether other lines of the text need the references of the spheres of a body, or the text that was read had them.
    fn has_references(&self, body: &RigidBody, at: usize, uses: &[u32]) -> bool {
        let scene = self.scene;
        let mut own = vec![0_u32; body.spheres.len()];
        let rods = body.rods.iter().filter_map(|rod| scene.rod(*rod).ok());
        for end in rods.flat_map(|rod| [rod.end1, rod.end2]) {
            own[self.index(end) - at] += 1;
        }
        let is_named = |(place, id): (usize, &_)| {
            let has_force = scene.spheres().get(at + place).is_some_and(|sphere| bits(sphere.force) != [0; 3]);
            uses[at + place] != own[place] || scene.reference(*id).is_some() || has_force
        };
        body.spheres.iter().enumerate().any(is_named)
    }

    /// Where a body lies: the place of the origin of its shape if that has the same digits as the centre of mass, otherwise the centre.
    fn position(&self, body: &RigidBody) -> String {
        let Ok(kinetics) = self.scene.shape_mass(body.shape) else { return String::new() };
        let arm = body.orientation.as_dquat().normalize() * kinetics.centre;
        let centre = if self.has_low_parts { DVec3::from_array(body.centre()) } else { body.position.as_dvec3() };
        let is_same = |words: &[String; 3]| {
            let origin = words.each_ref().map(|word| word.parse().unwrap_or(f64::NAN));
            let Fine { high, low } = Fine::at((DVec3::from_array(origin) + arm).to_array());
            bits(high) == bits(body.position) && (!self.has_low_parts || bits(low) == bits(body.position_low))
        };
        let origin = (centre - arm).to_array();
        // Adding 0 turns -0 into 0.
        let rounded = origin.map(|x| ((x * 1e6).round() / 1e6 + 0.0).to_string());
        let short = origin.map(|x| (x as f32).to_string());
        let exact = origin.map(|x| x.to_string());
        match [rounded, short, exact].into_iter().find(is_same) {
            Some(found) => format!("at={}", words(found)),
            None if self.has_low_parts => format!("centre={}", words(centre.to_array().map(|x| x.to_string()))),
            None => format!("centre={}", vector(body.position)),
        }
    }
}

fn scene_name(names: &[String], index: crate::error::Result<usize>) -> &str {
    index.ok().and_then(|index| names.get(index)).map_or("-", String::as_str)
}
