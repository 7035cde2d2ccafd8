//! Groups of bodies that rods and springs hold together.

use std::collections::BTreeMap;

use rockfall::Scene;

/// Bodies that cannot leave each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    /// The bodies of the group among those of a survey, as indices.
    pub(crate) bodies: Vec<usize>,
    /// Whether a fixed sphere or a tether keeps the group where it is.
    pub(crate) held: bool,
}

/// Returns the groups of a scene, with every `stride`-th sphere. A sphere without bonds is a group of its own.
pub(crate) fn groups(scene: &Scene, stride: usize) -> Vec<Group> {
    let sets = scene.bonded_sets(|_| true);
    let mut groups: BTreeMap<usize, Group> = BTreeMap::new();
    for (at, body) in (0..scene.spheres().len()).step_by(stride).enumerate() {
        let group = groups.entry(sets.first(body)).or_insert_with(|| Group { held: sets.is_held(body), ..Group::default() });
        group.bodies.push(at);
    }
    groups.into_values().collect()
}

#[cfg(test)]
mod tests {
    use rockfall::{Rod, Sphere, Spring, Tether};

    use super::*;

    #[test]
    fn rods_and_springs_connect_bodies_and_fixed_spheres_and_tethers_hold_them() {
        let mut scene = Scene::new();
        let ids: Vec<_> = (0..8).map(|k| scene.add_sphere(Sphere::new([2.0 * k as f32, 0.0, 0.0], 0.5)).unwrap()).collect();
        scene.add_rod(Rod::new(ids[0], ids[5], 0.1)).unwrap();
        scene.add_spring(Spring::new(ids[5], ids[3], 1.0, 1.0)).unwrap();
        scene.add_tether(Tether::new(ids[0], [0.0; 3], 1.0)).unwrap();
        let mut pivot = Sphere::new([20.0, 0.0, 0.0], 0.5);
        pivot.fixed = true;
        scene.add_sphere(pivot).unwrap();
        let mut found: Vec<_> = groups(&scene, 1).into_iter().map(|group| (group.bodies, group.held)).collect();
        found.sort();
        let alone = |body: usize| (vec![body], body == 8);
        assert_eq!(found, [(vec![0, 3, 5], true), alone(1), alone(2), alone(4), alone(6), alone(7), alone(8)]);
        let mut free = Scene::new();
        (0..5).for_each(|k| _ = free.add_sphere(Sphere::new([2.0 * k as f32, 0.0, 0.0], 0.5)).unwrap());
        let found: Vec<_> = groups(&free, 2).into_iter().map(|group| (group.bodies, group.held)).collect();
        assert_eq!(found, [(vec![0], false), (vec![1], false), (vec![2], false)]);
        // Of every third sphere.
        let mut found: Vec<_> = groups(&scene, 3).into_iter().map(|group| group.bodies).collect();
        found.sort();
        assert_eq!(found, [vec![0, 1], vec![2]]);
    }
}
