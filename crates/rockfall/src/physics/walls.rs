//! Bounds for the motion of walls within some steps (docs/physics section 2.12).

use glam::Vec3;

use crate::model::layout::{FLAG_CONTINUOUS, ROUNDING_SLACK};
use crate::model::period::Periods;
use crate::model::step::{Aabb, Step};
use crate::model::view::{Object, PolygonRecord, View};
use crate::physics::smooth::hull_of_smooth;

/// A moving box or polygon: its bounds, and the greatest speed and acceleration of its vertices.
pub(crate) struct Reach {
    pub(crate) bounds: (Vec3, Vec3),
    speed: f32,
    acceleration: f32,
}

impl Reach {
    /// `None` for an object that does not move on a prescribed path.
    pub(crate) fn of(view: &View, object: Object) -> Option<Self> {
        let wall = view.wall(object).filter(|_| view.body(object) != 0)?;
        let (bounds, edges) = match object {
            Object::Cuboid(cuboid) => {
                let record = view.cuboid(cuboid);
                (hull(record.corner, &record.edges), record.edges)
            }
            Object::Polygon(polygon) => {
                let record = view.polygon(polygon);
                (hull_of_polygon(&record), [record.left, record.right, Vec3::ZERO])
            }
            Object::Sphere(_) | Object::Rod(_) => return None,
        };
        let farthest = edges.iter().map(|edge| edge.length()).sum::<f32>();
        let rate = wall.spin.length();
        Some(Self {
            bounds,
            speed: wall.velocity.length() + rate * farthest,
            acceleration: wall.acceleration.length() + rate * rate * farthest,
        })
    }

    /// Bound for the way of the vertices within some steps. The last term leaves room for changes of the acceleration.
    fn way(&self, step: &Step, steps: f32) -> f32 {
        let time = steps * step.constants.dt;
        (1.05 * self.speed + 0.5 * self.acceleration * time) * time + 0.05 * steps * size(step)
    }

    /// Margin of the AABB. `repeat` is added where a step is repeated, in units of the size of most bodies.
    pub(crate) fn margin(&self, step: &Step, repeat: f32) -> f32 {
        let ahead = self.way(step, step.lists.lookahead.max(1.0));
        // The path of the last step, for contacts that begin and end within it.
        let behind = if step.constants.flags & FLAG_CONTINUOUS != 0 { self.way(step, 1.0) } else { 0.0 };
        ahead.max(behind) + ((step.lists.margin_scale - 1.0).max(0.0) * 0.02 + repeat) * size(step)
    }
}

/// The radius of most bodies, which the margins of walls are compared with.
fn size(step: &Step) -> f32 {
    0.4 * step.layout.cell_size
}

/// Bounds of a corner and the edges from it.
pub(crate) fn hull(corner: Vec3, edges: &[Vec3]) -> (Vec3, Vec3) {
    edges.iter().fold((corner, corner), |(min, max), edge| (min + edge.min(Vec3::ZERO), max + edge.max(Vec3::ZERO)))
}

/// Bounds of a polygon.
pub(crate) fn hull_of_polygon(polygon: &PolygonRecord) -> (Vec3, Vec3) {
    let PolygonRecord { corner, left, right, surface } = *polygon;
    if surface.is_smooth() {
        return hull_of_smooth(polygon);
    }
    if polygon.is_triangle() {
        return (corner + left.min(right).min(Vec3::ZERO), corner + left.max(right).max(Vec3::ZERO));
    }
    hull(corner, &[left, right])
}

/// How far a shape may be outside its AABB after some steps, in units of 0.02 of the size of most bodies; 0 when it is inside.
pub(crate) fn escape(view: &View, aabb: &Aabb, reach: &Reach, steps: f32) -> f32 {
    let (step, (min, max)) = (view.step, reach.bounds);
    let way = if steps > 0.0 { reach.way(step, steps) } else { 0.0 };
    let (least, most) = (Vec3::from_array(aabb.min), Vec3::from_array(aabb.max));
    let mut far = least.abs().max(most.abs()).max_element();
    let (mut min, mut max) = (min, max);
    if let Some(periods) = Periods::of(step) {
        far = far.max(min.abs().max(max.abs()).max_element());
        let apart = 0.5 * min + 0.5 * max - aabb.centre();
        let back = periods.nearest(apart.as_dvec3()).as_vec3() - apart;
        (min, max) = (min + back, max + back);
    }
    let slack = ROUNDING_SLACK * far;
    let out = (least - min).max(max - most).max_element() + way + slack;
    if out <= 0.0 { 0.0 } else { (out / (0.02 * size(step))).clamp(1e-3, 1e30) }
}
