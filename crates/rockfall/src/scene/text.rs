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
//! | `@group N meets=N,N...` | nothing: the objects of the lines below belong to group N. With `meets=`, the group touches those of the list ([`Scene::set_group_meets`]) |
//! | `@orientation ref w x y z` | nothing: sets the orientation of that sphere |
//! | `@force ref x y z` | nothing: sets the external force on that sphere |
//! | `@muscle amplitude frequency phase` | nothing: the rest length of the spring added last oscillates |
//! | `@capsule ref1 ref2` | nothing: the two spheres and the rod added last are a capsule |
//! | `@material NAME density=D young=E poisson=N` | nothing: defines a material; each constant may be left out |
//! | `@pair NAME NAME restitution=e friction=mu stiffness=k characteristic_velocity=V rolling_friction=mu rolling_model=c rolling_damping=eta twisting_friction=mu surface_energy=gamma cohesion=jkr` | nothing: sets properties of the contacts between two materials |
//! | `@use NAME` | nothing: the objects of the lines below are of this material; `@use -`: of none |
//! | `@name NAME` | nothing: the name of the objects of the lines below; `@name -`: none |
//! | `@colour COLOUR` | nothing: the colour of the objects of the lines below ([`Colour`](crate::Colour)); `@colour -`: that of their kind |
//! | `@look LOOK` | nothing: how the objects of the lines below are drawn: `plain`, `striped`, `wood`, `stone` or `glass` ([`Look`](crate::Look)); `@look -`: as usual |
//! | `@label TEXT` | nothing: text beside the objects of the lines below; `@label -`: none, and no numbers instead |
//! | `@run dt=S integrator=NAME steps=N every=K substeps=N speed=X` | nothing: how the scene is meant to be run ([`RunDefaults`](crate::RunDefaults)) |
//! | `@motion NAME velocity=x,y,z spin=w axis=x,y,z through=x,y,z amplitude=x,y,z frequency=F phase=P from=S to=S` | nothing: adds a term to the motion of that name ([`MotionTerm`](crate::MotionTerm)) |
//! | `@triangle x y z` + two edges | a triangle with the vertices x y z and the ends of both edges, which is touched from both sides |
//! | `@mesh FILE scale=s at=x,y,z axis=x,y,z turn=degrees name=N` | the triangles of an STL, OBJ or PLY file ([`Mesh`](crate::Mesh)): scaled, turned about the axis through its origin, and moved. A relative path begins at the folder of the scene file |
//! | `@plane at=x,y,z normal=x,y,z name=N` | a plane without ends, which is touched on the side of its normal |
//! | `@cylinder at=x,y,z axis=x,y,z radius=r length=l inside=yes name=N` | a cylinder without caps. Its axis begins at `at` and goes into the direction of `axis`. It is touched from outside, or with `inside=yes` from inside |
//! | `@cone at=x,y,z axis=x,y,z radius=a..b length=l inside=yes name=N` | a cone without caps, with the radius `a` at the beginning of its axis and `b` at its end. One of them may be 0 |
//! | `@ball at=x,y,z radius=r inside=yes name=N` | a ball |
//! | `@move NAME` | nothing: the boxes and polygons of the lines below follow that motion; `@move -`: none |
//! | `@surface velocity=x,y,z` | nothing: the surfaces of the boxes, polygons and meshes of the lines below move, like conveyors; `@surface -`: they do not |
//! | `@periodic AXIS FROM TO [shear=RATE,DIRECTION,DISPLACEMENT]` | nothing: the scene is periodic along x, y or z, between two coordinates ([`Scene::set_periodic`](crate::Scene::set_periodic)), and sheared ([`Scene::set_shear`](crate::Scene::set_shear)) |
//! | `@gauge name=N wall=NAME` | nothing: measures the load on the boxes and polygons of that name or motion ([`Gauge`](crate::Gauge)) |
//! | `@gauge name=N plane=x,y,z,nx,ny,nz` | nothing: counts the spheres that pass the plane through that point, across that normal |
//! | `@inlet name=N box=x0,y0,z0,x1,y1,z1 rate=PER_S radius=r by=number density=D velocity=x,y,z from=S to=S limit=COUNT seed=N` | nothing: spheres of the material in use come in while a simulation runs ([`Inlet`](crate::Inlet)). `mass_rate=` or `volume_rate=` may replace `rate=`, `mass=` may replace `density=`, `radius=` also takes `a..b` and `lognormal:median,sigma`, `by=mass` weights radii by mass. `mix=NAME:SHARE,...` in place of the radius lets in several kinds: `@grain NAME radius=r by=number density=D` above names one of spheres, with the material, group and tag in use there |
//! | `@outlet name=N box=x0,y0,z0,x1,y1,z1` | nothing: spheres that enter the box are removed ([`Outlet`](crate::Outlet)) |
//! | `@sensor name=N box=x0,y0,z0,x1,y1,z1` | nothing: reports what enters and leaves the box ([`Sensor`](crate::Sensor)) |
//! | `@body NAME mass=M centre=x,y,z inertia=xx,yy,zz,xy,xz,yz` ... `@end` | nothing: the `S`, `R` and `C` lines between are the parts of a shape in coordinates of its own ([`Shape`](crate::Shape)), with velocities of 0 and any mass. `density=D` may replace `mass=`. References, `@group`, `@use`, `@name`, `@colour`, `@look` and `@label` in a block hold up to its `@end` |
//! | `@hull x,y,z x,y,z ...` | within `@body`: the convex hull of the points |
//! | `@hull FILE scale=s at=x,y,z axis=x,y,z turn=degrees` | within `@body`: the convex hull of the vertices of a mesh file |
//! | `@place NAME at=x,y,z axis=x,y,z turn=degrees velocity=x,y,z spin=x,y,z name=N first=REFERENCE` | a rigid body of that shape ([`Placement`](crate::Placement)). Its spheres have references that count on from `first`. `centre=` may replace `at=`, `orientation=w,x,y,z` may replace `axis=` and `turn=`, and `momentum=` may replace `spin=` |
//! | `@joint KIND A B at=x,y,z to=x,y,z axis=x,y,z limits=a..b cone=a twist=a..b speed=v force=F torque=T target=p stiffness=k damping=c effort=F drag=c armature=J friction=f break_force=F break_torque=T collide=yes name=N` | a joint of two bodies ([`Joint`](crate::Joint)): a `ball`, `hinge`, `slider`, `fixed` or `distance`. `A` and `B` are the name of a body that a line above places, the reference of a sphere, or `world`. Angles are in degrees, rates in rad/s. `to=` is for distance joints, `cone=` and `twist=` are for balls, `torque=` is for hinges and balls and `force=` for the others. `frame_a=x,y,z,w,i,j,k` and `frame_b=`, places and turns in coordinates of the bodies, may replace `at=`, `to=` and `axis=`, and `length=` the distance |
//! | `@repeat N dx dy dz` ... `@end` | N copies of the lines between; copy k, from 0, is moved by k times (dx, dy, dz), and the references that the lines define count on |
//!
//! The whole first word of a line decides its kind. A line with any other first word is a comment. The last thirty-four kinds above are
//! comments to the reader of the thesis. `#` at the beginning of a line or after white space begins a comment up to the end of
//! the line. `#` with six hexadecimal digits after `@colour` is a colour.
//!
//! `-` in place of the mass of a sphere or capsule stands for its volume times the density of the material in use.
//!
//! A line that begins with `set` or `@` and is not understood is an error. In a file without any other such line, without
//! tethers and without `#`, it may be prose of a file for the thesis's program: there it is a comment with a warning. A comment without `#` that
//! looks like an object or a setting (`s 1 0 2 ...`, `Sphere 1 ...`, `gravity 3`) has a warning too, and so has a second `set`
//! of the same constant, which replaces the first one.

use std::collections::{HashMap, HashSet};
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use glam::Vec3;

mod body;
mod comment;
mod gauge;
mod hull;
mod inlet;
mod joint;
mod line;
mod materials;
mod mesh;
mod motion;
mod objects;
mod periodic;
mod repeat;
mod run;
mod servo;
mod set;
mod smooth;
mod tags;
mod values;

use comment::{Title, has_number_sign, is_extension, looks_like, may_be_prose, without_comment};
use joint::Named;
use line::{BALL, CONE, CYLINDER, GROUP, HULL, Line, PLANE, TETHER, Wrong};

use repeat::{Block, Copy};
use values::Values;

pub(super) use smooth::line_of;

use super::{Gauge, GrainKind, Joint, MaterialId, MotionId, Scene, SphereId, Tag};
use crate::error::{Error, Result, nearest, quoted};
use crate::settings::Precision;

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
    /// Reads a scene text. `name` names its source in messages. Relative paths of `@mesh` lines begin at its folder.
    ///
    /// # Errors
    /// [`Error::SceneLine`] for the first wrong line, with the field and what was expected.
    pub fn parse(text: &str, name: &Path) -> Result<Loaded> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = Reader::new(text, name.parent().unwrap_or(Path::new("")));
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
            .and_then(|()| reader.check_body_end())
            .and_then(|()| reader.check_run())
            .and_then(|()| reader.add_gauges())
            .and_then(|()| {
                reader.round_positions();
                reader.add_joints()
            })
            .map_err(|(line, Wrong { field, message })| Error::SceneLine { file: name.to_owned(), line, field, message })?;
        reader.choose_law();
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

/// First words of extensions that begin with `@`.
const AT_WORDS: [&str; 35] = [
    "@group",
    "@orientation",
    "@force",
    "@capsule",
    "@muscle",
    "@material",
    "@pair",
    "@use",
    "@name",
    "@colour",
    "@look",
    "@label",
    "@run",
    "@mesh",
    "@triangle",
    "@motion",
    "@servo",
    "@move",
    "@surface",
    "@periodic",
    "@plane",
    "@cylinder",
    "@cone",
    "@ball",
    "@gauge",
    "@grain",
    "@inlet",
    "@outlet",
    "@sensor",
    "@body",
    "@hull",
    "@place",
    "@joint",
    "@repeat",
    "@end",
];

struct Reader<'a> {
    /// The whole text.
    text: &'a str,
    /// Where relative paths begin.
    folder: &'a Path,
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
    /// The lines between `@body` and `@end` so far.
    body: Option<body::Block>,
    /// Kinds of spheres for mixtures, by name.
    grains: HashMap<String, GrainKind>,
    /// The copies that the present line is part of, the outermost first.
    copies: Vec<Copy>,
    /// Number of lines of all blocks so far.
    repeated: u64,
    /// The line `@run`.
    run_at: Option<usize>,
    /// The sphere that each reference stands for: the last one defined with it.
    references: HashMap<u32, SphereId>,
    /// The gauges, with their lines. Walls may follow below.
    gauges: Vec<(usize, Gauge)>,
    /// The joints, with their lines. They are added when the positions of the bodies are final.
    joints: Vec<(usize, Joint)>,
    joint_names: HashSet<String>,
    /// What the names of placed bodies stand for.
    body_names: HashMap<String, Named>,
    /// The group of the following objects.
    group: u16,
    /// The material of the following objects.
    material: Option<MaterialId>,
    /// The motion that the following boxes and polygons follow.
    motion: Option<MotionId>,
    /// Velocity of the surface of the following boxes and polygons.
    surface: Vec3,
    /// The name, colour, look and label of the following objects.
    tag: Option<Arc<Tag>>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str, folder: &'a Path) -> Self {
        Self {
            text,
            folder,
            scene: Scene::new(),
            warnings: Vec::new(),
            comments: 0,
            set_at: HashMap::new(),
            at: 0,
            open: Vec::new(),
            body: None,
            grains: HashMap::new(),
            copies: Vec::new(),
            repeated: 0,
            run_at: None,
            references: HashMap::new(),
            gauges: Vec::new(),
            joints: Vec::new(),
            joint_names: HashSet::new(),
            body_names: HashMap::new(),
            group: 0,
            material: None,
            motion: None,
            surface: Vec3::ZERO,
            tag: None,
        }
    }

    fn line(&mut self, whole: &str, number: usize) -> Line<()> {
        // A file of 16-bit characters would otherwise be one long comment.
        if whole.contains('\0') {
            return Err(Wrong { field: "text".to_owned(), message: "a NUL byte, expected plain text (UTF-8)".to_owned() });
        }
        let line = without_comment(whole);
        let mut words = line.split_ascii_whitespace();
        let word = words.next().unwrap_or_default();
        match word {
            _ if self.body.is_some() && !Self::is_common(word) => self.body_line(line, word),
            "S" => self.sphere(line),
            "R" => self.rod(line),
            "C" => self.capsule(line),
            "P" => self.polygon(line),
            "@mesh" => self.mesh(line, number),
            "@triangle" => self.triangle(line),
            "@plane" => self.smooth(&PLANE, line, number),
            "@cylinder" => self.smooth(&CYLINDER, line, number),
            "@cone" => self.smooth(&CONE, line, number),
            "@ball" => self.smooth(&BALL, line, number),
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
            "@name" => self.name(line, number),
            "@colour" => self.colour(line, number),
            "@look" => self.look(line, number),
            "@label" => self.label(line, number),
            "@run" => self.run(line, number),
            "@motion" => self.motion(line, number),
            "@servo" => self.servo(line, number),
            "@move" => self.follow(line, number),
            "@surface" => self.surface(line, number),
            "@periodic" => self.periodic(line, number),
            "@gauge" => self.gauge(line, number),
            "@grain" => self.grain(line, number),
            "@inlet" => self.inlet(line, number),
            "@outlet" => self.outlet(line, number),
            "@sensor" => self.sensor(line, number),
            "@body" => self.begin_body(line, number),
            "@place" => self.place(line, number),
            "@joint" => self.joint(line, number),
            "@hull" => {
                self.not_understood(number, HULL.wrong("line", "not possible here, expected between `@body` and `@end`"))
            }
            "@end" => {
                let message = "no `@repeat` or `@body` above, expected one before the lines of its block".to_owned();
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

    /// Rounds positions to `f32`, unless the scene has double precision.
    fn round_positions(&mut self) {
        if self.scene.chosen_precision().precision == Precision::Double {
            return;
        }
        self.scene.round_positions();
    }

    fn group(&mut self, line: &str) -> Line<()> {
        let (own, list) =
            line.split_at(line.find('=').map_or(line.len(), |at| line[..at].rfind(char::is_whitespace).unwrap_or(at)));
        let ([group], []) = GROUP.read::<1, 0>(own)?;
        self.group =
            group.try_into().map_err(|_| GROUP.wrong("number", format!("{group} is too large, expected 0 to {}", u16::MAX)))?;
        match Values::read(&GROUP, &["meets"], list.split_ascii_whitespace())?.of("meets") {
            Some(list) => self.meets(list),
            None => Ok(()),
        }
    }

    /// Sets the list of the present group.
    fn meets(&mut self, list: &str) -> Line<()> {
        let expected = format!("expected whole numbers from 0 to {} with commas, or none", u16::MAX);
        let group = |word: &str| {
            word.parse::<u16>().map_err(|_| GROUP.wrong("meets", format!("{} is not a group, {expected}", quoted(word))))
        };
        let words = if list == "none" { Vec::new() } else { list.split(',').collect() };
        let mut groups = words.into_iter().map(group).collect::<Line<Vec<u16>>>()?;
        groups.sort_unstable();
        groups.dedup();
        if self.scene.group_meets(self.group).is_some_and(|before| before != groups) {
            return Err(GROUP.wrong("meets", format!("group {} has another list already", self.group)));
        }
        self.scene.set_group_meets(self.group, groups).map_err(|error| GROUP.refused(&error))
    }
}

#[cfg(test)]
#[path = "text_tests.rs"]
mod tests;
