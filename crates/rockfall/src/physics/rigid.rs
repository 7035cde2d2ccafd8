//! The sides of rigid bodies in contacts (docs/physics.md section 4.16).

use crate::model::rigid::times;
use crate::model::view::{Object, View};
use crate::physics::motions::Touch;
use crate::physics::rigid_box::core_point;
use crate::physics::side::{Side, side};

/// The side of an object in a contact with another one, with the mass and inertia of the rigid body that it belongs to, if any. `parameter`
/// is that of the contact on a rod.
pub(crate) fn side_in_body(view: &View, object: Object, parameter: f32, other: Object, touch: &Touch) -> Side {
    let mut side = side(view, object, parameter);
    let Some((body, mut radius)) = view.body_of(object).zip(side.radius) else { return side };
    let body = view.rigid_body(body);
    let mut point = match object {
        Object::Rod(rod) => {
            let [one, two] = view.rod(rod).ends;
            view.position(one).lerp(view.position(two), parameter)
        }
        Object::Sphere(sphere) => view.position(sphere),
        Object::Cuboid(_) | Object::Polygon(_) => return side,
    };
    if let Some((from_centre, rounding)) = core_point(view, object, other, touch) {
        point += from_centre;
        side.velocity += side.spin.cross(from_centre);
        (radius, side.radius) = (rounding, Some(rounding));
    }
    let lever = point - body.centre;
    let across = lever.cross(touch.normal);
    let reach = 1.0 + lever.length() / radius;
    Side {
        inverse_mass: body.inverse_mass + across.dot(times(body.inverse_inertia, across)),
        inverse_inertia: reach * reach * body.greatest,
        // It exerts a force at any approach velocity.
        free_acceleration: f32::INFINITY,
        ..side
    }
}
