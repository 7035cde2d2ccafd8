//! Shapes: a core and a radius. A shape is stored once, and many colliders share it.

mod bounds;
mod hull;
mod mass;
mod moments;
mod rounded_hull;
#[cfg(test)]
pub(crate) mod tests;

use std::sync::Arc;

use glam::Vec3;

pub(crate) use hull::BadHull;
pub(crate) use moments::{moments, outer};

/// What a shape is about. A shape is all points within its radius of the core.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Core {
    /// The origin. With a radius: a ball.
    Point,
    /// From (0, -half, 0) to (0, half, 0). With a radius: a capsule.
    Segment {
        /// Half the length, in units.
        half: f32,
    },
    /// A face in the plane z = 0 about the origin: a parallelogram with the corners -u - v, u - v, u + v and v - u, or a triangle with
    /// the corners u, v and -u - v. Touched on both sides, or only on that of +z.
    Face {
        /// Of a parallelogram half of one edge, of a triangle a corner; z is 0.
        u: Vec3,
        /// Of a parallelogram half of the other edge, of a triangle the next corner counterclockwise; z is 0.
        v: Vec3,
        /// Whether it is a triangle.
        is_triangle: bool,
        /// Touched only from z > 0.
        one_sided: bool,
        /// Balls do not touch it. It is a part of a smooth wall, which they touch itself.
        is_facet: bool,
    },
    /// A box about the origin along the axes.
    Box {
        /// Half the edges, in units.
        half: Vec3,
    },
    /// A convex hull.
    Hull(Arc<Hull>),
    /// The half-space y <= 0. Only for bodies without mass.
    HalfSpace,
    /// A cylinder or a cone without caps about the y axis. Only balls touch it, and only bodies without mass have it.
    Cone {
        /// Half the length of the axis, in units.
        half: f32,
        /// The radii at y = -half and y = half, in units.
        radii: [f32; 2],
        /// Touched from inside, else from outside.
        inside: bool,
    },
    /// A sphere about the origin that is touched from inside. Only balls touch it, and only bodies without mass have it.
    Bowl {
        /// In units.
        radius: f32,
    },
}

/// A convex hull with at most [`MOST_FACES`] faces, about its own centre of mass.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hull {
    /// Vertices, in units.
    pub(crate) vertices: Vec<Vec3>,
    /// Faces: outward unit normal, and the vertices counterclockwise from outside.
    pub(crate) faces: Vec<(Vec3, Vec<u8>)>,
    /// Edges: the two vertices and the two faces beside them.
    pub(crate) edges: Vec<[u8; 4]>,
}

/// Greatest number of faces of a hull.
pub(crate) const MOST_FACES: usize = 32;

/// Greatest number of vertices of a hull: each has at least 3 edges, and the numbers follow Euler's formula.
pub(crate) const MOST_VERTICES: u32 = 2 * MOST_FACES as u32 - 4;

/// A core and a radius.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shape {
    pub(crate) core: Core,
    /// In units; 0 for sharp boxes, faces and hulls.
    pub(crate) radius: f32,
}

impl Shape {
    pub(crate) fn ball(radius: f32) -> Self {
        Self { core: Core::Point, radius }
    }

    pub(crate) fn capsule(half: f32, radius: f32) -> Self {
        Self { core: Core::Segment { half }, radius }
    }

    pub(crate) fn cuboid(half: Vec3) -> Self {
        Self { core: Core::Box { half }, radius: 0.0 }
    }

    /// Whether contacts with it are computed anew at every refresh (docs/physics section 11): balls and capsules.
    pub(crate) fn is_round(&self) -> bool {
        matches!(self.core, Core::Point | Core::Segment { .. })
    }
}
