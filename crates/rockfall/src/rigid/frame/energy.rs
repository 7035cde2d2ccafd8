//! Energy and momenta of all bodies, and the number of substeps that a scene needs (docs/physics sections 11.2 and 11.10).

use glam::{DVec3, Vec3};

use crate::rigid::common::MAX_SUBSTEPS;
use crate::rigid::joints::{Free, Joint};
use crate::rigid::spring_bound::SpringBound;
use crate::rigid::world::{Body, Kind, RigidWorld};
use crate::rotate::{product, rotated};

fn loose(world: &RigidWorld) -> impl Iterator<Item = &Body> {
    world.bodies.iter().filter(|body| body.kind == Kind::Dynamic && body.inverse_mass > 0.0)
}

/// Kinetic energy, and potential energy in the uniform field. Overlaps store none.
pub(crate) fn energy(world: &RigidWorld) -> f64 {
    loose(world)
        .map(|body| {
            let mass = 1.0 / f64::from(body.inverse_mass);
            let [v, w, l] = [body.velocity, body.spin, body.momentum].map(|vector| vector.as_dvec3());
            0.5 * (mass * v.length_squared() + w.dot(l)) - mass * world.gravity.as_dvec3().dot(body.pose.position.as_dvec3())
        })
        .sum()
}

/// Kinetic energy alone.
pub(crate) fn kinetic_energy(world: &RigidWorld) -> f64 {
    let part = |body: &Body| {
        let [v, w, l] = [body.velocity, body.spin, body.momentum].map(|vector| vector.as_dvec3());
        0.5 * (v.length_squared() / f64::from(body.inverse_mass) + w.dot(l))
    };
    loose(world).map(part).sum()
}

/// Momentum, and angular momentum about the origin.
pub(crate) fn momenta(world: &RigidWorld) -> (DVec3, DVec3) {
    loose(world).fold((DVec3::ZERO, DVec3::ZERO), |(sum, turning), body| {
        let p = body.velocity.as_dvec3() / f64::from(body.inverse_mass);
        (sum + p, turning + body.pose.position.as_dvec3().cross(p) + body.momentum.as_dvec3())
    })
}

/// Least number of substeps.
const LEAST_SUBSTEPS: u32 = 4;
/// Greatest number of substeps that `auto` chooses.
const MOST_SUBSTEPS: u32 = 32;
/// A rotor with more than this multiple of the inertia that its joint moves needs `MOST_SUBSTEPS`.
const HEAVY_ROTOR: f32 = 10.0;
/// Greatest h sqrt(g / a) for the least edge a of a body.
const GREATEST_FALL: f32 = 0.0135;

/// The least edge or diameter of a body that moves or is to come; infinite without one.
pub(crate) fn least_width(world: &RigidWorld) -> f32 {
    loose(world).map(|body| body.width).chain(world.least_to_come).filter(|width| *width > 0.0).fold(f32::INFINITY, f32::min)
}

/// The substeps of a frame of `dt` seconds for the smallest body that moves. It ignores masses, since one pebble under a
/// lorry would set them for all.
pub(crate) fn auto_substeps(world: &RigidWorld, dt: f32) -> u32 {
    let needed = dt * (world.gravity.length() / least_width(world)).sqrt() / GREATEST_FALL;
    let least =
        if world.joints.list.iter().any(|joint| has_heavy_rotor(world, joint)) { MOST_SUBSTEPS } else { LEAST_SUBSTEPS };
    let of_bodies = (needed.ceil() as u32).clamp(least, MOST_SUBSTEPS);
    of_bodies.max(SpringBound::of(world).substeps(dt).min(MAX_SUBSTEPS))
}

/// Whether the rotor of a joint outweighs what the joint moves. Contacts of the body do not know of the rotor.
fn has_heavy_rotor(world: &RigidWorld, joint: &Joint) -> bool {
    let bodies = joint.ends.map(|end| &world.bodies[end.body as usize]);
    let give: f32 = match joint.kind.free {
        Free::Slide | Free::Line => bodies.iter().map(|body| body.inverse_mass).sum(),
        Free::Turn | Free::None => {
            let axis = rotated(product(bodies[0].pose.turn, joint.ends[0].turn), Vec3::X);
            bodies.iter().map(|body| axis.dot(body.inverse_inertia * axis)).sum()
        }
    };
    joint.drive.armature * give > HEAVY_ROTOR
}
