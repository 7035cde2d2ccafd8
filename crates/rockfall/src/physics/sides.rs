//! Both sides of a contact, with the motion of a wall at the contact point (docs/physics section 2.12).

use glam::Vec3;

use crate::model::period::Periods;
use crate::model::view::{Object, View, Wall};
use crate::physics::rigid::side_in_body;
use crate::physics::side::{Side, side};
use crate::physics::touch::{Motions, Touch};

/// Returns both sides of a contact of objects A and B. A moving wall, which is always B, has the velocity of the contact point. The free
/// acceleration of its side is the sum of both, because it may accelerate against A (docs/physics section 2.12). In a sheared scene B has
/// the velocity of its nearest image (section 2.14).
pub(crate) fn sides(view: &View, [a, b]: [u32; 2], touch: &Touch) -> [Side; 2] {
    let of_a = side_in_body(view, view.object(a), touch.a, touch);
    let of_b = match view.wall(view.object(b)) {
        None => {
            let own = side_in_body(view, view.object(b), touch.b, touch);
            Side { velocity: own.velocity + image_velocity(view, a, b), ..own }
        }
        Some(wall) => {
            let place = place_of(view, view, view.object(a), touch.a);
            let reach = of_a.radius.unwrap_or(0.0) - touch.overlap;
            Side {
                velocity: wall.surface_velocity_at(place + reach * touch.normal, touch.normal),
                spin: wall.spin,
                free_acceleration: of_a.free_acceleration + wall_acceleration(view, &wall, view.object(a)),
                ..side(view, view.object(b), touch.b)
            }
        }
    };
    [of_a, of_b]
}

/// Velocity of the image of sphere B that is nearest to sphere A, relative to B itself.
fn image_velocity(view: &View, a: u32, b: u32) -> Vec3 {
    match (Periods::of(view.step), view.object(a), view.object(b)) {
        (Some(periods), Object::Sphere(a), Object::Sphere(b)) => {
            periods.velocity_of_nearest(view.fine(b).wide() - view.fine(a).wide())
        }
        _ => Vec3::ZERO,
    }
}

/// Size of the acceleration of a wall at the centre of A. For a rod, the greater one of its ends.
fn wall_acceleration(view: &View, wall: &Wall, a: Object) -> f32 {
    let at = |sphere: u32| wall.acceleration_at(view.position(sphere)).length();
    match a {
        Object::Sphere(sphere) => at(sphere),
        Object::Rod(rod) => view.rod(rod).ends.map(at).into_iter().fold(0.0, f32::max),
        Object::Cuboid(_) | Object::Polygon(_) => 0.0,
    }
}

/// The wall of a contact, if B is one that moves, and the contact point on its surface: the end of the arm of A. `at` has the positions.
pub(crate) fn wall_of(view: &View, at: &impl Motions, [a, b]: [u32; 2], touch: &Touch) -> Option<(Wall, Vec3)> {
    let wall = view.wall(view.object(b))?;
    let radius = match view.object(a) {
        Object::Sphere(sphere) => view.radius(sphere),
        Object::Rod(rod) => view.rod(rod).radius,
        Object::Cuboid(_) | Object::Polygon(_) => return None,
    };
    Some((wall, place_of(view, at, view.object(a), touch.a) + (radius - touch.overlap) * touch.normal))
}

/// The centre of a sphere, or the point of the axis of a rod at a parameter.
fn place_of(view: &View, at: &impl Motions, object: Object, parameter: f32) -> Vec3 {
    match object {
        Object::Sphere(sphere) => at.position(sphere),
        Object::Rod(rod) => {
            let [one, two] = view.rod(rod).ends.map(|end| at.position(end));
            one.lerp(two, parameter)
        }
        Object::Cuboid(_) | Object::Polygon(_) => Vec3::ZERO,
    }
}
