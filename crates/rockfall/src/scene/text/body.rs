//! Lines about rigid bodies: `@body` ... `@end` and `@place`.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use glam::{DQuat, DVec3, Quat, Vec3};

use super::Reader;
use super::comment::without_comment;
use super::joint::Named;
use super::line::{BODY, BOX, CAPSULE, Kind, Line, MARK, PLACE, ROD, SPHERE, Wrong};
use super::motion::{number, numbers, vector};
use crate::error::{nearest, quoted};
use crate::scene::{Cuboid, MaterialId, ObjectId, Placement, Shape, ShapeId, SphereId, Tag, shared};

const BODY_KEYS: [&str; 5] = ["mass", "density", "centre", "inertia", "rounding"];
const PLACE_KEYS: [&str; 13] = [
    "at",
    "centre",
    "axis",
    "turn",
    "orientation",
    "velocity",
    "spin",
    "momentum",
    "force",
    "torque",
    "name",
    "first",
    "fixed",
];
/// Words of lines that hold for the lines below them.
const STATE: [&str; 6] = ["@group", "@use", "@name", "@colour", "@look", "@label"];
/// Share of the distance of two spheres by which the length of a rod between them may differ from it.
const LENGTH_ERROR: f32 = 1e-4;

/// Lines between `@body` and `@end`.
pub(super) struct Block {
    /// Number of the line `@body`.
    number: usize,
    shape: Shape,
    /// The number in the shape of the sphere that each reference stands for.
    references: HashMap<u32, usize>,
    /// What held for the lines above the block, and holds again below it.
    before: (u16, Option<MaterialId>, Option<Arc<Tag>>),
}

impl Reader<'_> {
    pub(super) fn begin_body(&mut self, line: &str, number: usize) -> Line<()> {
        let Some(name) = line.split_ascii_whitespace().nth(1).filter(|name| !name.contains('=')) else {
            return self.not_understood(number, BODY.wrong("NAME", format!("missing, expected {}", BODY.form())));
        };
        let shape = mass_of(Shape::new().name(name), line)?.rounding(rounding_of(line)?);
        if self.scene.find_shape(name).is_some() {
            return Err(BODY.wrong("NAME", format!("{} is the name of another body above, expected a new name", quoted(name))));
        }
        let before = (self.group, self.material, self.tag.take());
        self.body = Some(Block { number, shape, references: HashMap::new(), before });
        Ok(())
    }

    /// Reads a line of a block. `word` is its first word.
    pub(super) fn body_line(&mut self, line: &str, word: &str) -> Line<()> {
        match word {
            "S" => self.body_sphere(line),
            "R" => self.body_rod(line),
            "C" => self.body_capsule(line),
            "@capsule" => self.body_mark(line),
            "B" => self.body_box(line),
            "@hull" => self.body_hull(line),
            "@end" => self.end_body(line),
            _ => {
                let message = format!("not possible between @body and @end, expected S, R, C, B, @hull, {}", STATE.join(", "));
                Err(Wrong { field: quoted(word), message })
            }
        }
    }

    /// Whether a line is read in the same way inside a block and outside of it.
    pub(super) fn is_common(word: &str) -> bool {
        STATE.contains(&word) || !(word.starts_with('@') || ["S", "R", "C", "B", "P", "K", "T", "set"].contains(&word))
    }

    fn end_body(&mut self, line: &str) -> Line<()> {
        if let Some(more) = line.split_ascii_whitespace().nth(1) {
            let message = format!("{} is one word too many, expected `@end`", quoted(more));
            return Err(Wrong { field: "@end".to_owned(), message });
        }
        let Some(block) = self.body.take() else { return Ok(()) };
        (self.group, self.material, self.tag) = block.before;
        self.at = block.number;
        self.scene.add_shape(block.shape).map(drop).map_err(|error| BODY.refused(&error))
    }

    /// Changes the shape of the block. The part that is added next gets what holds for the present line.
    pub(super) fn change_shape(&mut self, change: impl FnOnce(Shape) -> Shape) {
        let (group, material, tag) = (self.group, self.material, self.tag.clone());
        if let Some(block) = &mut self.body {
            block.shape = change(std::mem::take(&mut block.shape).with(group, material, tag));
        }
    }

    fn body_sphere(&mut self, line: &str) -> Line<()> {
        let ([reference], n) = SPHERE.read::<1, 12>(line)?;
        still(&SPHERE, &n[3..9], &["vx", "vy", "vz", "lx", "ly", "lz"])?;
        if n[11] > 0.0 {
            return Err(SPHERE.wrong("fixed", "not possible between @body and @end, expected 0 or nothing"));
        }
        let (reference, centre) = (self.counted_on(reference), self.point(&n[0..3]));
        self.change_shape(|shape| shape.sphere(centre, n[10]));
        if let Some(block) = &mut self.body {
            block.references.insert(reference, block.shape.spheres.len() - 1);
        }
        self.check_body(&SPHERE)
    }

    fn body_rod(&mut self, line: &str) -> Line<()> {
        let (references, [radius, length]) = ROD.read::<2, 2>(line)?;
        let [a, b] = self.ends(&ROD, references)?;
        if length > 0.0 {
            let distance = self.distance(a, b);
            if (length - distance).abs() > LENGTH_ERROR * distance {
                let message = format!("{length} is not the distance {distance} of the ends, expected that or nothing");
                return Err(ROD.wrong("length", message));
            }
        }
        self.change_shape(|shape| shape.rod(a, b, radius));
        self.check_body(&ROD)
    }

    fn body_capsule(&mut self, line: &str) -> Line<()> {
        let ([], n) = CAPSULE.read::<0, 11>(line)?;
        still(&CAPSULE, &n[6..9], &["vx", "vy", "vz"])?;
        let ends = [self.point(&n[0..3]), self.point(&n[3..6])];
        self.change_shape(|shape| shape.capsule(ends[0], ends[1], n[10]));
        self.check_body(&CAPSULE)
    }

    fn body_box(&mut self, line: &str) -> Line<()> {
        let ([], n) = BOX.read::<0, 12>(line)?;
        let [i, j, k] = [3, 6, 9].map(|at| Vec3::from_slice(&n[at..at + 3]));
        let cuboid = Cuboid::new(self.point(&n[0..3]), i, j, k);
        self.change_shape(|shape| shape.cuboid(cuboid));
        self.check_body(&BOX)
    }

    /// The line `@capsule`, which has no effect here: a body is rigid without it.
    fn body_mark(&mut self, line: &str) -> Line<()> {
        let (references, []) = MARK.read::<2, 0>(line)?;
        let ends = self.ends(&MARK, references)?;
        let last = self.body.as_ref().and_then(|block| block.shape.rods.last());
        if last.is_some_and(|rod| [rod.end1, rod.end2] == ends) {
            return Ok(());
        }
        Err(MARK.wrong("end1", "expected right after the R line of these two spheres"))
    }

    /// The numbers in the shape of two spheres.
    fn ends(&self, kind: &Kind, references: [u32; 2]) -> Line<[usize; 2]> {
        let mut ends = [0; 2];
        for (place, (end, reference)) in ends.iter_mut().zip(references).enumerate() {
            let (name, reference) = (kind.references[place], self.counted_on(reference));
            let found = self.body.as_ref().and_then(|block| block.references.get(&reference));
            *end = *found.ok_or_else(|| {
                let expected = "expected one that a line between @body and this line defined";
                kind.wrong(name, format!("no sphere with reference {reference} in this body yet, {expected}"))
            })?;
        }
        if ends[0] == ends[1] {
            let message = format!("{} is the same sphere as {}, expected another one", references[1], kind.references[0]);
            return Err(kind.wrong(kind.references[1], message));
        }
        Ok(ends)
    }

    fn distance(&self, a: usize, b: usize) -> f32 {
        let centre = |sphere: usize| self.body.as_ref().map_or(Vec3::ZERO, |block| block.shape.spheres[sphere].centre);
        centre(a).distance(centre(b))
    }

    /// Checks the part of the shape that was added last, so that a wrong number has the line of the part.
    fn check_body(&self, kind: &Kind) -> Line<()> {
        let Some(block) = &self.body else { return Ok(()) };
        block.shape.validate_last().map_err(|error| {
            let Wrong { field, message } = kind.refused(&error);
            Wrong { field: field.replace("sphere.", "").replace("rod.", ""), message }
        })
    }

    /// Checks at the end of the text that the block has an end. Returns the wrong line.
    pub(super) fn check_body_end(&self) -> Result<(), (usize, Wrong)> {
        match &self.body {
            Some(block) => Err((block.number, BODY.wrong("line", "no `@end` below, expected one after the parts of the body"))),
            None => Ok(()),
        }
    }
}

/// Checks that the numbers of a part about its motion are 0.
fn still(kind: &Kind, numbers: &[f32], names: &[&str]) -> Line<()> {
    match numbers.iter().zip(names).find(|(number, _)| **number != 0.0) {
        Some((number, name)) => {
            let expected = "expected 0: a part of a body moves with the body, whose motion the line @place has";
            Err(kind.wrong(name, format!("{number} is not allowed, {expected}")))
        }
        None => Ok(()),
    }
}

/// The rounding radius of boxes that a line gives, in units.
fn rounding_of(line: &str) -> Line<f32> {
    let given = Keys::read(&BODY, &BODY_KEYS, line)?;
    given.get("rounding").map_or(Ok(0.0), |value| Ok(number(&BODY, "rounding", value)? as f32))
}

/// Gives a shape the mass that its line has.
fn mass_of(shape: Shape, line: &str) -> Line<Shape> {
    let given = Keys::read(&BODY, &BODY_KEYS, line)?;
    let single = |key: &str, value| Ok::<f32, Wrong>(number(&BODY, key, value)? as f32);
    if let Some(value) = given.get("density") {
        let other = ["mass", "centre", "inertia"].into_iter().find(|key| given.get(key).is_some());
        return match other {
            Some(key) => Err(BODY.wrong(key, "given with density, expected one of them")),
            None => Ok(shape.density(single("density", value)?)),
        };
    }
    let mass = given.get("mass").map_or(Ok(1.0), |value| single("mass", value))?;
    match (given.get("centre"), given.get("inertia")) {
        (Some(centre), Some(inertia)) => {
            let inertia = numbers::<6>(&BODY, "inertia", inertia, "six numbers xx,yy,zz,xy,xz,yz")?;
            let centre = vector(&BODY, "centre", centre)?.as_vec3();
            Ok(shape.mass_properties(mass, centre, inertia.map(|element| element as f32)))
        }
        (None, None) => Ok(shape.mass(mass)),
        (Some(_), None) => Err(BODY.wrong("centre", "given without inertia, expected both")),
        (None, Some(_)) => Err(BODY.wrong("inertia", "given without centre, expected both")),
    }
}

impl Reader<'_> {
    pub(super) fn place(&mut self, line: &str, number_of_line: usize) -> Line<()> {
        let Some(name) = line.split_ascii_whitespace().nth(1).filter(|name| !name.contains('=')) else {
            return self.not_understood(number_of_line, PLACE.wrong("NAME", format!("missing, expected {}", PLACE.form())));
        };
        let given = Keys::read(&PLACE, &PLACE_KEYS, line)?;
        let shape = self.known_shape(&PLACE, name)?;
        let placement = self.placed(Placement::new(shape), &given)?;
        let references = self.references_of(line)?;
        let mut tag = self.tag.as_deref().cloned().unwrap_or_default();
        if let Some(name) = given.get("name") {
            tag = Tag { name: Some(name.to_owned()), ..tag };
            tag.validate().map_err(|error| PLACE.wrong("name", PLACE.refused(&error).message))?;
        }
        let fixed = match given.get("fixed") {
            None | Some("0") => self.motion.is_some(),
            Some("1") => true,
            Some(other) => return Err(PLACE.wrong("fixed", format!("{} is not possible, expected 0 or 1", quoted(other)))),
        };
        let refused = |error| PLACE.refused(&error);
        if fixed {
            if let Some(key) = ["force", "torque"].into_iter().find(|key| given.get(key).is_some()) {
                return Err(PLACE.wrong(key, "given for a body that no force moves, expected none"));
            }
            let parts = self.scene.add_static_body(placement, self.motion).map_err(refused)?;
            for wall in parts.iter().filter(|id| matches!(id, ObjectId::Box(_) | ObjectId::Polygon(_))) {
                self.scene.set_surface_velocity(*wall, self.surface).map_err(refused)?;
            }
            let spheres: Vec<SphereId> =
                parts.iter().filter_map(|id| if let ObjectId::Sphere(id) = id { Some(*id) } else { None }).collect();
            self.name_spheres(&spheres, references)?;
            self.name_body(tag.name.as_deref(), Named::Fixed);
            return self.scene.tag_parts(&parts, &tag).map_err(refused);
        }
        let id = self.scene.add_body(placement).map_err(refused)?;
        let spheres = self.scene.body(id).map_err(refused)?.spheres().to_vec();
        self.name_spheres(&spheres, references)?;
        self.name_body(tag.name.as_deref(), Named::Body(id));
        self.scene.share_tag(ObjectId::from(id), &shared(tag)).map_err(refused)
    }

    /// The shape of a name, which a line of this kind has.
    pub(super) fn known_shape(&self, kind: &Kind, name: &str) -> Line<ShapeId> {
        self.scene.find_shape(name).ok_or_else(|| {
            let known: Vec<&str> = self.scene.shapes().iter().filter_map(|shape| shape.name.as_deref()).collect();
            let hint = match nearest(name, &known) {
                Some(near) => format!("did you mean {}?", quoted(near)),
                None => "expected the name of an @body line above".to_owned(),
            };
            kind.wrong(&quoted(name), format!("an unknown body, {hint}"))
        })
    }

    fn placed(&self, placement: Placement, given: &Keys) -> Line<Placement> {
        for (one, other) in [("at", "centre"), ("turn", "orientation"), ("axis", "orientation"), ("spin", "momentum")] {
            if given.get(one).is_some() && given.get(other).is_some() {
                return Err(PLACE.wrong(other, format!("given with {one}, expected one of them")));
            }
        }
        let point = |key, value| Ok::<DVec3, Wrong>(vector(&PLACE, key, value)? + self.offset());
        let mut placement = match (given.get("at"), given.get("centre")) {
            (Some(value), _) => placement.at(point("at", value)?),
            (_, Some(value)) => placement.centred_at(point("centre", value)?),
            _ => return Err(PLACE.wrong("at", format!("missing, expected {}", PLACE.form()))),
        };
        placement = match (given.get("axis"), given.get("turn")) {
            (Some(axis), Some(turn)) => {
                let axis = vector(&PLACE, "axis", axis)?;
                let unit = axis.try_normalize().ok_or_else(|| PLACE.wrong("axis", "has no direction, expected one"))?;
                let angle = number(&PLACE, "turn", turn)?.to_radians();
                placement.turned(DQuat::from_axis_angle(unit, angle).as_quat())
            }
            (Some(_), None) => return Err(PLACE.wrong("axis", "given without turn, expected both")),
            (None, Some(_)) => return Err(PLACE.wrong("turn", "given without axis, expected both")),
            (None, None) => placement,
        };
        if let Some(value) = given.get("orientation") {
            let [w, x, y, z] = numbers(&PLACE, "orientation", value, "four numbers w,x,y,z")?.map(|number| number as f32);
            placement = placement.turned(Quat::from_xyzw(x, y, z, w));
        }
        if let Some(value) = given.get("velocity") {
            placement = placement.velocity(vector(&PLACE, "velocity", value)?.as_vec3());
        }
        if let Some(value) = given.get("spin") {
            placement = placement.spin(vector(&PLACE, "spin", value)?.as_vec3());
        }
        if let Some(value) = given.get("momentum") {
            placement = placement.angular_momentum(vector(&PLACE, "momentum", value)?.as_vec3());
        }
        let load = |key| given.get(key).map_or(Ok(Vec3::ZERO), |value| Ok(vector(&PLACE, key, value)?.as_vec3()));
        placement = placement.force(load("force")?, load("torque")?);
        Ok(placement)
    }

    /// Gives the spheres of a body references that count on from `first`, if there is one.
    fn name_spheres(&mut self, spheres: &[SphereId], first: Option<u32>) -> Line<()> {
        let Some(first) = first else { return Ok(()) };
        if spheres.is_empty() {
            return Err(
                PLACE.wrong("first", "given for a body without spheres of its own: below @move they are walls, expected none")
            );
        }
        for (reference, sphere) in (first..).zip(spheres) {
            let reference = self.counted_on(reference);
            self.references.insert(reference, *sphere);
            self.scene.references.set(*sphere, reference);
        }
        Ok(())
    }

    /// The first reference that a line `@place` gives to the spheres of its body.
    fn references_of(&self, line: &str) -> Line<Option<u32>> {
        let given = Keys::read(&PLACE, &PLACE_KEYS, line)?;
        let Some(value) = given.get("first") else { return Ok(None) };
        let range = self.defined_by(line);
        let whole = || PLACE.wrong("first", format!("{} is not a whole number, or counts on too far", quoted(value)));
        Ok(Some(range.ok_or_else(whole)?.start))
    }

    /// The references that a line `@place` defines, in a text without copies.
    pub(super) fn defined_by(&self, line: &str) -> Option<Range<u32>> {
        let mut words = without_comment(line).split_ascii_whitespace();
        let name = words.nth(1)?;
        let first: u32 = words.find_map(|word| word.strip_prefix("first="))?.parse().ok()?;
        let shape = self.scene.shape(self.scene.find_shape(name)?).ok()?;
        Some(first..first.checked_add(u32::try_from(shape.sphere_count()).ok()?)?)
    }
}

/// Words KEY=VALUE of a line, after its first two words.
struct Keys<'a>(Vec<(&'static str, &'a str)>);

impl<'a> Keys<'a> {
    fn read(kind: &Kind, keys: &[&'static str], line: &'a str) -> Line<Self> {
        let mut given: Vec<(&'static str, &str)> = Vec::new();
        for word in line.split_ascii_whitespace().skip(2) {
            let Some((key, value)) = word.split_once('=') else {
                return Err(kind.wrong(&quoted(word), format!("expected KEY=VALUE with a key of {}", keys.join(", "))));
            };
            let Some(known) = keys.iter().find(|known| **known == key) else {
                let known = || format!("expected one of {}", keys.join(", "));
                let hint = nearest(key, keys).map_or_else(known, |near| format!("did you mean {near}?"));
                return Err(kind.wrong(&quoted(key), format!("an unknown key, {hint}")));
            };
            if given.iter().any(|(other, _)| other == known) {
                return Err(kind.wrong(key, "given twice in the line"));
            }
            given.push((known, value));
        }
        Ok(Self(given))
    }

    fn get(&self, key: &str) -> Option<&'a str> {
        self.0.iter().find(|(known, _)| *known == key).map(|(_, value)| *value)
    }
}

#[cfg(test)]
#[path = "body_tests.rs"]
mod tests;
