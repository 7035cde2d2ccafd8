//! Random scenes with boxes of rigid bodies ("bricks"), which meet balls, rods, each other and walls at faces, edges and vertices.
//!
//! Every scene has at most one wall, whose corners nothing hides. Rods are left to meet bricks by chance.

use rand::RngExt;
use rockfall::glam::{Quat, Vec3};
use rockfall::{Cuboid, Placement, Polygon, RigidBodyId, Shape, Surface};

use crate::draw::Draw;

/// A box whose centre is the origin of its coordinates.
#[derive(Clone, Copy)]
struct Brick {
    half: Vec3,
    /// Rounding radius.
    radius: f32,
}

/// A place on the surface of a box, and the direction that leads out of it there.
#[derive(Clone, Copy)]
struct Spot {
    at: Vec3,
    out: Vec3,
}

/// What is at a place on the surface of a box, by the number of axes along which it is at an end.
const FACE: usize = 1;
const EDGE: usize = 2;
const VERTEX: usize = 3;

impl Spot {
    /// The same place of a box that is turned and moved.
    fn placed(self, turn: Quat, centre: Vec3) -> Self {
        Self { at: centre + turn * self.at, out: turn * self.out }
    }
}

impl Draw {
    /// A random place on a face, an edge or a vertex of a box.
    fn spot(&mut self, brick: Brick, ends: usize) -> Spot {
        let core = brick.half - brick.radius;
        let first = self.rng.random_range(0..3);
        let (mut at, mut out) = (Vec3::ZERO, Vec3::ZERO);
        for k in 0..3 {
            let axis = (first + k) % 3;
            if k < ends {
                out[axis] = if self.chance(0.5) { 1.0 } else { -1.0 };
                at[axis] = out[axis] * core[axis];
            } else {
                at[axis] = self.between(-0.95, 0.95) * core[axis];
            }
        }
        let out = out.normalize();
        Spot { at: at + brick.radius * out, out }
    }

    fn any_spot(&mut self, brick: Brick) -> Spot {
        let ends = self.rng.random_range(FACE..=VERTEX);
        self.spot(brick, ends)
    }

    /// A shape with a box about its origin. It may have further parts.
    fn brick_shape(&mut self) -> (Shape, Brick) {
        let half = Vec3::from_array([0; 3].map(|_| self.between(0.15, 0.4)));
        let share = if self.chance(0.2) { 0.0 } else { self.between(0.1, 0.5) };
        let radius = if share == 0.0 { 0.04 } else { share } * half.min_element();
        let boxed = |centre: Vec3, half: Vec3| {
            let [i, j, k] = [2.0 * half.x * Vec3::X, 2.0 * half.y * Vec3::Y, 2.0 * half.z * Vec3::Z];
            Cuboid::new(centre - half, i, j, k)
        };
        let mut shape = Shape::new().cuboid(boxed(Vec3::ZERO, half));
        if share > 0.0 {
            shape = shape.rounding(radius);
        }
        if self.chance(0.3) {
            let spot = self.any_spot(Brick { half, radius });
            shape = shape.sphere(spot.at, self.between(0.1, 0.2));
            if self.chance(0.5) {
                shape = shape.sphere(spot.at + 0.3 * spot.out, self.between(0.08, 0.15));
                shape = shape.rod(0, 1, self.between(0.05, 0.1));
            }
        }
        if self.chance(0.2) {
            let centre = half + self.vector(0.1);
            shape = shape.cuboid(boxed(centre, half * self.between(0.6, 1.0)));
        }
        (shape, Brick { half, radius })
    }

    /// A body with a box. Its shape is laid with its origin at `at`.
    fn lay(&mut self, shape: Shape, at: Vec3, turn: Quat, velocity: Vec3) -> RigidBodyId {
        let shape = self.weighed(shape);
        let shape = self.scene.add_shape(shape).expect("a valid shape");
        let spin = self.vector(3.0);
        let placed = Placement::new(shape).at(at.as_dvec3()).turned(turn.normalize()).velocity(velocity).spin(spin);
        self.scene.add_body(placed).expect("a valid body")
    }

    /// A random orientation.
    fn any_turn(&mut self) -> Quat {
        let axis = self.direction();
        Quat::from_axis_angle(axis, self.between(0.0, 3.0))
    }

    /// A body with a box that has just hit the place `hit` with one of its own.
    fn throw(&mut self, hit: Spot, velocity: Vec3, ends: usize) {
        let (shape, brick) = self.brick_shape();
        let own = self.spot(brick, ends);
        let twist = Quat::from_axis_angle(hit.out, self.between(0.0, 6.0));
        let tilt = self.between(0.0, 0.3) * self.direction();
        let turn = twist * Quat::from_rotation_arc(own.out, (tilt - hit.out).normalize());
        let depth = self.between(0.001, 0.06);
        let at = hit.at - depth * hit.out - turn * own.at;
        let speed = self.between(-1.0, 3.0);
        let aside = self.vector(0.7);
        self.lay(shape, at, turn, velocity + aside - speed * hit.out);
    }

    /// A body with a box in the middle.
    fn middle_brick(&mut self) -> (Brick, Quat, Vec3) {
        let (shape, brick) = self.brick_shape();
        let (turn, velocity) = (self.any_turn(), self.vector(1.0));
        self.lay(shape, self.middle, turn, velocity);
        (brick, turn, velocity)
    }

    /// A body with a box that balls and rods hit at faces, edges and vertices.
    pub(crate) fn brick_and_balls(&mut self) {
        let (brick, turn, velocity) = self.middle_brick();
        for _ in 0..self.rng.random_range(1..5) {
            let hit = self.any_spot(brick).placed(turn, self.middle);
            let mut ball = self.ball(hit.at);
            ball.radius *= self.between(0.3, 1.0);
            ball.position += (ball.radius - self.between(0.001, 0.05)) * hit.out;
            ball.velocity = 0.3 * ball.velocity + velocity - self.between(-1.0, 3.0) * hit.out;
            ball.fixed = self.chance(0.1);
            self.add(ball);
        }
        if self.chance(0.5) {
            let hit = self.spot(brick, EDGE).placed(turn, self.middle);
            let across = (self.direction().cross(hit.out)).normalize_or(hit.out.any_orthonormal_vector());
            let away = self.between(-0.05, 0.12);
            let pushed = velocity - self.between(-1.0, 2.0) * hit.out;
            self.rod(hit.at + away * hit.out, across, 1.4, pushed, 0.1);
        }
    }

    /// Two or three bodies with boxes that meet at faces, edges and vertices, and a ball.
    pub(crate) fn bricks(&mut self) {
        let (brick, turn, velocity) = self.middle_brick();
        for _ in 0..self.rng.random_range(1..3) {
            let all = [[FACE, FACE], [FACE, VERTEX], [VERTEX, FACE], [EDGE, EDGE], [EDGE, EDGE], [FACE, EDGE]];
            let [one, two] = all[self.rng.random_range(0..6)];
            let hit = self.spot(brick, one).placed(turn, self.middle);
            self.throw(hit, velocity, two);
        }
        if self.chance(0.3) {
            let hit = self.any_spot(brick).placed(turn, self.middle);
            self.shoot(hit.at, velocity, 0.0);
        }
    }

    /// A body with a box that hits a wall at faces, edges and vertices of both.
    pub(crate) fn brick_landing(&mut self) {
        let all = [[FACE, FACE], [FACE, VERTEX], [VERTEX, FACE], [EDGE, EDGE], [EDGE, FACE], [EDGE, VERTEX]];
        let ends = all[self.rng.random_range(0..6)];
        let hit = match self.rng.random_range(0..4) {
            0 => {
                let normal = self.direction();
                self.square(self.middle, normal);
                Spot { at: self.middle, out: normal }
            }
            1 => {
                let normal = self.direction();
                self.plate(normal);
                Spot { at: self.middle, out: normal }
            }
            2 => self.leaf(ends[0]),
            _ => {
                let Cuboid { corner, edges, .. } = self.cuboid();
                let half = 0.5 * Vec3::from_array(edges.map(Vec3::length));
                let axes = edges.map(Vec3::normalize);
                let spot = self.spot(Brick { half, radius: 0.0 }, ends[0]);
                let along = |v: Vec3| v.x * axes[0] + v.y * axes[1] + v.z * axes[2];
                let centre = corner + 0.5 * (edges[0] + edges[1] + edges[2]);
                Spot { at: centre + along(spot.at), out: along(spot.out) }
            }
        };
        self.throw(hit, Vec3::ZERO, ends[1]);
    }

    /// A small polygon, and a place on its face, an edge or a corner.
    fn leaf(&mut self, ends: usize) -> Spot {
        let (left, helper) = (self.direction() * self.between(0.5, 1.0), self.direction());
        let across = left.normalize().cross(helper).normalize();
        let right = across * self.between(0.5, 1.0) + self.between(-0.2, 0.2) * left;
        let mut polygon = Polygon::new(self.middle, left, right);
        if self.chance(0.5) {
            polygon.surface = Surface::Triangle;
        }
        self.scene.add_polygon(polygon).expect("a valid polygon");
        let normal = left.cross(right).normalize();
        match ends {
            FACE => Spot { at: self.middle + self.between(0.1, 0.5) * left + self.between(0.1, 0.5) * right, out: normal },
            EDGE => Spot { at: self.middle + self.between(0.1, 0.9) * left, out: (normal - across).normalize() },
            _ => Spot { at: self.middle, out: (normal - (left + right).normalize()).normalize() },
        }
    }
}
