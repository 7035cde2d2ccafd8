//! Periodic boundaries (docs/physics section 2.14).

use glam::{DVec3, Vec3};

use crate::error::{Error, Result};
use crate::phase::phase;
use crate::scene::{Scene, Shear};
use crate::settings::{Precision, Settings};

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

    /// The displacement of a position, in units, that takes it into the box of a periodic scene: whole periods along each axis, and what
    /// a shear displaces the images by.
    pub fn way_into_box(&self, position: DVec3) -> DVec3 {
        self.image_in_box(position).0
    }

    /// The displacement that takes a position into the box, and the velocity that the image there has in addition, in units/s.
    pub(crate) fn image_in_box(&self, position: DVec3) -> (DVec3, Vec3) {
        let mut way = DVec3::ZERO;
        let mut velocity = Vec3::ZERO;
        if let Some(shear) = self.shear {
            let Shear { gradient, flow, .. } = shear;
            let period = |axis: usize| self.periodic[axis].map_or(0.0, |[from, to]| f64::from(to - from));
            way[gradient] = self.back(gradient, position);
            let boxes = (way[gradient] / period(gradient)).round();
            way[flow] = boxes * shear.turns() * period(flow);
            velocity[flow] = (boxes * self.shear_speed()) as f32;
        }
        for axis in 0..3 {
            let moved = position + way;
            way[axis] += self.back(axis, moved);
        }
        (way, velocity)
    }

    /// Whole periods along an axis that take a position into the box.
    fn back(&self, axis: usize, position: DVec3) -> f64 {
        let Some([from, to]) = self.periodic[axis] else { return 0.0 };
        let (from, period) = (f64::from(from), f64::from(to - from));
        let way = -period * ((position[axis] - from) / period).floor();
        // Just below the lower face, rounding may take a position to the upper one, which is the lower one again.
        if position[axis] + way >= from + period { way - period } else { way }
    }

    /// Checks that no two images of one body can touch the same object.
    pub(crate) fn check_periods(&self) -> Result<()> {
        self.check_shear()?;
        if self.is_periodic() && self.settings.precision == Precision::Single && !self.is_rigid() {
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

impl Scene {
    /// The shear of a periodic scene.
    pub fn shear(&self) -> Option<Shear> {
        self.shear
    }

    /// Shears a periodic scene, or no longer with `None`. The scene must be periodic along both axes when a simulation is made.
    ///
    /// Bodies meet the images above and below the box with the velocity that these have. A simulation keeps the displacement of the
    /// images in its scene. A sheared scene consists of moving spheres, springs, tethers and forces, and has no collisions as impulses
    /// and no `linear_damping`; that is checked when a simulation is made.
    ///
    /// # Errors
    /// [`Error::Invalid`] if an axis is not 0, 1 or 2, both are the same, or the rate is not finite.
    pub fn set_shear(&mut self, shear: Option<Shear>) -> Result<()> {
        if let Some(Shear { gradient, flow, rate, .. }) = shear {
            if gradient > 2 || flow > 2 || gradient == flow {
                let value = format!("{gradient} and {flow}");
                return Err(Error::Invalid { field: "shear.axes", value, expected: "two of the axes 0, 1 and 2" });
            }
            if !rate.is_finite() {
                return Err(Error::Invalid {
                    field: "shear.rate",
                    value: rate.to_string(),
                    expected: "a finite number, in 1/s",
                });
            }
        }
        self.shear = shear;
        Ok(())
    }

    /// Velocity of the box above, in units/s.
    pub(crate) fn shear_speed(&self) -> f64 {
        let Some(Shear { gradient, rate, .. }) = self.shear else { return 0.0 };
        self.periodic()[gradient].map_or(0.0, |[from, to]| f64::from(to - from) * f64::from(rate))
    }

    /// Change of the displacement of the box above in half a step of `dt` seconds, in units of 2^-64 periods.
    pub(crate) fn shear_in_half_step(&self, dt: f32) -> u64 {
        let Some(Shear { flow, .. }) = self.shear else { return 0 };
        let period = self.periodic()[flow].map_or(1.0, |[from, to]| f64::from(to - from));
        phase(0.5 * f64::from(dt) * self.shear_speed() / period)
    }

    /// Moves the images on by some steps.
    pub(crate) fn advance_shear(&mut self, steps: u64, dt: f32) {
        let change = self.shear_in_half_step(dt).wrapping_mul(steps.wrapping_mul(2));
        if let Some(shear) = &mut self.shear {
            shear.phase = shear.phase.wrapping_add(change);
        }
    }

    /// Checks that a sheared scene has nothing that cannot be sheared.
    fn check_shear(&self) -> Result<()> {
        let Some(Shear { gradient, flow, .. }) = self.shear else { return Ok(()) };
        if let Some(axis) = [gradient, flow].into_iter().find(|axis| self.periodic()[*axis].is_none()) {
            let value = format!("not periodic along {}", AXES[axis]);
            return Err(Error::Invalid {
                field: "shear",
                value,
                expected: "a scene that is periodic along both axes of the shear",
            });
        }
        let Settings { collisions, coulomb_friction, linear_damping, contact_law, .. } = self.chosen_settings();
        let impulses = !contact_law.has_history() && coulomb_friction != 0.0;
        let found = [
            (!self.rods().is_empty(), "a rod"),
            (!self.bodies().is_empty(), "a rigid body"),
            (!self.boxes().is_empty(), "a box"),
            (!self.polygons().is_empty(), "a polygon"),
            (self.spheres().iter().any(|sphere| sphere.fixed), "a fixed sphere"),
            (!self.inlets().is_empty(), "an inlet"),
            (!self.outlets().is_empty(), "an outlet"),
            (collisions, "collisions on"),
            (impulses, "coulomb_friction"),
            (linear_damping != 0.0, "linear_damping"),
        ];
        let Some((_, value)) = found.into_iter().find(|(is_there, _)| *is_there) else { return Ok(()) };
        let expected = "moving spheres, springs, tethers and forces in a sheared scene, without collisions, friction impulses and linear_damping";
        Err(Error::Invalid { field: "shear", value: value.to_owned(), expected })
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;

    fn sheared() -> Scene {
        let mut scene = Scene::new();
        scene.set_periodic(0, Some([-1.0, 3.0])).unwrap();
        scene.set_periodic(1, Some([0.0, 2.0])).unwrap();
        scene.set_shear(Some(Shear::new(1, 0, 0.5).with_turns(0.375))).unwrap();
        scene
    }

    #[test]
    fn images_are_brought_into_the_box_along_the_shear() {
        let scene = sheared();
        let (way, velocity) = scene.image_in_box(DVec3::new(0.5, 3.0, 7.0));
        // One box down: 0.375 of 4 units back along x, and one unit/s less.
        assert_eq!((way, velocity), (DVec3::new(-1.5, -2.0, 0.0), Vec3::new(-1.0, 0.0, 0.0)));
        let (way, velocity) = scene.image_in_box(DVec3::new(0.5, -3.0, 7.0));
        assert_eq!((way, velocity), (DVec3::new(3.0 - 4.0, 4.0, 0.0), Vec3::new(2.0, 0.0, 0.0)));
    }

    #[test]
    fn displacements_do_not_depend_on_how_steps_are_divided() {
        let mut once = sheared();
        once.advance_shear(1_000_000, 0.001);
        let mut often = sheared();
        (0..1000).for_each(|_| often.advance_shear(1000, 0.001));
        assert_eq!(once.shear(), often.shear());
        // 1000 s at 0.25 periods/s.
        let turns = once.shear().unwrap().turns();
        assert!((turns - 0.375).abs() < 1e-4, "{turns}");
    }

    #[test]
    fn what_cannot_be_sheared_is_refused() {
        let check = |change: fn(&mut Scene)| {
            let mut scene = sheared();
            scene.settings.collisions = false;
            change(&mut scene);
            scene.check_periods().map_err(|error| error.to_string())
        };
        check(|_| ()).unwrap();
        let error = check(|scene| scene.set_periodic(0, None).unwrap()).unwrap_err();
        assert!(error.contains("not periodic along x"), "{error}");
        let error = check(|scene| scene.settings.linear_damping = 0.1).unwrap_err();
        assert!(error.contains("linear_damping"), "{error}");
        let error = check(|scene| scene.settings.collisions = true).unwrap_err();
        assert!(error.contains("collisions on"), "{error}");
    }
}
