//! Boxes and polygons that move, and the images of bodies that are near a box or polygon.

use glam::Vec3;

use crate::fine::Fine;
use crate::model::layout::{WALL_BODY, WALL_SURFACE, WALL_WORDS};
use crate::model::period::Periods;
use crate::model::step::Layout;
use crate::model::view::{BoxRecord, Object, PolygonRecord, View};
use crate::scene::{ConeAxis, Polygon, Surface};

/// The motion of a box or polygon at the time of a view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall {
    /// The corner, its velocity in units/s and its acceleration in units/s².
    corner: Vec3,
    pub(crate) velocity: Vec3,
    pub(crate) acceleration: Vec3,
    /// Angular velocity, in rad/s.
    pub(crate) spin: Vec3,
    /// Velocity of its surface, in units/s.
    surface: Vec3,
    /// The middle of the shape, in periodic scenes: points are seen from the nearest image of the wall.
    middle: Vec3,
    periods: Option<Periods>,
}

impl Wall {
    /// The corner.
    pub(crate) fn corner(&self) -> Vec3 {
        self.corner
    }

    /// From the corner to a point.
    pub(crate) fn lever(&self, point: Vec3) -> Vec3 {
        let lever = point - self.corner;
        let to_middle = self.middle - self.corner;
        self.periods.map_or(lever, |periods| periods.nearest((lever - to_middle).as_dvec3()).as_vec3() + to_middle)
    }

    /// Velocity of the wall at a point.
    pub(crate) fn velocity_at(&self, point: Vec3) -> Vec3 {
        self.velocity + self.spin.cross(self.lever(point))
    }

    /// Velocity of its surface at a contact point. A conveyor has a part of its own in the tangent plane.
    pub(crate) fn surface_velocity_at(&self, point: Vec3, normal: Vec3) -> Vec3 {
        self.velocity_at(point) + (self.surface - self.surface.dot(normal) * normal)
    }

    /// Acceleration of the wall at a point.
    pub(crate) fn acceleration_at(&self, point: Vec3) -> Vec3 {
        self.acceleration + self.spin.cross(self.spin.cross(self.lever(point)))
    }
}

impl BoxRecord {
    /// The middle of the box.
    pub(crate) fn middle(&self) -> Vec3 {
        self.corner + 0.5 * (self.edges[0] + self.edges[1] + self.edges[2])
    }
}

impl PolygonRecord {
    pub(crate) fn of(polygon: &Polygon) -> Self {
        let Polygon { corner, left, right, surface, .. } = *polygon;
        Self { corner, left, right, surface }
    }

    /// The middle of the parallelogram, also for a triangle (docs/physics section 2.14); of the axis of a cone; the corner of a plane or a ball
    /// (section 2.17).
    pub(crate) fn middle(&self) -> Vec3 {
        match self.surface {
            Surface::Parallelogram | Surface::Triangle => self.corner + 0.5 * (self.left + self.right),
            Surface::Plane | Surface::Ball { .. } => self.corner,
            Surface::Cone { .. } => self.corner + 0.5 * ConeAxis::of(self.left, self.right).along.as_vec3(),
        }
    }

    pub(crate) fn is_triangle(&self) -> bool {
        self.surface == Surface::Triangle
    }
}

impl View<'_> {
    /// The image of a position that is nearest to the middle of a box or polygon.
    pub(crate) fn near_shape(&self, shape: Object, position: Fine) -> Fine {
        let near = |periods: Periods| periods.near(self.middle(shape).as_dvec3(), position);
        Periods::of(self.step).map_or(position, near)
    }

    /// The middle of a box or polygon.
    fn middle(&self, shape: Object) -> Vec3 {
        match shape {
            Object::Cuboid(cuboid) => self.cuboid(cuboid).middle(),
            Object::Polygon(polygon) => self.polygon(polygon).middle(),
            Object::Sphere(_) | Object::Rod(_) => Vec3::ZERO,
        }
    }

    /// Number of the body that a box or polygon belongs to: 0 for the world, which never moves. 0 for spheres and rods.
    pub(crate) fn body(&self, object: Object) -> u32 {
        self.wall_record(object).map_or(0, |at| self.topology[at + WALL_BODY])
    }

    /// The motion of a box or polygon that moves, or whose surface does.
    pub(crate) fn wall(&self, object: Object) -> Option<Wall> {
        let at = self.wall_record(object)?;
        let vector =
            |place: usize| Vec3::from_array(std::array::from_fn(|axis| f32::from_bits(self.topology[at + place + axis])));
        let corner = match object {
            Object::Cuboid(cuboid) => self.cuboid(cuboid).corner,
            Object::Polygon(polygon) => self.polygon(polygon).corner,
            Object::Sphere(_) | Object::Rod(_) => return None,
        };
        let surface = vector(WALL_SURFACE);
        let moves = self.topology[at + WALL_BODY] != 0 || surface != Vec3::ZERO;
        let (velocity, spin, acceleration) = (vector(0), vector(4), vector(8));
        let (middle, periods) = (self.middle(object), Periods::of(self.step));
        moves.then_some(Wall { corner, velocity, acceleration, spin, surface, middle, periods })
    }

    /// First word of the motion of a box or polygon, in scenes in which some of them move.
    fn wall_record(&self, object: Object) -> Option<usize> {
        let Layout { walls_at, boxes, .. } = self.step.layout;
        let index = match object {
            Object::Cuboid(cuboid) => cuboid,
            Object::Polygon(polygon) => boxes + polygon,
            Object::Sphere(_) | Object::Rod(_) => return None,
        };
        (walls_at != 0).then_some((walls_at + index * WALL_WORDS) as usize)
    }
}
