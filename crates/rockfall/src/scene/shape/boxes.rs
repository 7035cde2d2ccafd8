//! Boxes of shapes, and the spheres and rods that they are made of (docs/physics section 1.5).
//!
//! A box is rounded inward: it is its core, a smaller box, and everything within the rounding radius of it. It becomes a sphere around
//! all of it, which stands for the solid, a sphere at each vertex of the core, and a rod along each edge of the core.

use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};

use super::solid::Part;
use super::{Shape, ShapeRod, ShapeSphere};
use crate::error::Result;
use crate::scene::checks::invalid;
use crate::scene::{Cuboid, Tag};

/// The rounding radius of a box that has none of its own, as a share of the shortest edge.
const ROUNDING: f32 = 0.02;
/// Spheres of a box: the solid, and the vertices.
pub(crate) const BOX_SPHERES: usize = 9;
/// Rods of a box.
const BOX_RODS: usize = 12;

/// A box of a [`Shape`], in its coordinates.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShapeBox {
    /// Corner, edges, group and material. A box of a shape has no motion and no surface velocity of its own.
    pub cuboid: Cuboid,
    /// Name, colour, look and label, before those of the body.
    pub(crate) tag: Option<Arc<Tag>>,
}

/// The core of a box in the coordinates of its shape, in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Core {
    /// Centre.
    pub(crate) centre: DVec3,
    /// Turns coordinates along the edges of the box into those of the shape.
    pub(crate) turn: DQuat,
    /// Half the lengths of its edges.
    pub(crate) half: DVec3,
    /// The rounding radius.
    pub(crate) radius: f64,
}

/// What a sphere of a rigid body is of a box. The value is the number of the box in the shape, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxPart {
    /// The sphere around the whole box. It stands for the solid.
    Solid(usize),
    /// A vertex of the core.
    Rim(usize),
}

impl Core {
    /// Half the edges of the sharp box.
    pub(crate) fn sharp(&self) -> DVec3 {
        self.half + self.radius
    }

    /// The vertices of a box with this centre and these half edges: bit k of the number of a vertex is the side along edge k.
    pub(crate) fn vertices(self, half: DVec3) -> impl Iterator<Item = DVec3> {
        let side = |vertex: u32, axis: u32| if vertex >> axis & 1 == 1 { 1.0 } else { -1.0 };
        (0..8).map(move |v| self.centre + self.turn * (half * DVec3::new(side(v, 0), side(v, 1), side(v, 2))))
    }
}

impl ShapeBox {
    fn shortest_edge(&self) -> f32 {
        self.cuboid.edges.map(|edge| edge.length()).into_iter().fold(f32::INFINITY, f32::min)
    }

    /// `rounding` is that of the shape.
    pub(super) fn validate(&self, rounding: f32) -> Result<()> {
        self.cuboid.validate()?;
        if self.cuboid.motion.is_some() || self.cuboid.surface_velocity != Vec3::ZERO {
            return Err(invalid("shape.box", "with a motion or a surface velocity", "a box that moves with its body alone"));
        }
        if rounding >= 0.0 && rounding < 0.5 * self.shortest_edge() {
            return Ok(());
        }
        Err(invalid("shape.rounding", rounding, "a radius less than half the shortest edge, or 0 for 2 % of that edge"))
    }

    /// The core, with the rounding of the shape.
    pub(crate) fn core(&self, rounding: f32) -> Core {
        let (centre, turn, half) = self.cuboid.frame();
        let radius = f64::from(if rounding > 0.0 { rounding } else { ROUNDING * self.shortest_edge() });
        Core { centre, turn, half: half - radius, radius }
    }

    /// Volume of the sharp box, in units³.
    pub(crate) fn volume(&self) -> f64 {
        8.0 * self.core(0.0).sharp().element_product()
    }

    /// The sharp box.
    pub(super) fn part(&self) -> Part {
        let core = self.core(0.0);
        Part::cuboid(core.centre, core.turn, core.sharp())
    }

    /// The solid, and the vertices.
    fn spheres(&self, rounding: f32) -> impl Iterator<Item = ShapeSphere> + '_ {
        let core = self.core(rounding);
        let sphere = move |place: DVec3, radius: f64| ShapeSphere {
            centre: place.as_vec3(),
            radius: radius as f32,
            group: self.cuboid.group,
            material: self.cuboid.material,
            tag: self.tag.clone(),
        };
        let solid = sphere(core.centre, core.sharp().length());
        std::iter::once(solid).chain(core.vertices(core.half).map(move |place| sphere(place, core.radius)))
    }

    /// The edges, between vertices that are numbered from `first` on.
    fn rods(&self, rounding: f32, first: usize) -> impl Iterator<Item = ShapeRod> + '_ {
        let radius = self.core(rounding).radius as f32;
        let edge = move |axis: usize, other: usize| {
            // Bits of the other two axes.
            let start = (other & 1) << ((axis + 1) % 3) | (other >> 1) << ((axis + 2) % 3);
            ShapeRod {
                end1: first + start,
                end2: first + (start | 1 << axis),
                radius,
                group: self.cuboid.group,
                material: self.cuboid.material,
                tag: self.tag.clone(),
            }
        };
        (0..3).flat_map(move |axis| (0..4).map(move |other| edge(axis, other)))
    }
}

impl Shape {
    /// All spheres of a body of this shape: those of the shape, then 9 for each box, then one for each hull.
    pub(crate) fn all_spheres(&self) -> Vec<ShapeSphere> {
        let of_boxes = self.boxes.iter().flat_map(|part| part.spheres(self.rounding));
        self.spheres.iter().cloned().chain(of_boxes).chain(self.spheres_of_hulls()).collect()
    }

    /// All rods of a body of this shape: those of the shape, then 12 for each box.
    pub(crate) fn all_rods(&self) -> Vec<ShapeRod> {
        let first = |number: usize| self.spheres.len() + BOX_SPHERES * number + 1;
        let of_boxes = self.boxes.iter().enumerate().flat_map(|(number, part)| part.rods(self.rounding, first(number)));
        self.rods.iter().cloned().chain(of_boxes).collect()
    }

    /// Number of spheres of a body of this shape: those of the shape, 9 for each box, and one for each hull.
    pub fn sphere_count(&self) -> usize {
        self.first_hull() + self.hulls.len()
    }

    /// Number of rods of a body of this shape: those of the shape, and 12 for each box.
    pub fn rod_count(&self) -> usize {
        self.rods.len() + BOX_RODS * self.boxes.len()
    }

    /// What a sphere of [`Shape::all_spheres`] is of a box.
    pub(crate) fn box_of_sphere(&self, sphere: usize) -> Option<BoxPart> {
        let place = sphere.checked_sub(self.spheres.len())?;
        let number = place / BOX_SPHERES;
        if number >= self.boxes.len() {
            return None;
        }
        Some(if place % BOX_SPHERES == 0 { BoxPart::Solid(number) } else { BoxPart::Rim(number) })
    }

    /// The box that a rod of [`Shape::all_rods`] is an edge of.
    pub(crate) fn box_of_rod(&self, rod: usize) -> Option<usize> {
        Some(rod.checked_sub(self.rods.len())? / BOX_RODS)
    }
}
