//! The line `@joint`.

use glam::{DVec3, Quat, Vec3};

use super::Reader;
use super::line::{JOINT, Line, Wrong};
use super::motion::{number, numbers};
use super::values::Values;
use crate::error::{Error, nearest, quoted};
use crate::scene::{Anchor, Joint, JointFrame, JointKind, RigidBodyId, name_is_taken};

const KEYS: [&str; 23] = [
    "at",
    "to",
    "axis",
    "limits",
    "cone",
    "twist",
    "speed",
    "force",
    "torque",
    "target",
    "stiffness",
    "damping",
    "effort",
    "drag",
    "armature",
    "friction",
    "break_force",
    "break_torque",
    "collide",
    "length",
    "name",
    "frame_a",
    "frame_b",
];
/// The word for the world as an end.
const WORLD: &str = "world";

/// What the name of a placed body stands for.
#[derive(Clone, Copy)]
pub(super) enum Named {
    Body(RigidBodyId),
    /// A body with `fixed=1`.
    Fixed,
    /// Several bodies have the name.
    Several,
}

impl Reader<'_> {
    /// Remembers the name of a placed body, if it has one. In copies, their numbers are added.
    pub(super) fn name_body(&mut self, name: Option<&str>, body: Named) {
        if let Some(name) = name {
            let known = self.body_names.entry(name.to_owned() + &self.suffix());
            known.and_modify(|named| *named = Named::Several).or_insert(body);
            self.name_in_copy(name, body);
        }
    }

    pub(super) fn joint(&mut self, line: &str, at: usize) -> Line<()> {
        let words: Vec<&str> = line.split_ascii_whitespace().skip(1).collect();
        let [kind, a, b, ..] = words[..] else {
            return self.not_understood(at, JOINT.wrong("line", format!("too short, expected {}", JOINT.form())));
        };
        let Ok(kind) = kind.parse::<JointKind>() else {
            let names = JointKind::ALL.map(|kind| kind.to_string());
            let names = names.each_ref().map(String::as_str);
            let known = || format!("expected one of {}", names.join(", "));
            let hint = nearest(kind, &names).map_or_else(known, |near| format!("did you mean {near}?"));
            return self.not_understood(at, JOINT.wrong(&quoted(kind), format!("an unknown kind, {hint}")));
        };
        let ends = [self.joint_end("A", a)?, self.joint_end("B", b)?];
        let values = Values::read(&JOINT, &KEYS, words[3..].iter().copied())?;
        let mut joint = self.laid(&values, kind, ends)?;
        drive(&values, &mut joint)?;
        joint.collides = match values.of("collide") {
            None | Some("no") => false,
            Some("yes") => true,
            Some(other) => return Err(JOINT.wrong("collide", format!("{} is not possible, expected yes or no", quoted(other)))),
        };
        joint.name = values.of("name").map(|name| name.to_owned() + &self.suffix());
        self.check_joint(&joint).map_err(|error| refused(&values, &error))?;
        if let Some(name) = joint.name.clone()
            && !self.joint_names.insert(name.clone())
        {
            if self.suffix().is_empty() {
                return Err(refused(&values, &name_is_taken(&name)));
            }
            let expected = "expected another name: copies of another @repeat, or another line, have it";
            return Err(JOINT.wrong("name", format!("a joint has the name {} already, {expected}", quoted(&name))));
        }
        self.joints.push((self.at, joint));
        Ok(())
    }

    fn check_joint(&self, joint: &Joint) -> crate::Result<()> {
        joint.validate()?;
        joint.check_idle()?;
        self.scene.check_joint_ends(joint)?;
        // The positions are not rounded yet.
        self.scene.laid_joint(joint.clone(), true).map(drop)
    }

    /// Adds the joints when the bodies have their positions. Returns the wrong line.
    pub(super) fn add_joints(&mut self) -> Result<(), (usize, Wrong)> {
        for (line, joint) in std::mem::take(&mut self.joints) {
            let laid = self.scene.laid_joint(joint, true);
            laid.and_then(|joint| self.scene.keep_joint(joint)).map_err(|error| (line, JOINT.refused(&error)))?;
        }
        Ok(())
    }

    /// What is added to names in the copies that the present line is part of.
    fn suffix(&self) -> String {
        self.numbers_of_copies().map(|number| format!(".{number}")).collect()
    }

    fn joint_end(&self, which: &str, word: &str) -> Line<Anchor> {
        if word == WORLD {
            return Ok(Anchor::World);
        }
        if word.contains('=') {
            return Err(JOINT.wrong(which, format!("missing before {}, expected {}", quoted(word), JOINT.form())));
        }
        if word.starts_with(|first: char| first.is_ascii_digit()) {
            let not_whole = |_| JOINT.wrong(which, format!("{} is not a whole number from 0 to {}", quoted(word), u32::MAX));
            let sphere = self.find(&JOINT, which, word.parse().map_err(not_whole)?)?;
            return Ok(self.scene.whole_end(Anchor::Sphere(sphere)));
        }
        let wrong = |message: String| Err(JOINT.wrong(which, message));
        match self.named(word) {
            Some(Named::Body(id)) => Ok(Anchor::Body(id)),
            Some(Named::Fixed) => {
                wrong(format!("{} is a body with fixed=1, expected a body that moves, or world", quoted(word)))
            }
            Some(Named::Several) => {
                wrong(format!("several bodies have the name {}, expected a name of one body", quoted(word)))
            }
            None => {
                let known: Vec<&str> = self.body_names.keys().map(String::as_str).chain([WORLD]).collect();
                let hint = match nearest(word, &known) {
                    Some(near) => format!("did you mean {}?", quoted(near)),
                    None => "expected the name of a body that an @place line above places, the reference of a sphere, or world"
                        .to_owned(),
                };
                wrong(format!("no body with the name {} yet, {hint}", quoted(word)))
            }
        }
    }

    /// The body that a name stands for in the present line: one of the same copy, otherwise one of those around it. Copies of another
    /// block may have the same names.
    fn named(&self, word: &str) -> Option<Named> {
        if let Some(named) = self.named_in_copy(word) {
            return Some(named);
        }
        let suffix = self.suffix();
        let ends = suffix.match_indices('.').map(|(at, _)| at).chain([suffix.len()]).rev();
        ends.map(|end| word.to_owned() + &suffix[..end]).find_map(|name| self.body_names.get(&name).copied())
    }

    /// The joint with its place.
    fn laid(&self, values: &Values, kind: JointKind, [a, b]: [Anchor; 2]) -> Line<Joint> {
        let framed = [values.of("frame_a"), values.of("frame_b")];
        if framed.iter().any(Option::is_some) {
            let [Some(one), Some(other)] = framed else {
                let [missing, given] = if framed[0].is_none() { ["frame_a", "frame_b"] } else { ["frame_b", "frame_a"] };
                return Err(JOINT.wrong(missing, format!("missing, expected it with {given}")));
            };
            if let Some(key) = ["at", "to", "axis"].into_iter().find(|key| values.of(key).is_some()) {
                return Err(JOINT.wrong(key, "given with frame_a and frame_b, expected one of the two"));
            }
            let ends = [self.frame("frame_a", one, a)?, self.frame("frame_b", other, b)?];
            return Ok(of_kind(kind, a, b, [DVec3::ZERO; 2]).frames(ends));
        }
        let point = |key: &str| Ok::<_, Wrong>(values.vector(key)?.map(|point| point + self.offset()));
        let at = values.needed("at", point("at")?)?;
        let to = match (kind, point("to")?) {
            (JointKind::Distance, to) => values.needed("to", to)?,
            (_, Some(_)) => {
                return Err(JOINT.wrong("to", format!("not possible for the kind {kind}, expected it for distance only")));
            }
            (_, None) => at,
        };
        let joint = of_kind(kind, a, b, [at, to]);
        Ok(match values.vector("axis")? {
            Some(axis) => joint.axis(axis),
            None => joint,
        })
    }

    fn frame(&self, key: &str, value: &str, anchor: Anchor) -> Line<JointFrame> {
        let [x, y, z, turn @ ..] = numbers::<7>(&JOINT, key, value, "seven numbers x,y,z,w,i,j,k")?;
        let offset = if self.scene.is_still(anchor) { self.offset() } else { DVec3::ZERO };
        let [w, i, j, k] = turn.map(|element| element as f32);
        let frame = JointFrame { place: (DVec3::new(x, y, z) + offset).as_vec3(), turn: Quat::from_xyzw(i, j, k, w) };
        let place = Vec3::new(x as f32, y as f32, z as f32);
        // Adding 0 would turn -0 into 0.
        Ok(if offset == DVec3::ZERO { JointFrame { place, ..frame } } else { frame })
    }
}

fn of_kind(kind: JointKind, a: Anchor, b: Anchor, [at, to]: [DVec3; 2]) -> Joint {
    match kind {
        JointKind::Ball => Joint::ball(a, b, at),
        JointKind::Hinge => Joint { kind, ..Joint::ball(a, b, at) },
        JointKind::Slider => Joint { kind, ..Joint::ball(a, b, at) },
        JointKind::Fixed => Joint::fixed(a, b, at),
        JointKind::Distance => Joint::distance(a, b, at, to),
    }
}

/// Reads what acts along the free axis.
fn drive(values: &Values, joint: &mut Joint) -> Line<()> {
    let kind = joint.kind;
    let in_files = |number: f64| if kind.turns() { number.to_radians() as f32 } else { number as f32 };
    let plain = |key: &str| Ok::<_, Wrong>(values.number(key)?.map(|number| number as f32));
    let [range, other] = if kind == JointKind::Ball { ["twist", "limits"] } else { ["limits", "twist"] };
    if values.of(other).is_some() {
        let expected = if kind == JointKind::Fixed { "nothing" } else { range };
        return Err(JOINT.wrong(other, format!("not possible for the kind {kind}, expected {expected}")));
    }
    joint.limits = values.of(range).map(|value| Ok::<_, Wrong>(limits(range, value)?.map(in_files))).transpose()?;
    joint.cone = values.number("cone")?.map(|angle| angle.to_radians() as f32);
    joint.speed = plain("speed")?;
    joint.target = values.number("target")?.map(in_files);
    joint.stiffness = plain("stiffness")?.unwrap_or(joint.stiffness);
    joint.damping = plain("damping")?.unwrap_or(joint.damping);
    joint.effort = plain("effort")?.unwrap_or(joint.effort);
    joint.drag = plain("drag")?.unwrap_or(joint.drag);
    joint.armature = plain("armature")?.unwrap_or(joint.armature);
    joint.friction = plain("friction")?.unwrap_or(joint.friction);
    joint.break_force = plain("break_force")?.unwrap_or(joint.break_force);
    joint.break_torque = plain("break_torque")?.unwrap_or(joint.break_torque);
    joint.length = plain("length")?;
    let [key, other] = if kind.turns() { ["torque", "force"] } else { ["force", "torque"] };
    if values.of(other).is_some() {
        let expected = if kind == JointKind::Fixed { "nothing" } else { key };
        return Err(JOINT.wrong(other, format!("not possible for the kind {kind}, expected {expected}")));
    }
    joint.max_force = plain(key)?.unwrap_or(joint.max_force);
    Ok(())
}

/// A range `a..b`.
fn limits(key: &str, value: &str) -> Line<[f64; 2]> {
    let Some((least, greatest)) = value.split_once("..") else {
        return Err(JOINT.wrong(key, format!("{} is not allowed, expected a range a..b", quoted(value))));
    };
    Ok([number(&JOINT, key, least)?, number(&JOINT, key, greatest)?])
}

/// The library's error about a joint with the words of the line, whose angles have other units.
fn refused(values: &Values, error: &Error) -> Wrong {
    if let Error::Invalid { field, expected, .. } = error {
        let key = match field.trim_start_matches("joint.") {
            "limits" if values.of("twist").is_some() => "twist",
            "max_force" if values.of("torque").is_some() => "torque",
            "max_force" => "force",
            key => key,
        };
        if let Some(value) = values.of(key) {
            return JOINT.wrong(key, format!("{} is not allowed, expected {expected}", quoted(value)));
        }
    }
    JOINT.refused(error)
}

#[cfg(test)]
#[path = "joint_tests.rs"]
mod tests;
