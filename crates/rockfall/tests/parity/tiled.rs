//! Clusters of boxes and polygons that form one surface (docs/physics section 2.11).

use glam::Vec3;
use rockfall::{Cuboid, Polygon};

use crate::random::Draw;

/// Directions of a plane: two along it and its normal.
type Frame = [Vec3; 3];

/// Along the axes, where the coordinates of flush shapes are equal numbers.
const LEVEL: Frame = [Vec3::X, Vec3::Z, Vec3::Y];

impl Draw<'_> {
    fn frame_of_plane(&mut self) -> Frame {
        if self.chance(0.6) {
            return LEVEL;
        }
        let (normal, helper) = (self.direction(), self.direction());
        let along = normal.cross(helper).normalize();
        [along, normal.cross(along), normal]
    }

    /// A box below a plane through the middle: from `low` to `high` along it, and down to a random depth.
    fn slab(&mut self, frame: Frame, low: [f32; 2], high: [f32; 2]) {
        let depth = self.between(0.8, 1.2);
        self.deep_slab(frame, low, high, depth);
    }

    fn deep_slab(&mut self, [u, v, up]: Frame, low: [f32; 2], high: [f32; 2], depth: f32) {
        let corner = self.middle + low[0] * u + low[1] * v;
        let down = -depth * up;
        self.scene.add_box(Cuboid::new(corner, (high[0] - low[0]) * u, down, (high[1] - low[1]) * v)).unwrap();
    }

    /// The same rectangle as a polygon that faces up, at a depth below the plane.
    fn sheet(&mut self, [u, v, up]: Frame, low: [f32; 2], high: [f32; 2], depth: f32) {
        let (left, right) = ((high[0] - low[0]) * u, (high[1] - low[1]) * v);
        let (left, right) = if left.cross(right).dot(up) > 0.0 { (left, right) } else { (right, left) };
        let corner = self.middle + low[0] * u + low[1] * v - depth * up;
        self.scene.add_polygon(Polygon::new(corner, left, right)).unwrap();
    }

    /// A ball that overlaps the plane and moves down. `at` is the place along the plane.
    fn ball_on(&mut self, [u, v, up]: Frame, at: [f32; 2]) {
        let mut ball = self.ball(self.middle + at[0] * u + at[1] * v);
        ball.radius = self.between(0.4, 0.5);
        ball.position += (ball.radius - self.between(0.02, 0.1)) * up;
        ball.velocity -= self.between(-0.5, 3.0) * up;
        self.add(ball);
    }

    fn between_each(&mut self, low: f32, high: f32) -> [f32; 2] {
        [0; 2].map(|_| self.between(low, high))
    }

    /// A ball on a floor that is cut into four flush boxes. Its centre is above one of them, beside the cuts.
    pub(crate) fn tiles(&mut self) {
        let frame = self.frame_of_plane();
        let cut = self.between_each(-0.1, 0.1);
        let other = self.between(-0.1, 0.1);
        for (low, high) in [
            ([-1.0, -1.0], [cut[0], cut[1]]),
            ([-1.0, cut[1]], [cut[0], 1.0]),
            ([cut[0], -1.0], [1.0, other]),
            ([cut[0], other], [1.0, 1.0]),
        ] {
            self.slab(frame, low, high);
        }
        let at = self.between_each(-0.25, 0.25);
        self.ball_on(frame, at);
    }

    /// Boxes that overlap in one plane, a flush polygon beside them, and another polygon in them, below the plane.
    pub(crate) fn overlaid(&mut self) {
        let frame = self.frame_of_plane();
        for _ in 0..2 {
            let (low, high) = (self.between_each(-1.2, -0.3), self.between_each(0.1, 0.3));
            self.slab(frame, low, high);
        }
        let (low, high) = (self.between(-0.6, -0.1), self.between(0.4, 1.0));
        self.sheet(frame, [0.3, low], [1.2, high], 0.0);
        let depth = self.between(0.002, 0.02);
        self.sheet(frame, [-0.5, -0.5], [0.0, 0.0], depth);
        for _ in 0..2 {
            let at = self.between_each(-0.4, 0.5);
            self.ball_on(frame, at);
        }
    }

    /// A ball between two walls that slope down to a common edge.
    pub(crate) fn groove(&mut self) {
        let [u, along, up] = self.frame_of_plane();
        let mut outward = Vec::new();
        for side in [1.0, -1.0] {
            let (sin, cos) = self.between(10.0, 70.0_f32).to_radians().sin_cos();
            let out = -sin * side * u + cos * up;
            self.slab([cos * side * u + sin * up, along, out], [0.0, -1.0], [2.0, 1.0]);
            outward.push(out);
        }
        let mut ball = self.ball(self.middle);
        ball.radius = self.between(0.3, 0.4);
        let d = [0; 2].map(|_| ball.radius - self.between(0.01, 0.06));
        let cosine = outward[0].dot(outward[1]);
        let parts = [d[0] - cosine * d[1], d[1] - cosine * d[0]].map(|part| part / (1.0 - cosine * cosine));
        ball.position += parts[0] * outward[0] + parts[1] * outward[1];
        ball.velocity -= self.between(0.0, 3.0) * (outward[0] + outward[1]).normalize();
        self.add(ball);
    }

    /// Balls whose centres are in one of two flush boxes or in both, beside a wall that begins in the floor.
    pub(crate) fn sunk(&mut self) {
        let frame @ [u, v, up] = self.frame_of_plane();
        let cut = self.between(-0.2, 0.2);
        self.deep_slab(frame, [-1.0, -1.0], [cut + 0.3, 1.0], 1.0);
        self.deep_slab(frame, [cut, -1.0], [1.0, 1.0], 1.0);
        let wall = self.middle + self.between(0.4, 0.6) * u - self.between(0.1, 0.3) * up - v;
        self.scene.add_box(Cuboid::new(wall, 0.4 * u, 2.0 * v, 1.5 * up)).unwrap();
        for side in [-0.5, 0.5] {
            let (at, depth) = (self.between(-0.3, 0.35), self.between(-0.15, 0.2));
            let ball = self.ball(self.middle + at * u + side * v - depth * up);
            self.add(ball);
        }
    }
}
