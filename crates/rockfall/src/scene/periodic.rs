//! Periodic boundaries (docs/physics.md section 2.14).

use glam::{DVec3, Vec3};

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::settings::Precision;

/// Names of the axes.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

impl Scene {
    /// The bounds of the box along x, y and z, in units; `None` for an axis along which the scene is not periodic.
    pub fn periodic(&self) -> [Option<[f32; 2]>; 3] {
        self.periodic
    }

    /// Whether the scene is periodic along some axis.
    pub fn is_periodic(&self) -> bool {
        self.periodic.iter().any(Option::is_some)
    }

    /// Makes the scene periodic along an axis (0 for x, 1 for y, 2 for z), between two coordinates in units, or not periodic with `None`.
    ///
    /// Bodies meet the nearest images of each other. Boxes and polygons are not repeated, but a body meets the nearest image of each of
    /// them. A sphere, or a rod with its ends, may not be longer along the axis than half of the period, and a rigid body not in any direction; that is checked when a simulation
    /// is made.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the axis is not 0, 1 or 2, or the bounds are not finite or not in ascending order.
    pub fn set_periodic(&mut self, axis: usize, bounds: Option<[f32; 2]>) -> Result<()> {
        let Some(place) = self.periodic.get_mut(axis) else {
            return Err(Error::Invalid { field: "axis", value: axis.to_string(), expected: "0, 1 or 2" });
        };
        if let Some([from, to]) = bounds {
            let length = to - from;
            if !(from.is_finite() && to.is_finite() && length.is_finite() && length > 0.0) {
                let value = format!("{from} to {to}");
                return Err(Error::Invalid {
                    field: "periodic.bounds",
                    value,
                    expected: "two finite numbers in ascending order",
                });
            }
        }
        *place = bounds;
        Ok(())
    }

    /// The image of a position, in units, that is in the box of a periodic scene. Along other axes the position stays.
    pub fn in_box(&self, position: Vec3) -> Vec3 {
        if self.is_periodic() { (position.as_dvec3() + self.way_into_box(position.as_dvec3())).as_vec3() } else { position }
    }

    /// The displacement of a position, in units, that takes it into the box of a periodic scene: whole periods along each axis.
    pub fn way_into_box(&self, position: DVec3) -> DVec3 {
        let back = |axis: usize| {
            let Some([from, to]) = self.periodic[axis] else { return 0.0 };
            let (from, period) = (f64::from(from), f64::from(to - from));
            let way = -period * ((position[axis] - from) / period).floor();
            // Just below the lower face, rounding may take a position to the upper one, which is the lower one again.
            if position[axis] + way >= from + period { way - period } else { way }
        };
        DVec3::from_array(std::array::from_fn(back))
    }

    /// Checks that no two images of one body can touch the same object.
    pub(crate) fn check_periods(&self) -> Result<()> {
        if self.is_periodic() && self.settings.precision == Precision::Single {
            let expected = "auto or double for a periodic scene";
            return Err(Error::Invalid { field: "precision", value: Precision::Single.to_string(), expected });
        }
        for (axis, bounds) in self.periodic.iter().enumerate() {
            let Some([from, to]) = bounds else { continue };
            let most = 0.5 * (to - from);
            let too_long = |field: &'static str, index: usize, size: f32| {
                let value = format!("{} {index} is {size} units long along {}", field, AXES[axis]);
                Err(Error::Invalid { field: "periodic", value, expected: "spheres and rods of at most half of the period" })
            };
            for (index, sphere) in self.spheres().iter().enumerate() {
                if 2.0 * sphere.radius > most {
                    return too_long("sphere", index, 2.0 * sphere.radius);
                }
            }
            for (index, body) in self.bodies().iter().enumerate() {
                let size = 2.0 * self.shape_reach(body.shape)? as f32;
                if size > most {
                    let value = format!("rigid body {index} is {size} units long in some direction");
                    let expected = "rigid bodies of at most half of the period";
                    return Err(Error::Invalid { field: "periodic", value, expected });
                }
            }
            for (index, rod) in self.rods().iter().enumerate() {
                let [one, two] = [rod.end1, rod.end2].map(|end| self.sphere(end).map(|sphere| sphere.position));
                let apart: Vec3 = one? - two?;
                let size = apart[axis].abs() + 2.0 * rod.radius;
                if size > most {
                    return too_long("rod", index, size);
                }
            }
        }
        Ok(())
    }
}
