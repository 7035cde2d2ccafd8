//! The sides of rigid bodies in contacts (docs/physics.md section 4.16).

use glam::Vec3;

use crate::model::layout::{LAW_HERTZ_MINDLIN, LAW_THESIS};
use crate::model::view::{Object, PartOfBox, RigidRecord, View};
use crate::physics::motions::{Motions, Touch};
use crate::physics::rigid_box::core_point;
use crate::physics::side::{Side, side};

/// The side of an object in a contact with another one, with the mass and inertia of the rigid body that it belongs to, if any. `parameter`
/// is that of the contact on a rod.
pub(crate) fn side_in_body(view: &View, object: Object, parameter: f32, other: Object, touch: &Touch) -> Side {
    let mut side = side(view, object, parameter);
    let Some((body, mut radius)) = view.body_of(object).zip(side.radius) else { return side };
    let body = view.rigid_body(body);
    let mut lever = lever(view, view, &body, object, parameter);
    if let Some((from_centre, rounding)) = core_point(view, object, other, touch) {
        lever += from_centre;
        side.velocity += side.spin.cross(from_centre);
        (radius, side.radius) = (rounding, Some(rounding));
    }
    let across = lever.cross(touch.normal);
    let reach = 1.0 + lever.length() / radius;
    Side {
        inverse_mass: body.inverse_mass + body.by_inverse_inertia(across),
        inverse_inertia: reach * reach * body.greatest,
        ..side
    }
}

/// The lever of a contact on a rigid body in the state `at`: from the centre of the body to that of the sphere, or to the point of the axis
/// of the rod at a parameter.
pub(crate) fn lever(view: &View, at: &impl Motions, body: &RigidRecord, object: Object, parameter: f32) -> Vec3 {
    mixed(view, object, parameter, |sphere| at.position(sphere)).map_or(Vec3::ZERO, |point| point - body.centre)
}

/// Velocity of the centre of a sphere, or of the point of the axis of a rod at a parameter, in the state `at`.
pub(crate) fn velocity_of(view: &View, at: &impl Motions, object: Object, parameter: f32) -> Vec3 {
    mixed(view, object, parameter, |sphere| at.velocity(sphere)).unwrap_or_default()
}

/// A vector of a sphere, or that of a point of the axis of a rod, from those of its ends.
fn mixed(view: &View, object: Object, parameter: f32, of: impl Fn(u32) -> Vec3) -> Option<Vec3> {
    match object {
        Object::Rod(rod) => {
            let [one, two] = view.rod(rod).ends.map(of);
            Some(one.lerp(two, parameter))
        }
        Object::Sphere(sphere) => Some(of(sphere)),
        Object::Cuboid(_) | Object::Polygon(_) => None,
    }
}

/// Factor of the damping of a contact of objects A and B. If A is a sphere of a rigid body and B a wall, all spheres of the body that touch
/// the wall, taken as a plane, damp as one contact. `inverse_mass` is that of A.
pub(crate) fn wall_damping(view: &View, [a, b]: [u32; 2], touch: &Touch, inverse_mass: f32) -> f32 {
    let (Object::Sphere(own), Object::Cuboid(_) | Object::Polygon(_)) = (view.object(a), view.object(b)) else { return 1.0 };
    let is_solid = |sphere: u32| view.part_of_box(Object::Sphere(sphere)) == Some(PartOfBox::Solid);
    let Some(body) = view.body_of_sphere(own).filter(|_| touch.overlap > 0.0 && !is_solid(own)) else { return 1.0 };
    let body = view.rigid_body(body);
    let pressed = touch.overlap * view.radius(own);
    let turning = |moment: Vec3| body.by_inverse_inertia(moment.cross(touch.normal));
    let (mut force, mut moment, mut energy) = (0.0, Vec3::ZERO, 0.0);
    for (index, _) in view.members(body) {
        let sphere = view.slot_of(index);
        let place = view.position(sphere);
        let further = view.radius(sphere) - view.radius(own);
        let overlap = touch.overlap + ((place - view.position(own)).dot(touch.normal) + further);
        if overlap <= 0.0 || is_solid(sphere) {
            continue;
        }
        let stiffness = match view.step.layout.law {
            LAW_THESIS => inverse_mass / (body.inverse_mass + turning(place - body.centre)),
            LAW_HERTZ_MINDLIN => (view.radius(sphere) * overlap / pressed).sqrt(),
            _ => 1.0,
        };
        let push = stiffness * overlap;
        force += push;
        moment += push * (place - body.centre);
        energy += push * overlap;
    }
    let response = body.inverse_mass * force * force + turning(moment);
    (inverse_mass * energy / response).sqrt()
}
