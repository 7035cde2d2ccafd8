//! Contacts of two shapes in a relative pose: the table (kind, kind) -> function.
//!
//! | room | what it knows |
//! |---|---|
//! | `ball` | a ball against everything: the nearest point of a core |
//! | `half_space` | vertices below a plane |
//! | `capsule` | a segment against segments and polyhedra |
//! | `box_box` | two sharp boxes: 15 axes and a clip in the plane of the face |
//! | `polyhedra` | any two of box, hull and face, with radii |
//! | `solid` | vertices, faces and edges of a core |
//! | `closest` | closest points of two sets of vertices |
//! | `clip` | polygons, segments and the choice of four points |

mod ball;
mod box_box;
mod capsule;
mod clip;
mod closest;
mod half_space;
mod ids;
mod polyhedra;
#[cfg(test)]
mod reference;
mod solid;
#[cfg(test)]
mod tests;

pub(crate) use ball::nearest;
use glam::Vec3;

use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};

/// Greatest number of contact points of a pair.
pub(crate) const MOST_POINTS: usize = 4;

/// A contact point, in coordinates of shape a.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Point {
    /// The point on the surface of a.
    pub(crate) on_a: Vec3,
    /// The point on the surface of b. The separation is (on_b - on_a) . normal, negative for an overlap.
    pub(crate) on_b: Vec3,
    /// Which features meet. Equal ids in successive frames are the same point.
    pub(crate) id: u32,
}

/// The contact points of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Manifold {
    /// Unit vector from a to b, in coordinates of a.
    pub(crate) normal: Vec3,
    /// Number of points, 1 to [`MOST_POINTS`].
    pub(crate) count: usize,
    pub(crate) points: [Point; MOST_POINTS],
}

impl Manifold {
    /// No points yet.
    fn empty(normal: Vec3) -> Self {
        Self { normal, count: 0, points: [Point::default(); MOST_POINTS] }
    }

    /// One point: the nearest points of both cores, and the radii.
    fn single(normal: Vec3, cores: (Vec3, Vec3), radii: (f32, f32), id: u32) -> Self {
        let mut manifold = Self::empty(normal);
        manifold.push(cores, radii, id);
        manifold
    }

    /// Adds the point between two points of the cores. There must be room.
    fn push(&mut self, cores: (Vec3, Vec3), radii: (f32, f32), id: u32) {
        let (on_a, on_b) = (cores.0 + self.normal * radii.0, cores.1 - self.normal * radii.1);
        self.points[self.count] = Point { on_a, on_b, id };
        self.count += 1;
    }

    /// The same contact as seen from the other shape, whose pose in coordinates of this one is `pose`.
    fn flipped(mut self, pose: &Pose) -> Self {
        self.normal = -(pose.turn * self.normal);
        for point in &mut self.points[..self.count] {
            (point.on_a, point.on_b) = (pose.point(point.on_b), pose.point(point.on_a));
        }
        self
    }

    /// The least separation of its points.
    fn least(&self) -> f32 {
        let points = &self.points[..self.count];
        points.iter().map(|point| (point.on_b - point.on_a).dot(self.normal)).fold(f32::INFINITY, f32::min)
    }

    fn some(self) -> Option<Self> {
        (self.count > 0).then_some(self)
    }
}

/// Contacts of a pair whose kinds are in the order of the table.
type Function = fn(&Shape, &Shape, &Pose, f32) -> Option<Manifold>;

/// Who meets whom: row a, column b, in the order of [`kind`]. The lower half is the upper one, flipped.
const TABLE: [[Option<Function>; 7]; 7] = {
    const HALF: Option<Function> = Some(half_space::collide);
    const POLY: Option<Function> = Some(polyhedra::collide);
    const BOX: Option<Function> = Some(box_box::collide);
    const ROD: Option<Function> = Some(capsule::with_polyhedron);
    const RODS: Option<Function> = Some(capsule::with_capsule);
    const BALL: Option<Function> = Some(ball::collide);
    const NONE: Option<Function> = None;
    [
        // cone or bowl, half-space, face, box, hull, segment, point
        [NONE, NONE, NONE, NONE, NONE, NONE, BALL],
        [NONE, NONE, HALF, HALF, HALF, HALF, BALL],
        [NONE, NONE, POLY, POLY, POLY, ROD, BALL],
        [NONE, NONE, NONE, BOX, POLY, ROD, BALL],
        [NONE, NONE, NONE, NONE, POLY, ROD, BALL],
        [NONE, NONE, NONE, NONE, NONE, RODS, BALL],
        [NONE, NONE, NONE, NONE, NONE, NONE, BALL],
    ]
};

/// Row of a core in the table.
fn kind(core: &Core) -> usize {
    match core {
        Core::Cone { .. } | Core::Bowl { .. } => 0,
        Core::HalfSpace => 1,
        Core::Face { .. } => 2,
        Core::Box { .. } => 3,
        Core::Hull(_) => 4,
        Core::Segment { .. } => 5,
        Core::Point => 6,
    }
}

/// The contact points of two shapes whose separation is at most `reach`; `None` if there are none. `b_in_a` is the pose of
/// b in coordinates of a. Two smooth walls have none: they belong to bodies without mass.
pub(crate) fn collide(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32) -> Option<Manifold> {
    let (row, column) = (kind(&a.core), kind(&b.core));
    if row <= column {
        TABLE[row][column]?(a, b, b_in_a, reach)
    } else {
        let a_in_b = b_in_a.relative(&Pose::IDENTITY);
        TABLE[column][row]?(b, a, &a_in_b, reach).map(|manifold| manifold.flipped(b_in_a))
    }
}

/// The place of the surface of a shape nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// Distance of the point from the surface, negative inside.
    pub(crate) distance: f32,
    /// Unit vector outwards.
    pub(crate) normal: Vec3,
}

/// The distance of a point from a shape; `None` on the far side of a one-sided face.
pub(crate) fn place(shape: &Shape, point: Vec3) -> Option<Place> {
    let found = nearest(&shape.core, point)?;
    Some(Place { distance: (point - found.place).dot(found.normal) - shape.radius, normal: found.normal })
}
