//! Shapes of rigid bodies: spheres, rods, boxes and convex hulls in coordinates of their own, with mass, centre and inertia.

use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};

use super::tag::check_name;
use super::{Cuboid, Handle, MaterialId, Scene, Tag, shared};
use crate::error::{Error, Result, quoted};
use crate::scene::checks::{finite, invalid, positive};

mod boxes;
mod hulls;
mod mass;
mod solid;

pub(crate) use boxes::Core;
pub use boxes::ShapeBox;
pub use hulls::ShapeHull;
pub use mass::MassProperties;
use solid::{Part, Solid};

/// Handle of a [`Shape`].
pub type ShapeId = Handle<Shape>;

/// Greatest number of spheres, rods, boxes and hulls of a shape.
const MOST_PARTS: usize = 1_000;

/// What rigid bodies are made of: spheres, rods between them, boxes, and convex hulls. Many bodies share one shape.
///
/// Parts have coordinates of the shape, in units. They may overlap. The matter of the shape fills the parts evenly; where
/// parts overlap, it counts once.
///
/// ```
/// # fn main() -> rockfall::Result<()> {
/// use rockfall::{Placement, Scene, Shape};
///
/// let mut scene = Scene::new();
/// let dimer = scene.add_shape(Shape::new().sphere([0.0, 0.0, 0.0], 0.5).sphere([0.7, 0.0, 0.0], 0.4).density(2.0))?;
/// let body = scene.add_body(Placement::new(dimer).at([0.0, 3.0, 0.0]))?;
/// assert_eq!(scene.body(body)?.spheres().len(), 2);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shape {
    /// Name, which no other shape of the scene has. It is one word without `=`, `,` and `#`, and begins with a letter or `_`.
    pub name: Option<String>,
    /// The spheres.
    pub spheres: Vec<ShapeSphere>,
    /// The rods.
    pub rods: Vec<ShapeRod>,
    /// The boxes.
    pub boxes: Vec<ShapeBox>,
    /// The convex hulls.
    pub hulls: Vec<ShapeHull>,
    /// Rounding radius of all boxes, in units. It is kept in files and has no effect: edges are sharp.
    pub rounding: f32,
    /// What the mass properties follow from.
    pub mass: ShapeMass,
    /// Group of the parts that are added next.
    group: u16,
    /// Material of the parts that are added next.
    material: Option<MaterialId>,
    /// Name, colour, look and label of the parts that are added next.
    tag: Option<Arc<Tag>>,
}

/// A sphere of a [`Shape`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShapeSphere {
    /// Centre in coordinates of the shape, in units.
    pub centre: Vec3,
    /// Radius in units, greater than 0.
    pub radius: f32,
    /// Collision group. Objects of different groups never touch.
    pub group: u16,
    /// Material; `None` for an object to whose contacts the constants of the scene apply.
    pub material: Option<MaterialId>,
    /// Name, colour, look and label, before those of the body.
    pub(crate) tag: Option<Arc<Tag>>,
}

/// A rod of a [`Shape`]: a solid cylinder between the centres of two spheres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShapeRod {
    /// Number of the sphere at end 1, from 0.
    pub end1: usize,
    /// Number of the sphere at end 2, from 0.
    pub end2: usize,
    /// Radius in units, greater than 0.
    pub radius: f32,
    /// Collision group. Objects of different groups never touch.
    pub group: u16,
    /// Material; `None` for an object to whose contacts the constants of the scene apply.
    pub material: Option<MaterialId>,
    /// Name, colour, look and label, before those of the body.
    pub(crate) tag: Option<Arc<Tag>>,
}

/// What the mass properties of a [`Shape`] follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ShapeMass {
    /// The mass.
    Mass(f32),
    /// The density, in mass/units³.
    Density(f32),
    /// All mass properties.
    Given {
        /// Mass.
        mass: f32,
        /// Centre of mass in coordinates of the shape, in units.
        centre: Vec3,
        /// Inertia xx, yy, zz, xy, xz, yz about the centre along the axes of the shape, in mass units². The last three are elements
        /// of the tensor, which are minus the products of inertia.
        inertia: [f32; 6],
    },
}

/// How a body of a shape moves: the mass properties with the principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kinetics {
    pub(crate) mass: f64,
    /// Centre of mass in coordinates of the shape.
    pub(crate) centre: DVec3,
    /// Principal moments of inertia about the centre.
    pub(crate) moments: DVec3,
    /// Turns coordinates along the principal axes into those of the shape.
    pub(crate) axes: DQuat,
}

impl Default for Shape {
    fn default() -> Self {
        Self::new()
    }
}

impl Shape {
    /// Creates a shape of mass 1 without parts.
    pub fn new() -> Self {
        let mass = ShapeMass::Mass(1.0);
        let (spheres, rods, boxes, hulls) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { name: None, spheres, rods, boxes, hulls, rounding: 0.0, mass, group: 0, material: None, tag: None }
    }

    /// Sets the name.
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Adds a sphere. Centre and radius are in units.
    pub fn sphere(mut self, centre: impl Into<Vec3>, radius: f32) -> Self {
        let (group, material, tag) = (self.group, self.material, self.tag.clone());
        self.spheres.push(ShapeSphere { centre: centre.into(), radius, group, material, tag });
        self
    }

    /// Adds a rod between the spheres number `a` and `b` of the shape, from 0. The radius is in units.
    pub fn rod(mut self, a: usize, b: usize, radius: f32) -> Self {
        let (group, material, tag) = (self.group, self.material, self.tag.clone());
        self.rods.push(ShapeRod { end1: a, end2: b, radius, group, material, tag });
        self
    }

    /// Adds a capsule: two spheres and a rod. Ends and radius are in units.
    pub fn capsule(self, end1: impl Into<Vec3>, end2: impl Into<Vec3>, radius: f32) -> Self {
        let first = self.spheres.len();
        self.sphere(end1, radius).sphere(end2, radius).rod(first, first + 1, radius)
    }

    /// Adds a box. Its corner and edges are in units. Only the contact law `rigid` takes bodies with boxes. The group and
    /// the material are those of the shape.
    pub fn cuboid(mut self, cuboid: Cuboid) -> Self {
        let cuboid = Cuboid { group: self.group, material: self.material, ..cuboid };
        self.boxes.push(ShapeBox { cuboid, tag: self.tag.clone() });
        self
    }

    /// Sets the rounding radius of all boxes, in units, less than half the shortest edge. It has no effect.
    pub fn rounding(mut self, radius: f32) -> Self {
        self.rounding = radius;
        self
    }

    /// Sets the mass.
    pub fn mass(mut self, mass: f32) -> Self {
        self.mass = ShapeMass::Mass(mass);
        self
    }

    /// Sets the density, in mass/units³.
    pub fn density(mut self, density: f32) -> Self {
        self.mass = ShapeMass::Density(density);
        self
    }

    /// Sets all mass properties: mass, centre in coordinates of the shape in units, and inertia xx, yy, zz, xy, xz, yz about the centre
    /// in mass units² ([`ShapeMass::Given`]).
    pub fn mass_properties(mut self, mass: f32, centre: impl Into<Vec3>, inertia: [f32; 6]) -> Self {
        self.mass = ShapeMass::Given { mass, centre: centre.into(), inertia };
        self
    }

    /// Sets the material of the parts that are added after it.
    pub fn material(mut self, material: MaterialId) -> Self {
        self.material = Some(material);
        self
    }

    /// Sets the group of the parts that are added after it.
    pub fn group(mut self, group: u16) -> Self {
        self.group = group;
        self
    }

    /// Sets the name, colour, look and label of the parts that are added after it. What it leaves open, a part gets from its body.
    pub fn tag(mut self, tag: Tag) -> Self {
        self.tag = shared(tag);
        self
    }

    /// Sets what the parts that are added next belong to.
    pub(crate) fn with(mut self, group: u16, material: Option<MaterialId>, tag: Option<Arc<Tag>>) -> Self {
        (self.group, self.material, self.tag) = (group, material, tag);
        self
    }

    /// Computes mass, centre and inertia: as given, or of matter that fills the parts evenly. Where parts overlap, it counts once.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a shape without parts or with more than 1000 parts, numbers that are not finite, a mass, density or radius
    /// that is not positive, a rod without two different spheres at a distance, and an inertia that no body has.
    pub fn mass_properties_of(&self) -> Result<MassProperties> {
        self.validate_parts()?;
        let properties = match self.mass {
            ShapeMass::Given { mass, centre, inertia } => {
                let centre = centre.to_array().map(f64::from);
                MassProperties { mass: mass.into(), centre, inertia: inertia.map(f64::from) }
            }
            ShapeMass::Mass(mass) => {
                positive("shape.mass", mass)?;
                let solid = self.solid().properties();
                solid.scaled(f64::from(mass) / solid.mass)
            }
            ShapeMass::Density(density) => {
                positive("shape.density", density)?;
                self.solid().properties().scaled(density.into())
            }
        };
        properties.validate()?;
        Ok(properties)
    }

    fn solid(&self) -> Solid {
        let centre = |sphere: usize| self.spheres[sphere].centre.as_dvec3();
        let spheres = self.spheres.iter().map(|sphere| Part::sphere(sphere.centre.as_dvec3(), sphere.radius.into()));
        let rods = self.rods.iter().map(|rod| Part::cylinder(centre(rod.end1), centre(rod.end2), rod.radius.into()));
        let (boxes, hulls) = (self.boxes.iter().map(ShapeBox::part), self.hulls.iter().map(ShapeHull::part));
        Solid::new(spheres.chain(rods).chain(boxes).chain(hulls).collect())
    }

    /// Checks the sphere, the rod and the box that were added last.
    pub(crate) fn validate_last(&self) -> Result<()> {
        self.spheres.last().map_or(Ok(()), ShapeSphere::validate)?;
        self.rods.last().map_or(Ok(()), |rod| self.validate_rod(rod))?;
        self.boxes.last().map_or(Ok(()), |part| part.validate(self.rounding))
    }

    fn validate_rod(&self, rod: &ShapeRod) -> Result<()> {
        positive("shape.rod.radius", rod.radius)?;
        let ends = [rod.end1, rod.end2].map(|end| self.spheres.get(end).map(|sphere| sphere.centre.as_dvec3()));
        match ends {
            [Some(a), Some(b)] if a.distance(b) > 0.0 => Ok(()),
            _ => {
                let expected = "the numbers, from 0, of two spheres of the shape with different centres";
                Err(invalid("shape.rod", [rod.end1, rod.end2], expected))
            }
        }
    }

    fn validate_parts(&self) -> Result<()> {
        if let Some(name) = &self.name {
            check_name("shape.name", name)?;
        }
        let solids = self.spheres.len() + self.boxes.len() + self.hulls.len();
        let parts = solids + self.rods.len();
        if solids == 0 || parts > MOST_PARTS {
            let expected = "at least one sphere, box or hull, and at most 1000 spheres, rods, boxes and hulls";
            return Err(invalid("shape.parts", parts, expected));
        }
        self.spheres.iter().try_for_each(ShapeSphere::validate)?;
        self.rods.iter().try_for_each(|rod| self.validate_rod(rod))?;
        self.boxes.iter().try_for_each(|part| part.validate(self.rounding))?;
        let tags = self.spheres.iter().map(|sphere| &sphere.tag).chain(self.rods.iter().map(|rod| &rod.tag));
        let tags = tags.chain(self.boxes.iter().map(|part| &part.tag)).chain(self.hulls.iter().map(|hull| &hull.tag));
        tags.flatten().try_for_each(|tag| tag.validate())
    }
}

impl ShapeSphere {
    fn validate(&self) -> Result<()> {
        finite("shape.sphere.centre", self.centre)?;
        positive("shape.sphere.radius", self.radius)
    }
}

impl Kinetics {
    pub(crate) fn of(properties: &MassProperties) -> Self {
        let (moments, axes) = properties.principal();
        Self { mass: properties.mass, centre: DVec3::from_array(properties.centre), moments, axes }
    }
}

impl Scene {
    /// Adds a shape, and computes its mass properties.
    ///
    /// # Errors
    /// [`Error::Invalid`] as for [`Shape::mass_properties_of`], and for a name that another shape has. [`Error::StaleHandle`] for a
    /// material that is not in the scene.
    pub fn add_shape(&mut self, shape: Shape) -> Result<ShapeId> {
        let materials = shape.spheres.iter().map(|sphere| sphere.material).chain(shape.rods.iter().map(|rod| rod.material));
        let materials = materials.chain(shape.boxes.iter().map(|part| part.cuboid.material));
        let materials = materials.chain(shape.hulls.iter().map(ShapeHull::material));
        for material in materials {
            self.material_number(material)?;
        }
        if let Some(name) = shape.name.as_deref().filter(|name| self.find_shape(name).is_some()) {
            let expected = "a name that no other shape has";
            return Err(Error::Invalid { field: "shape.name", value: quoted(name), expected });
        }
        self.kinetics.push(Kinetics::of(&shape.mass_properties_of()?));
        Ok(self.shapes.add(shape))
    }

    /// The shape of a name.
    pub fn find_shape(&self, name: &str) -> Option<ShapeId> {
        let index = self.shapes.objects().iter().position(|shape| shape.name.as_deref() == Some(name))?;
        Some(self.shapes.handle_at(index))
    }

    /// The greatest distance of a point of a shape from its centre of mass.
    pub(crate) fn shape_reach(&self, id: ShapeId) -> Result<f64> {
        let (shape, centre) = (self.shapes.get(id)?, self.shape_mass(id)?.centre);
        let place = |number: usize| shape.spheres[number].centre.as_dvec3();
        let spheres = (0..shape.spheres.len()).map(|number| (number, shape.spheres[number].radius));
        let rods = shape.rods.iter().flat_map(|rod| [(rod.end1, rod.radius), (rod.end2, rod.radius)]);
        let reach = |(number, radius): (usize, f32)| place(number).distance(centre) + f64::from(radius);
        let corners = shape.boxes.iter().flat_map(|part| part.core().vertices());
        let of_boxes = corners.map(|corner| corner.distance(centre));
        Ok(spheres.chain(rods).map(reach).chain(of_boxes).fold(shape.reach_of_hulls(centre), f64::max))
    }

    /// How bodies of a shape move.
    pub(crate) fn shape_mass(&self, id: ShapeId) -> Result<&Kinetics> {
        // Shapes are never removed, so both lists have the same order.
        Ok(&self.kinetics[self.shapes.index(id)?])
    }
}

/// The mass properties of a solid capsule about its middle. `length` is that of its axis, along x.
pub(super) fn capsule_along_x(mass: f64, length: f64, radius: f64) -> MassProperties {
    let [a, b] = [-0.5, 0.5].map(|place| place * length * DVec3::X);
    let solid = Solid::new(vec![Part::sphere(a, radius), Part::sphere(b, radius), Part::cylinder(a, b, radius)]).properties();
    solid.scaled(mass / solid.mass)
}
