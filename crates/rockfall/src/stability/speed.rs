//! Finds bodies that are too fast for the time step, because there is no continuous collision detection.

use std::fmt;

use glam::DVec3;

use crate::scene::{Cuboid, MotionId, Scene};
use crate::stability::{at_most, nearest};

/// The object that bodies may pass through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thin {
    /// The smallest sphere.
    Sphere,
    /// The thinnest rod.
    Rod,
    /// The box with this index, in order of addition.
    Box(usize),
    /// A polygon. It touches a sphere only while the sphere's centre is on the polygon's front side and nearer than the radius.
    Polygon,
}

/// A warning that bodies may become fast enough to pass through an object within a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tunnelling {
    /// The object that they pass through first.
    pub what: Thin,
    /// The speed that bodies may reach, in units/s, plus that of the fastest moving wall.
    pub speed: f64,
    /// The speed of the fastest moving wall, in units/s. 0 without moving walls.
    pub wall_speed: f64,
    /// The distance that they move per time step at that speed, in units.
    pub way: f64,
    /// The largest safe distance per time step, in units.
    pub depth: f64,
    /// The largest safe time step, in s.
    pub largest_dt: f64,
}

impl fmt::Display for Tunnelling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [speed, way, depth] = [self.speed, self.way, self.depth].map(nearest);
        let dt = at_most(self.largest_dt);
        if self.wall_speed > 0.0 {
            let wall = nearest(self.wall_speed);
            write!(f, "bodies and moving walls may meet at {speed} units/s ({wall} of it of the wall), ")?;
        } else {
            write!(f, "bodies may reach {speed} units/s, ")?;
        }
        write!(f, "{way} units a step, and pass through ")?;
        match self.what {
            Thin::Sphere => write!(f, "other spheres: the limit is the sum of the two smallest radii, {depth}")?,
            Thin::Rod => write!(f, "rods: the limit is the thinnest rod's radius plus the smallest sphere's, {depth}")?,
            Thin::Box(index) => {
                write!(f, "box number {index}: the limit is half its thickness plus the smallest radius, {depth}")?;
            }
            Thin::Polygon => write!(f, "polygons: the limit is the smallest radius, {depth}")?,
        }
        write!(f, "; the largest time step that works is {dt} s")
    }
}

impl Scene {
    /// Returns a warning if a body can become fast enough to pass through something thin in a time step of `dt` seconds.
    ///
    /// The speed u is that of the fastest body after a fall through the height of the scene, sqrt(v² + 2 G h), plus that of the fastest
    /// moving wall. Springs and
    /// external forces are not counted. A contact is detected if bodies overlap at the end of a step, and it pushes towards the
    /// nearest side. So u dt must not exceed
    ///
    /// - for a sphere or rod at rest that is hit head-on: the sum of the smallest radius r of a mover and that of the other
    ///   body. Beyond that distance the axes have passed each other;
    /// - for a box: r plus half its thickness. Beyond that distance the far side is nearer;
    /// - for a polygon: r, because a centre behind it is not in contact.
    pub fn tunnelling(&self, dt: f32) -> Option<Tunnelling> {
        if self.is_rigid() {
            // Its solver sees the whole path of a frame.
            return None;
        }
        let movers = || self.spheres().iter().filter(|sphere| !sphere.fixed);
        let radius = movers().map(|sphere| f64::from(sphere.radius)).fold(f64::INFINITY, f64::min);
        let wall_speed = self.greatest_wall_speed();
        let speed = self.greatest_speed() + wall_speed;
        let thickness =
            |cuboid: &Cuboid| cuboid.edges.map(|edge| edge.as_dvec3().length()).into_iter().fold(f64::INFINITY, f64::min);
        let thinnest = self.boxes().iter().map(thickness).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let of_box = thinnest.map(|(index, thickness)| (Thin::Box(index), radius + 0.5 * thickness));
        let of_polygon = (!self.polygons().is_empty()).then_some((Thin::Polygon, radius));
        let all_radii = self.spheres().iter().map(|sphere| f64::from(sphere.radius));
        let smallest = all_radii.fold(f64::INFINITY, f64::min);
        let of_sphere = (self.spheres().len() > 1).then_some((Thin::Sphere, radius + smallest));
        let thinnest_rod = self.rods().iter().map(|rod| f64::from(rod.radius)).reduce(f64::min);
        // A single capsule or rod meets no spheres but its own ends.
        let others = self.spheres().len() > 2;
        let of_rod = thinnest_rod.filter(|_| others).map(|thin| (Thin::Rod, radius + thin));
        let all = [of_polygon, of_sphere, of_rod, of_box].into_iter().flatten();
        let (what, depth) = all.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let way = speed * f64::from(dt);
        (way > depth).then_some(Tunnelling { what, speed, wall_speed, way, depth, largest_dt: depth / speed })
    }

    /// The speed of the fastest body after a fall through the height of the scene, sqrt(v² + 2 G h), in units/s.
    pub(super) fn greatest_speed(&self) -> f64 {
        let moving = self.spheres().iter().filter(|sphere| !sphere.fixed);
        let fastest = moving.map(|sphere| sphere.velocity.as_dvec3().length()).fold(0.0, f64::max);
        (fastest * fastest + 2.0 * f64::from(self.settings.gravity.abs()) * self.height()).sqrt()
    }

    /// A bound for the speed of the moving walls, in units/s: the sum of the speeds of the terms of their motions, with the farthest vertex
    /// from the axis at rest.
    pub(super) fn greatest_wall_speed(&self) -> f64 {
        let of = |motion: Option<MotionId>, vertices: &mut dyn Iterator<Item = DVec3>| {
            let Some(Ok(motion)) = motion.map(|id| self.motion(id)) else { return 0.0 };
            vertices.map(|vertex| motion.speed_bound(vertex)).fold(0.0, f64::max)
        };
        let boxes = self.boxes().iter().map(|cuboid| {
            let [i, j, k] = cuboid.edges.map(|edge| edge.as_dvec3());
            let corner = |n: u32| {
                [i, j, k]
                    .iter()
                    .enumerate()
                    .fold(cuboid.corner.as_dvec3(), |sum, (axis, edge)| sum + f64::from(n >> axis & 1) * *edge)
            };
            of(cuboid.motion, &mut (0..8).map(corner))
        });
        let polygons = self.polygons().iter().map(|polygon| of(polygon.motion, &mut polygon.vertices().map(|v| v.as_dvec3())));
        boxes.chain(polygons).fold(0.0, f64::max)
    }

    /// The height through which the highest mover can fall, in units: down to the lowest surface that faces up, or to the
    /// lowest sphere.
    fn height(&self) -> f64 {
        let sign = if self.settings.gravity < 0.0 { 1.0 } else { -1.0 };
        let up = sign * self.settings.gravity_direction.as_dvec3().normalize();
        let above = |point: DVec3| point.dot(up);
        let bottoms =
            || self.spheres().iter().map(|sphere| (sphere, above(sphere.position.as_dvec3()) - f64::from(sphere.radius)));
        let top = bottoms().filter(|(sphere, _)| !sphere.fixed).map(|(_, bottom)| bottom).fold(f64::NEG_INFINITY, f64::max);
        let boxes = self.boxes().iter().map(|cuboid| lowest_of_top(cuboid, up));
        let polygons = self.polygons().iter().map(|polygon| {
            let [corner, left, right] = [polygon.corner, polygon.left, polygon.right].map(|vector| above(vector.as_dvec3()));
            corner + left.min(0.0) + right.min(0.0)
        });
        let lowest = bottoms().map(|(_, bottom)| bottom).chain(boxes).chain(polygons).fold(f64::INFINITY, f64::min);
        let height = top - lowest;
        if height.is_finite() { height.max(0.0) } else { 0.0 }
    }
}

/// Height of the lowest corner of the face of a box that faces upwards most.
fn lowest_of_top(cuboid: &Cuboid, up: DVec3) -> f64 {
    let edges = cuboid.edges.map(|edge| edge.as_dvec3());
    let rise = edges.map(|edge| edge.dot(up));
    let steepness = |axis: usize| rise[axis].abs() / edges[axis].length();
    let steepest = (0..3).max_by(|a, b| steepness(*a).total_cmp(&steepness(*b))).unwrap_or(0);
    let height: f64 = (0..3).map(|axis| if axis == steepest { rise[axis].max(0.0) } else { rise[axis].min(0.0) }).sum();
    cuboid.corner.as_dvec3().dot(up) + height
}
