//! `<geom>`.

use rockfall::glam::{DQuat, DVec3};

use super::Mjcf;
use super::defaults::Attributes;
use crate::error::Result;
use crate::mass::Pose;
use crate::model::{Friction, Geom, Mask};
use crate::solid::Solid;
use crate::urdf::{not_negative, positive};
use crate::xml::{Element, quoted};

/// Density of geoms that have none, in kg/m³.
const DENSITY: f64 = 1000.0;

impl Mjcf<'_> {
    pub(super) fn geom(&mut self, element: &Element, link: usize, frame: Pose, class: usize) -> Result<()> {
        let Some((solid, pose)) = self.solid(element, class)? else { return Ok(()) };
        let of = self.attributes(element, class)?;
        let kind = of.bits("contype")?.unwrap_or(1);
        let affinity = of.bits("conaffinity")?.unwrap_or(1);
        let coefficient = not_negative(element, "friction", of.first("friction")?.unwrap_or(1.0))?;
        let friction = Friction { coefficient, is_smooth: of.bits("condim")? == Some(1) };
        let pose = frame.then(&pose);
        let group = of.number("group")?.unwrap_or(0.0);
        let mut mass = match of.number("mass")? {
            Some(mass) => {
                let solid = solid.mass(1.0);
                let wanted = not_negative(element, "mass", mass)?;
                if solid.mass > 0.0 { solid.scaled(wanted / solid.mass) } else { solid }
            }
            None => solid.mass(not_negative(element, "density", of.number("density")?.unwrap_or(DENSITY))?),
        };
        if of.get("shellinertia") == Some("true") {
            self.notes.ignored_attribute(element, "shellinertia");
        }
        let [least, greatest] = self.compiler.inertia_groups;
        if (least..=greatest).contains(&group) && link > 0 {
            mass = mass.moved(&pose);
            self.links[link].mass = self.links[link].mass.and(&mass);
        }
        let element = element.alone();
        self.links[link].geoms.push(Geom { element, pose, solid, mask: Mask { kind, affinity }, friction: Some(friction) });
        Ok(())
    }

    /// The solid and its pose in the body. `None`, with a note, for what a scene does not have.
    fn solid(&mut self, element: &Element, class: usize) -> Result<Option<(Solid, Pose)>> {
        let of = self.attributes(element, class)?;
        let mesh = of.get("mesh").map(str::to_owned);
        let kind = of.get("type").unwrap_or(if mesh.is_some() { "mesh" } else { "sphere" }).to_owned();
        let mut pose = self.compiler.pose(&of)?;
        let size = Sizes { of, sizes: of.list("size")?.unwrap_or_default() };
        let along = of.numbers::<6>("fromto")?.map(|[a, b, c, d, e, f]| (DVec3::new(a, b, c), DVec3::new(d, e, f)));
        let half = match along {
            Some((from, to)) => {
                let line = to - from;
                let direction = line.try_normalize();
                let direction = direction.ok_or_else(|| element.wrong("fromto has equal ends, expected two points"))?;
                pose = Pose { at: (from + to) / 2.0, turn: DQuat::from_rotation_arc(DVec3::Z, direction) };
                Some(line.length() / 2.0)
            }
            None => None,
        };
        let solid = match kind.as_str() {
            "sphere" => Solid::Sphere { radius: size.at(0)? },
            "capsule" => Solid::Capsule { radius: size.at(0)?, half: half.map_or_else(|| size.at(1), Ok)? },
            "cylinder" => Solid::Cylinder { radius: size.at(0)?, half: half.map_or_else(|| size.at(1), Ok)? },
            "box" => Solid::Box { half: size.three(half)? },
            "ellipsoid" => Solid::Ellipsoid { radii: size.three(half)? },
            "plane" => Solid::Plane,
            "mesh" => {
                let Some(mesh) = mesh else { return Err(element.wrong("no attribute mesh, expected the name of a mesh")) };
                match self.mesh(element, &mesh)? {
                    Some(points) => Solid::Mesh(points),
                    None => return Ok(None),
                }
            }
            "hfield" | "sdf" => {
                self.notes.add(element, format!("the geom of the type {kind} is left out"));
                return Ok(None);
            }
            _ => {
                let expected = "expected plane, sphere, capsule, ellipsoid, cylinder, box or mesh";
                return Err(element.wrong(format!("type={} is unknown, {expected}", quoted(&kind))));
            }
        };
        Ok(Some((solid, pose)))
    }
}

struct Sizes<'a> {
    of: Attributes<'a>,
    sizes: Vec<f64>,
}

impl Sizes<'_> {
    fn at(&self, place: usize) -> Result<f64> {
        let element = self.of.element;
        let size = self.sizes.get(place).copied();
        let size =
            size.ok_or_else(|| element.wrong(format!("size has {} numbers, expected {}", self.sizes.len(), place + 1)))?;
        positive(element, "size", size)
    }

    /// Half of the edges; with `fromto`, the first size holds for both of the others.
    fn three(&self, half: Option<f64>) -> Result<DVec3> {
        Ok(match half {
            Some(half) => DVec3::new(self.at(0)?, self.at(0)?, half),
            None => DVec3::new(self.at(0)?, self.at(1)?, self.at(2)?),
        })
    }
}
