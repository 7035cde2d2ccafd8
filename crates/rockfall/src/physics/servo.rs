//! What a contact contributes to the force and to the stiffness of a servo (docs/physics section 2.18).

use glam::{Vec2, Vec3};

use crate::model::layout::LAW_THESIS;
use crate::model::servo::ServoRecord;
use crate::model::view::View;
use crate::physics::forces::contacts::Contacts;
use crate::physics::laws::contact::{Pliancy, pliancy};
use crate::physics::side::Side;
use crate::physics::sides::{sides, wall_of};
use crate::physics::surface::Hidden;
use crate::physics::touch::Touch;

/// Adds what the contacts of a mover contribute to the servos, force and stiffness each.
pub(crate) fn add_contacts(contacts: &Contacts, mover: u32, servos: &[ServoRecord], sums: &mut [Vec2]) {
    let view = contacts.view;
    let (count, list) = contacts.lists.list(mover);
    let servo_of = |wall: u32| {
        let body = if wall < view.step.movers() { 0 } else { view.body(view.object(wall)) };
        servos.iter().position(|servo| servo.body == body)
    };
    // Boxes and polygons are the last entries of a list.
    let first = (0..count).rev().take_while(|place| list(*place).id() >= view.step.movers()).last().unwrap_or(count);
    if (first..count).all(|place| servo_of(list(place).id()).is_none()) {
        return;
    }
    let hidden = Hidden::of(view, mover, count, &list);
    for entry in (first..count).map(&list).filter(|entry| !hidden.has(entry)) {
        let Some(number) = servo_of(entry.id()) else { continue };
        let Some((touch, loads, _)) = contacts.evaluate(mover, entry.id(), entry.feature()) else { continue };
        if loads.force != Vec3::ZERO {
            sums[number] += share(view, [mover, entry.id()], &touch, loads.force, &servos[number]);
        }
    }
}

/// The contribution of a contact with a force on the mover.
fn share(view: &View, ids: [u32; 2], touch: &Touch, force: Vec3, servo: &ServoRecord) -> Vec2 {
    let [a, b] = sides(view, ids, touch);
    let n = touch.normal;
    let arm = a.radius.unwrap_or(0.0) - touch.overlap;
    let way = match wall_of(view, view, ids, touch) {
        Some((wall, place)) if servo.turns => servo.axis.cross(wall.corner() + wall.lever(place) - servo.point),
        _ => servo.axis,
    };
    let Pliancy { stiffness, damping } =
        if view.step.layout.law == LAW_THESIS { of_thesis(view, [&a, &b], n, arm, force) } else { pliancy(view, ids, touch) };
    let [normal, tangential] = [0, 1].map(|kind| stiffness[kind] + damping[kind] / view.step.constants.dt);
    let along = way.dot(n);
    let across = way - along * n;
    Vec2::new(force.dot(way), normal * along * along + tangential * across.length_squared())
}

/// Stiffness and damping of a contact of the law of sections 4.3 to 4.6, along its normal and in its tangent plane.
fn of_thesis(view: &View, [a, b]: [&Side; 2], n: Vec3, arm: f32, force: Vec3) -> Pliancy {
    let mass = 1.0 / (a.inverse_mass + b.inverse_mass);
    let slip = b.velocity - (a.velocity + a.spin.cross(arm * n));
    let (slip, friction) = (slip - slip.dot(n) * n, force - force.dot(n) * n);
    let rub = if slip == Vec3::ZERO { 0.0 } else { friction.length() / slip.length() };
    let constants = &view.step.constants;
    Pliancy { stiffness: [constants.contact_force * mass, 0.0], damping: [constants.contact_damping * mass, rub] }
}
