//! The sides of rigid bodies in contacts (docs/physics section 4.16).

use glam::Vec3;

use crate::laws::of_file;
use crate::model::view::{Object, RigidRecord, View};
use crate::physics::motions::Touch;
use crate::physics::side::{Side, side};
use crate::rotate::rotated;

/// Whether two objects never touch because they are parts of one rigid body. Lists leave such pairs out.
pub(crate) fn never_meet(view: &View, a: u32, b: u32) -> bool {
    view.step.layout.rigid_bodies > 0
        && view.body_of(view.object(a)).is_some_and(|body| view.body_of(view.object(b)) == Some(body))
}

/// The side of an object in a contact, with the mass and inertia of the rigid body that it belongs to, if any. `parameter` is
/// that of the contact on a rod.
pub(crate) fn side_in_body(view: &View, object: Object, parameter: f32, touch: &Touch) -> Side {
    let side = side(view, object, parameter);
    let Some((body, radius)) = view.body_of(object).zip(side.radius) else { return side };
    let body = view.rigid_body(body);
    let lever = lever(view, &body, object, parameter);
    let across = lever.cross(touch.normal);
    let reach = 1.0 + lever.length() / radius;
    Side {
        inverse_mass: body.inverse_mass + body.by_inverse_inertia(across),
        inverse_inertia: reach * reach * body.greatest,
        ..side
    }
}

/// The lever of a contact on a rigid body: from the centre of the body to that of the sphere, or to the point of the axis of
/// the rod at a parameter.
fn lever(view: &View, body: &RigidRecord, object: Object, parameter: f32) -> Vec3 {
    match object {
        Object::Sphere(sphere) => view.position(sphere) - body.centre,
        Object::Rod(rod) => {
            let [one, two] = view.rod(rod).ends.map(|end| view.position(end));
            one.lerp(two, parameter) - body.centre
        }
        Object::Cuboid(_) | Object::Polygon(_) => Vec3::ZERO,
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

/// A rigid body, or a sphere of its own.
struct Party {
    body: Option<RigidRecord>,
    inverse_mass: f32,
    /// The greatest distance of a point of a sphere from the centre.
    reach: f32,
    /// The sphere that touches, its place from the centre, and its radius.
    sphere: u32,
    place: Vec3,
    radius: f32,
}

/// A sphere of a party.
#[derive(Clone, Copy)]
struct Member {
    sphere: u32,
    /// Its place from the centre of the party.
    place: Vec3,
    radius: f32,
}

impl Party {
    fn of(view: &View, sphere: u32) -> Self {
        let body = view.body_of_sphere(sphere).map(|body| view.rigid_body(body));
        let radius = view.radius(sphere);
        let (inverse_mass, reach) =
            body.map_or_else(|| (view.inverse_mass(sphere), radius), |body| (body.inverse_mass, body.reach));
        let mut party = Self { body, inverse_mass, reach, sphere, place: Vec3::ZERO, radius };
        let own = party.members(view).find(|member| member.sphere == sphere);
        party.place = own.map_or(Vec3::ZERO, |own| own.place);
        party
    }

    fn members<'a>(&self, view: &'a View) -> impl Iterator<Item = Member> + use<'a> {
        let of_body = self.body.into_iter().flat_map(move |body| {
            view.members(body).map(move |(index, place)| {
                let sphere = view.slot_of(index);
                Member { sphere, place: rotated(body.orientation, place), radius: view.radius(sphere) }
            })
        });
        let alone = Member { sphere: self.sphere, place: Vec3::ZERO, radius: self.radius };
        of_body.chain(self.body.is_none().then_some(alone))
    }

    /// What a torque contributes to the response.
    fn turning(&self, torque: Vec3) -> f32 {
        self.body.map_or(0.0, |body| body.by_inverse_inertia(torque))
    }
}

/// The same for a sphere and a wall, which is taken as a plane.
fn wall_damping(view: &View, own: u32, touch: &Touch, inverse_mass: f32) -> f32 {
    if view.body_of_sphere(own).is_none() {
        return 1.0;
    }
    let body = Party::of(view, own);
    let (mut force, mut moment, mut energy) = (0.0, Vec3::ZERO, 0.0);
    for Member { place, radius, .. } in body.members(view) {
        let overlap = touch.overlap + ((place - body.place).dot(touch.normal) + (radius - body.radius));
        if overlap <= 0.0 {
            continue;
        }
        let ratio = radius * overlap / (body.radius * touch.overlap);
        let stiffness = of_file(view.step.layout.law, |law| law.stiffness_by_overlap(ratio));
        let push = stiffness * overlap;
        force += push;
        moment += push * place;
        energy += push * overlap;
    }
    let response = body.inverse_mass * force * force + body.turning(moment.cross(touch.normal));
    (inverse_mass * energy / response).sqrt()
}

/// Least part of the response that forces without resistance to each other would have.
const LEAST_RESPONSE: f32 = 0.25;

/// Factor of the damping of a contact of two spheres, at least one of which belongs to a rigid body. `inverse_mass` is that of the contact.
///
/// The places of the other spheres follow from those of the two that touch, the orientations and the forms of the bodies.
fn pair_damping(view: &View, own: [u32; 2], touch: &Touch, inverse_mass: f32) -> f32 {
    let [one, other] = own.map(|sphere| Party::of(view, sphere));
    let reduced = |pair: [Member; 2]| {
        let [r, s] = pair.map(|member| member.radius);
        r * s / (r + s)
    };
    let of = |party: &Party| Member { sphere: party.sphere, place: party.place, radius: party.radius };
    let own_reduced = reduced([of(&one), of(&other)]);
    let between = (one.radius + other.radius - touch.overlap) * touch.normal;
    let (mut push, mut energy, mut force, mut torques) = (0.0, 0.0, Vec3::ZERO, [Vec3::ZERO; 2]);
    for k in one.members(view) {
        let seen = between - (k.place - one.place);
        if (seen - other.place).length_squared() > (other.reach + k.radius).powi(2) && k.sphere != one.sphere {
            continue;
        }
        for l in other.members(view) {
            let apart = seen + (l.place - other.place);
            let is_own = [k.sphere, l.sphere] == own;
            if apart.length_squared() > (k.radius + l.radius).powi(2) && !is_own {
                continue;
            }
            let (overlap, normal) = if is_own {
                (touch.overlap, touch.normal)
            } else {
                (k.radius + l.radius - apart.length(), apart.normalize_or_zero())
            };
            if overlap <= 0.0 || overlap.is_nan() {
                continue;
            }
            let turns = [k, l].map(|member| member.place.cross(normal));
            let ratio = reduced([k, l]) / own_reduced * overlap / touch.overlap;
            let stiffness = of_file(view.step.layout.law, |law| law.stiffness_by_overlap(ratio));
            let pressed = stiffness * overlap;
            push += pressed;
            energy += pressed * overlap;
            force += pressed * normal;
            torques = [0, 1].map(|side| torques[side] + pressed * turns[side]);
        }
    }
    let mass = one.inverse_mass + other.inverse_mass;
    let response = mass * force.length_squared() + (one.turning(torques[0]) + other.turning(torques[1]));
    (inverse_mass * energy / response.max(LEAST_RESPONSE * mass * push * push)).sqrt()
}
