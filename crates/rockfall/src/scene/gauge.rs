//! Gauges: what a run measures of walls and planes.

use glam::DVec3;

use crate::error::{Error, Result, nearest, quoted};
use crate::scene::{Body, MotionId, ObjectId, Scene};

/// Measures the load on walls, or the flow of spheres through a plane. It changes no result.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gauge {
    /// Name, which no other gauge of the scene has. It is one word without `=`, `,` and `#`, and begins with a letter or `_`.
    pub name: String,
    /// What it measures.
    pub of: Gauged,
}

/// What a [`Gauge`] measures.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Gauged {
    /// The force and the torque that bodies exert on the boxes and polygons that have this name or follow the motion of this name.
    Wall(String),
    /// The spheres whose centre passes a plane. A sphere is in front of it where (x - point) · normal is positive. In a scene that is
    /// periodic along the normal, the images of the plane count as well.
    Plane {
        /// A point of the plane, in units.
        point: DVec3,
        /// Direction in which a passage counts as positive. Its length does not matter, but it is not 0.
        normal: DVec3,
    },
}

impl Gauge {
    /// A gauge of the load on the walls of a name or a motion.
    pub fn wall(name: impl Into<String>, wall: impl Into<String>) -> Self {
        Self { name: name.into(), of: Gauged::Wall(wall.into()) }
    }

    /// A gauge of the flow through a plane.
    pub fn plane(name: impl Into<String>, point: impl Into<DVec3>, normal: impl Into<DVec3>) -> Self {
        Self { name: name.into(), of: Gauged::Plane { point: point.into(), normal: normal.into() } }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        super::tag::check_name("gauge.name", &self.name)?;
        let Gauged::Plane { point, normal } = self.of else { return Ok(()) };
        if !(point.is_finite() && normal.is_finite() && normal.try_normalize().is_some()) {
            let value = format!("{:?} {:?}", point.to_array(), normal.to_array());
            return Err(Error::Invalid {
                field: "gauge.plane",
                value,
                expected: "six finite numbers: a point, and a normal other than 0",
            });
        }
        Ok(())
    }
}

/// The spheres in front of the plane of a gauge: their number and their mass. Both are 0 for the gauge of a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Front {
    pub(crate) count: i64,
    pub(crate) mass: f64,
}

impl Front {
    pub(crate) fn add(&mut self, mass: f32, times: i64) {
        self.count += times;
        self.mass += f64::from(mass) * times as f64;
    }

    pub(crate) fn less(self, other: Self) -> Self {
        Self { count: self.count - other.count, mass: self.mass - other.mass }
    }
}

impl Gauged {
    pub(crate) fn is_plane(&self) -> bool {
        matches!(self, Self::Plane { .. })
    }

    /// How often a centre is in front of the plane: 0 or 1. Where the normal is along a periodic axis, the images of the plane count, too,
    /// less those behind which the centre is.
    pub(crate) fn times_in_front(&self, centre: DVec3, bounds: &[Option<[f32; 2]>; 3]) -> i64 {
        let Self::Plane { point, normal } = self else { return 0 };
        let from_plane = centre - *point;
        let along = |axis: &usize| (0..3).all(|other| (normal[other] != 0.0) == (other == *axis));
        match (0..3).find(along).map(|axis| (axis, bounds[axis])) {
            Some((axis, Some([from, to]))) => {
                let period = f64::from(to) - f64::from(from);
                (from_plane[axis] * normal[axis].signum() / period).ceil() as i64
            }
            _ => i64::from(from_plane.dot(*normal) > 0.0),
        }
    }
}

impl Scene {
    /// Adds a gauge. Gauges change no result of a simulation; [`Simulation::gauges`](crate::Simulation::gauges) reads them.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a name that another gauge has or that is not one word, a plane whose numbers are not finite or whose
    /// normal is 0, and a wall that is neither the name of a box or polygon nor a motion that one follows.
    pub fn add_gauge(&mut self, gauge: Gauge) -> Result<()> {
        if let Gauged::Wall(wall) = &gauge.of {
            self.check_wall("gauge.wall", wall)?;
        }
        self.put_gauge(gauge)
    }

    /// Adds a gauge whose walls may be added later.
    pub(crate) fn put_gauge(&mut self, gauge: Gauge) -> Result<()> {
        gauge.validate()?;
        if self.gauges.iter().any(|known| known.name == gauge.name) {
            let expected = "a name that no other gauge has";
            return Err(Error::Invalid { field: "gauge.name", value: quoted(&gauge.name), expected });
        }
        self.gauges.push(gauge);
        Ok(())
    }

    /// All gauges, in order of addition.
    pub fn gauges(&self) -> &[Gauge] {
        &self.gauges
    }

    /// Checks that a box or a polygon has a name or follows the motion of that name.
    pub(crate) fn check_wall(&self, field: &'static str, name: &str) -> Result<()> {
        if self.walls().any(|wall| self.is_wall(wall, name)) {
            return Ok(());
        }
        let motions = self.motions().iter().map(|motion| motion.name.as_str());
        let known: Vec<&str> = self.names().into_iter().chain(motions).collect();
        let value = quoted(name) + &nearest(name, &known).map_or(String::new(), |near| format!(" (similar: {})", quoted(near)));
        Err(Error::Invalid { field, value, expected: "the name of a motion, or of boxes or polygons" })
    }

    /// The boxes and polygons.
    fn walls(&self) -> impl Iterator<Item = Body> {
        self.box_ids().map(Body::Box).chain(self.polygon_ids().map(Body::Polygon))
    }

    /// Whether a body is a box or polygon that has a name or follows the motion of that name.
    pub(crate) fn is_wall(&self, body: Body, name: &str) -> bool {
        let id = match body {
            Body::Box(id) => ObjectId::from(id),
            Body::Polygon(id) => ObjectId::from(id),
            _ => return false,
        };
        let of_motion = self.motion_of(body).and_then(|id| self.motion(id).ok()).is_some_and(|motion| motion.name == name);
        of_motion || self.tag(id).ok().flatten().is_some_and(|tag| tag.name.as_deref() == Some(name))
    }

    /// The motion that a wall follows.
    pub(crate) fn motion_of(&self, body: Body) -> Option<MotionId> {
        match body {
            Body::Box(id) => self.cuboid(id).ok()?.motion,
            Body::Polygon(id) => self.polygon(id).ok()?.motion,
            _ => None,
        }
    }
}

#[cfg(test)]
#[path = "gauge_tests.rs"]
mod tests;
