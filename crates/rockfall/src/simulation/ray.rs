//! Ray queries: the first body that a ray meets.

use glam::{DQuat, DVec3, Vec3};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::scene::{Body, Cuboid, Polygon, Rod, Scene, ShapeHull, Surface, finite};
use crate::simulation::Simulation;

/// The point at which a ray enters a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RayHit {
    /// The body.
    pub body: Body,
    /// Distance from the ray's origin, in units.
    pub distance: f32,
    /// The point of entry, in units.
    pub point: Vec3,
    /// Unit normal of the surface at the point, pointing out of the body; for a polygon, of the face that the ray reaches.
    pub normal: Vec3,
}

impl Simulation {
    /// The first body of the current scene that a ray enters, or `None`. `origin` is in units; `direction` may have any length
    /// except 0.
    ///
    /// A rod is treated as the capsule of its radius between the centres of its spheres. A box of a rigid body is hit as the sphere that
    /// stands for it ([`Scene::box_at`]). A polygon or triangle is hit from both sides. A
    /// body that contains the origin is not entered, and so not hit. If two bodies are entered at the same distance, the first
    /// one is returned in the order of [`Body`], then in order of addition.
    ///
    /// The query reads the state back ([`Simulation::sync`]) and runs on all threads of the host. It suits mouse clicks, not
    /// millions of rays.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an origin or a direction that is not finite, or a direction of zero length.
    /// Otherwise as for [`Simulation::sync`].
    pub fn cast_ray(&mut self, origin: impl Into<Vec3>, direction: impl Into<Vec3>) -> Result<Option<RayHit>> {
        let ray = Ray::new(origin.into(), direction.into())?;
        let time = self.muscle_clock.written_time();
        Ok(ray.first(self.sync()?, time))
    }
}

/// A ray, in f64 because scenes can be large compared with their bodies.
struct Ray {
    origin: DVec3,
    /// A unit vector.
    direction: DVec3,
}

/// An entry into a surface: the distance, and the unit normal against the ray.
type Entry = (f64, DVec3);

impl Ray {
    fn new(origin: Vec3, direction: Vec3) -> Result<Self> {
        finite("ray.origin", origin)?;
        finite("ray.direction", direction)?;
        let unit = direction.as_dvec3().try_normalize().ok_or_else(|| Error::Invalid {
            field: "ray.direction",
            value: format!("{:?}", direction.to_array()),
            expected: "a vector that is not zero",
        })?;
        Ok(Self { origin: origin.as_dvec3(), direction: unit })
    }

    /// The first hit in a scene whose walls are where their motions put them at a time, in s.
    fn first(&self, scene: &Scene, time: f64) -> Option<RayHit> {
        let poses = scene.poses(time);
        let spheres = nearest(scene.spheres(), |index, sphere| {
            let centre = sphere.position.as_dvec3();
            let way = scene.way_into_box(centre);
            let id = scene.spheres.handle_at(index);
            match (scene.box_at(id), scene.hull_of_sphere(id)) {
                (Some(cuboid), _) => self.cuboid(&Cuboid { corner: cuboid.corner + way.as_vec3(), ..cuboid }),
                (None, Some(hull)) => self.hull(hull, centre + way, sphere.orientation.as_dquat().normalize()),
                (None, None) => self.sphere(centre + way, sphere.radius.into()),
            }
        });
        let rods = nearest(scene.rods(), |_, rod| self.rod(scene, rod));
        let boxes = nearest(scene.boxes(), |_, cuboid| self.cuboid(&poses.of_box(cuboid)));
        let polygons = nearest(scene.polygons(), |_, polygon| self.polygon(&poses.of_polygon(polygon)));
        let found = [
            spheres.map(|(index, entry)| (Body::Sphere(scene.spheres.handle_at(index)), entry)),
            rods.map(|(index, entry)| (Body::Rod(scene.rods.handle_at(index)), entry)),
            boxes.map(|(index, entry)| (Body::Box(scene.boxes.handle_at(index)), entry)),
            polygons.map(|(index, entry)| (Body::Polygon(scene.polygons.handle_at(index)), entry)),
        ];
        // Of equal distances, `min_by` returns the first.
        let (body, (distance, normal)) = found.into_iter().flatten().min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        Some(RayHit { body, distance: distance as f32, point: self.at(distance).as_vec3(), normal: normal.as_vec3() })
    }

    fn at(&self, distance: f64) -> DVec3 {
        self.origin + distance * self.direction
    }

    /// Solves |o + t d - c| = r by t = b - sqrt(r² - |(o - c) + b d|²), b = (c - o).d. The foot of the perpendicular from the
    /// centre is computed first, so that nothing cancels for distant spheres.
    fn sphere(&self, centre: DVec3, radius: f64) -> Option<Entry> {
        let m = self.origin - centre;
        let b = -m.dot(self.direction);
        let half_chord = radius * radius - (m + b * self.direction).length_squared();
        let outside = m.length_squared() >= radius * radius;
        (outside && b >= 0.0 && half_chord >= 0.0).then(|| {
            let t = (b - half_chord.sqrt()).max(0.0);
            (t, (self.at(t) - centre) / radius)
        })
    }

    fn rod(&self, scene: &Scene, rod: &Rod) -> Option<Entry> {
        let [one, two] = [rod.end1, rod.end2].map(|end| scene.sphere(end).map(|sphere| sphere.position.as_dvec3()));
        let (one, two) = (one.ok()?, two.ok()?);
        let way = scene.way_into_box(one);
        self.capsule(one + way, two + way, rod.radius.into())
    }

    /// Intersects the infinite cylinder around the capsule: the ray meets its side or, beyond an end, the sphere of that end.
    fn capsule(&self, one: DVec3, two: DVec3, radius: f64) -> Option<Entry> {
        let axis = two - one;
        let Some(unit) = axis.try_normalize() else {
            return self.sphere(one, radius);
        };
        let length = axis.length();
        let along = |p: DVec3| (p - one).dot(unit);
        let mut place = along(self.origin);
        if self.origin.distance_squared(one + place * unit) >= radius * radius {
            let side = self.cylinder(one, unit, radius)?;
            place = along(self.at(side.0));
            if (0.0..=length).contains(&place) {
                return Some(side);
            }
        } else if (0.0..=length).contains(&place) {
            return None;
        }
        self.sphere(if place < 0.0 { one } else { two }, radius)
    }

    /// Intersects an infinite cylinder, which is a circle when seen along its axis.
    fn cylinder(&self, start: DVec3, axis: DVec3, radius: f64) -> Option<Entry> {
        let across = |v: DVec3| v - v.dot(axis) * axis;
        let direction = across(self.direction);
        let rate = direction.length();
        if rate == 0.0 {
            return None;
        }
        let flat = Ray { origin: across(self.origin - start), direction: direction / rate };
        flat.sphere(DVec3::ZERO, radius).map(|(t, normal)| (t / rate, normal))
    }

    /// A ray enters a box where it has entered all three slabs between opposite faces.
    fn cuboid(&self, cuboid: &Cuboid) -> Option<Entry> {
        let from_corner = self.origin - cuboid.corner.as_dvec3();
        let mut enter = (f64::NEG_INFINITY, DVec3::ZERO);
        let mut leave = f64::INFINITY;
        for edge in cuboid.edges.map(Vec3::as_dvec3) {
            let length = edge.length();
            let outward = edge / length;
            let (place, rate) = (from_corner.dot(outward), self.direction.dot(outward));
            if rate == 0.0 {
                if !(0.0..=length).contains(&place) {
                    return None;
                }
                continue;
            }
            let (near, far) = if rate > 0.0 { (0.0, length) } else { (length, 0.0) };
            let t = (near - place) / rate;
            if t > enter.0 {
                enter = (t, -rate.signum() * outward);
            }
            leave = leave.min((far - place) / rate);
        }
        (enter.0 >= 0.0 && enter.0 <= leave).then_some(enter)
    }

    /// Intersects the half-spaces of the faces of a hull about its centre.
    fn hull(&self, hull: &ShapeHull, centre: DVec3, turn: DQuat) -> Option<Entry> {
        let back = turn.inverse();
        let (origin, direction) = (back * (self.origin - centre), back * self.direction);
        let (mut enter, mut leave) = ((f64::NEG_INFINITY, DVec3::ZERO), f64::INFINITY);
        for (normal, anchor) in hull.planes() {
            let (height, rate) = (normal.dot(origin - anchor), normal.dot(direction));
            if rate < 0.0 && -height / rate > enter.0 {
                enter = (-height / rate, normal);
            } else if rate > 0.0 {
                leave = leave.min(-height / rate);
            } else if rate == 0.0 && height > 0.0 {
                return None;
            }
        }
        (enter.0 >= 0.0 && enter.0 <= leave).then_some((enter.0, turn * enter.1))
    }

    /// Intersects the plane, then computes the oblique parameters along both edges (docs/physics section 2).
    fn polygon(&self, polygon: &Polygon) -> Option<Entry> {
        if polygon.surface.is_round() {
            return self.round(polygon);
        }
        let [corner, left, right] = [polygon.corner, polygon.left, polygon.right].map(Vec3::as_dvec3);
        let normal = left.cross(right);
        let rate = self.direction.dot(normal);
        if rate == 0.0 {
            return None;
        }
        let t = (corner - self.origin).dot(normal) / rate;
        let p = self.at(t) - corner;
        let square = normal.length_squared();
        let parameters = [p.cross(right).dot(normal) / square, left.cross(p).dot(normal) / square];
        let on_parallelogram = parameters.iter().all(|parameter| (0.0..=1.0).contains(parameter))
            && (!polygon.is_triangle() || parameters[0] + parameters[1] <= 1.0);
        let inside = on_parallelogram || polygon.surface == Surface::Plane;
        (t >= 0.0 && inside).then(|| (t, -rate.signum() * normal.normalize()))
    }

    /// Solves |o + t d - c|² = r² for a ball, and |across|² = (r + slope z)² with the way z along the axis for a cone (docs/physics section 2.17).
    fn round(&self, wall: &Polygon) -> Option<Entry> {
        let from_corner = self.origin - wall.corner.as_dvec3();
        let Some(axis) = wall.cone_axis() else {
            let radius = wall.left.as_dvec3().length();
            let normal = |t: f64| from_corner + t * self.direction;
            let roots = roots([1.0, from_corner.dot(self.direction), from_corner.length_squared() - radius * radius]);
            let t = roots.into_iter().find(|t| *t >= 0.0)?;
            return Some((t, self.against(normal(t).normalize())));
        };
        let (length, unit) = (axis.along.length(), axis.along.normalize());
        let slope = (axis.radii[1] - axis.radii[0]) / length;
        let [(way, across), (rate, turn)] = [from_corner, self.direction].map(|v| (v.dot(unit), v - v.dot(unit) * unit));
        let (radius, growth) = (axis.radii[0] + slope * way, slope * rate);
        let roots = roots([
            turn.length_squared() - growth * growth,
            across.dot(turn) - radius * growth,
            across.length_squared() - radius * radius,
        ]);
        let t = roots.into_iter().find(|t| *t >= 0.0 && (0.0..=length).contains(&(way + t * rate)))?;
        let out = (across + t * turn).normalize_or(wall.right.as_dvec3().normalize());
        Some((t, self.against((out - slope * unit).normalize())))
    }

    /// A normal, turned against the ray.
    fn against(&self, normal: DVec3) -> DVec3 {
        if normal.dot(self.direction) > 0.0 { -normal } else { normal }
    }
}

/// The real roots of a t² + 2 b t + c = 0 in ascending order.
fn roots([a, b, c]: [f64; 3]) -> Vec<f64> {
    if a == 0.0 {
        return if b == 0.0 { Vec::new() } else { vec![-c / (2.0 * b)] };
    }
    let squared = b * b - a * c;
    if squared < 0.0 {
        return Vec::new();
    }
    // The sum of numbers of one sign does not cancel.
    let far = -b - b.signum() * squared.sqrt();
    let mut both = if far == 0.0 { vec![0.0] } else { vec![far / a, c / far] };
    both.sort_by(f64::total_cmp);
    both
}

/// The object that the ray enters first; of equal distances, the one that was added first.
fn nearest<T: Sync>(objects: &[T], entry: impl Fn(usize, &T) -> Option<Entry> + Sync) -> Option<(usize, Entry)> {
    let entered = objects.par_iter().enumerate().filter_map(|(index, object)| Some((index, entry(index, object)?)));
    entered.min_by(|a, b| a.1.0.total_cmp(&b.1.0).then(a.0.cmp(&b.0)))
}
