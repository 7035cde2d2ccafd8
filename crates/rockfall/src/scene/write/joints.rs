//! Writes joints.

use std::collections::HashMap;
use std::fmt::Write as _;

use glam::DVec3;

use super::Writer;
use crate::scene::joint::Laid;
use crate::scene::{Anchor, Joint, JointFrame, JointKind, RigidBodyId, Scene};

/// Digits after the point of numbers that are written short.
const DIGITS: f64 = 1e6;

/// Bodies of whose name there is one, by name. No other name refers to a body.
pub(super) fn names_of_bodies(scene: &Scene) -> HashMap<RigidBodyId, String> {
    if scene.joints().is_empty() {
        return HashMap::new();
    }
    let name = |id: RigidBodyId| scene.tag(id).ok().flatten().and_then(|tag| tag.name.clone());
    let mut count: HashMap<String, usize> = HashMap::new();
    scene.body_ids().filter_map(name).for_each(|name| *count.entry(name).or_default() += 1);
    let is_clear = |name: &String| name != "world" && count.get(name) == Some(&1);
    scene.body_ids().filter_map(|id| Some((id, name(id).filter(is_clear)?))).collect()
}

/// A number with few digits, as an `f32`, and in full. Adding 0 turns -0 into 0.
fn forms(number: f64) -> [f64; 3] {
    [(number * DIGITS).round() / DIGITS + 0.0, f64::from(number as f32), number]
}

fn words(vector: DVec3) -> String {
    // Digits of an f32 are enough where it is one.
    let word = |x: f64| {
        let short = (x as f32).to_string();
        if short.parse() == Ok(x) { short } else { x.to_string() }
    };
    vector.to_array().map(word).join(",")
}

/// An angle in degrees that reads back to the same angle in rad.
fn degrees(angle: f32) -> String {
    let reads_back = |degrees: &f64| (degrees.to_radians() as f32).to_bits() == angle.to_bits();
    let exact = f64::from(angle).to_degrees();
    let rounded = (0..9).map(|digits| {
        let scale = 10_f64.powi(digits);
        // Adding 0 turns -0 into 0.
        (exact * scale).round() / scale + 0.0
    });
    rounded.chain([exact]).find(reads_back).unwrap_or(exact).to_string()
}

impl Writer<'_> {
    /// Writes the joints.
    pub(super) fn joints(&mut self) {
        for joint in self.scene.joints() {
            let [a, b] = joint.anchors().map(|anchor| self.end(anchor));
            let place = self.place_of(joint);
            let _ = write!(self.text, "@joint {} {a} {b} {place}", joint.kind);
            self.drive(joint);
            for (key, strength) in [("break_force", joint.break_force), ("break_torque", joint.break_torque)] {
                if strength.is_finite() {
                    let _ = write!(self.text, " {key}={strength}");
                }
            }
            if joint.collides {
                self.text.push_str(" collide=yes");
            }
            if let Some(name) = &joint.name {
                let _ = write!(self.text, " name={name}");
            }
            self.text.push('\n');
        }
    }

    /// The sphere whose reference stands for an end of a joint; `None` for an end with a name.
    pub(super) fn sphere_of_end(&self, anchor: Anchor) -> Option<usize> {
        match anchor {
            Anchor::World => None,
            Anchor::Body(id) if self.body_names.contains_key(&id) => None,
            Anchor::Body(id) => self.scene.body(id).ok().map(|body| self.index(body.spheres()[0])),
            Anchor::Sphere(id) => Some(self.index(id)),
        }
    }

    fn end(&self, anchor: Anchor) -> String {
        match (anchor, self.sphere_of_end(anchor)) {
            (_, Some(sphere)) => self.names[sphere].to_string(),
            (Anchor::Body(id), None) => self.body_names.get(&id).cloned().unwrap_or_default(),
            _ => "world".to_owned(),
        }
    }

    /// Points and an axis of the world that read back to the same joint; if there are none, both ends in coordinates of the bodies.
    fn place_of(&self, joint: &Joint) -> String {
        let length = joint.length.map_or(String::new(), |length| format!(" length={length}"));
        if let Some(found) = self.place_in_world(joint) {
            return found;
        }
        let words = |JointFrame { place, turn: q }: JointFrame| {
            let numbers = place.to_array().into_iter().chain([q.w, q.x, q.y, q.z]);
            numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(",")
        };
        let [a, b] = joint.ends().map(|ends| ends.map(words)).unwrap_or_default();
        format!("frame_a={a} frame_b={b}{length}")
    }

    fn place_in_world(&self, joint: &Joint) -> Option<String> {
        let [(at, frame), (to, _)] = self.scene.joint_poses_of(joint, self.has_low_parts).ok()?;
        let to = if joint.kind == JointKind::Distance { to } else { at };
        let has_axis = !matches!(joint.kind, JointKind::Fixed | JointKind::Distance);
        let axis = frame * DVec3::X;
        let longest = axis / axis.abs().max_element();
        let rounded = |vector: DVec3, form: usize| DVec3::from_array(vector.to_array().map(|x| forms(x)[form]));
        let mut axes = [rounded(axis, 0), rounded(longest, 0), rounded(axis, 1), axis];
        axes[..2].sort_by_key(|axis| words(*axis).len());
        for form in 0..3 {
            let [at, to] = [at, to].map(|point| rounded(point, form));
            for axis in &axes[..if has_axis { axes.len() } else { 1 }] {
                let axis = has_axis.then_some(*axis);
                for length in [None, joint.length] {
                    let written = Joint { laid: Laid::World { at, to, axis }, length, ..joint.clone() };
                    let read = self.scene.laid_joint(written, self.has_low_parts);
                    if read.is_ok_and(|read| is_same(&read, joint)) {
                        let axis = axis.filter(|axis| *axis != DVec3::X);
                        return Some(text_of(joint.kind, [at, to], axis, length));
                    }
                }
            }
        }
        None
    }

    /// Writes what acts along the free axis.
    fn drive(&mut self, joint: &Joint) {
        let position = |number: f32| if joint.kind.turns() { degrees(number) } else { number.to_string() };
        let some = |number: f32, without: f32| (number != without).then(|| number.to_string());
        let values = [
            (
                if joint.kind == JointKind::Ball { "twist" } else { "limits" },
                joint.limits.map(|ends| ends.map(position).join("..")),
            ),
            ("cone", joint.cone.map(degrees)),
            ("speed", joint.speed.map(|speed| speed.to_string())),
            (if joint.kind.turns() { "torque" } else { "force" }, some(joint.max_force, f32::INFINITY)),
            ("target", joint.target.filter(|_| joint.stiffness > 0.0).map(position)),
            ("stiffness", some(joint.stiffness, 0.0)),
            ("damping", some(joint.damping, 0.0)),
            ("effort", some(joint.effort, 0.0)),
            ("drag", some(joint.drag, 0.0)),
            ("armature", some(joint.armature, 0.0)),
            ("friction", some(joint.friction, 0.0)),
        ];
        for (key, value) in values {
            if let Some(value) = value {
                let _ = write!(self.text, " {key}={value}");
            }
        }
    }
}

fn text_of(kind: JointKind, [at, to]: [DVec3; 2], axis: Option<DVec3>, length: Option<f32>) -> String {
    let mut text = format!("at={}", words(at));
    if kind == JointKind::Distance {
        text += &format!(" to={}", words(to));
    }
    if let Some(axis) = axis {
        text += &format!(" axis={}", words(axis));
    }
    if let Some(length) = length {
        text += &format!(" length={length}");
    }
    text
}

/// Whether two joints have the same places, to the last bit.
fn is_same(one: &Joint, other: &Joint) -> bool {
    let bits = |joint: &Joint| {
        let ends = joint.ends().unwrap_or([JointFrame { place: glam::Vec3::NAN, turn: glam::Quat::IDENTITY }; 2]);
        let ends = ends.map(|end| (end.place.to_array().map(f32::to_bits), end.turn.to_array().map(f32::to_bits)));
        (ends, joint.length.map(f32::to_bits))
    };
    bits(one) == bits(other)
}
