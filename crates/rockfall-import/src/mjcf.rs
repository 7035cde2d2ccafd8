//! MJCF files, the format of MuJoCo.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rockfall::glam::DVec3;

use crate::Imported;
use crate::assets::Assets;
use crate::build;
use crate::error::Result;
use crate::mass::{Mass, Pose};
use crate::model::{Link, Mask, Model};
use crate::notes::Notes;
use crate::xml::{Element, Reader};

mod actuators;
mod bodies;
mod compiler;
mod defaults;
mod geoms;
mod include;
mod joints;
mod links;
mod meshes;

use compiler::Compiler;
use defaults::{Attributes, Defaults};

/// What the bodies of a file become.
struct Mjcf<'a> {
    path: &'a Path,
    compiler: Compiler,
    defaults: Defaults,
    notes: Notes,
    assets: Assets,
    /// Elements of mesh assets by name.
    meshes: HashMap<String, Element>,
    links: Vec<Link>,
    /// Links by name.
    names: HashMap<String, usize>,
    /// Links and numbers of joints by name.
    joints: HashMap<String, (usize, usize)>,
    /// Place and joint of actuators whose force a control gives.
    forces: [Vec<(String, String)>; 2],
}

pub(crate) fn load(path: &Path) -> Result<Imported> {
    let root = Reader::default().read(path)?;
    if root.name == "mujoco" {
        return convert(path, root);
    }
    Err(root.wrong("the root element is not that of an MJCF file, expected <mujoco>"))
}

pub(crate) fn convert(path: &Path, root: Element) -> Result<Imported> {
    let mut root = root;
    include::expand(&mut root, path)?;
    let mut notes = Notes::default();
    let compiler = Compiler::of(&root, &mut notes)?;
    let defaults = Defaults::of(&root)?;
    let world = Link::alone("world".to_owned(), Element::empty("worldbody", path), Mass::NONE, Vec::new());
    let mut mjcf = Mjcf {
        path,
        compiler,
        defaults,
        notes,
        assets: Assets::default(),
        meshes: HashMap::new(),
        links: vec![world],
        names: HashMap::from([("world".to_owned(), 0)]),
        joints: HashMap::new(),
        forces: Default::default(),
    };
    let model = mjcf.model(&root)?;
    let notes = mjcf.notes;
    build::scene(path, model, notes)
}

impl Mjcf<'_> {
    fn model(&mut self, root: &Element) -> Result<Model> {
        self.read_meshes(root)?;
        for section in &root.children {
            match section.name.as_str() {
                "worldbody" => self.body_of(section, 0, Pose::NONE, Defaults::MAIN)?,
                "compiler" | "option" | "default" | "asset" | "actuator" | "contact" | "equality" => {}
                // They say nothing about how bodies move.
                "size" | "visual" | "statistic" | "custom" => {}
                _ => self.notes.ignored(section),
            }
        }
        for section in root.all("actuator") {
            for actuator in &section.children {
                self.actuator(actuator)?;
            }
        }
        self.note_forces();
        let loops = self.loops(root)?;
        let apart = self.apart(root)?;
        let gravity = self.option(root)?;
        self.scale_masses();
        Ok(Model { links: std::mem::take(&mut self.links), loops, apart, gravity, has_masks: true })
    }

    /// Reads gravity, and notes what else acts on bodies.
    fn option(&mut self, root: &Element) -> Result<DVec3> {
        let mut gravity = DVec3::new(0.0, 0.0, -9.81);
        for option in root.all("option") {
            gravity = option.vector("gravity")?.unwrap_or(gravity);
            for key in ["wind", "density", "viscosity", "magnetic"] {
                let Some(text) = option.attribute(key) else { continue };
                if option.list(key, text, 3)?.iter().any(|number| *number != 0.0) {
                    self.notes.add(option, format!("{key}={text:.40} is not taken over: a scene has no fluid"));
                }
            }
            for flag in option.all("flag") {
                if flag.attribute("gravity") == Some("disable") {
                    gravity = DVec3::ZERO;
                }
                if flag.attribute("contact") == Some("disable") {
                    let geoms = self.links.iter_mut().flat_map(|link| &mut link.geoms);
                    geoms.for_each(|geom| geom.mask = Mask { kind: 0, affinity: 0 });
                }
            }
        }
        Ok(gravity)
    }

    fn scale_masses(&mut self) {
        let total: f64 = self.links.iter().skip(1).map(|link| link.mass.mass).sum();
        if let Some(wanted) = self.compiler.total_mass.filter(|_| total > 0.0) {
            self.links.iter_mut().for_each(|link| link.mass = link.mass.scaled(wanted / total));
        }
    }

    /// The attributes of an element with those of its default class.
    fn attributes<'a>(&'a self, element: &'a Element, class: usize) -> Result<Attributes<'a>> {
        self.defaults.attributes(element, class)
    }

    fn folder(&self) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).to_owned()
    }
}
