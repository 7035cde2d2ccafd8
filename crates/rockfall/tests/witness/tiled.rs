//! More kinds of clusters: surfaces of several boxes and polygons, on which shapes hide each other (docs/physics section
//! 2.11).

use rand::RngExt;
use rockfall::glam::{Quat, Vec3};
use rockfall::{Cuboid, Polygon};

use crate::draw::Draw;

/// Directions of a plane: two along it and its normal.
type Frame = [Vec3; 3];

impl Draw {
    /// Along the axes half of the time, so that the coordinates of flush shapes are equal numbers.
    fn frame_of_plane(&mut self) -> Frame {
        if self.chance(0.5) {
            let [x, y, z] = Vec3::AXES;
            return [[x, z, y], [y, x, z], [z, y, x]][self.rng.random_range(0..3)];
        }
        let (normal, helper) = (self.direction(), self.direction());
        let along = normal.cross(helper).normalize();
        [along, normal.cross(along), normal]
    }

    /// A box below a plane through `middle`: from `low` to `high` along it, and down to a random depth.
    fn slab(&mut self, [u, v, up]: Frame, middle: Vec3, low: [f32; 2], high: [f32; 2]) {
        let corner = middle + low[0] * u + low[1] * v;
        let down = -self.between(0.4, 1.2) * up;
        let cuboid = Cuboid::new(corner, (high[0] - low[0]) * u, down, (high[1] - low[1]) * v);
        self.scene.add_box(cuboid).expect("a valid box");
    }

    /// The same rectangle as a polygon that faces up.
    fn sheet(&mut self, [u, v, up]: Frame, middle: Vec3, low: [f32; 2], high: [f32; 2]) {
        let (left, right) = ((high[0] - low[0]) * u, (high[1] - low[1]) * v);
        let (left, right) = if left.cross(right).dot(up) > 0.0 { (left, right) } else { (right, left) };
        let polygon = Polygon::new(middle + low[0] * u + low[1] * v, left, right);
        self.scene.add_polygon(polygon).expect("a valid polygon");
    }

    /// Balls that overlap a plane a little, most of them on their way down.
    fn balls_on(&mut self, [u, v, up]: Frame, count: usize) {
        for _ in 0..count {
            let at = [self.between(-0.6, 0.6), self.between(-0.6, 0.6)];
            let mut ball = self.ball(self.middle);
            ball.radius = self.between(0.3, 0.45);
            ball.position += at[0] * u + at[1] * v + (ball.radius - self.between(0.002, 0.08)) * up;
            ball.velocity -= self.between(-0.5, 3.0) * up;
            self.add(ball);
        }
    }

    /// Numbers from -1 to 1 in rising order, at random places between.
    fn cuts(&mut self) -> Vec<f32> {
        let mut cuts: Vec<f32> = (0..self.rng.random_range(1..4)).map(|_| self.between(-0.8, 0.8)).collect();
        cuts.extend([-1.0, 1.0]);
        cuts.sort_by(f32::total_cmp);
        cuts.dedup();
        cuts
    }

    /// A floor that is cut at random into flush rectangles. `sheets` is the part of them that are polygons.
    fn floor_of_parts(&mut self, sheets: f64) {
        let frame = self.frame_of_plane();
        let columns = self.cuts();
        for column in columns.windows(2) {
            let rows = self.cuts();
            for row in rows.windows(2) {
                let (low, high) = ([column[0], row[0]], [column[1], row[1]]);
                if self.chance(sheets) {
                    self.sheet(frame, self.middle, low, high);
                } else {
                    self.slab(frame, self.middle, low, high);
                }
            }
        }
        let count = self.rng.random_range(1..4);
        self.balls_on(frame, count);
        if self.chance(0.3) {
            self.capsule(self.middle + 0.35 * frame[2], -2.0 * frame[2]);
        }
    }

    pub(crate) fn tiles(&mut self) {
        self.floor_of_parts(0.0);
    }

    pub(crate) fn tiles_and_sheets(&mut self) {
        self.floor_of_parts(0.5);
    }

    /// Boxes and polygons that overlap in one plane.
    pub(crate) fn overlaid(&mut self) {
        let [u, v, up] = self.frame_of_plane();
        let count = self.rng.random_range(2..5);
        for _ in 0..count {
            let turn = Quat::from_axis_angle(up, if self.chance(0.5) { 0.0 } else { self.between(0.0, 3.0) });
            let frame = [turn * u, turn * v, up];
            let low = [self.between(-1.2, -0.2), self.between(-1.2, -0.2)];
            let high = [self.between(0.2, 1.2), self.between(0.2, 1.2)];
            if self.chance(0.25) {
                self.sheet(frame, self.middle, low, high);
            } else {
                self.slab(frame, self.middle, low, high);
            }
        }
        let count = self.rng.random_range(1..3);
        self.balls_on([u, v, up], count);
    }

    /// Two walls that slope down to a common edge, perhaps with a third wall across it, and a ball that touches them.
    pub(crate) fn groove(&mut self) {
        let [u, along, up] = self.frame_of_plane();
        let slopes = [0; 2].map(|_| self.between(5.0, 75.0).to_radians());
        let mut ways = Vec::new();
        for (side, slope) in [1.0, -1.0].into_iter().zip(slopes) {
            let (sin, cos) = slope.sin_cos();
            let out = -sin * side * u + cos * up;
            ways.push(out);
            // The middle is on the common edge.
            self.slab([cos * side * u + sin * up, along, out], self.middle, [0.0, -1.0], [2.0, 1.0]);
        }
        let mut ball = self.ball(self.middle);
        ball.radius = self.between(0.3, 0.4);
        // At the distance d from both walls, or at different distances.
        let d = ball.radius - self.between(0.002, 0.06);
        let apart = if self.chance(0.5) { 0.0 } else { self.between(-0.05, 0.05) };
        let (one, two, between) = (ways[0], ways[1], ways[0].dot(ways[1]));
        let parts = [d - between * (d + apart), d + apart - between * d].map(|part| part / (1.0 - between * between));
        ball.position += parts[0] * one + parts[1] * two;
        ball.velocity -= self.between(0.0, 3.0) * (one + two).normalize();
        if self.chance(0.4) {
            let corner = self.middle - (d - 0.01) * along - 2.0 * u - 1.0 * up;
            self.scene.add_box(Cuboid::new(corner, -0.5 * along, 4.0 * u, 3.0 * up)).expect("a valid box");
        }
        self.add(ball);
    }

    /// Balls whose centres are in a box, beside flush boxes and a wall.
    pub(crate) fn sunk(&mut self) {
        let frame @ [u, v, up] = self.frame_of_plane();
        let cut = self.between(-0.3, 0.3);
        self.slab(frame, self.middle, [-1.0, -1.0], [cut, 1.0]);
        self.slab(frame, self.middle, [cut, -1.0], [1.0, 1.0]);
        let wall = self.middle + self.between(0.3, 0.6) * u - self.between(0.0, 0.3) * up;
        self.scene.add_box(Cuboid::new(wall - v, 0.4 * u, 2.0 * v, 1.5 * up)).expect("a valid box");
        for _ in 0..self.rng.random_range(1..3) {
            let at = [self.between(-0.5, 0.5), self.between(-0.6, 0.6)];
            let mut ball = self.ball(self.middle);
            ball.radius = self.between(0.3, 0.45);
            ball.position += at[0] * u + at[1] * v - self.between(-0.05, 0.15) * up;
            self.add(ball);
        }
    }
}
