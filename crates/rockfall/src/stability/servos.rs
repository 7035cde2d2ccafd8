//! Servos that no wall follows, that seek nothing, or that are too fast for the force that they seek (docs/physics section 2.18).

use glam::DVec3;

use crate::scene::{Motion, Scene, Servo, Sphere};
use crate::settings::ContactLaw;
use crate::stability::{at_most, nearest};

impl Scene {
    /// Warnings about servos, for a time step of `dt` seconds:
    ///
    /// - a servo that no box and no polygon follows;
    /// - a torque of 0, with which the walls only yield;
    /// - a speed at which a wall moves further in a step than the overlap with which a single contact has all of the force that is sought. It
    ///   then meets bodies with more than this force, and cannot approach them.
    pub(super) fn servo_concerns(&self, dt: f32) -> Vec<String> {
        let servos = self.motions().iter().filter_map(|motion| Some((motion, motion.servo?)));
        servos.filter_map(|(motion, servo)| self.servo_concern(motion, &servo, f64::from(dt))).collect()
    }

    fn servo_concern(&self, motion: &Motion, servo: &Servo, dt: f64) -> Option<String> {
        let name = &motion.name;
        let lever = self.farthest_of(motion, servo);
        let Some(lever) = lever else {
            return Some(format!(
                "no box and no polygon follows the servo {name}: put `@move {name}` before the lines of its walls"
            ));
        };
        if servo.target() == 0.0 {
            return Some(format!("the servo {name} seeks a torque of 0: its walls yield to bodies, and rest without them"));
        }
        let force = servo.target().abs() / lever;
        let movers = self.spheres().iter().filter(|sphere| !sphere.fixed);
        let overlap = movers.filter_map(|sphere| self.overlap_of_one(sphere, force)).reduce(f64::min)?;
        let (way, largest) = (servo.speed * lever * dt, overlap / (lever * dt));
        let unit = if servo.turns() { "rad/s" } else { "units/s" };
        (way > overlap).then(|| {
            format!(
                "the walls of the servo {name} move by up to {} units a step, and a contact has all of the force that it seeks at an overlap \
                 of {} units: the first contact is far too hard; the greatest speed that works is {} {unit}",
                nearest(way),
                nearest(overlap),
                at_most(largest),
            )
        })
    }

    /// The greatest distance of a vertex of the walls of a servo from its axis, 1 for a force. `None` without walls.
    fn farthest_of(&self, motion: &Motion, servo: &Servo) -> Option<f64> {
        let id = self.find_motion(&motion.name);
        let boxes = self.boxes().iter().filter(|cuboid| cuboid.motion == id).flat_map(|cuboid| {
            let [i, j, k] = cuboid.edges.map(|edge| edge.as_dvec3());
            let edges = [DVec3::ZERO, i, j, k, i + j, j + k, i + k, i + j + k];
            edges.map(|edge| cuboid.corner.as_dvec3() + edge)
        });
        let polygons = self.polygons().iter().filter(|polygon| polygon.motion == id);
        let polygons = polygons.flat_map(|polygon| polygon.vertices().map(|vertex| vertex.as_dvec3()).collect::<Vec<_>>());
        let distance = |vertex: DVec3| {
            if servo.turns() { (vertex - servo.through()).reject_from(servo.direction()).length() } else { 1.0 }
        };
        boxes.chain(polygons).map(distance).reduce(f64::max)
    }

    /// The overlap of a sphere with a wall under a force. With the laws that have materials, that of two such spheres.
    fn overlap_of_one(&self, sphere: &Sphere, force: f64) -> Option<f64> {
        if self.contact_law() == ContactLaw::Thesis {
            let stiffness = f64::from(self.resolved_settings().contact_force) * f64::from(sphere.mass);
            return (stiffness > 0.0).then(|| force / stiffness);
        }
        self.overlap_under(sphere, force).map(|(overlap, _)| overlap)
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::{Cuboid, Motion, Scene, Servo, Sphere};

    fn press(servo: Servo) -> Scene {
        let mut scene = Scene::new();
        (scene.settings.contact_force, scene.settings.contact_damping) = (1000.0, 10.0);
        let id = scene.add_motion(Motion::servo("lid", servo)).unwrap();
        scene.add_box(Cuboid::between([-1.0, 2.0, -1.0], [1.0, 3.0, 1.0]).motion(id)).unwrap();
        scene.add_sphere(Sphere::new([0.0, 0.5, 0.0], 0.5).mass(2.0)).unwrap();
        scene
    }

    #[test]
    fn servos_that_cannot_work_are_found() {
        let found = |servo: Servo| press(servo).servo_concerns(0.01).join("\n");
        // A contact has 20 at an overlap of 0.01.
        assert_eq!(found(Servo::force([0.0, -20.0, 0.0], 0.99)), "");
        let fast = found(Servo::force([0.0, -20.0, 0.0], 1.5));
        assert!(fast.contains("servo lid move by up to 0.015 units a step") && fast.contains("0.01 units"), "{fast}");
        assert!(fast.contains("the greatest speed that works is 1 units/s"), "{fast}");
        // The farthest vertex is at the distance 2 from the axis.
        let axis = ([0.0, 0.0, 1.0], [1.0, 3.0, 0.0]);
        assert_eq!(found(Servo::torque(-40.0, axis.0, axis.1, 0.4)), "");
        assert!(found(Servo::torque(-40.0, axis.0, axis.1, 0.6)).contains("rad/s"));
        assert!(found(Servo::torque(0.0, axis.0, axis.1, 0.4)).contains("seeks a torque of 0"));
        let mut scene = press(Servo::force([0.0, -20.0, 0.0], 0.5));
        scene.add_motion(Motion::servo("other", Servo::force([1.0, 0.0, 0.0], 1.0))).unwrap();
        let alone = scene.concerns(0.01, crate::Integrator::Rk4).join("\n");
        assert!(alone.contains("no box and no polygon follows the servo other"), "{alone}");
    }
}
