//! URDF files.

use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;
use std::path::Path;

use rockfall::glam::{DQuat, DVec3, EulerRot};

use crate::Imported;
use crate::assets::{self, Assets};
use crate::build;
use crate::error::Result;
use crate::mass::{Mass, Pose};
use crate::model::{Geom, Link, LinkJoint, Mask, Model, Motion, Spring};
use crate::notes::Notes;
use crate::solid::Solid;
use crate::xml::{Element, Reader, quoted};

/// Standard gravity of simulators, in m/s².
const GRAVITY: DVec3 = DVec3::new(0.0, 0.0, -9.81);

pub(crate) fn load(path: &Path) -> Result<Imported> {
    let root = Reader::default().read(path)?;
    if root.name == "robot" {
        return convert(path, &root);
    }
    Err(root.wrong("the root element is not that of a URDF file, expected <robot>"))
}

pub(crate) fn convert(path: &Path, root: &Element) -> Result<Imported> {
    let mut notes = Notes::default();
    let mut reader = Urdf { path, root, assets: Assets::default(), notes: &mut notes };
    let model = reader.model()?;
    build::scene(path, model, notes)
}

struct Urdf<'a> {
    path: &'a Path,
    root: &'a Element,
    assets: Assets,
    notes: &'a mut Notes,
}

/// A joint element with the name of the link above.
struct Edge<'a> {
    element: &'a Element,
    parent: &'a str,
}

impl Urdf<'_> {
    fn model(&mut self) -> Result<Model> {
        for other in &self.root.children {
            match other.name.as_str() {
                "link" | "joint" | "material" => {}
                _ => self.notes.ignored(other),
            }
        }
        let (order, edges) = tree(self.root)?;
        let world = Element::empty("robot", self.path);
        let mut links = vec![Link::alone("world".to_owned(), world, Mass::NONE, Vec::new())];
        let mut numbers: HashMap<&str, usize> = HashMap::new();
        for element in &order {
            let name = element.needed("name")?;
            let mut link = self.link(element)?;
            match edges.get(name) {
                Some(edge) => {
                    link.parent = numbers.get(edge.parent).copied();
                    link.pose = origin(edge.element)?;
                    self.join(&mut link, edge)?;
                }
                None => self.root(&mut link, order.len(), has_fixed_mass(name, &order, &edges)),
            }
            numbers.insert(name, links.len());
            links.push(link);
        }
        Ok(Model { links, loops: Vec::new(), apart: Vec::new(), gravity: GRAVITY, has_masks: false })
    }

    /// The link that no joint has as a child.
    fn root(&mut self, link: &mut Link, count: usize, has_fixed_mass: bool) {
        link.parent = Some(0);
        if link.name == "world" || link.mass.mass <= 0.0 && !has_fixed_mass {
            if link.name != "world" && count > 1 {
                self.notes.add(&link.element, "the root link has no mass, so it is the world");
            }
            return;
        }
        link.is_free = true;
        if count > 1 {
            let text =
                format!("the robot is not held: add `@joint fixed world {} at=0,0,0` to the scene to fix its root", link.name);
            self.notes.add(&link.element, text);
        }
    }

    fn link(&mut self, element: &Element) -> Result<Link> {
        let mass = element.child("inertial").map_or(Ok(Mass::NONE), inertial)?;
        let mut geoms = Vec::new();
        for collision in element.all("collision") {
            geoms.extend(self.geom(collision)?);
        }
        for other in &element.children {
            if !["inertial", "collision", "visual"].contains(&other.name.as_str()) {
                self.notes.ignored(other);
            }
        }
        let name = element.needed("name")?.to_owned();
        let element = element.alone();
        Ok(Link::alone(name, element, mass, geoms))
    }

    fn geom(&mut self, collision: &Element) -> Result<Option<Geom>> {
        let geometry = collision.needed_child("geometry")?;
        let Some(shape) = geometry.children.first() else {
            return Err(geometry.wrong("no shape, expected <box>, <sphere>, <cylinder>, <capsule> or <mesh>"));
        };
        let length = |name: &str| -> Result<f64> { positive(shape, name, shape.one(name, shape.needed(name)?)?) };
        let solid = match shape.name.as_str() {
            "box" => Solid::Box { half: sizes(shape)? / 2.0 },
            "sphere" => Solid::Sphere { radius: length("radius")? },
            "cylinder" => Solid::Cylinder { radius: length("radius")?, half: length("length")? / 2.0 },
            "capsule" => Solid::Capsule { radius: length("radius")?, half: length("length")? / 2.0 },
            "mesh" => {
                let path = assets::find(shape, self.path, shape.needed("filename")?)?;
                let scale = shape.vector("scale")?.unwrap_or(DVec3::ONE);
                match self.assets.mesh(shape, &path, scale, self.notes)? {
                    Some(points) => Solid::Mesh(points),
                    None => return Ok(None),
                }
            }
            "plane" => Solid::Plane,
            _ => {
                self.notes.add(shape, "the shape is left out: only box, sphere, cylinder, capsule and mesh are taken over");
                return Ok(None);
            }
        };
        let mut element = collision.alone();
        if element.attribute("name").is_none() {
            element = shape.alone();
        }
        let mut pose = origin(collision)?;
        if let (Solid::Plane, Some(normal)) = (&solid, shape.vector("normal")?) {
            pose.turn *= DQuat::from_rotation_arc(DVec3::Z, normal.try_normalize().unwrap_or(DVec3::Z));
        }
        Ok(Some(Geom { element, pose, solid, mask: Mask::ALL, friction: None }))
    }

    /// Adds the joint above a link.
    fn join(&mut self, link: &mut Link, edge: &Edge<'_>) -> Result<()> {
        let element = edge.element;
        let name = element.needed("name")?.to_owned();
        if let Some(mimic) = element.child("mimic") {
            let message = format!("the joint {} follows another one, which a scene cannot express", quoted(&name));
            return Err(mimic.wrong(message));
        }
        let expected = "expected revolute, continuous, prismatic, fixed, floating or spherical";
        let motion = match element.needed("type")? {
            "fixed" => return Ok(()),
            "floating" => {
                link.is_free = true;
                return Ok(());
            }
            "revolute" | "continuous" => Motion::Hinge,
            "prismatic" => Motion::Slide,
            "spherical" => Motion::Ball,
            other => return Err(element.wrong(format!("the type {} is not taken over, {expected}", quoted(other)))),
        };
        let axis = element.child("axis").map_or(Ok(None), |axis| axis.vector("xyz"))?.unwrap_or(DVec3::X);
        let Some(axis) = axis.try_normalize() else {
            return Err(element.wrong("the axis is 0, expected a direction"));
        };
        let limits = self.limits(element, motion)?;
        let effort = self.effort(element)?;
        let dynamics = element.child("dynamics");
        let constant = |key: &str| -> Result<f64> {
            let number = dynamics.map_or(Ok(None), |dynamics| dynamics.number(key))?.unwrap_or(0.0);
            dynamics.map_or(Ok(number), |dynamics| not_negative(dynamics, key, number))
        };
        let (damping, friction) = (constant("damping")?, constant("friction")?);
        let mut springs = Vec::new();
        if damping > 0.0 {
            springs.push(Spring { stiffness: 0.0, damping, target: 0.0, most: None });
        }
        for other in &element.children {
            if !["origin", "parent", "child", "axis", "limit", "dynamics"].contains(&other.name.as_str()) {
                self.notes.ignored(other);
            }
        }
        let element = element.alone();
        let (at, reference, motors, armature) = (DVec3::ZERO, 0.0, Vec::new(), 0.0);
        let joint =
            LinkJoint { name, element, motion, at, axis, reference, limits, springs, motors, effort, armature, friction };
        link.joints.push(joint);
        Ok(())
    }

    /// The greatest force of motors. 0 stands for none.
    fn effort(&mut self, joint: &Element) -> Result<Option<f64>> {
        let Some(limit) = joint.child("limit") else { return Ok(None) };
        if limit.number("velocity")?.is_some_and(|number| number != 0.0) {
            self.notes.ignored_attribute(limit, "velocity");
        }
        let effort = limit.number("effort")?.unwrap_or(0.0);
        Ok(Some(not_negative(limit, "effort", effort)?).filter(|effort| *effort > 0.0))
    }

    fn limits(&mut self, joint: &Element, motion: Motion) -> Result<Option<[f64; 2]>> {
        let is_continuous = joint.attribute("type") == Some("continuous");
        let Some(limit) = joint.child("limit") else {
            if !is_continuous && motion != Motion::Ball {
                self.notes.add(joint, "it has no limits, because the file gives none");
            }
            return Ok(None);
        };
        if is_continuous || motion == Motion::Ball {
            return Ok(None);
        }
        let [lower, upper] = ["lower", "upper"].map(|key| limit.number(key).map(|number| number.unwrap_or(0.0)));
        let (lower, upper) = (lower?, upper?);
        if lower > upper {
            self.notes.add(joint, format!("it has no limits: {lower} is greater than {upper}"));
            return Ok(None);
        }
        let is_turn = motion == Motion::Hinge && upper - lower >= TAU;
        Ok(Some([lower, upper]).filter(|_| !is_turn))
    }
}

/// Links, parents before children, and the joint above each of them by its name.
type Tree<'a> = (Vec<&'a Element>, HashMap<&'a str, Edge<'a>>);

/// The links, parents before children, and the joint above each of them.
fn tree(root: &Element) -> Result<Tree<'_>> {
    let mut links: HashMap<&str, &Element> = HashMap::new();
    for link in root.all("link") {
        if links.insert(link.needed("name")?, link).is_some() {
            return Err(link.wrong("another link has this name, expected names that differ"));
        }
    }
    if links.len() > build::MOST_LINKS {
        return Err(root.wrong(format!("more than {} links", build::MOST_LINKS)));
    }
    if links.is_empty() {
        return Err(root.wrong("no link, expected at least one"));
    }
    let mut edges: HashMap<&str, Edge<'_>> = HashMap::new();
    let mut children: HashMap<&str, Vec<&str>> = HashMap::new();
    for element in root.all("joint") {
        let [parent, child] = ["parent", "child"].map(|end| element.needed_child(end).and_then(|end| end.needed("link")));
        let (parent, child) = (parent?, child?);
        for name in [parent, child] {
            if !links.contains_key(name) {
                return Err(element.wrong(format!("no link has the name {}, expected the name of a link", quoted(name))));
            }
        }
        children.entry(parent).or_default().push(child);
        if edges.insert(child, Edge { element, parent }).is_some() {
            let message = format!("the link {} is the child of two joints, expected a tree of links", quoted(child));
            return Err(element.wrong(message));
        }
    }
    let roots = root.all("link").filter(|link| link.attribute("name").is_some_and(|name| !edges.contains_key(name)));
    let mut order: Vec<&Element> = roots.collect();
    let mut next = 0;
    while let Some(element) = order.get(next) {
        let name = element.attribute("name").unwrap_or_default();
        order.extend(children.remove(name).unwrap_or_default().into_iter().filter_map(|child| links.get(child).copied()));
        next += 1;
    }
    if order.len() < links.len() {
        // Every link that is not reached has a parent, so going up ends in a loop.
        let reached: HashSet<&str> = order.iter().filter_map(|link| link.attribute("name")).collect();
        let lost = root.all("joint").find(|joint| ends(joint).is_some_and(|[_, child]| !reached.contains(child)));
        let lost = lost.unwrap_or(root);
        return Err(lost.wrong("the links form a loop, expected a tree with a root"));
    }
    Ok((order, edges))
}

/// Whether links with mass are fixed to a root.
fn has_fixed_mass(root: &str, order: &[&Element], edges: &HashMap<&str, Edge<'_>>) -> bool {
    let mass = |link: &Element| link.child("inertial")?.child("mass")?.number("value").ok()?;
    let mut merged = HashSet::from([root]);
    order.iter().filter_map(|link| Some((*link, link.attribute("name")?))).any(|(link, name)| {
        let is_fixed = |edge: &Edge<'_>| edge.element.attribute("type") == Some("fixed") && merged.contains(edge.parent);
        let is_part = name == root || edges.get(name).is_some_and(is_fixed);
        if is_part {
            merged.insert(name);
        }
        is_part && mass(link).is_some_and(|mass| mass > 0.0)
    })
}

fn ends(joint: &Element) -> Option<[&str; 2]> {
    let end = |name: &str| joint.child(name)?.attribute("link");
    Some([end("parent")?, end("child")?])
}

fn sizes(shape: &Element) -> Result<DVec3> {
    let size = DVec3::from_array(shape.numbers("size", shape.needed("size")?)?);
    size.to_array().into_iter().try_for_each(|size| positive(shape, "size", size).map(|_| ()))?;
    Ok(size)
}

pub(crate) fn positive(element: &Element, name: &str, number: f64) -> Result<f64> {
    if number > 0.0 {
        return Ok(number);
    }
    Err(element.wrong(format!("{name}={number} is not allowed, expected a number greater than 0")))
}

pub(crate) fn not_negative(element: &Element, name: &str, number: f64) -> Result<f64> {
    if number >= 0.0 {
        return Ok(number);
    }
    Err(element.wrong(format!("{name}={number} is not allowed, expected a number that is not negative")))
}

/// The pose of the element `<origin>`.
fn origin(element: &Element) -> Result<Pose> {
    let Some(origin) = element.child("origin") else { return Ok(Pose::NONE) };
    let at = origin.vector("xyz")?.unwrap_or(DVec3::ZERO);
    let angles = origin.vector("rpy")?.unwrap_or(DVec3::ZERO);
    // Roll, pitch and yaw about the axes of the parent.
    Ok(Pose { at, turn: DQuat::from_euler(EulerRot::ZYX, angles.z, angles.y, angles.x) })
}

fn inertial(element: &Element) -> Result<Mass> {
    let given = element.needed_child("mass")?;
    let mass = not_negative(given, "value", given.one("value", given.needed("value")?)?)?;
    let mut elements = [0.0; 6];
    if let Some(inertia) = element.child("inertia") {
        for (element, key) in elements.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
            *element = inertia.number(key)?.unwrap_or(0.0);
        }
    }
    if mass <= 0.0 {
        return Ok(Mass::NONE);
    }
    let mass = Mass { mass, centre: DVec3::ZERO, inertia: Mass::tensor(elements) };
    Ok(mass.moved(&origin(element)?))
}
