//! One side of a contact: its velocities and inverse masses at the contact point.

use glam::Vec3;

use crate::model::view::{Object, View, Wall};
use crate::physics::touch::{Motions, Touch};

/// One object of a contact, at the contact point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// 1/m of a sphere, 1/M(a) of a rod (2.6), 0 of a box or polygon.
    pub(crate) inverse_mass: f32,
    /// 1/I of a moving sphere, (1-a)^2 / I1 + a^2 / I2 of a rod; 0 of a fixed sphere, box or polygon.
    pub(crate) inverse_inertia: f32,
    pub(crate) velocity: Vec3,
    pub(crate) spin: Vec3,
    /// `None` for a box or polygon.
    pub(crate) radius: Option<f32>,
    /// Size of the acceleration by everything but contacts, in units/s².
    pub(crate) free_acceleration: f32,
}

/// Returns both sides of a contact of objects A and B. A moving wall, which is always B, has the velocity of the contact point. The free
/// acceleration of its side is the sum of both, because it may accelerate against A (docs/physics.md section 2.12).
pub(crate) fn sides(view: &View, [a, b]: [u32; 2], touch: &Touch) -> [Side; 2] {
    let of_a = side(view, view.object(a), touch.a);
    let of_b = match view.wall(view.object(b)) {
        None => side(view, view.object(b), touch.b),
        Some(wall) => {
            let place = place_of(view, view, view.object(a), touch.a);
            let reach = of_a.radius.unwrap_or(0.0) - touch.overlap;
            Side {
                velocity: wall.velocity_at(place + reach * touch.normal),
                spin: wall.spin,
                free_acceleration: of_a.free_acceleration + wall_acceleration(view, &wall, view.object(a)),
                ..side(view, view.object(b), touch.b)
            }
        }
    };
    [of_a, of_b]
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

/// Returns the side of `object`, a wall as if it were at rest. For a rod, the contact is at `parameter`. A fixed end of a rod is at rest: the surface
/// velocity of a fixed sphere counts only in contacts of the sphere itself (E26).
pub(crate) fn side(view: &View, object: Object, parameter: f32) -> Side {
    let free_acceleration = view.free_acceleration(object);
    match object {
        Object::Sphere(sphere) => Side {
            inverse_mass: view.inverse_mass(sphere),
            inverse_inertia: view.mobility(sphere),
            velocity: view.velocity(sphere),
            spin: view.spin(sphere),
            radius: Some(view.radius(sphere)),
            free_acceleration,
        },
        Object::Rod(rod) => {
            let rod = view.rod(rod);
            let [one, two] = rod.ends;
            let (s, t) = (1.0 - parameter, parameter);
            Side {
                inverse_mass: s * s * view.inverse_mass(one) + t * t * view.inverse_mass(two),
                inverse_inertia: s * s * view.mobility(one) + t * t * view.mobility(two),
                velocity: s * view.own_velocity(one) + t * view.own_velocity(two),
                spin: s * view.own_spin(one) + t * view.own_spin(two),
                radius: Some(rod.radius),
                free_acceleration,
            }
        }
        Object::Cuboid(_) | Object::Polygon(_) => {
            let (velocity, spin) = (Vec3::ZERO, Vec3::ZERO);
            Side { inverse_mass: 0.0, inverse_inertia: 0.0, velocity, spin, radius: None, free_acceleration }
        }
    }
}
