//! The sides of rigid bodies in contacts (docs/physics.md section 4.16).

use glam::Vec3;

use crate::model::rigid::times;
use crate::model::view::{Object, View};
use crate::physics::side::Side;

/// The side of a contact with the mass and inertia of the rigid body that the object belongs to, if any. `parameter` is that of the contact on a
/// rod.
pub(crate) fn in_body(view: &View, object: Object, parameter: f32, normal: Vec3, side: Side) -> Side {
    let Some((body, radius)) = view.body_of(object).zip(side.radius) else { return side };
    let body = view.rigid_body(body);
    let point = match object {
        Object::Rod(rod) => {
            let [one, two] = view.rod(rod).ends;
            view.position(one).lerp(view.position(two), parameter)
        }
        Object::Sphere(sphere) => view.position(sphere),
        Object::Cuboid(_) | Object::Polygon(_) => return side,
    };
    let lever = point - body.centre;
    let across = lever.cross(normal);
    let reach = 1.0 + lever.length() / radius;
    Side {
        inverse_mass: body.inverse_mass + across.dot(times(body.inverse_inertia, across)),
        inverse_inertia: reach * reach * body.greatest,
        // It exerts a force at any approach velocity.
        free_acceleration: f32::INFINITY,
        ..side
    }
}
