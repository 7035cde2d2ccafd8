//! Moving walls: where they are at a time, and their velocity and acceleration (docs/physics section 2.12).

use std::f64::consts::TAU;

use rockfall::glam::{DQuat, DVec3};
use rockfall::{MotionTerm, Scene};

use crate::geometry::{Line, Pair, Thing};
use crate::sides::{Motion, sides};
use crate::world::{Block, Face, Mistake, World};

/// A point of a wall: its place, velocity and acceleration, and the angular velocity of what it belongs to.
#[derive(Clone, Copy)]
struct Moving {
    x: DVec3,
    v: DVec3,
    a: DVec3,
    omega: DVec3,
}

/// The terms of a motion. A later one is inside the earlier ones.
#[derive(Clone, Debug)]
pub(crate) struct Path(Vec<MotionTerm>);

impl Path {
    pub(crate) fn all(scene: &Scene) -> Vec<Self> {
        scene.motions().iter().map(|motion| Self(motion.terms.clone())).collect()
    }

    fn point(&self, x: DVec3, t: f64) -> Moving {
        let still = Moving { x, v: DVec3::ZERO, a: DVec3::ZERO, omega: DVec3::ZERO };
        self.0.iter().rev().fold(still, |inner, term| outside(term, &inner, t))
    }

    /// A point of the first axis, whose acceleration is known.
    fn reference(&self) -> DVec3 {
        self.0.iter().find(|term| term.spin != 0.0).map_or(DVec3::ZERO, |term| term.through)
    }

    fn edge(&self, edge: DVec3, t: f64) -> DVec3 {
        self.point(edge, t).x - self.point(DVec3::ZERO, t).x
    }
}

/// The motion of a point that moves inside of a term.
fn outside(term: &MotionTerm, inner: &Moving, t: f64) -> Moving {
    let s = t.clamp(term.from, term.to) - term.from;
    let turns = if t < term.from || t >= term.to { 0.0 } else { 1.0 };
    let spin = term.spin * term.axis.normalize();
    let turn = DQuat::from_scaled_axis(spin * s);
    let (omega, rate) = (turns * spin, TAU * term.frequency);
    let angle = TAU * (term.frequency * s + term.phase);
    let arm = turn * (inner.x - term.through);
    let (v, a) = (turn * inner.v, turn * inner.a);
    Moving {
        x: term.through + arm + term.velocity * s + term.amplitude * (angle.sin() - (TAU * term.phase).sin()),
        v: omega.cross(arm) + v + turns * (term.velocity + term.amplitude * rate * angle.cos()),
        a: omega.cross(omega.cross(arm)) + 2.0 * omega.cross(v) + a - turns * term.amplitude * rate * rate * angle.sin(),
        omega: omega + turn * inner.omega,
    }
}

/// The motion of a wall as a rigid body: its corner, with velocity and acceleration, and its angular velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall {
    corner: DVec3,
    v: DVec3,
    a: DVec3,
    pub(crate) omega: DVec3,
}

impl Wall {
    pub(crate) fn velocity(&self, y: DVec3) -> DVec3 {
        self.v + self.omega.cross(y - self.corner)
    }

    pub(crate) fn acceleration(&self, y: DVec3) -> DVec3 {
        self.a + self.omega.cross(self.omega.cross(y - self.corner))
    }

    /// Where a point that was at `x` a time `tau` ago is seen from the wall as it is now. `curved`: with the acceleration of the corner.
    pub(crate) fn seen(&self, x: DVec3, tau: f64, curved: bool) -> DVec3 {
        let z = x - self.corner + tau * self.v;
        let turned = self.omega.cross(z);
        let bend = 0.5 * tau * tau;
        x + tau * (self.v + turned) + bend * self.omega.cross(turned) - if curved { bend * self.a } else { DVec3::ZERO }
    }

    /// A unit vector as it was a time `tau` ago, when it turns with the wall.
    pub(crate) fn turned_back(&self, unit: DVec3, tau: f64) -> DVec3 {
        let turn = -tau * self.omega;
        (unit + turn.cross(unit) + 0.5 * turn.cross(turn.cross(unit))).normalize()
    }
}

impl World {
    /// Moves all walls to where they are at a time.
    pub(crate) fn place_walls(&mut self, t: f64) {
        self.time = t;
        let paths = &self.paths;
        let placed = |corner: DVec3, motion: usize| paths[motion].point(corner, t).x;
        self.blocks = self.blocks_at_rest.clone();
        self.faces = self.faces_at_rest.clone();
        for block in &mut self.blocks {
            let Some(motion) = block.motion else { continue };
            block.corner = placed(block.corner, motion);
            block.edges = block.edges.map(|edge| paths[motion].edge(edge, t));
        }
        for face in &mut self.faces {
            let Some(motion) = face.motion else { continue };
            face.corner = placed(face.corner, motion);
            [face.left, face.right] = [face.left, face.right].map(|edge| paths[motion].edge(edge, t));
        }
    }

    /// Lets all walls stand still.
    pub(crate) fn stop_walls(&mut self) {
        for block in &mut self.blocks_at_rest {
            (block.motion, block.belt) = (None, DVec3::ZERO);
        }
        for face in &mut self.faces_at_rest {
            (face.motion, face.belt) = (None, DVec3::ZERO);
        }
        self.place_walls(self.time);
    }

    /// The motion of the wall on side B of a contact, if it moves.
    pub(crate) fn wall(&self, thing: Thing) -> Option<Wall> {
        let (corner, motion) = match thing {
            Thing::Block(block) => (self.blocks_at_rest[block].corner, self.blocks[block].motion?),
            Thing::Face(face) => (self.faces_at_rest[face].corner, self.faces[face].motion?),
            Thing::Ball(_) | Thing::Bar(_) => return None,
        };
        let path = &self.paths[motion];
        let Moving { x, v, omega, .. } = path.point(corner, self.time);
        let reference = path.point(path.reference(), self.time);
        Some(Wall { corner: x, v, a: reference.a + omega.cross(omega.cross(x - reference.x)), omega })
    }

    /// Whether two walls belong to one body: that of their motion, or the world.
    pub(crate) fn are_one_body(&self, a: Thing, b: Thing) -> bool {
        let motion = |thing: Thing| match thing {
            Thing::Block(block) => self.blocks[block].motion,
            Thing::Face(face) => self.faces[face].motion,
            Thing::Ball(_) | Thing::Bar(_) => None,
        };
        motion(a) == motion(b)
    }

    /// The point of a wall that a contact touches: the end of the arm of A.
    pub(crate) fn wall_point(&self, pair: &Pair, line: &Line) -> DVec3 {
        let (x, radius) = match pair.a {
            Thing::Ball(ball) => (self.balls[ball].x, self.balls[ball].radius),
            Thing::Bar(bar) => {
                let [one, two] = self.ends(bar);
                (one.lerp(two, line.at[0]), self.bars[bar].radius)
            }
            Thing::Block(_) | Thing::Face(_) => unreachable!("A can move"),
        };
        x + (radius - line.o) * line.n
    }

    /// The velocity of the wall on side B at the contact point, 0 without one.
    pub(crate) fn wall_velocity(&self, pair: &Pair, line: &Line) -> DVec3 {
        let wall = self.wall(pair.b).filter(|_| !self.made(Mistake::WallVelocity));
        wall.map_or(DVec3::ZERO, |wall| wall.velocity(self.wall_point(pair, line)))
    }

    /// The surface velocity of the wall on side B in the tangent plane.
    pub(crate) fn belt(&self, pair: &Pair, line: &Line) -> DVec3 {
        let s = match pair.b {
            Thing::Block(block) => self.blocks[block].belt,
            Thing::Face(face) => self.faces[face].belt,
            Thing::Ball(_) | Thing::Bar(_) => DVec3::ZERO,
        };
        if self.made(Mistake::Belts) { DVec3::ZERO } else { s - s.dot(line.n) * line.n }
    }

    /// The approach velocity of a contact in the present state.
    pub(crate) fn closing(&self, pair: &Pair, line: &Line) -> f64 {
        self.approach(pair, line, &Motion::of(self)) - self.wall_velocity(pair, line).dot(line.n)
    }

    /// The greatest acceleration of the wall on side B at the centres of A.
    pub(crate) fn wall_acceleration(&self, pair: &Pair) -> f64 {
        let Some(wall) = self.wall(pair.b) else { return 0.0 };
        let at = |ball: usize| wall.acceleration(self.balls[ball].x).length();
        match pair.a {
            Thing::Ball(ball) => at(ball),
            Thing::Bar(bar) => self.bars[bar].ends.map(at).into_iter().fold(0.0, f64::max),
            Thing::Block(_) | Thing::Face(_) => 0.0,
        }
    }

    /// The contact with a moving wall and its approach velocity, a time `tau` ago. This world is that of the bodies at that time,
    /// `curved` with their accelerations, and of the wall now. `line_of` finds the contact in a world.
    pub(crate) fn closing_of_wall(
        &self,
        pair: &Pair,
        wall: &Wall,
        tau: f64,
        curved: bool,
        line_of: impl Fn(&Self) -> Option<Line>,
    ) -> Option<(Line, f64)> {
        let mut seen = self.clone();
        let balls = match pair.a {
            Thing::Ball(ball) => vec![ball],
            Thing::Bar(bar) => self.bars[bar].ends.to_vec(),
            Thing::Block(_) | Thing::Face(_) => Vec::new(),
        };
        for ball in balls {
            seen.balls[ball].x = wall.seen(self.balls[ball].x, tau, curved);
        }
        let line = line_of(&seen)?;
        let y = seen.wall_point(pair, &line);
        let velocity = wall.velocity(y) - tau * wall.acceleration(y);
        let back = Line { n: wall.turned_back(line.n, tau), ..line };
        let u = self.approach(pair, &back, &Motion::of(self)) - velocity.dot(back.n);
        (u > 0.0).then_some((back, u))
    }

    /// The velocity of the surfaces of both sides, without their spins.
    pub(crate) fn surface_velocities(&self, pair: &Pair, line: &Line, motion: &Motion) -> [DVec3; 2] {
        let [a, b] = sides(pair, line);
        [self.velocity(a, motion), self.velocity(b, motion) + self.wall_velocity(pair, line)]
    }
}

/// Boxes and polygons as they are written.
pub(crate) fn at_rest(scene: &Scene) -> (Vec<Block>, Vec<Face>) {
    let ids: Vec<_> = scene.motion_ids().collect();
    let number = |motion| ids.iter().position(|id| Some(*id) == motion);
    let blocks = scene.boxes().iter().map(|cuboid| Block {
        corner: cuboid.corner.as_dvec3(),
        edges: cuboid.edges.map(|edge| edge.as_dvec3()),
        group: cuboid.group,
        motion: number(cuboid.motion),
        belt: cuboid.surface_velocity.as_dvec3(),
    });
    let faces = scene.polygons().iter().map(|polygon| Face {
        corner: polygon.corner.as_dvec3(),
        left: polygon.left.as_dvec3(),
        right: polygon.right.as_dvec3(),
        is_triangle: polygon.is_triangle(),
        group: polygon.group,
        motion: number(polygon.motion),
        belt: polygon.surface_velocity.as_dvec3(),
    });
    (blocks.collect(), faces.collect())
}
