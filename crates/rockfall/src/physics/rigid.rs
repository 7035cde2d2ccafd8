//! The sides of rigid bodies in contacts (docs/physics.md section 4.16).

use glam::Vec3;

use crate::model::layout::{LAW_HERTZ_MINDLIN, LAW_THESIS};
use crate::model::view::{Object, RigidRecord, View};
use crate::physics::motions::{Motions, Touch};
use crate::physics::rigid_box::{core_point, has_box, is_solid, solid_and_ball};
use crate::physics::side::{Side, side};
use crate::rotate::rotated;

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
    /// Of the solid of a box, that of the sphere around it.
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
    let is_solid = |sphere: u32| is_solid(view, Object::Sphere(sphere));
    if view.body_of_sphere(own).is_none() || is_solid(own) {
        return 1.0;
    }
    let body = Party::of(view, own);
    let (mut force, mut moment, mut energy) = (0.0, Vec3::ZERO, 0.0);
    for Member { sphere, place, radius } in body.members(view) {
        let overlap = touch.overlap + ((place - body.place).dot(touch.normal) + (radius - body.radius));
        if overlap <= 0.0 || is_solid(sphere) {
            continue;
        }
        let stiffness = match view.step.layout.law {
            LAW_THESIS => inverse_mass / (body.inverse_mass + body.turning(place.cross(touch.normal))),
            LAW_HERTZ_MINDLIN => (radius * overlap / (body.radius * touch.overlap)).sqrt(),
            _ => 1.0,
        };
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

/// Overlap and normal of two members of parties, which are `apart`. `None` where they never touch.
fn member_contact(view: &View, [k, l]: [Member; 2], apart: Vec3) -> Option<(f32, Vec3)> {
    let objects = [k, l].map(|member| Object::Sphere(member.sphere));
    if !has_box(view, objects[0], objects[1]) {
        return Some((k.radius + l.radius - apart.length(), apart.normalize_or_zero()));
    }
    match objects.map(|object| is_solid(view, object)) {
        [true, false] => {
            let (outward, overlap) = solid_and_ball(&view.box_of(objects[0])?, apart, l.radius);
            Some((overlap, outward))
        }
        [false, true] => {
            let (outward, overlap) = solid_and_ball(&view.box_of(objects[1])?, -apart, k.radius);
            Some((overlap, -outward))
        }
        _ => None,
    }
}

/// The radius of a sphere; of the solid of a box, its rounding radius.
fn round_radius(view: &View, member: Member) -> f32 {
    let object = Object::Sphere(member.sphere);
    let of_box = view.box_of(object).filter(|_| is_solid(view, object));
    of_box.map_or(member.radius, |body_box| body_box.radius)
}

/// Factor of the damping of a contact of two spheres, at least one of which belongs to a rigid body. `inverse_mass` is that of the contact.
///
/// The places of the other spheres follow from those of the two that touch, the orientations and the forms of the bodies.
fn pair_damping(view: &View, own: [u32; 2], touch: &Touch, inverse_mass: f32) -> f32 {
    let [one, other] = own.map(|sphere| Party::of(view, sphere));
    let reduced = |pair: [Member; 2]| {
        let [r, s] = pair.map(|member| round_radius(view, member));
        r * s / (r + s)
    };
    let of = |party: &Party| Member { sphere: party.sphere, place: party.place, radius: party.radius };
    let own_reduced = reduced([of(&one), of(&other)]);
    let between = own_distance(view, own, touch, one.radius + other.radius);
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
            let met = if is_own { Some((touch.overlap, touch.normal)) } else { member_contact(view, [k, l], apart) };
            let Some((overlap, normal)) = met.filter(|met| met.0 > 0.0) else { continue };
            // A solid is touched on the line through the centre of the other sphere.
            let lever = |member: Member, way: Vec3| {
                member.place + if is_solid(view, Object::Sphere(member.sphere)) { way } else { Vec3::ZERO }
            };
            let turns = [lever(k, apart), lever(l, -apart)].map(|lever| lever.cross(normal));
            let stiffness = match view.step.layout.law {
                LAW_THESIS => {
                    inverse_mass / (one.inverse_mass + one.turning(turns[0]) + (other.inverse_mass + other.turning(turns[1])))
                }
                LAW_HERTZ_MINDLIN => (reduced([k, l]) / own_reduced * overlap / touch.overlap).sqrt(),
                _ => 1.0,
            };
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

/// The vector between the centres of two spheres that touch. `reach` is the sum of their radii.
fn own_distance(view: &View, [a, b]: [u32; 2], touch: &Touch, reach: f32) -> Vec3 {
    if has_box(view, Object::Sphere(a), Object::Sphere(b)) {
        return view.between(a, b);
    }
    (reach - touch.overlap) * touch.normal
}
