//! The sides of rigid bodies in contacts (docs/physics.md section 4.16).

use glam::Vec3;

use crate::model::layout::{LAW_HERTZ_MINDLIN, LAW_THESIS};
use crate::model::view::{Object, RigidRecord, View};
use crate::physics::motions::{Motions, Touch};
use crate::physics::rigid_box::{core_point, is_left_to_others, is_solid, toucher};
use crate::physics::side::{Side, side};
use crate::physics::touch::line;

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

/// Factor of the damping of a contact of objects A and B, which damps as one with the other contacts of the same two bodies.
/// `inverse_masses` are those of A and B at the contact.
pub(crate) fn shared_damping(view: &View, ids: [u32; 2], touch: &Touch, inverse_masses: [f32; 2]) -> f32 {
    if view.step.layout.rigid_bodies == 0 || touch.overlap <= 0.0 {
        return 1.0;
    }
    let [a, b] = ids.map(|id| view.object(id));
    match (a, b) {
        (Object::Sphere(own), Object::Cuboid(_) | Object::Polygon(_)) => wall_damping(view, own, touch, inverse_masses[0]),
        (Object::Sphere(one), Object::Sphere(other)) if view.touches_body(ids) => {
            pair_damping(view, [one, other], touch, inverse_masses.iter().sum())
        }
        _ => 1.0,
    }
}

/// The same for a sphere and a wall, which is taken as a plane.
fn wall_damping(view: &View, own: u32, touch: &Touch, inverse_mass: f32) -> f32 {
    let is_solid = |sphere: u32| is_solid(view, Object::Sphere(sphere));
    let Some(body) = view.body_of_sphere(own).filter(|_| !is_solid(own)) else { return 1.0 };
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

/// A rigid body, or a sphere of its own.
struct Party {
    body: Option<RigidRecord>,
    centre: Vec3,
    inverse_mass: f32,
    reach: f32,
    /// The sphere of its own.
    alone: Option<u32>,
}

impl Party {
    fn of(view: &View, sphere: u32) -> Self {
        let Some(body) = view.body_of_sphere(sphere).map(|body| view.rigid_body(body)) else {
            let (centre, reach) = (view.position(sphere), view.radius(sphere));
            return Self { body: None, centre, inverse_mass: view.inverse_mass(sphere), reach, alone: Some(sphere) };
        };
        Self { body: Some(body), centre: body.centre, inverse_mass: body.inverse_mass, reach: body.reach, alone: None }
    }

    fn spheres(&self, view: &View) -> impl Iterator<Item = u32> {
        let members = self.body.into_iter().flat_map(|body| view.members(body)).map(|(index, _)| view.slot_of(index));
        members.chain(self.alone)
    }

    /// What a torque contributes to the response.
    fn turning(&self, torque: Vec3) -> f32 {
        self.body.map_or(0.0, |body| body.by_inverse_inertia(torque))
    }
}

/// Least part of the response that forces without resistance to each other would have.
const LEAST_RESPONSE: f32 = 0.25;

/// A contact of two spheres of two parties. The levers are those of a point of the line along the normal.
struct Meeting {
    overlap: f32,
    normal: Vec3,
    levers: [Vec3; 2],
}

impl Meeting {
    /// The contact of two spheres, or `None` where they do not touch.
    fn of(view: &View, [k, l]: [u32; 2], [one, other]: &[Party; 2]) -> Option<Self> {
        let reach = view.radius(k) + view.radius(l);
        if view.between(k, l).length_squared() > reach * reach || is_left_to_others(view, Object::Sphere(k), Object::Sphere(l))
        {
            return None;
        }
        let touch = line(view, view, Object::Sphere(k), Object::Sphere(l), None)?;
        let toucher = |object: u32, other: u32| toucher(view, Object::Sphere(object), Object::Sphere(other), &touch);
        let of = |sphere: u32, party: &Party, toucher: Option<Vec3>| {
            view.position(sphere) - party.centre + toucher.unwrap_or_default()
        };
        let levers = [of(k, one, toucher(k, l)), of(l, other, toucher(l, k))];
        Some(Self { overlap: touch.overlap, normal: touch.normal, levers })
    }
}

/// The radius of a sphere; of the solid of a box, its rounding radius.
fn round_radius(view: &View, sphere: u32) -> f32 {
    let object = Object::Sphere(sphere);
    let of_box = view.box_of(object).filter(|_| is_solid(view, object));
    of_box.map_or_else(|| view.radius(sphere), |body_box| body_box.radius)
}

/// Factor of the damping of a contact of two spheres, at least one of which belongs to a rigid body. `inverse_mass` is that of the contact.
fn pair_damping(view: &View, own: [u32; 2], touch: &Touch, inverse_mass: f32) -> f32 {
    let parties = own.map(|sphere| Party::of(view, sphere));
    let [one, other] = &parties;
    let reduced = |pair: [u32; 2]| {
        let [r, s] = pair.map(|sphere| round_radius(view, sphere));
        r * s / (r + s)
    };
    let (mut push, mut energy, mut force, mut torques) = (0.0, 0.0, Vec3::ZERO, [Vec3::ZERO; 2]);
    let pairs = one.spheres(view).filter(|k| {
        let away = view.image(other.centre - view.position(*k));
        away.length_squared() <= (other.reach + view.radius(*k)).powi(2)
    });
    for pair in pairs.flat_map(|k| other.spheres(view).map(move |l| [k, l])) {
        let Some(mut met) = Meeting::of(view, pair, &parties) else { continue };
        if pair == own {
            (met.overlap, met.normal) = (touch.overlap, touch.normal);
        }
        if met.overlap <= 0.0 {
            continue;
        }
        let turns = met.levers.map(|lever| lever.cross(met.normal));
        let stiffness = match view.step.layout.law {
            LAW_THESIS => {
                inverse_mass / (one.inverse_mass + one.turning(turns[0]) + (other.inverse_mass + other.turning(turns[1])))
            }
            LAW_HERTZ_MINDLIN => (reduced(pair) / reduced(own) * met.overlap / touch.overlap).sqrt(),
            _ => 1.0,
        };
        let pressed = stiffness * met.overlap;
        push += pressed;
        energy += pressed * met.overlap;
        force += pressed * met.normal;
        torques = [0, 1].map(|side| torques[side] + pressed * turns[side]);
    }
    let mass = one.inverse_mass + other.inverse_mass;
    let response = mass * force.length_squared() + (one.turning(torques[0]) + other.turning(torques[1]));
    (inverse_mass * energy / response.max(LEAST_RESPONSE * mass * push * push)).sqrt()
}
