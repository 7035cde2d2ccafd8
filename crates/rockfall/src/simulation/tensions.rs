//! The forces of springs, muscles and tethers (docs/physics sections 4.2 and 4.9).

use glam::DVec3;

use crate::error::Result;
use crate::scene::{Scene, SphereId, SpringId, TetherId};
use crate::simulation::Simulation;

/// A spring or a tether.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Link {
    /// A spring, which may be a muscle.
    Spring(SpringId),
    /// A tether.
    Tether(TetherId),
}

/// The length and the force of a spring or a tether.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Tension {
    /// The spring or the tether.
    pub link: Link,
    /// The sphere at end A.
    pub a: SphereId,
    /// The sphere at end B; `None` for a tether, which ends in a point.
    pub b: Option<SphereId>,
    /// Distance of the ends, in units.
    pub length: f32,
    /// Force with which it pulls its ends together, damping included, in mass units/s². It is negative where it pushes them apart.
    pub force: f32,
}

/// What determines the force of a spring.
struct Law {
    stiffness: f32,
    /// Present rest length.
    rest: f64,
    damping: f32,
}

impl Law {
    /// The distance of the ends and the tension. `apart` and `velocity` are those of end B relative to end A.
    fn pull(&self, apart: DVec3, velocity: DVec3) -> (f32, f32) {
        let distance = apart.length();
        // Where the ends coincide there is no direction, and so no force.
        let Some(direction) = apart.try_normalize() else { return (0.0, 0.0) };
        let elastic = f64::from(self.stiffness) * (distance - self.rest);
        (distance as f32, (elastic + f64::from(self.damping) * velocity.dot(direction)) as f32)
    }
}

impl Tension {
    /// The point in which a tether ends; the origin for a spring.
    pub(super) fn point(&self, scene: &Scene) -> DVec3 {
        match self.link {
            Link::Tether(id) => scene.tether(id).map(|tether| tether.point.as_dvec3()).unwrap_or_default(),
            Link::Spring(_) => DVec3::ZERO,
        }
    }
}

impl Simulation {
    /// The lengths and tensions of all springs and then of all tethers, each in order of addition, in the current state. Muscles
    /// have their present rest length. The model has no force in a rod: rods of fixed length are kept by corrections of positions
    /// and velocities (docs/physics section 5.4).
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn tensions(&mut self) -> Result<Vec<Tension>> {
        self.sync()?;
        let scene = &self.scene;
        let state =
            |id: SphereId| scene.sphere(id).map(|sphere| (DVec3::from_array(sphere.centre()), sphere.velocity.as_dvec3()));
        let mut found = Vec::with_capacity(scene.springs().len() + scene.tethers().len());
        for (id, spring) in scene.spring_ids().zip(scene.springs()) {
            let ((from, first), (to, second)) = (state(spring.a)?, state(spring.b)?);
            let law = Law { stiffness: spring.stiffness, rest: self.rest_length(id)?, damping: spring.damping };
            let (length, force) = law.pull(to - from, second - first);
            found.push(Tension { link: Link::Spring(id), a: spring.a, b: Some(spring.b), length, force });
        }
        for (id, tether) in scene.tether_ids().zip(scene.tethers()) {
            let (place, velocity) = state(tether.sphere)?;
            let law = Law { stiffness: tether.stiffness, rest: tether.length.into(), damping: tether.damping };
            let (length, force) = law.pull(tether.point.as_dvec3() - place, -velocity);
            found.push(Tension { link: Link::Tether(id), a: tether.sphere, b: None, length, force });
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{Backend, Muscle, Options, Scene, Sphere, Spring, Tether};

    fn simulation(scene: Scene) -> Simulation {
        Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap()
    }

    fn ball(x: f32, velocity: [f32; 3]) -> Sphere {
        Sphere::new([x, 0.0, 0.0], 0.1).velocity(velocity)
    }

    #[test]
    fn tensions_are_those_of_hookes_law_with_damping() {
        let mut scene = Scene::new();
        let balls = [ball(0.0, [0.0; 3]), ball(3.0, [0.5, 7.0, 0.0])].map(|ball| scene.add_sphere(ball).unwrap());
        // 10 (3 - 2) + 4 · 0.5
        let long = scene.add_spring(Spring::new(balls[0], balls[1], 10.0, 2.0).damping(4.0)).unwrap();
        // 10 (3 - 5)
        let short = scene.add_spring(Spring::new(balls[1], balls[0], 10.0, 5.0)).unwrap();
        // 2 (1 - 0) + 3 · (-0.5): the ball comes nearer to the point.
        let tether = scene.add_tether(Tether::new(balls[1], [4.0, 0.0, 0.0], 2.0).damping(3.0)).unwrap();
        let found = simulation(scene).tensions().unwrap();
        let links: Vec<_> = found.iter().map(|tension| tension.link).collect();
        assert_eq!(links, [Link::Spring(long), Link::Spring(short), Link::Tether(tether)]);
        assert_eq!(
            found.iter().map(|tension| (tension.length, tension.force)).collect::<Vec<_>>(),
            [(3.0, 12.0), (3.0, -20.0), (1.0, 0.5)]
        );
        assert_eq!([found[1].a, found[2].a], [balls[1]; 2]);
        assert_eq!([found[1].b, found[2].b], [Some(balls[0]), None]);
    }

    #[test]
    fn a_muscle_pulls_with_its_present_rest_length() {
        let mut scene = Scene::new();
        let ends = [0.0, 2.0].map(|x| scene.add_sphere(ball(x, [0.0; 3]).fixed()).unwrap());
        // At a quarter of a turn the rest length is 2 (1 + 0.25).
        let muscle = Muscle::new(0.25, 1.0, 0.0);
        scene.add_spring(Spring::new(ends[0], ends[1], 8.0, 2.0).muscle(muscle)).unwrap();
        let mut simulation = simulation(scene);
        assert_eq!(simulation.tensions().unwrap()[0].force, 0.0);
        simulation.run(1, 0.25).unwrap();
        assert!((simulation.tensions().unwrap()[0].force + 4.0).abs() < 1e-5);
    }

    /// The force that the engine evaluates moves a ball by the tension.
    #[test]
    fn the_net_force_of_a_ball_is_the_tension_of_its_springs() {
        let mut scene = Scene::new();
        let [one, two] = [ball(0.0, [0.0; 3]), ball(2.5, [0.3, 0.2, 0.0])].map(|ball| scene.add_sphere(ball).unwrap());
        scene.add_spring(Spring::new(one, two, 7.0, 2.0).damping(0.7)).unwrap();
        scene.add_tether(Tether::new(one, [-1.0, 0.0, 0.0], 3.0).length(0.5)).unwrap();
        scene.settings.gravity = 0.0;
        let mut simulation = simulation(scene);
        simulation.run(20, 0.01).unwrap();
        let [spring, tether] = simulation.tensions().unwrap().try_into().unwrap();
        let state = simulation.spheres().unwrap();
        let [first, second] = [&state[0], &state[1]].map(|state| state.position);
        let expected = spring.force * (second - first).normalize() + tether.force * (Vec3::NEG_X - first).normalize();
        let net = simulation.diagnostics().unwrap()[0].net_force;
        assert!((net - expected).length() < 1e-4 * net.length(), "{net} {expected}");
    }

    #[test]
    fn ends_at_one_place_have_no_tension() {
        let mut scene = Scene::new();
        let ends = [0.0, 0.0].map(|x| scene.add_sphere(ball(x, [0.0; 3]).fixed()).unwrap());
        scene.add_spring(Spring::new(ends[0], ends[1], 8.0, 2.0)).unwrap();
        let found = simulation(scene).tensions().unwrap();
        assert_eq!((found[0].length, found[0].force), (0.0, 0.0));
    }
}
