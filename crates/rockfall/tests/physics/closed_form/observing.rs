//! `contacts()`, `diagnostics()`, `energy()` and the report against values derived by hand.

use rockfall::{Backend, Body, Contact, ContactAction, Scene, Sphere, Spring};

use crate::common::*;

/// Returns the contact of a scene that has exactly one.
pub(crate) fn only_contact(scene: Scene, backend: Backend) -> Contact {
    let contacts = simulation(scene, backend).contacts().expect("contacts are found");
    assert_eq!(contacts.len(), 1, "{contacts:?}");
    contacts[0]
}

#[track_caller]
fn impulse(contact: &Contact, expected: [f64; 3]) {
    let ContactAction::Impulse(impulse) = contact.action else {
        panic!("an impulse was expected, not {:?}", contact.action);
    };
    near(impulse, expected, 1e-4, "impulse on B");
}

#[track_caller]
fn force(contact: &Contact, expected: [f64; 3]) {
    let ContactAction::Force(force) = contact.action else {
        panic!("a force was expected, not {:?}", contact.action);
    };
    near(force, expected, 1e-3, "force on B");
}

/// Two balls, o = 0.02, closing at 3, masses 1 and 3: j = 1.75 * 3 / (4/3) = 3.9375 on B. The contact point is in the
/// middle of the overlap, 0.5 - 0.01 from A's centre.
fn a_colliding_pair_is_one_contact_with_an_impulse(backend: Backend) {
    let mut scene = weightless();
    let [a, b] = spheres(
        &mut scene,
        [
            Sphere::new([0.0; 3], 0.5).velocity([2.0, 0.0, 0.0]),
            Sphere::new([0.98, 0.0, 0.0], 0.5).mass(3.0).velocity([-1.0, 0.0, 0.0]),
        ],
    );
    let contact = only_contact(scene, backend);
    assert_eq!((contact.a, contact.b), (Body::Sphere(a), Body::Sphere(b)));
    near(contact.normal, [1.0, 0.0, 0.0], 1e-6, "normal");
    near(contact.point, [0.49, 0.0, 0.0], 1e-6, "point");
    close(contact.overlap, 0.02, 1e-6, "overlap");
    impulse(&contact, [3.9375, 0.0, 0.0]);
}

/// A ball of mass 2 lies on the floor with o = 0.01: a force of Cc o m* = 20 acts downwards on the box. The contact
/// point is on the surface of the box.
fn a_resting_ball_is_one_contact_with_a_force(backend: Backend) {
    let mut scene = Scene::new();
    floor_box(&mut scene);
    let [ball] = spheres(&mut scene, [Sphere::new([0.3, 0.49, -0.2], 0.5).mass(2.0)]);
    let floor = scene.box_ids().next().expect("a box");
    let contact = only_contact(scene, backend);
    assert_eq!((contact.a, contact.b), (Body::Sphere(ball), Body::Box(floor)));
    near(contact.normal, [0.0, -1.0, 0.0], 1e-5, "normal");
    near(contact.point, [0.3, 0.0, -0.2], 1e-5, "point");
    force(&contact, [0.0, -20.0, 0.0]);
}

/// Crossing rods at rest, a = 0.25, b = 0.5, unit masses: m* = 1/(10/16 + 1/2) = 8/9, o = 0.02: a force of 20 * 8/9
/// acts upwards on B.
fn crossing_rods_are_one_contact_with_a_force(backend: Backend) {
    let mut scene = weightless();
    let a = rod(&mut scene, [-1.0, 3.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.05)), 0.1);
    let b = rod(&mut scene, [-1.0, 1.0].map(|z| Sphere::new([0.0, 0.18, z], 0.05)), 0.1);
    let contact = only_contact(scene, backend);
    assert_eq!((contact.a, contact.b), (Body::Rod(a), Body::Rod(b)));
    near(contact.normal, [0.0, 1.0, 0.0], 1e-6, "normal");
    near(contact.point, [0.0, 0.09, 0.0], 1e-6, "point");
    force(&contact, [0.0, 160.0 / 9.0, 0.0]);
}

/// A ball of radius 1 overlaps the floor by 0.05, its radius by 5 %. A rod of radius 0.1 overlaps a ball of radius 0.5 by 0.02,
/// its own radius by 20 %. Two fixed balls overlap by more than both, which has no effect.
fn the_deepest_overlap_in_radii_is_that_of_the_smaller_body(backend: Backend) {
    let mut scene = weightless();
    floor_box(&mut scene);
    spheres(&mut scene, [Sphere::new([0.0, 0.95, 0.0], 1.0)]);
    spheres(&mut scene, [4.0, 4.2].map(|x| Sphere::new([x, 3.0, 0.0], 0.5).fixed()));
    let thin = rod(&mut scene, [-1.0, 1.0].map(|z| Sphere::new([0.0, 9.0, z], 0.05)), 0.1);
    let [ball] = spheres(&mut scene, [Sphere::new([0.0, 9.58, 0.0], 0.5)]);
    let mut simulation = simulation(scene, backend);
    let most = simulation.max_overlap().expect("a state");
    close(most.units, 0.05, 1e-6, "units");
    close(most.radii, 0.2, 1e-5, "radii");
    assert_eq!(most.bodies, Some([Body::Sphere(ball), Body::Rod(thin)]));

    // The number is that of the state after a step, not of its beginning.
    simulation.step(0.001).expect("a step");
    let y = simulation.sphere(ball).expect("a ball").position.y;
    let ends = simulation.scene().rod(thin).expect("a rod").end1;
    let axis = simulation.sphere(ends).expect("an end").position.y;
    close(simulation.max_overlap().expect("a state").radii, f64::from((0.6 - (y - axis)) / 0.1), 1e-5, "radii after a step");
    assert!(y > 9.58, "the contact pushes the ball away");
}

/// In the contact of a ball with a polygon, body B is the polygon.
fn a_polygon_is_body_b_of_its_contact(backend: Backend) {
    let mut scene = weightless();
    floor_polygon(&mut scene);
    let [ball] = spheres(&mut scene, [Sphere::new([0.3, 0.49, -0.2], 0.5).velocity([0.0, -2.0, 0.0])]);
    let floor = scene.polygon_ids().next().expect("a polygon");
    let contact = only_contact(scene, backend);
    assert_eq!((contact.a, contact.b), (Body::Sphere(ball), Body::Polygon(floor)));
    impulse(&contact, [0.0, -3.5, 0.0]);
}

/// A ball that hits two balls at once (see `collisions`) has an impulse of 0.8 sqrt 3 along each normal, with e = 1.
/// Phase 3 then applies the same impulses. The third contact, between the two balls that are hit, has a force.
fn contacts_report_the_impulses_that_phase_3_applies(backend: Backend) {
    let mut scene = weightless();
    scene.settings.restitution = 1.0;
    let (cos, sin) = (0.999 * 0.75_f32.sqrt(), 0.999 * 0.5);
    let [_, b, _] = spheres(
        &mut scene,
        [
            Sphere::new([0.0; 3], 0.5).velocity([2.0, 0.0, 0.0]),
            Sphere::new([cos, sin, 0.0], 0.5),
            Sphere::new([cos, -sin, 0.0], 0.5),
        ],
    );
    let mut simulation = simulation(scene, backend);
    let contacts = simulation.contacts().expect("contacts are found");
    assert_eq!(contacts.len(), 3);
    impulse(&contacts[0], [1.2, 0.4 * 3.0_f64.sqrt(), 0.0]);
    assert!(matches!(contacts[2].action, ContactAction::Force(_)));
    simulation.handle_collisions().expect("phase 3");
    let hit = simulation.sphere(b).expect("a ball");
    near(hit.velocity, [1.2, 0.4 * 3.0_f64.sqrt(), 0.0], F32, "velocity");
}

/// A ball of mass 2 (gravity 20 downwards) on the floor with o = 0.03 (60 upwards), an external force of 5 along z, and
/// a neighbour of mass 2 with o = 0.01. The neighbour is fixed, so m* = 2 and its force is 20. The net force on the
/// neighbour itself is reported as 0.
fn diagnostics_hold_net_force_contacts_and_deepest_overlap(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    floor_box(&mut scene);
    spheres(
        &mut scene,
        [
            Sphere::new([0.0, 0.47, 0.0], 0.5).mass(2.0).force([0.0, 0.0, 5.0]),
            Sphere::new([0.99, 0.47, 0.0], 0.5).mass(2.0).fixed(),
            Sphere::new([0.0, 3.0, 0.0], 0.5),
        ],
    );
    let mut simulation = simulation(scene, backend);
    let values = simulation.diagnostics().expect("diagnostics");
    near(values[0].net_force, [-20.0, 40.0, 5.0], 2e-3, "net force");
    assert_eq!(values[0].contacts, 2);
    close(values[0].deepest_overlap, 0.03, 1e-6, "deepest overlap");
    near(values[1].net_force, [0.0; 3], 0.0, "net force on a fixed sphere");
    close(values[1].deepest_overlap, 0.01, 1e-6, "deepest overlap of a fixed sphere, without its contact with the box");
    near(values[2].net_force, [0.0, -10.0, 0.0], 1e-5, "net force in free fall");
    assert_eq!(values[2].contacts, 0);
}

/// Kinetic: 2 * 9 / 2 + L^2/(2 I) = 9 + 0.04/(2 * 0.2) = 9.1. Potential (G = 10, without the fixed sphere):
/// 2 * 10 * 0.49 + 10 * 3. Spring: 10 * (2.51 - 2)^2 / 2. Contact: 1000 * 2 * 0.01^2 / 2. Angular momentum:
/// 2 (0.49 y) x (3 x) + L = (0.2, 0, -2.94).
fn every_kind_of_energy_is_reported(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    floor_box(&mut scene);
    let [a, b, _] = spheres(
        &mut scene,
        [
            Sphere::new([0.0, 0.49, 0.0], 0.5).mass(2.0).velocity([3.0, 0.0, 0.0]).angular_momentum([0.2, 0.0, 0.0]),
            Sphere::new([0.0, 3.0, 0.0], 0.5),
            Sphere::new([9.0, 9.0, 9.0], 0.5).velocity([9.0, 9.0, 9.0]).fixed(),
        ],
    );
    scene.add_spring(Spring::new(a, b, 10.0, 2.0)).expect("a valid spring");
    let energy = simulation(scene, backend).energy().expect("energies");
    close(energy.kinetic, 9.1, 1e-5, "kinetic energy");
    close(energy.potential, 39.8, 1e-5, "potential energy");
    close(energy.spring, 5.0 * 0.51 * 0.51, 1e-5, "energy of the spring");
    close(energy.contact, 0.1, 1e-5, "energy of the contact");
    close(energy.total(), 9.1 + 39.8 + 1.3005 + 0.1, 1e-4, "total energy");
    near(energy.momentum, [6.0, 0.0, 0.0], 1e-6, "momentum");
    near(energy.angular_momentum, [0.2, 0.0, -2.94], 1e-5, "angular momentum");
}

/// The report holds the numbers of steps, contacts and collisions, the time and the overlap. Two balls collide in the
/// first step and then separate above a floor on which a third ball lies.
fn the_report_counts_steps_contacts_and_collisions(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 0.0);
    floor_box(&mut scene);
    spheres(
        &mut scene,
        [
            Sphere::new([0.0, 2.0, 0.0], 0.5).velocity([2.0, 0.0, 0.0]),
            Sphere::new([0.99, 2.0, 0.0], 0.5).velocity([-2.0, 0.0, 0.0]),
            Sphere::new([3.0, 0.5, 0.0], 0.5).force([0.0, -10.0, 0.0]),
        ],
    );
    // Two fixed rods that cross have no contact with each other.
    for axis in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
        let [x, y, z] = axis;
        let ends = [[-x, 3.9 + y, -z], [x, 3.9 + y, z]].map(|end| Sphere::new(end, 0.05).fixed());
        rod(&mut scene, ends, 0.1);
    }
    let mut simulation = simulation(scene, backend);
    let first = simulation.step(DT).expect("a step");
    assert_eq!((first.steps, first.collisions, first.total_collisions), (1, 1, 1));
    let later = simulation.run(63, DT).expect("63 steps");
    assert_eq!((later.steps, later.collisions, later.total_collisions), (64, 0, 1));
    close(later.time, 1.0, 0.0, "time");
    // A force of 10 presses a mass of 1 against the floor, so it rests at o = 10 / Cc = 0.01, up to exp(-Cd t / 2) = 2e-3
    // of that.
    assert_eq!(later.contacts, 1);
    close(later.max_overlap, 0.01, 4e-5, "overlap");
    assert_eq!(later.non_finite, 0);
}

both!(
    a_colliding_pair_is_one_contact_with_an_impulse,
    a_resting_ball_is_one_contact_with_a_force,
    crossing_rods_are_one_contact_with_a_force,
    a_polygon_is_body_b_of_its_contact,
    the_deepest_overlap_in_radii_is_that_of_the_smaller_body,
    contacts_report_the_impulses_that_phase_3_applies,
    diagnostics_hold_net_force_contacts_and_deepest_overlap,
    every_kind_of_energy_is_reported,
    the_report_counts_steps_contacts_and_collisions,
);
