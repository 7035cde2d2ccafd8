//! Boxes of shapes. Only the contact law `rigid` takes them (docs/physics section 1.5).

use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};

use super::solid::Part;
use super::{Shape, ShapeSphere};
use crate::error::Result;
use crate::scene::checks::invalid;
use crate::scene::{Cuboid, Tag};

/// A box of a [`Shape`], in its coordinates. Edges and corners are sharp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShapeBox {
    /// Corner, edges, group and material. A box of a shape has no motion and no surface velocity of its own.
    pub cuboid: Cuboid,
    /// Name, colour, look and label, before those of the body.
    pub(crate) tag: Option<Arc<Tag>>,
}

/// Where a box is in the coordinates of its shape, in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Core {
    /// Centre.
    pub(crate) centre: DVec3,
    /// Turns coordinates along the edges of the box into those of the shape.
    pub(crate) turn: DQuat,
    /// Half the lengths of its edges.
    pub(crate) half: DVec3,
}

impl Core {
    /// The corners: bit k of the number of a corner is the side along edge k.
    pub(crate) fn vertices(self) -> impl Iterator<Item = DVec3> {
        let side = |vertex: u32, axis: u32| if vertex >> axis & 1 == 1 { 1.0 } else { -1.0 };
        (0..8).map(move |v| self.centre + self.turn * (self.half * DVec3::new(side(v, 0), side(v, 1), side(v, 2))))
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
        Err(invalid("shape.rounding", rounding, "a radius less than half the shortest edge, and at least 0"))
    }

    pub(crate) fn core(&self) -> Core {
        let (centre, turn, half) = self.cuboid.frame();
        Core { centre, turn, half }
    }

    /// Volume in units³.
    pub(crate) fn volume(&self) -> f64 {
        8.0 * self.core().half.element_product()
    }

    pub(super) fn part(&self) -> Part {
        let Core { centre, turn, half } = self.core();
        Part::cuboid(centre, turn, half)
    }

    /// The sphere about the centre that contains the box. It stands for the box in the scene.
    fn sphere(&self) -> ShapeSphere {
        let core = self.core();
        let Cuboid { group, material, .. } = self.cuboid;
        let (centre, radius) = (core.centre.as_vec3(), core.half.length() as f32);
        ShapeSphere { centre, radius, group, material, tag: self.tag.clone() }
    }
}

impl Shape {
    /// All spheres of a body of this shape: those of the shape, then one for each box, then one for each hull.
    pub(crate) fn all_spheres(&self) -> Vec<ShapeSphere> {
        let of_boxes = self.boxes.iter().map(ShapeBox::sphere);
        self.spheres.iter().cloned().chain(of_boxes).chain(self.spheres_of_hulls()).collect()
    }

    /// Number of spheres of a body of this shape: those of the shape, and one for each box and each hull.
    pub fn sphere_count(&self) -> usize {
        self.first_hull() + self.hulls.len()
    }

    /// The number of the box that a sphere of [`Shape::all_spheres`] stands for.
    pub(crate) fn box_of_sphere(&self, sphere: usize) -> Option<usize> {
        sphere.checked_sub(self.spheres.len()).filter(|number| *number < self.boxes.len())
    }
}
