//! Net forces with those of rods of fixed length, which the physics has as conditions and not as forces.

use std::collections::HashMap;

use rockfall::glam::DVec3;
use rockfall::{Result, Scene, Simulation, SphereDiagnostics, SphereId};

/// Greatest number of iterations. As many as there are rods are enough without rounding errors.
const MOST: usize = 200;
/// Residual at which the tensions are exact enough, divided by that at the start.
const EXACT: f64 = 1e-9;

/// The values of all spheres, where the net force contains the forces of rods of fixed length and of capsules.
///
/// # Errors
/// As for [`Simulation::diagnostics`].
pub(crate) fn diagnostics(simulation: &mut Simulation) -> Result<Vec<SphereDiagnostics>> {
    let mut values = simulation.diagnostics()?;
    let scene = simulation.sync()?;
    if scene.rods().iter().any(|rod| rod.length.is_some()) {
        let forces: Vec<DVec3> = values.iter().map(|value| value.net_force.as_dvec3()).collect();
        for (value, force) in values.iter_mut().zip(Network::of(scene).held(&forces)) {
            value.net_force = force.as_vec3();
        }
    }
    Ok(values)
}

/// A rod of fixed length.
struct Link {
    ends: [usize; 2],
    /// Unit vector from the first end to the second.
    along: DVec3,
    /// How fast the ends have to accelerate towards each other because they move around each other.
    inward: f64,
}

/// The rods of fixed length of a scene.
struct Network {
    links: Vec<Link>,
    /// One divided by the mass of every sphere, 0 for a fixed one.
    inverse: Vec<f64>,
}

impl Network {
    fn of(scene: &Scene) -> Self {
        let index: HashMap<SphereId, usize> = scene.sphere_ids().zip(0..).collect();
        let spheres = scene.spheres();
        let link = |rod: &rockfall::Rod| {
            rod.length?;
            let ends = [index.get(&rod.end1).copied()?, index.get(&rod.end2).copied()?];
            let [one, two] = ends.map(|end| &spheres[end]);
            let way = nearest(scene, (two.position - one.position).as_dvec3());
            let along = way.try_normalize()?;
            let velocity = (two.velocity - one.velocity).as_dvec3();
            let around = velocity - velocity.dot(along) * along;
            Some(Link { ends, along, inward: around.length_squared() / way.length() })
        };
        let inverse = spheres.iter().map(|sphere| if sphere.fixed { 0.0 } else { 1.0 / f64::from(sphere.mass) });
        Self { links: scene.rods().iter().filter_map(link).collect(), inverse: inverse.collect() }
    }

    /// The forces of tensions on all spheres.
    fn forces(&self, tensions: &[f64]) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; self.inverse.len()];
        for (link, tension) in self.links.iter().zip(tensions) {
            forces[link.ends[0]] += *tension * link.along;
            forces[link.ends[1]] -= *tension * link.along;
        }
        forces
    }

    /// How fast forces make the ends of every rod accelerate towards each other.
    fn approach(&self, forces: &[DVec3]) -> Vec<f64> {
        let acceleration = |end: usize| self.inverse[end] * forces[end];
        self.links.iter().map(|link| (acceleration(link.ends[0]) - acceleration(link.ends[1])).dot(link.along)).collect()
    }

    /// Forces with those of the rods, by the method of conjugate gradients: the tensions keep all lengths.
    fn held(&self, forces: &[DVec3]) -> Vec<DVec3> {
        let mut rest: Vec<f64> =
            self.links.iter().zip(self.approach(forces)).map(|(link, approach)| link.inward - approach).collect();
        let (mut tensions, mut way) = (vec![0.0; rest.len()], rest.clone());
        let mut size = dot(&rest, &rest);
        let least = EXACT * EXACT * size;
        for _ in 0..MOST.min(4 * rest.len()) {
            let effect = self.approach(&self.forces(&way));
            let gain = dot(&way, &effect);
            if size <= least || gain <= 0.0 {
                break;
            }
            let step = size / gain;
            tensions.iter_mut().zip(&way).for_each(|(tension, way)| *tension += step * way);
            rest.iter_mut().zip(&effect).for_each(|(rest, effect)| *rest -= step * effect);
            let before = std::mem::replace(&mut size, dot(&rest, &rest));
            way.iter_mut().zip(&rest).for_each(|(way, rest)| *way = rest + size / before * *way);
        }
        let moved = self.inverse.iter().zip(forces.iter().zip(self.forces(&tensions)));
        moved.map(|(inverse, (force, rods))| if *inverse > 0.0 { *force + rods } else { *force }).collect()
    }
}

fn dot(one: &[f64], two: &[f64]) -> f64 {
    one.iter().zip(two).map(|(one, two)| one * two).sum()
}

/// The nearest image of a vector.
fn nearest(scene: &Scene, way: DVec3) -> DVec3 {
    let periods = scene.periodic().map(|bounds| bounds.map_or(0.0, |[from, to]| f64::from(to - from)));
    let whole = |axis: usize| if periods[axis] > 0.0 { periods[axis] * (way[axis] / periods[axis]).round() } else { 0.0 };
    way - DVec3::from_array(std::array::from_fn(whole))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rockfall::glam::Vec3;
    use rockfall::{Backend, Options};

    use super::*;

    fn forces(text: &str) -> Vec<Vec3> {
        let scene = Scene::parse(text, Path::new("test")).unwrap().scene;
        let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
        diagnostics(&mut simulation).unwrap().iter().map(|values| values.net_force).collect()
    }

    #[track_caller]
    fn near(found: Vec3, expected: [f32; 3]) {
        assert!((found - Vec3::from_array(expected)).length() < 1e-4, "{found} {expected:?}");
    }

    #[test]
    fn rods_hold_what_hangs_and_what_turns() {
        let set = "set gravity 10\n";
        // Two balls below each other hang at rest, the lower one through the upper one.
        let chain = "S 1 0 5 0 0 0 0 0 0 0 1 0.1 1\nS 2 0 4 0 0 0 0 0 0 0 2 0.1 0\nS 3 0 2 0 0 0 0 0 0 0 3 0.1 0\n\
                     R 1 2 0.05 1\nR 2 3 0.05 2\n";
        forces(&format!("{set}{chain}")).into_iter().for_each(|force| near(force, [0.0; 3]));
        // A pendulum that is let go at 45 degrees: the part of the weight across the rod.
        let pendulum = "S 1 0 0 0 0 0 0 0 0 0 1 0.1 1\nS 2 1 -1 0 0 0 0 0 0 0 2 0.1 0\nR 1 2 0.05 1.41421356\n";
        near(forces(&format!("{set}{pendulum}"))[1], [-10.0, -10.0, 0.0]);
        // A pair turns around its middle without gravity: m v²/r.
        let pair = "set gravity 0\nS 1 -1 0 0 0 3 0 0 0 0 2 0.1 0\nS 2 1 0 0 0 -3 0 0 0 0 2 0.1 0\nR 1 2 0.05 2\n";
        near(forces(pair)[0], [18.0, 0.0, 0.0]);
        // Rods of free length do nothing.
        near(
            forces(&format!("{set}S 1 0 0 0 0 0 0 0 0 0 1 0.1 1\nS 2 0 -1 0 0 0 0 0 0 0 2 0.1 0\nR 1 2 0.05\n"))[1],
            [0.0, -20.0, 0.0],
        );
    }

    /// In a run, the ends of a rod may be on different sides of a periodic box.
    #[test]
    fn a_rod_through_the_face_of_a_periodic_box_is_short() {
        let scene = Scene::parse("@periodic x 0 10\n", Path::new("test")).unwrap().scene;
        assert_eq!(nearest(&scene, DVec3::new(-9.0, 9.0, 0.5)), DVec3::new(1.0, 9.0, 0.5));
    }
}
