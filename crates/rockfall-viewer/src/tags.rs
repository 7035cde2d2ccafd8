//! Names and colours that a scene gives to its objects (`@name`, `@colour`, `@look`).

use std::collections::HashSet;

use rockfall::{Body, ObjectId, RodId, Scene, SphereId};

use crate::palette::{KINDS, Rgb};
use crate::whole::rigid_of;

/// The colour that the scene gives to an object, or else that of its look. A rigid body without one has that of its first sphere.
pub(crate) fn colour_of(scene: &Scene, id: impl Into<ObjectId>) -> Option<Rgb> {
    let id = id.into();
    let own = |id: ObjectId| {
        let tag = scene.tag(id).ok()??;
        Some(tag.colour.or_else(|| tag.look?.colour())?.0)
    };
    own(id).or_else(|| match id {
        ObjectId::Body(rigid) => own((*scene.body(rigid).ok()?.spheres().first()?).into()),
        _ => None,
    })
}

/// Returns whether a scene has objects of each kind of [`KINDS`] that are drawn in the colour of the kind.
pub(crate) fn kinds_shown(scene: &Scene) -> [bool; KINDS.len()] {
    let is_plain = |id: ObjectId| colour_of(scene, id).is_none();
    let ends: HashSet<SphereId> = scene.capsules().iter().flat_map(|parts| [parts.end1, parts.end2]).collect();
    let is_fixed = |id: SphereId| scene.sphere(id).is_ok_and(|sphere| sphere.fixed);
    let has_sphere = |fixed: bool| {
        let mut spheres = scene.sphere_ids().filter(|id| !ends.contains(id) && is_fixed(*id) == fixed);
        spheres.any(|id| is_plain(id.into()))
    };
    let capsules: HashSet<RodId> = scene.capsules().iter().map(|parts| parts.rod).collect();
    [
        has_sphere(false),
        has_sphere(true),
        scene.rod_ids().any(|id| !capsules.contains(&id) && is_plain(id.into())),
        capsules.iter().any(|id| is_plain((*id).into())),
        scene.spring_ids().any(|id| is_plain(id.into())),
        !scene.tethers().is_empty(),
        scene.box_ids().any(|id| is_plain(id.into())),
        scene.polygon_ids().any(|id| is_plain(id.into())),
    ]
}

/// The name that the scene gives to an object.
pub(crate) fn name_of(scene: &Scene, id: impl Into<ObjectId>) -> Option<&str> {
    scene.tag(id).ok()??.name.as_deref()
}

/// The object of a body: the rigid body for its spheres and rods.
pub(crate) fn object_of(scene: &Scene, body: Body) -> Option<ObjectId> {
    if let Some(rigid) = rigid_of(scene, body) {
        return Some(rigid.into());
    }
    Some(match body {
        Body::Sphere(id) => id.into(),
        Body::Rod(id) => id.into(),
        Body::Box(id) => id.into(),
        Body::Polygon(id) => id.into(),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_kind_whose_objects_have_colours_of_their_own_is_not_shown() {
        let shown = |text: &str| {
            let kinds = kinds_shown(&Scene::parse(text, Path::new("test")).unwrap().scene);
            KINDS.iter().zip(kinds).filter(|(_, shown)| *shown).map(|(kind, _)| kind.name).collect::<Vec<_>>()
        };
        let bodies = "S 1 0 2 0 0 0 0 0 0 0 1 0.5 0\nS 2 3 2 0 0 0 0 0 0 0 1 0.5 1\nC 0 5 0 2 5 0 0 0 0 1 0.25\nR 1 2 0.1 3\n";
        assert_eq!(shown(bodies), ["spheres", "fixed spheres", "rods", "capsules"]);
        assert_eq!(shown(&format!("B 0 0 0 1 0 0 0 1 0 0 0 1\n@colour red\n{bodies}")), ["boxes"]);
        assert_eq!(shown(&format!("@colour red\n{bodies}@colour -\nS 3 9 2 0 0 0 0 0 0 0 1 0.5 0\n")), ["spheres"]);
    }
}
