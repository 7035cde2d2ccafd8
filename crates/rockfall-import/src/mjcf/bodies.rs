//! `<worldbody>`, `<body>` and `<frame>`.

use rockfall::glam::DVec3;

use super::Mjcf;
use super::compiler::InertiaFrom;
use crate::error::Result;
use crate::mass::{Mass, Pose};
use crate::model::Link;
use crate::urdf::not_negative;
use crate::xml::{Element, quoted};

impl Mjcf<'_> {
    /// Reads what is in a body. `frame` is the pose of a frame around the elements.
    pub(super) fn body_of(&mut self, element: &Element, link: usize, frame: Pose, class: usize) -> Result<()> {
        for child in &element.children {
            match child.name.as_str() {
                "body" => self.body(child, link, frame, class)?,
                "frame" => {
                    let class = self.defaults.class(child, "childclass")?.unwrap_or(class);
                    let pose = self.compiler.pose(&self.attributes(child, class)?)?;
                    self.body_of(child, link, frame.then(&pose), class)?;
                }
                "geom" => self.geom(child, link, frame, class)?,
                "joint" | "freejoint" if link > 0 => self.joint(child, link, frame, class)?,
                // The inertia is read with the body. The others do not act on bodies.
                "inertial" | "site" | "camera" | "light" => {}
                "replicate" | "attach" | "composite" | "flexcomp" => {
                    self.notes.add(child, "it is not taken over, and neither are the bodies that it makes");
                }
                _ => self.notes.ignored(child),
            }
        }
        Ok(())
    }

    fn body(&mut self, element: &Element, parent: usize, frame: Pose, class: usize) -> Result<()> {
        let class = self.defaults.class(element, "childclass")?.unwrap_or(class);
        let pose = frame.then(&self.compiler.pose(&self.attributes(element, class)?)?);
        let number = self.links.len();
        let name = element.attribute("name").map_or_else(|| format!("body{number}"), str::to_owned);
        if self.names.insert(name.clone(), number).is_some() {
            return Err(element.wrong(format!("another body has the name {}, expected names that differ", quoted(&name))));
        }
        if element.attribute("mocap") == Some("true") {
            self.notes.add(element, "it does not follow motion capture, so it is fixed");
        }
        if element.number("gravcomp")?.is_some_and(|share| share != 0.0) {
            self.notes.ignored_attribute(element, "gravcomp");
        }
        let (element_alone, mass) = (element.alone(), Mass::NONE);
        let (joints, geoms) = (Vec::new(), Vec::new());
        self.links.push(Link { name, element: element_alone, parent: Some(parent), pose, joints, is_free: false, mass, geoms });
        self.body_of(element, number, Pose::NONE, class)?;
        let inertial = element.child("inertial");
        match (self.compiler.inertia_from, inertial) {
            (InertiaFrom::InertialOrGeoms | InertiaFrom::Inertial, Some(inertial)) => {
                self.links[number].mass = self.inertial(inertial)?;
            }
            (InertiaFrom::Inertial, None) => self.links[number].mass = Mass::NONE,
            // The sum of its geoms, which is there already.
            _ => {}
        }
        let (least_mass, least_inertia) = (self.compiler.least_mass, self.compiler.least_inertia);
        let mass = &mut self.links[number].mass;
        mass.mass = mass.mass.max(least_mass);
        for (axis, least) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip([least_inertia; 3]) {
            let lacking = (least - axis.dot(mass.inertia * axis)).max(0.0);
            mass.inertia += rockfall::glam::DMat3::from_diagonal(lacking * axis);
        }
        Ok(())
    }

    fn inertial(&mut self, element: &Element) -> Result<Mass> {
        let attributes = self.attributes(element, 0)?;
        let mass = not_negative(element, "mass", element.one("mass", element.needed("mass")?)?)?;
        let pose = self.compiler.pose(&attributes)?;
        let inertia = if let Some(all) = attributes.numbers::<6>("fullinertia")? {
            Mass::tensor(all)
        } else {
            let [x, y, z] = attributes.numbers::<3>("diaginertia")?.unwrap_or([0.0; 3]);
            Mass::tensor([x, y, z, 0.0, 0.0, 0.0])
        };
        Ok(Mass { mass, centre: DVec3::ZERO, inertia }.moved(&pose))
    }
}
