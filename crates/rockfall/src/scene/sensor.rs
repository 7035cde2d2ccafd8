//! Sensors: boxes that report what enters and leaves them.

use glam::DVec3;

use super::Scene;
use super::inlet::{check_box, demand};
use super::tag::check_name;
use crate::error::{Result, quoted};

/// A box that reports which bodies enter and leave it. It pushes nothing and changes no result.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sensor {
    /// Name, which no other sensor of the scene has. It is one word without `=`, `,` and `#`, and begins with a letter
    /// or `_`.
    pub name: String,
    /// Two opposite corners of the box, in units. It does not move.
    pub corners: [DVec3; 2],
}

impl Sensor {
    /// Creates a sensor between two opposite corners of a box, in units.
    pub fn new(name: impl Into<String>, corners: [[f64; 3]; 2]) -> Self {
        Self { name: name.into(), corners: corners.map(DVec3::from_array) }
    }

    /// Whether a point is in the box.
    pub(crate) fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.corners[0]).all() && point.cmple(self.corners[1]).all()
    }

    fn validate(&self) -> Result<()> {
        check_name("sensor.name", &self.name)?;
        check_box("sensor.box", &self.corners)
    }
}

impl Scene {
    /// Adds a sensor. [`Simulation::sensor_events`](crate::Simulation::sensor_events) tells what enters and leaves it.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a name that another sensor has or that is not one word, and for a
    /// box without volume.
    pub fn add_sensor(&mut self, sensor: Sensor) -> Result<()> {
        sensor.validate()?;
        let is_known = self.sensors.iter().any(|known| known.name == sensor.name);
        demand(!is_known, "sensor.name", quoted(&sensor.name), "a name that no other sensor has")?;
        self.sensors.push(sensor);
        Ok(())
    }

    /// The sensors, in order of addition.
    pub fn sensors(&self) -> &[Sensor] {
        &self.sensors
    }
}

#[cfg(test)]
#[path = "sensor_tests.rs"]
mod tests;
