//! One side of a contact: its velocities and inverse masses at the contact point.

use glam::Vec3;

use crate::model::view::{Object, View};

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
