//! Reads the scene text: the format of the thesis (section 2.11) and its extensions.
//!
//! | line | adds |
//! |---|---|
//! | `S ref x y z vx vy vz lx ly lz mass radius [fixed]` | a sphere; it is fixed if `fixed` > 0 |
//! | `R ref1 ref2 radius [length]` | a rod; its length is free if `length` <= 0 or missing |
//! | `C x1 y1 z1 x2 y2 z2 vx vy vz mass radius` | a capsule: two spheres and a rod |
//! | `P x y z` + two edges | a polygon that faces along first x second |
//! | `K ref1 ref2 k l c` | a spring |
//! | `B x y z` + three edges | a box |
//! | `T ref x y z k l c` | a tether |
//! | `set NAME VALUE` | nothing: sets a physical constant |
//! | `@group N` | nothing: the objects of the lines below belong to group N |
//! | `@orientation ref w x y z` | nothing: sets the orientation of that sphere |
//! | `@force ref x y z` | nothing: sets the external force on that sphere |
//! | `@capsule ref1 ref2` | nothing: the two spheres and the rod added last are a capsule |
//!
//! The whole first word of a line decides its kind. A line with any other first word is a comment. The last six kinds above are
//! comments to the reader of the thesis.
//!
//! So that ordinary prose can stay in a file, `set` must be followed by a known name and one value, and `T` by a number. A line
//! that only begins like an extension, such as `set the table`, `T` without a number or an unknown word with `@`, is a comment
//! with a warning.

use std::collections::HashMap;
use std::fmt;
use std::path::Path;

use glam::{Quat, Vec3};

mod line;

use line::{BOX, CAPSULE, FORCE, GROUP, Kind, Line, MARK, ORIENTATION, POLYGON, ROD, SPHERE, SPRING, TETHER, Wrong};

use super::{Capsule, CapsuleParts, Cuboid, Polygon, Rod, Scene, Sphere, SphereId, Spring, Tether};
use crate::error::{Error, Result};
use crate::settings::Settings;

/// A scene that was read, with warnings about its text.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Warnings about lines that were read as comments but look like something else.
    pub warnings: Vec<LineWarning>,
}

/// A warning about a line of a scene text. The line was accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineWarning {
    /// Line number, from 1.
    pub line: usize,
    /// The warning.
    pub text: String,
}

impl fmt::Display for LineWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.text)
    }
}

impl Scene {
    /// Reads a scene text. `name` names its source in messages.
    ///
    /// # Errors
    /// [`Error::SceneLine`] for the first wrong line, with the field and what was expected.
    pub fn parse(text: &str, name: &Path) -> Result<Loaded> {
        let mut reader = Reader { scene: Self::new(), warnings: Vec::new(), references: HashMap::new(), group: 0 };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        for (index, line) in text.lines().enumerate() {
            reader.line(line, index + 1).map_err(|wrong| Error::SceneLine {
                file: name.to_owned(),
                line: index + 1,
                field: wrong.field,
                message: wrong.message,
            })?;
        }
        Ok(Loaded { scene: reader.scene, warnings: reader.warnings })
    }

    /// Reads a scene file. Bytes that are not UTF-8 (in comments of an older encoding) are accepted outside of numbers.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be read, [`Error::SceneLine`] as for [`Scene::parse`].
    pub fn load(path: impl AsRef<Path>) -> Result<Loaded> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| Error::File { file: path.to_owned(), source })?;
        Self::parse_bytes(&bytes, path)
    }

    /// Reads a scene text as bytes from a file or a pipe; see [`Scene::load`].
    ///
    /// # Errors
    /// As for [`Scene::parse`].
    pub fn parse_bytes(bytes: &[u8], name: &Path) -> Result<Loaded> {
        Self::parse(&String::from_utf8_lossy(bytes), name)
    }
}

fn vector(numbers: &[f32]) -> Vec3 {
    Vec3::from_slice(numbers)
}

struct Reader {
    scene: Scene,
    warnings: Vec<LineWarning>,
    /// The sphere that each reference stands for: the last one defined with it.
    references: HashMap<u32, SphereId>,
    /// The group of the following objects.
    group: u16,
}

impl Reader {
    fn line(&mut self, line: &str, number: usize) -> Line<()> {
        // A file of 16-bit characters would otherwise be one long comment.
        if line.contains('\0') {
            return Err(Wrong { field: "text".to_owned(), message: "a NUL byte, expected plain text (UTF-8)".to_owned() });
        }
        let mut words = line.split_ascii_whitespace();
        match words.next().unwrap_or_default() {
            "S" => self.sphere(line),
            "R" => self.rod(line),
            "C" => self.capsule(line),
            "P" => self.polygon(line),
            "K" => self.spring(line),
            "B" => self.cuboid(line),
            "T" if words.next().is_some_and(|word| word.parse::<f64>().is_ok()) => self.tether(line),
            "@group" => self.group(line),
            "@orientation" => self.orientation(line),
            "@force" => self.force(line),
            "@capsule" => self.mark(line),
            "set" => self.set(line, number),
            "T" => {
                self.comment(number, "a tether is `T ref x y z k l c`");
                Ok(())
            }
            word if word.starts_with('@') => {
                self.comment(number, "the known words are @group, @orientation, @force and @capsule");
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn comment(&mut self, line: usize, hint: &str) {
        self.warnings.push(LineWarning { line, text: format!("taken for a comment; {hint}") });
    }

    fn find(&self, kind: &Kind, name: &str, reference: u32) -> Line<SphereId> {
        self.references.get(&reference).copied().ok_or_else(|| {
            let message = format!("no sphere with reference {reference} yet, expected one that a line above defined");
            kind.wrong(name, message)
        })
    }

    fn pair(&self, kind: &Kind, [a, b]: [u32; 2]) -> Line<(SphereId, SphereId)> {
        let [first, second] = [0, 1].map(|end| kind.references[end]);
        let ends = (self.find(kind, first, a)?, self.find(kind, second, b)?);
        if ends.0 == ends.1 {
            return Err(kind.wrong(second, format!("{b} is the same sphere as {first}, expected another one")));
        }
        Ok(ends)
    }

    fn sphere(&mut self, line: &str) -> Line<()> {
        let ([reference], n) = SPHERE.read::<1, 12>(line)?;
        let mut sphere = Sphere::new(vector(&n[0..3]), n[10])
            .velocity(vector(&n[3..6]))
            .angular_momentum(vector(&n[6..9]))
            .mass(n[9])
            .group(self.group);
        sphere.fixed = n[11] > 0.0;
        let id = self.scene.add_sphere(sphere).map_err(|error| SPHERE.refused(&error))?;
        self.references.insert(reference, id);
        self.scene.references.set(id, reference);
        Ok(())
    }

    fn rod(&mut self, line: &str) -> Line<()> {
        let (references, [radius, length]) = ROD.read::<2, 2>(line)?;
        let (end1, end2) = self.pair(&ROD, references)?;
        let mut rod = Rod::new(end1, end2, radius).group(self.group);
        rod.length = (length > 0.0).then_some(length);
        self.scene.add_rod(rod).map_err(|error| ROD.refused(&error))?;
        Ok(())
    }

    fn capsule(&mut self, line: &str) -> Line<()> {
        let ([], n) = CAPSULE.read::<0, 11>(line)?;
        let capsule =
            Capsule::new(vector(&n[0..3]), vector(&n[3..6]), n[10]).velocity(vector(&n[6..9])).mass(n[9]).group(self.group);
        self.scene.add_capsule(capsule).map_err(|error| CAPSULE.refused(&error))?;
        Ok(())
    }

    fn polygon(&mut self, line: &str) -> Line<()> {
        let ([], n) = POLYGON.read::<0, 9>(line)?;
        let polygon = Polygon::new(vector(&n[0..3]), vector(&n[3..6]), vector(&n[6..9])).group(self.group);
        self.scene.add_polygon(polygon).map_err(|error| POLYGON.refused(&error))?;
        Ok(())
    }

    fn spring(&mut self, line: &str) -> Line<()> {
        let (references, [stiffness, length, damping]) = SPRING.read::<2, 3>(line)?;
        let (a, b) = self.pair(&SPRING, references)?;
        let spring = Spring::new(a, b, stiffness, length).damping(damping);
        self.scene.add_spring(spring).map_err(|error| SPRING.refused(&error))?;
        Ok(())
    }

    fn cuboid(&mut self, line: &str) -> Line<()> {
        let ([], n) = BOX.read::<0, 12>(line)?;
        let cuboid = Cuboid::new(vector(&n[0..3]), vector(&n[3..6]), vector(&n[6..9]), vector(&n[9..12])).group(self.group);
        self.scene.add_box(cuboid).map_err(|error| BOX.refused(&error))?;
        Ok(())
    }

    fn tether(&mut self, line: &str) -> Line<()> {
        let ([reference], n) = TETHER.read::<1, 6>(line)?;
        let sphere = self.find(&TETHER, "sphere", reference)?;
        let tether = Tether::new(sphere, vector(&n[0..3]), n[3]).length(n[4]).damping(n[5]);
        self.scene.add_tether(tether).map_err(|error| TETHER.refused(&error))?;
        Ok(())
    }

    fn group(&mut self, line: &str) -> Line<()> {
        let ([group], []) = GROUP.read::<1, 0>(line)?;
        self.group =
            group.try_into().map_err(|_| GROUP.wrong("number", format!("{group} is too large, expected 0 to {}", u16::MAX)))?;
        Ok(())
    }

    /// Changes an existing sphere, and checks that it is still valid.
    fn change(&mut self, kind: &Kind, reference: u32, change: impl FnOnce(&mut Sphere)) -> Line<()> {
        let id = self.find(kind, "sphere", reference)?;
        let sphere = self.scene.spheres.get_mut(id).map_err(|error| kind.refused(&error))?;
        change(sphere);
        sphere.validate().map_err(|error| kind.refused(&error))
    }

    fn orientation(&mut self, line: &str) -> Line<()> {
        let ([reference], [w, x, y, z]) = ORIENTATION.read::<1, 4>(line)?;
        self.change(&ORIENTATION, reference, |sphere| {
            sphere.orientation = Quat::from_xyzw(x, y, z, w);
        })
    }

    fn force(&mut self, line: &str) -> Line<()> {
        let ([reference], n) = FORCE.read::<1, 3>(line)?;
        self.change(&FORCE, reference, |sphere| sphere.force = vector(&n))
    }

    fn mark(&mut self, line: &str) -> Line<()> {
        let (references, []) = MARK.read::<2, 0>(line)?;
        let (end1, end2) = self.pair(&MARK, references)?;
        let rods = &self.scene.rods;
        let last = rods.len().checked_sub(1).map(|index| rods.handle_at(index));
        let fits = rods.objects().last().is_some_and(|rod| rod.end1 == end1 && rod.end2 == end2 && rod.length.is_some());
        let taken = self.scene.capsules.objects().last().map(|parts| parts.rod);
        match last {
            Some(rod) if fits && taken != last => {
                self.scene.capsules.add(CapsuleParts { end1, end2, rod });
                Ok(())
            }
            _ => Err(MARK.wrong("end1", "expected right after the R line, with a length, of these two spheres")),
        }
    }

    fn set(&mut self, line: &str, number: usize) -> Line<()> {
        let mut words = line.split_ascii_whitespace().skip(1);
        let Some(name) = words.next().filter(|name| Settings::NAMES.contains(name)) else {
            let hint = format!("a setting is `set NAME VALUE` with NAME one of {}", Settings::NAMES.join(", "));
            self.comment(number, &hint);
            return Ok(());
        };
        let value = words.collect::<Vec<_>>().join(" ");
        let wrong = |error| Wrong {
            field: format!("set {name}"),
            message: match error {
                Error::Invalid { expected, .. } if value.is_empty() => format!("no value, expected {expected}"),
                Error::Invalid { value, expected, .. } => format!("{value} is not allowed, expected {expected}"),
                other => other.to_string(),
            },
        };
        self.scene.settings.set(name, &value).map_err(wrong)
    }
}

#[cfg(test)]
#[path = "text_tests.rs"]
mod tests;
