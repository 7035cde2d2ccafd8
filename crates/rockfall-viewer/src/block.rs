//! Static objects as blocks with three edges.

use rockfall::glam::{Mat3, Vec3};
use rockfall::{Cuboid, Polygon, Scene};

/// Distance from an object up to which a body lies on it, divided by its radius.
const TOUCH: f32 = 1.1;

/// A box, or a polygon as a box of no height.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) corner: Vec3,
    /// The edges at the corner. The third edge of a polygon is its unit normal.
    pub(crate) edges: [Vec3; 3],
    /// Transforms an offset from the corner to coordinates along the edges.
    into: Mat3,
    /// Greatest coordinates of a point of the block.
    most: Vec3,
}

/// The upper face of a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Top {
    pub(crate) normal: Vec3,
    pub(crate) corner: Vec3,
    /// Lengths of its sides.
    pub(crate) sides: [f32; 2],
    /// Height of the block across it.
    pub(crate) height: f32,
}

impl Block {
    pub(crate) fn of_box(cuboid: &Cuboid) -> Self {
        Self::new(cuboid.corner, cuboid.edges, Vec3::ONE)
    }

    pub(crate) fn of_polygon(polygon: &Polygon) -> Self {
        let normal = polygon.left.cross(polygon.right).normalize_or(Vec3::Y);
        Self::new(polygon.corner, [polygon.left, polygon.right, normal], Vec3::new(1.0, 1.0, 0.0))
    }

    fn new(corner: Vec3, edges: [Vec3; 3], most: Vec3) -> Self {
        let [i, j, k] = edges;
        Self { corner, edges, into: Mat3::from_cols(i, j, k).inverse(), most }
    }

    /// The boxes and polygons of a scene.
    pub(crate) fn all(scene: &Scene) -> impl Iterator<Item = Self> {
        scene.boxes().iter().map(Self::of_box).chain(scene.polygons().iter().map(Self::of_polygon))
    }

    /// The coordinates of a point along the edges.
    pub(crate) fn local(&self, point: Vec3) -> Vec3 {
        self.into * (point - self.corner)
    }

    /// Whether a ball lies on the block, for a unit vector upwards.
    pub(crate) fn carries(&self, place: Vec3, radius: f32, up: Vec3) -> bool {
        let down = place - self.point(self.local(place).clamp(Vec3::ZERO, self.most));
        down.length() < TOUCH * radius && down.dot(up) > 0.5 * radius
    }

    /// The upper face, for a unit vector upwards.
    pub(crate) fn top(&self, up: Vec3) -> Top {
        // That of a polygon is its solid side.
        let axes = if self.most.z == 0.0 { 2..3 } else { 0..3 };
        let faces = axes.flat_map(|axis| [(axis, 0.0), (axis, self.most[axis])]);
        let faces = faces.map(|(axis, at)| {
            let edge = self.edges[axis];
            let outwards = if at == 0.0 && self.most[axis] > 0.0 { -edge } else { edge };
            Top {
                normal: outwards.normalize_or_zero(),
                corner: self.corner + at * edge,
                sides: [self.edges[(axis + 1) % 3].length(), self.edges[(axis + 2) % 3].length()],
                height: self.most[axis] * edge.length(),
            }
        });
        let top = faces.reduce(|one, other| if other.normal.dot(up) > one.normal.dot(up) { other } else { one });
        top.expect("a block has faces")
    }

    pub(crate) fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|bits| {
            let part = |bit: usize| if bits >> bit & 1 == 1 { self.most[bit] } else { 0.0 };
            self.point(Vec3::new(part(0), part(1), part(2)))
        })
    }

    fn point(&self, local: Vec3) -> Vec3 {
        let [i, j, k] = self.edges;
        self.corner + local.x * i + local.y * j + local.z * k
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_upper_face_is_that_of_a_box_and_the_solid_side_of_a_polygon() {
        let top = Block::of_box(&Cuboid::between([0.0, 1.0, 0.0], [2.0, 4.0, 5.0])).top(Vec3::Y);
        assert_eq!((top.normal, top.corner.y, top.height), (Vec3::Y, 4.0, 3.0));
        assert_eq!(top.sides.iter().product::<f32>(), 10.0);
        for (polygon, normal) in [
            (Polygon::new([0.0; 3], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]), Vec3::Y),
            (Polygon::new([0.0; 3], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]), Vec3::NEG_Y),
        ] {
            let top = Block::of_polygon(&polygon).top(Vec3::Y);
            assert_eq!((top.normal, top.height), (normal, 0.0));
        }
    }

    #[test]
    fn a_ball_lies_on_what_is_below_it() {
        let cuboid = Block::of_box(&Cuboid::between([0.0, 0.0, 0.0], [2.0, 1.0, 2.0]));
        assert!(cuboid.carries(Vec3::new(1.0, 1.5, 1.0), 0.5, Vec3::Y));
        assert!(!cuboid.carries(Vec3::new(1.0, 1.7, 1.0), 0.5, Vec3::Y));
        assert!(!cuboid.carries(Vec3::new(2.5, 0.5, 1.0), 0.5, Vec3::Y));
        let slope = Block::of_polygon(&Polygon::new([0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [2.0, 1.0, 0.0]));
        let above = Vec3::new(1.0, 0.5, 1.0) + 0.5 * Vec3::new(-1.0, 2.0, 0.0).normalize();
        assert!(slope.carries(above, 0.5, Vec3::Y));
        assert!(!slope.carries(above + Vec3::Y, 0.5, Vec3::Y));
        assert_eq!(slope.corners()[3], Vec3::new(2.0, 1.0, 2.0));
    }
}
