//! The bodies of a scene that move as one: rigid bodies, capsules, and the spheres and rods that are part of neither. A rigid body is
//! known by its first sphere, a capsule by its rod.

use std::collections::HashMap;

use rockfall::glam::Vec3;
use rockfall::{Body, Cuboid, RigidBody, RigidBodyId, Scene, SphereId};

use crate::extent::Extent;

/// The rigid body that a sphere or a rod is part of.
pub(crate) fn rigid_of(scene: &Scene, body: Body) -> Option<RigidBodyId> {
    match body {
        Body::Sphere(id) => scene.body_of_sphere(id),
        Body::Rod(id) => scene.body_of_rod(id),
        _ => None,
    }
}

/// Returns the first sphere of a rigid body for its spheres and rods, the rod of a capsule for its end spheres, and other bodies as
/// they are.
pub(crate) fn whole(scene: &Scene, body: Body) -> Body {
    if let Some(first) = rigid_of(scene, body).and_then(|rigid| first_of(scene, rigid)) {
        return Body::Sphere(first);
    }
    let capsule = scene.capsules().iter().find(|parts| body == Body::Sphere(parts.end1) || body == Body::Sphere(parts.end2));
    capsule.map_or(body, |parts| Body::Rod(parts.rod))
}

/// All bodies that move as one and have spheres, in the order of their first spheres.
pub(crate) fn wholes(scene: &Scene) -> Vec<Body> {
    let capsules = scene.capsules().iter();
    let ends: HashMap<SphereId, Option<Body>> =
        capsules.flat_map(|parts| [(parts.end1, Some(Body::Rod(parts.rod))), (parts.end2, None)]).collect();
    let whole = |sphere: SphereId| match scene.body_of_sphere(sphere) {
        Some(rigid) => (first_of(scene, rigid) == Some(sphere)).then_some(Body::Sphere(sphere)),
        None => ends.get(&sphere).copied().unwrap_or(Some(Body::Sphere(sphere))),
    };
    scene.sphere_ids().filter_map(whole).collect()
}

/// The spheres of a rigid body, the ends of a rod or a capsule, or a sphere itself.
pub(crate) fn spheres(scene: &Scene, body: Body) -> impl Iterator<Item = SphereId> {
    let rigid = rigid_of(scene, body).and_then(|rigid| scene.body(rigid).ok());
    let others = match body {
        _ if rigid.is_some() => [None; 2],
        Body::Sphere(id) => [Some(id), None],
        Body::Rod(id) => scene.rod(id).map_or([None; 2], |rod| [Some(rod.end1), Some(rod.end2)]),
        _ => [None; 2],
    };
    rigid.map_or(&[] as &[SphereId], RigidBody::spheres).iter().copied().chain(others.into_iter().flatten())
}

/// Position and velocity of a body that can move: the centre of mass of a rigid body, of a rod or capsule, or of a sphere.
pub(crate) fn motion(scene: &Scene, body: Body) -> Option<(Vec3, Vec3)> {
    if let Some(rigid) = rigid_of(scene, body) {
        return scene.body(rigid).ok().map(|rigid| (rigid.position, rigid.velocity));
    }
    match body {
        Body::Sphere(id) => scene.sphere(id).ok().map(|sphere| (sphere.position, sphere.velocity)),
        Body::Rod(id) => {
            let rod = scene.rod(id).ok()?;
            let (one, two) = (scene.sphere(rod.end1).ok()?, scene.sphere(rod.end2).ok()?);
            let part = two.mass / (one.mass + two.mass);
            Some((one.position.lerp(two.position, part), one.velocity.lerp(two.velocity, part)))
        }
        _ => None,
    }
}

/// The mass of a body that can move.
#[cfg(any(test, feature = "window"))]
pub(crate) fn mass(scene: &Scene, body: Body) -> f64 {
    let rigid = rigid_of(scene, body).and_then(|rigid| scene.shape(scene.body(rigid).ok()?.shape).ok());
    let own = rigid.and_then(|shape| shape.mass_properties_of().ok()).map(|properties| properties.mass);
    own.unwrap_or_else(|| spheres(scene, body).filter_map(|id| scene.sphere(id).ok()).map(|part| f64::from(part.mass)).sum())
}

/// Centre and radius of a ball around a body that can move.
pub(crate) fn ball(scene: &Scene, body: Body) -> Option<(Vec3, f32)> {
    if let (Body::Rod(id), None) = (body, rigid_of(scene, body)) {
        let rod = scene.rod(id).ok()?;
        let (one, two) = (scene.sphere(rod.end1).ok()?.position, scene.sphere(rod.end2).ok()?.position);
        return Some((one.midpoint(two), 0.5 * one.distance(two) + rod.radius));
    }
    let (centre, _) = motion(scene, body)?;
    Some((centre, parts(scene, body).map(|(place, radius)| centre.distance(place) + radius).fold(0.0, f32::max)))
}

/// The sides of the box around a rigid body along its own axes, in units.
pub(crate) fn size(scene: &Scene, rigid: RigidBodyId) -> Option<Vec3> {
    let (body, first) = (scene.body(rigid).ok()?, first_of(scene, rigid)?);
    let turned = body.orientation.inverse();
    let extent = |(place, radius): (Vec3, f32)| Extent::around(turned * (place - body.position), radius);
    parts(scene, Body::Sphere(first)).map(extent).reduce(Extent::with).map(|extent| extent.max - extent.min)
}

/// How far a body reaches from its middle in the direction in which it reaches least: the radius of a sphere or a rod, and half of
/// the least side of a rigid body.
pub(crate) fn thickness(scene: &Scene, body: Body) -> f32 {
    match (rigid_of(scene, body), body) {
        (Some(rigid), _) => size(scene, rigid).map_or(0.0, |size| 0.5 * size.min_element()),
        (None, Body::Sphere(id)) => scene.sphere(id).map_or(0.0, |sphere| sphere.radius),
        (None, Body::Rod(id)) => scene.rod(id).map_or(0.0, |rod| rod.radius),
        _ => 0.0,
    }
}

/// The number of bodies that move as one and have spheres, and that of rods that are part of none.
#[cfg(any(test, feature = "window"))]
pub(crate) fn counts(scene: &Scene) -> [usize; 2] {
    let all = scene.counts();
    let parts = |of: fn(&RigidBody) -> usize| scene.bodies().iter().map(of).sum::<usize>();
    let spheres = (all.spheres + all.bodies).saturating_sub(all.capsules + parts(|body| body.spheres().len()));
    [spheres, all.rods.saturating_sub(all.capsules + parts(|body| body.rods().len()))]
}

/// Balls that reach as far as a body: its spheres, and the corners of its boxes.
fn parts(scene: &Scene, body: Body) -> impl Iterator<Item = (Vec3, f32)> {
    let corners = |Cuboid { corner, edges: [i, j, k], .. }: Cuboid| {
        let share = |bits: u32, bit: u32| (bits >> bit & 1) as f32;
        (0..8).map(move |bits| (corner + share(bits, 0) * i + share(bits, 1) * j + share(bits, 2) * k, 0.0))
    };
    spheres(scene, body).flat_map(move |id| {
        let cuboid = scene.box_at(id);
        let ball = scene.sphere(id).ok().filter(|_| cuboid.is_none()).map(|sphere| (sphere.position, sphere.radius));
        ball.into_iter().chain(cuboid.into_iter().flat_map(corners))
    })
}

fn first_of(scene: &Scene, rigid: RigidBodyId) -> Option<SphereId> {
    scene.body(rigid).ok()?.spheres().first().copied()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// A crate, a ball, a cross of two capsules as one body, and a capsule.
    const SCENE: &str = "@body crate mass=108\nB -0.3 -0.4 -0.5 0.6 0 0 0 0.8 0 0 0 1\n@end\n\
                         @body cross mass=4\nC -1 0 0 1 0 0 0 0 0 1 0.2\nC 0 -1 0 0 1 0 0 0 0 1 0.2\n@end\n\
                         @place crate at=5,2,0 velocity=1,2,3\nS 0 2 0 0 0 0 0 0 0 0 3 0.5\n@place cross at=0,0,9\n\
                         C 0 5 0 2 5 0 1 0 0 1 0.25\n";

    #[test]
    fn parts_belong_to_one_body() {
        let scene = Scene::parse(SCENE, Path::new("test")).unwrap().scene;
        let found = wholes(&scene);
        assert_eq!(found.len(), 4, "{found:?}");
        assert_eq!(counts(&scene), [4, 0]);
        for sphere in scene.sphere_ids() {
            assert!(found.contains(&whole(&scene, Body::Sphere(sphere))));
        }
        let motions: Vec<_> = found.iter().map(|body| motion(&scene, *body).unwrap()).collect();
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        assert_eq!(motions[0], (at(5.0, 2.0, 0.0), at(1.0, 2.0, 3.0)));
        assert_eq!(motions[2], (at(0.0, 0.0, 9.0), Vec3::ZERO));
        assert_eq!(motions[3], (at(1.0, 5.0, 0.0), at(1.0, 0.0, 0.0)));
        let masses: Vec<_> = found.iter().map(|body| mass(&scene, *body)).collect();
        assert!((masses[0] - 108.0).abs() < 1e-6 && masses[1] == 3.0 && (masses[2] - 4.0).abs() < 1e-6, "{masses:?}");
        let sizes: Vec<_> = found.iter().map(|body| thickness(&scene, *body)).collect();
        assert!((sizes[0] - 0.3).abs() < 1e-5 && sizes[1] == 0.5 && (sizes[2] - 0.2).abs() < 1e-5, "{sizes:?}");
        assert_eq!(sizes[3], 0.25);
        let (_, radius) = ball(&scene, found[0]).unwrap();
        assert!((radius - 0.5 * (0.36_f32 + 0.64 + 1.0).sqrt()).abs() < 1e-5, "{radius}");
    }
}
