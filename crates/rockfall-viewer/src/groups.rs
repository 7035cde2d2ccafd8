//! Groups of bodies that rods and springs hold together.

use rockfall::{Body, Scene, SphereId};

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
    let mut parents: Vec<usize> = (0..scene.spheres().len()).collect();
    let index = |id: SphereId| Body::Sphere(id).index(scene).ok();
    let rods = scene.rods().iter().map(|rod| (rod.end1, rod.end2));
    let springs = scene.springs().iter().map(|spring| (spring.a, spring.b));
    for (a, b) in rods.chain(springs) {
        if let Some((a, b)) = index(a).zip(index(b)) {
            let (a, b) = (root(&mut parents, a), root(&mut parents, b));
            parents[a] = b;
        }
    }
    let mut groups = vec![Group::default(); parents.len()];
    for (body, sphere) in scene.spheres().iter().enumerate() {
        let group = &mut groups[root(&mut parents, body)];
        group.held |= sphere.fixed;
        if body.is_multiple_of(stride) {
            group.bodies.push(body / stride);
        }
    }
    for body in scene.tethers().iter().filter_map(|tether| index(tether.sphere)) {
        groups[root(&mut parents, body)].held = true;
    }
    groups.retain(|group| !group.bodies.is_empty());
    groups
}

/// Returns the body that stands for the group of another one, and shortens the way to it.
fn root(parents: &mut [usize], mut body: usize) -> usize {
    while parents[body] != body {
        parents[body] = parents[parents[body]];
        body = parents[body];
    }
    body
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
        // Of every third sphere.
        let mut found: Vec<_> = groups(&scene, 3).into_iter().map(|group| group.bodies).collect();
        found.sort();
        assert_eq!(found, [vec![0, 1], vec![2]]);
    }
}
