//! Static objects: boxes and polygons.

use glam::{DMat3, DQuat, DVec3, Vec3};

use crate::error::{Error, Result};
use crate::scene::checks::{finite, invalid};
use crate::scene::materials::MaterialId;
use crate::scene::motion::MotionId;
use crate::scene::registry::Handle;
use crate::scene::surface::Surface;

/// Handle of a [`Cuboid`].
pub type BoxId = Handle<Cuboid>;
/// Handle of a [`Polygon`].
pub type PolygonId = Handle<Polygon>;

/// A box, static or moving on a prescribed path: a corner and the three orthogonal edges that meet there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Cuboid {
    /// A corner P, in units.
    pub corner: Vec3,
    /// The edges I, J, K from that corner, in units.
    pub edges: [Vec3; 3],
    /// Collision group. Objects of different groups never touch.
    pub group: u16,
    /// Material; `None` for an object to whose contacts the constants of the scene apply.
    pub material: Option<MaterialId>,
    /// Motion that it follows; `None` for an object that never moves. Corner and edges are those at rest.
    pub motion: Option<MotionId>,
    /// Velocity of its surface, like that of a conveyor, in units/s. The part along the normal of a contact has no effect.
    pub surface_velocity: Vec3,
}

impl Cuboid {
    /// Creates a box from a corner and three orthogonal edges, in units.
    pub fn new(corner: impl Into<Vec3>, i: impl Into<Vec3>, j: impl Into<Vec3>, k: impl Into<Vec3>) -> Self {
        let edges = [i.into(), j.into(), k.into()];
        Self { corner: corner.into(), edges, group: 0, material: None, motion: None, surface_velocity: Vec3::ZERO }
    }

    /// Creates an axis-aligned box between two opposite corners, in units.
    pub fn between(min: impl Into<Vec3>, max: impl Into<Vec3>) -> Self {
        let min = min.into();
        let size = max.into() - min;
        Self::new(min, Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z)
    }

    /// Sets the group.
    pub fn group(mut self, group: u16) -> Self {
        self.group = group;
        self
    }

    /// Sets the material.
    pub fn material(mut self, material: MaterialId) -> Self {
        self.material = Some(material);
        self
    }

    /// Lets it follow a motion.
    pub fn motion(mut self, motion: MotionId) -> Self {
        self.motion = Some(motion);
        self
    }

    /// Sets the velocity of its surface, in units/s.
    pub fn surface_velocity(mut self, velocity: impl Into<Vec3>) -> Self {
        self.surface_velocity = velocity.into();
        self
    }

    /// Its centre, the turn that takes the axes to the directions of its edges, and half their lengths.
    pub(crate) fn frame(&self) -> (DVec3, DQuat, DVec3) {
        let [i, j, k] = self.edges.map(|edge| edge.as_dvec3());
        let half = 0.5 * DVec3::new(i.length(), j.length(), k.length());
        (self.corner.as_dvec3() + 0.5 * (i + j + k), upright(i, j), half)
    }

    pub(crate) fn validate(&self) -> Result<()> {
        finite("box.corner", self.corner)?;
        finite("box.surface_velocity", self.surface_velocity)?;
        for edge in self.edges {
            usable_edge("box.edge", edge)?;
        }
        let [i, j, k] = self.edges.map(Vec3::as_dvec3);
        let pairs = [("i and j", i, j), ("j and k", j, k), ("k and i", k, i)];
        let cosines = pairs.map(|(names, one, other)| (names, one.normalize().dot(other.normalize())));
        let wrong = cosines.iter().filter(|(_, cosine)| cosine.abs() > 1e-4);
        let degrees = |cosine: &f64| (1e4 * cosine.acos().to_degrees()).round() / 1e4;
        let wrong: Vec<String> = wrong.map(|(names, cosine)| format!("{} degrees between {names}", degrees(cosine))).collect();
        if wrong.is_empty() {
            return Ok(());
        }
        Err(Error::Invalid {
            field: "box.edges",
            value: format!("{:?} with {}", self.edges.map(|edge| edge.to_array()), wrong.join(", ")),
            expected: "three edges at right angles to each other",
        })
    }
}

/// The turn that takes the axes x and y to the directions of two edges. Edges may be off right angles by rounding, and left-handed.
pub(crate) fn upright(i: DVec3, j: DVec3) -> DQuat {
    let x = i.normalize();
    let y = (j - x * j.dot(x)).normalize();
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize()
}

/// A surface, static or moving on a prescribed path, given by a corner and two edges: a parallelogram, a triangle, or a smooth wall (plane, cone,
/// cylinder, ball). [`Surface`] says what it consists of and on which side it is touched.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Polygon {
    /// A corner P, in units.
    pub corner: Vec3,
    /// Edge L from that corner, in units.
    pub left: Vec3,
    /// Edge R from that corner, in units.
    pub right: Vec3,
    /// What the corner and the edges stand for.
    pub surface: Surface,
    /// Collision group. Objects of different groups never touch.
    pub group: u16,
    /// Material; `None` for an object to whose contacts the constants of the scene apply.
    pub material: Option<MaterialId>,
    /// Motion that it follows; `None` for an object that never moves. Corner and edges are those at rest.
    pub motion: Option<MotionId>,
    /// Velocity of its surface, like that of a conveyor, in units/s. The part along the normal of a contact has no effect.
    pub surface_velocity: Vec3,
}

impl Polygon {
    /// Creates a parallelogram from a corner and two edges that are not parallel, in units.
    pub fn new(corner: impl Into<Vec3>, left: impl Into<Vec3>, right: impl Into<Vec3>) -> Self {
        let (corner, left, right) = (corner.into(), left.into(), right.into());
        let (surface, group, surface_velocity) = (Surface::Parallelogram, 0, Vec3::ZERO);
        Self { corner, left, right, surface, group, material: None, motion: None, surface_velocity }
    }

    /// Whether it is a triangle.
    pub fn is_triangle(&self) -> bool {
        self.surface == Surface::Triangle
    }

    /// The vertices of a parallelogram or triangle in order around the edge, in units: 4 or 3. Those of a smooth wall have no meaning.
    pub fn vertices(&self) -> impl Iterator<Item = Vec3> + use<> {
        let Self { corner, left, right, .. } = *self;
        let far = (!self.is_triangle()).then_some(corner + left + right);
        [corner, corner + left].into_iter().chain(far).chain([corner + right])
    }

    /// Creates a triangle from its vertices, in units.
    pub fn triangle(a: impl Into<Vec3>, b: impl Into<Vec3>, c: impl Into<Vec3>) -> Self {
        let corner = a.into();
        Self { surface: Surface::Triangle, ..Self::new(corner, b.into() - corner, c.into() - corner) }
    }

    /// Sets the group.
    pub fn group(mut self, group: u16) -> Self {
        self.group = group;
        self
    }

    /// Sets the material.
    pub fn material(mut self, material: MaterialId) -> Self {
        self.material = Some(material);
        self
    }

    /// Lets it follow a motion.
    pub fn motion(mut self, motion: MotionId) -> Self {
        self.motion = Some(motion);
        self
    }

    /// Sets the velocity of its surface, in units/s.
    pub fn surface_velocity(mut self, velocity: impl Into<Vec3>) -> Self {
        self.surface_velocity = velocity.into();
        self
    }

    /// Whether both edges are parallel within 1e-4 rad.
    pub(super) fn has_parallel_edges(&self) -> bool {
        let (left, right) = (self.left.as_dvec3(), self.right.as_dvec3());
        left.cross(right).length() < 1e-4 * left.length() * right.length()
    }

    pub(crate) fn validate(&self) -> Result<()> {
        finite("polygon.corner", self.corner)?;
        finite("polygon.surface_velocity", self.surface_velocity)?;
        usable_edge("polygon.left", self.left)?;
        usable_edge("polygon.right", self.right)?;
        if self.has_parallel_edges() {
            return Err(invalid("polygon.right", self.right.to_array(), "an edge that is not parallel to the first"));
        }
        self.validate_smooth()
    }
}

/// Checks the length of an edge, because the kernels divide by squared edge lengths in f32.
fn usable_edge(field: &'static str, edge: Vec3) -> Result<()> {
    let square = edge.length_squared();
    if edge.is_finite() && (1e-30..1e30).contains(&square) {
        Ok(())
    } else {
        Err(invalid(field, edge.to_array(), "an edge with a length between 1e-15 and 1e15"))
    }
}
