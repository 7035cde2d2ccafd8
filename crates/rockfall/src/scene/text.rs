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
//! | `@muscle amplitude frequency phase` | nothing: the rest length of the spring added last oscillates |
//! | `@capsule ref1 ref2` | nothing: the two spheres and the rod added last are a capsule |
//! | `@material NAME density=D young=E poisson=N` | nothing: defines a material; each constant may be left out |
//! | `@pair NAME NAME restitution=e friction=mu stiffness=k characteristic_velocity=V rolling_friction=mu rolling_model=c rolling_damping=eta twisting_friction=mu surface_energy=gamma cohesion=jkr` | nothing: sets properties of the contacts between two materials |
//! | `@use NAME` | nothing: the objects of the lines below are of this material; `@use -`: of none |
//! | `@run dt=S integrator=NAME steps=N every=K substeps=N` | nothing: how the scene is meant to be run ([`RunDefaults`](crate::RunDefaults)) |
//! | `@repeat N dx dy dz` ... `@end` | N copies of the lines between; copy k, from 0, is moved by k times (dx, dy, dz), and the references that the lines define count on |
//!
//! The whole first word of a line decides its kind. A line with any other first word is a comment. The last twelve kinds above are
//! comments to the reader of the thesis. `#` at the beginning of a line or after white space begins a comment up to the end of
//! the line.
//!
//! `-` in place of the mass of a sphere or capsule stands for its volume times the density of the material in use.
//!
//! A line that begins with `set` or `@` and is not understood is an error. In a file without any other such line, without
//! tethers and without `#`, it may be prose of a file for the thesis's program: there it is a comment with a warning. A comment without `#` that
//! looks like an object or a setting (`s 1 0 2 ...`, `Sphere 1 ...`, `gravity 3`) has a warning too, and so has a second `set`
//! of the same constant, which replaces the first one.

use std::collections::HashMap;
use std::fmt;
use std::path::Path;

use glam::{Quat, Vec3};

mod comment;
mod line;
mod materials;
mod repeat;
mod run;

use comment::{Title, has_number_sign, is_extension, is_number, looks_like, may_be_prose, without_comment};
use line::{BOX, CAPSULE, FORCE, GROUP, Kind, Line, MARK, MUSCLE, ORIENTATION, POLYGON, ROD, SPHERE, SPRING, TETHER, Wrong};

use repeat::{Block, Copy};

use super::{Capsule, CapsuleParts, Cuboid, MaterialId, Muscle, Polygon, Rod, Scene, Sphere, SphereId, Spring, Tether};
use crate::error::{Error, Result, nearest, quoted};
use crate::settings::{Precision, Settings};

/// A scene that was read, with warnings about its text.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Warnings about lines that were read as comments but look like something else, and about constants that are set twice.
    pub warnings: Vec<LineWarning>,
    /// Number of lines that are comments. Empty lines, and comments after an object, are not counted.
    pub comments: usize,
    /// The comment at the beginning of the text, up to the first line that is empty or no comment, without `#`. One item per line.
    pub title: Vec<String>,
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
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = Reader::new(text);
        let mut title = Title::default();
        for (index, line) in text.lines().enumerate() {
            let before = reader.comments;
            if let Err(wrong) = reader.next(line, index + 1) {
                // A line in a block is read at the end of the block.
                let line = text.lines().nth(reader.at - 1).unwrap_or_default();
                return Err(Error::SceneLine {
                    file: name.to_owned(),
                    line: reader.at,
                    field: wrong.field,
                    message: wrong.message
                        + if may_be_prose(line) { "; if the line is a comment, begin it with #" } else { "" },
                });
            }
            title.add(line, reader.comments > before);
        }
        reader
            .check_blocks()
            .and_then(|()| reader.check_run())
            .map_err(|(line, Wrong { field, message })| Error::SceneLine { file: name.to_owned(), line, field, message })?;
        reader.round_positions();
        Ok(Loaded { scene: reader.scene, warnings: reader.warnings, comments: reader.comments, title: title.lines })
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

/// A value for a message, or a word in place of one that is missing or long.
fn shown(value: &str) -> &str {
    if is_number(value) && value.len() < 20 { value } else { "VALUE" }
}

/// The key of the line `@run` that a word after `set` means.
fn key_for(word: &str) -> Option<&'static str> {
    match word.to_ascii_lowercase().replace('-', "_").as_str() {
        "dt" | "timestep" | "time_step" => Some("`@run dt=SECONDS`"),
        "steps" => Some("`@run steps=N`"),
        "time" | "duration" => Some("`@run dt=SECONDS steps=N`"),
        "integrator" => Some("`@run integrator=NAME`"),
        "substeps" => Some("`@run substeps=N`"),
        _ => None,
    }
}

/// First words of extensions that begin with `@`.
const AT_WORDS: [&str; 11] =
    ["@group", "@orientation", "@force", "@capsule", "@muscle", "@material", "@pair", "@use", "@run", "@repeat", "@end"];

struct Reader<'a> {
    /// The whole text.
    text: &'a str,
    scene: Scene,
    warnings: Vec<LineWarning>,
    /// Number of lines that are comments.
    comments: usize,
    /// Lines of the constants that were set.
    set_at: HashMap<&'static str, usize>,
    /// Number of the line that is read.
    at: usize,
    /// Blocks that have no `@end` yet, the outermost first.
    open: Vec<Block<'a>>,
    /// The copies that the present line is part of, the outermost first.
    copies: Vec<Copy>,
    /// Number of lines of all blocks so far.
    repeated: u64,
    /// The line `@run`.
    run_at: Option<usize>,
    /// The sphere that each reference stands for: the last one defined with it.
    references: HashMap<u32, SphereId>,
    /// The group of the following objects.
    group: u16,
    /// The material of the following objects.
    material: Option<MaterialId>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            text,
            scene: Scene::new(),
            warnings: Vec::new(),
            comments: 0,
            set_at: HashMap::new(),
            at: 0,
            open: Vec::new(),
            copies: Vec::new(),
            repeated: 0,
            run_at: None,
            references: HashMap::new(),
            group: 0,
            material: None,
        }
    }

    fn line(&mut self, whole: &str, number: usize) -> Line<()> {
        // A file of 16-bit characters would otherwise be one long comment.
        if whole.contains('\0') {
            return Err(Wrong { field: "text".to_owned(), message: "a NUL byte, expected plain text (UTF-8)".to_owned() });
        }
        let line = without_comment(whole);
        let mut words = line.split_ascii_whitespace();
        match words.next().unwrap_or_default() {
            "S" => self.sphere(line),
            "R" => self.rod(line),
            "C" => self.capsule(line),
            "P" => self.polygon(line),
            "K" => self.spring(line),
            "B" => self.cuboid(line),
            // Here, nan and inf are numbers, which a tether refuses by name.
            "T" if words.next().is_some_and(|word| word.parse::<f64>().is_ok()) => self.tether(line),
            "@group" => self.group(line),
            "@orientation" => self.orientation(line),
            "@force" => self.force(line),
            "@capsule" => self.mark(line),
            "@muscle" => self.muscle(line),
            "@material" => self.material(line),
            "@pair" => self.properties(line, number),
            "@use" => self.use_material(line),
            "@run" => self.run(line, number),
            "@end" => {
                let message = "no `@repeat` above, expected one before the lines to repeat".to_owned();
                self.not_understood(number, Wrong { field: "@end".to_owned(), message })
            }
            "set" => self.set(line, number),
            "T" => {
                self.suspicious(number, format!("a tether is `{}`", TETHER.form()));
                Ok(())
            }
            word if word.starts_with('@') => {
                let known = format!("expected one of {}", AT_WORDS.join(", "));
                let message = nearest(word, &AT_WORDS).map_or(known, |near| format!("did you mean {near}?"));
                self.not_understood(number, Wrong { field: quoted(word), message: format!("an unknown word, {message}") })
            }
            "" => {
                self.comments += usize::from(line.len() < whole.len());
                Ok(())
            }
            _ => {
                match looks_like(line) {
                    Some(what) => self.suspicious(number, format!("{what}; begin a comment with #")),
                    None => self.comments += 1,
                }
                Ok(())
            }
        }
    }

    /// Counts a line as a comment, with a warning.
    fn suspicious(&mut self, line: usize, hint: String) {
        self.comments += 1;
        self.warnings.push(LineWarning { line, text: format!("taken for a comment; {hint}") });
    }

    /// Refuses a line that begins like an extension. In a file that has no other line like it and no `#`, the line may be prose.
    fn not_understood(&mut self, line: usize, wrong: Wrong) -> Line<()> {
        let other = self.text.lines().filter(|line| is_extension(line)).nth(1).is_some();
        if other || self.text.lines().any(has_number_sign) {
            return Err(wrong);
        }
        self.suspicious(line, format!("{} is {}", wrong.field, wrong.message));
        Ok(())
    }

    fn find(&self, kind: &Kind, name: &str, reference: u32) -> Line<SphereId> {
        let reference = self.counted_on(reference);
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
        let reference = self.counted_on(reference);
        let mut sphere = Sphere::new(self.point(&n[0..3]), n[10])
            .velocity(vector(&n[3..6]))
            .angular_momentum(vector(&n[6..9]))
            .group(self.group);
        // The digits beyond those of an f32. Which precision the scene has is known at its end.
        let (digits, offset) = (line.split_ascii_whitespace().skip(2), self.offset());
        for (axis, word) in digits.take(3).enumerate() {
            let x = word.parse::<f64>().unwrap_or_default();
            if offset[axis] != 0.0 {
                sphere.position[axis] = (x + offset[axis]) as f32;
            }
            sphere.position_low[axis] = (x + offset[axis] - f64::from(sphere.position[axis])) as f32;
        }
        sphere.mass = self.mass(&SPHERE, n[9], |density| sphere.density(density).mass)?;
        sphere.fixed = n[11] > 0.0;
        sphere.material = self.material;
        let id = self.scene.add_sphere(sphere).map_err(|error| SPHERE.refused(&error))?;
        self.references.insert(reference, id);
        self.scene.references.set(id, reference);
        Ok(())
    }

    /// Rounds positions to `f32`, unless the scene has double precision.
    fn round_positions(&mut self) {
        if self.scene.chosen_precision().precision == Precision::Double {
            return;
        }
        for index in 0..self.scene.spheres.len() {
            let id = self.scene.spheres.handle_at(index);
            if let Ok(sphere) = self.scene.spheres.get_mut(id) {
                sphere.position_low = Vec3::ZERO;
            }
        }
    }

    fn rod(&mut self, line: &str) -> Line<()> {
        let (references, [radius, length]) = ROD.read::<2, 2>(line)?;
        let (end1, end2) = self.pair(&ROD, references)?;
        let mut rod = Rod::new(end1, end2, radius).group(self.group);
        rod.length = (length > 0.0).then_some(length);
        rod.material = self.material;
        self.scene.add_rod(rod).map_err(|error| ROD.refused(&error))?;
        Ok(())
    }

    fn capsule(&mut self, line: &str) -> Line<()> {
        let ([], n) = CAPSULE.read::<0, 11>(line)?;
        let capsule =
            Capsule::new(self.point(&n[0..3]), self.point(&n[3..6]), n[10]).velocity(vector(&n[6..9])).group(self.group);
        let mass = self.mass(&CAPSULE, n[9], |density| capsule.density(density).mass)?;
        let capsule = Capsule { material: self.material, ..capsule.mass(mass) };
        self.scene.add_capsule(capsule).map_err(|error| CAPSULE.refused(&error))?;
        Ok(())
    }

    fn polygon(&mut self, line: &str) -> Line<()> {
        let ([], n) = POLYGON.read::<0, 9>(line)?;
        let polygon = Polygon::new(self.point(&n[0..3]), vector(&n[3..6]), vector(&n[6..9])).group(self.group);
        let polygon = Polygon { material: self.material, ..polygon };
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
        let cuboid = Cuboid::new(self.point(&n[0..3]), vector(&n[3..6]), vector(&n[6..9]), vector(&n[9..12])).group(self.group);
        let cuboid = Cuboid { material: self.material, ..cuboid };
        self.scene.add_box(cuboid).map_err(|error| BOX.refused(&error))?;
        Ok(())
    }

    fn tether(&mut self, line: &str) -> Line<()> {
        let ([reference], n) = TETHER.read::<1, 6>(line)?;
        let sphere = self.find(&TETHER, "sphere", reference)?;
        let tether = Tether::new(sphere, self.point(&n[0..3]), n[3]).length(n[4]).damping(n[5]);
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

    fn muscle(&mut self, line: &str) -> Line<()> {
        let ([], [amplitude, frequency, phase]) = MUSCLE.read::<0, 3>(line)?;
        let Some(spring) = self.scene.springs.objects_mut().last_mut() else {
            return Err(MUSCLE.wrong("line", "expected after the K line of a spring"));
        };
        if spring.muscle.is_some() {
            return Err(MUSCLE.wrong("line", "the spring of the last K line has a muscle already, expected one per spring"));
        }
        let muscle = Muscle::new(amplitude, frequency, phase);
        muscle.validate().map_err(|error| MUSCLE.refused(&error))?;
        spring.muscle = Some(muscle);
        Ok(())
    }

    fn set(&mut self, line: &str, number: usize) -> Line<()> {
        let mut words = line.split_ascii_whitespace().skip(1);
        let Some(word) = words.next() else {
            let message = "a setting without a name, expected `set NAME VALUE`".to_owned();
            return self.not_understood(number, Wrong { field: "set".to_owned(), message });
        };
        if let Some((name, value)) = word.split_once('=').filter(|(name, _)| Settings::NAMES.contains(name)) {
            let message = format!("expected a space in place of `=`: `set {name} {}`", shown(value));
            return Err(Wrong { field: format!("set {}", quoted(word)), message });
        }
        let Some(name) = Settings::NAMES.iter().copied().find(|name| *name == word) else {
            if let Some(key) = key_for(word) {
                let message = format!("not a constant, expected {key}");
                return self.not_understood(number, Wrong { field: format!("set {}", quoted(word)), message });
            }
            let known = format!("expected one of {}", Settings::NAMES.join(", "));
            let message = nearest(word, Settings::NAMES).map_or(known, |near| format!("did you mean {near}?"));
            let message = format!("an unknown setting, {message}");
            return self.not_understood(number, Wrong { field: format!("set {}", quoted(word)), message });
        };
        if let Some(before) = self.set_at.insert(name, number) {
            let text = format!("{name} is set again; this replaces line {before}");
            self.warnings.push(LineWarning { line: number, text });
        }
        let value = words.collect::<Vec<_>>().join(" ");
        let wrong = |error| Wrong {
            field: format!("set {name}"),
            message: match error {
                Error::Invalid { expected, .. } if value.is_empty() => format!("no value, expected {expected}"),
                Error::Invalid { value: given, .. } if value.starts_with('=') => {
                    let rest = value.trim_start_matches('=').trim();
                    format!("{given} is not allowed, expected no `=`: `set {name} {}`", shown(rest))
                }
                Error::Invalid { value, expected, .. } => format!("{value} is not allowed, expected {expected}"),
                other => other.to_string(),
            },
        };
        let given = self.set_at.contains_key("collisions").then_some(self.scene.settings.collisions);
        self.scene.settings.set(name, &value).map_err(wrong)?;
        if let Some(collisions) = given.filter(|_| name == "contact_law") {
            // The order of the lines does not matter.
            self.scene.settings.collisions = collisions;
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "text_tests.rs"]
mod tests;
