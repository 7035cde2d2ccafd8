//! Bounds of shapes.

use glam::{Mat3, Vec2, Vec3};

use crate::rigid::broad::Aabb;
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Hull, Shape};

impl Shape {
    /// The box along the outer axes around the shape in a pose. A half-space is infinite, but for an axis along its normal.
    pub(crate) fn aabb(&self, pose: &Pose) -> Aabb {
        let turn = Mat3::from_quat(pose.turn);
        let around = |half: Vec3| Aabb { min: pose.position - half, max: pose.position + half };
        let rows = |scale: Vec3| turn.x_axis.abs() * scale.x + turn.y_axis.abs() * scale.y + turn.z_axis.abs() * scale.z;
        let core = match &self.core {
            Core::Point => around(Vec3::ZERO),
            Core::Segment { half } => around(rows(Vec3::new(0.0, *half, 0.0))),
            Core::Face { u, v, is_triangle: false, .. } => around((turn * *u).abs() + (turn * *v).abs()),
            Core::Face { u, v, .. } => {
                let (u, v) = (turn * *u, turn * *v);
                Aabb { min: pose.position + u.min(v).min(-u - v), max: pose.position + u.max(v).max(-u - v) }
            }
            Core::Box { half } => around(rows(*half)),
            Core::Hull(hull) => {
                let none = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
                hull.vertices.iter().fold(none, |bounds, vertex| {
                    let point = pose.point(*vertex);
                    Aabb { min: bounds.min.min(point), max: bounds.max.max(point) }
                })
            }
            Core::HalfSpace => half_space(turn.y_axis, pose.position),
            Core::Cone { half, radii, .. } => {
                let beside = (Vec3::ONE - turn.y_axis * turn.y_axis).max(Vec3::ZERO).map(f32::sqrt);
                around(turn.y_axis.abs() * *half + radii[0].max(radii[1]) * beside)
            }
            Core::Bowl { radius } => around(Vec3::splat(*radius)),
        };
        Aabb { min: core.min - self.radius, max: core.max + self.radius }
    }

    /// The greatest distance of the surface from the origin; infinite for a half-space.
    pub(crate) fn extent(&self) -> f32 {
        let core = match &self.core {
            Core::Point => 0.0,
            Core::Segment { half } => *half,
            Core::Face { u, v, is_triangle: false, .. } => (*u + *v).length().max((*u - *v).length()),
            Core::Face { u, v, .. } => u.length().max(v.length()).max((*u + *v).length()),
            Core::Box { half } => half.length(),
            Core::Hull(hull) => hull.vertices.iter().map(|vertex| vertex.length()).fold(0.0, f32::max),
            Core::HalfSpace => f32::INFINITY,
            Core::Cone { half, radii, .. } => Vec2::new(*half, radii[0].max(radii[1])).length(),
            Core::Bowl { radius } => *radius,
        };
        core + self.radius
    }

    /// The least edge or diameter: of a hull, the least distance between two parallel planes along its faces. A face without a
    /// radius has the lesser of its heights, a half-space is infinite.
    pub(crate) fn width(&self) -> f32 {
        let core = match &self.core {
            Core::Point | Core::Segment { .. } => 0.0,
            Core::Face { .. } if self.radius > 0.0 => 0.0,
            Core::Face { u, v, is_triangle: false, .. } => 2.0 * u.cross(*v).length() / u.length().max(v.length()),
            Core::Face { u, v, .. } => {
                let longest = u.distance(*v).max(v.distance(-*u - *v)).max(u.distance(-*u - *v));
                3.0 * u.cross(*v).length() / longest
            }
            Core::Box { half } => 2.0 * half.min_element(),
            Core::Hull(hull) => hull_width(hull),
            Core::HalfSpace | Core::Cone { .. } | Core::Bowl { .. } => f32::INFINITY,
        };
        core + 2.0 * self.radius
    }
}

/// Bounds of the half-space on the inner side of a plane.
fn half_space(normal: Vec3, origin: Vec3) -> Aabb {
    let mut bounds = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
    for axis in 0..3 {
        // Along an axis up to rounding: within 1e-6 of it the plane still leaves the bound beyond 1e6 units.
        if normal[(axis + 1) % 3].abs().max(normal[(axis + 2) % 3].abs()) > 1e-6 {
            continue;
        }
        if normal[axis] > 0.0 {
            bounds.max[axis] = origin[axis];
        } else {
            bounds.min[axis] = origin[axis];
        }
    }
    bounds
}

fn hull_width(hull: &Hull) -> f32 {
    let spread = |normal: Vec3| {
        let along = hull.vertices.iter().map(|vertex| vertex.dot(normal));
        along.clone().fold(f32::NEG_INFINITY, f32::max) - along.fold(f32::INFINITY, f32::min)
    };
    hull.faces.iter().map(|(normal, _)| spread(*normal)).fold(f32::INFINITY, f32::min)
}
