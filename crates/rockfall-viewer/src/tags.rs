//! Names and colours that a scene gives to its objects (`@name`, `@colour`, `@look`).

use rockfall::{Body, ObjectId, Scene};

use crate::palette::Rgb;

/// The colour that the scene gives to an object, or else that of its look.
pub(crate) fn colour_of(scene: &Scene, id: impl Into<ObjectId>) -> Option<Rgb> {
    let tag = scene.tag(id).ok()??;
    Some(tag.colour.or_else(|| tag.look?.colour())?.0)
}

/// The name that the scene gives to an object.
pub(crate) fn name_of(scene: &Scene, id: impl Into<ObjectId>) -> Option<&str> {
    scene.tag(id).ok()??.name.as_deref()
}

/// The object of a body.
pub(crate) fn object_of(body: Body) -> Option<ObjectId> {
    Some(match body {
        Body::Sphere(id) => id.into(),
        Body::Rod(id) => id.into(),
        Body::Box(id) => id.into(),
        Body::Polygon(id) => id.into(),
        _ => return None,
    })
}
