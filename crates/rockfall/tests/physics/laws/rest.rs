//! Bodies at rest: overlaps, static friction on an incline, and the energy of a scene that comes to rest.

use rockfall::{
    Backend, Body, Capsule, ContactAction, ContactLaw, Cuboid, Integrator, Material, Pair, Scene, Simulation, Sphere,
};

use super::{assert_close, ball, pair, scene_with, simulation, soft};

/// Two stacked balls on a floor: the lower contact carries 2 m g, the upper one m g. The overlap of a force F is F / k for
/// `linear`, and (3 F / (4 E* sqrt R*))^(2/3) for `hertz-mindlin`.
fn stacked_balls_rest_with_the_overlaps_of_the_closed_form(law: ContactLaw, backend: Backend) {
    let mut scene = scene_with(law);
    scene.settings.gravity = 10.0;
    let material = soft(&mut scene, "soft");
    pair(&mut scene, material, material, 0.1, 0.5);
    scene.add_box(Cuboid::between([-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]).material(material)).expect("a valid box");
    let balls = [0.5, 1.5].map(|y| ball(&scene, material, [0.0, y, 0.0], 0.5));
    let weight = 10.0 * f64::from(balls[0].mass);
    let ids = balls.map(|sphere| scene.add_sphere(sphere).expect("a valid sphere"));
    let mut simulation = simulation(scene, backend);
    let steps = crate::common::on(backend, 6000, 1000);
    simulation.run(steps, 1.5 / steps as f32).expect("steps");
    let scene = simulation.sync().expect("the state");
    let [low, high] = ids.map(|id| f64::from(scene.sphere(id).expect("a sphere").position.y));
    let overlaps = [0.5 - low, 1.0 - (high - low)];
    let young = 1e5 / (2.0 * (1.0 - 0.25 * 0.25));
    for ((found, force), radius) in overlaps.into_iter().zip([2.0 * weight, weight]).zip([0.5_f64, 0.25]) {
        let expected = match law {
            ContactLaw::HertzMindlin => (3.0 * force / (4.0 * young * radius.sqrt())).powf(2.0 / 3.0),
            _ => force / 1e4,
        };
        assert_close(found, expected, 0.01, "overlap");
    }
    // The contacts that are reported carry these forces.
    let mut forces: Vec<f64> = simulation.contacts().expect("contacts").iter().map(normal_force).collect();
    forces.sort_by(f64::total_cmp);
    assert_eq!(forces.len(), 2);
    assert_close(forces[0], weight, 0.01, "upper force");
    assert_close(forces[1], 2.0 * weight, 0.01, "lower force");
}

fn normal_force(contact: &rockfall::Contact) -> f64 {
    match contact.action {
        ContactAction::Force(force) => f64::from(force.dot(contact.normal)),
        _ => panic!("a law with history has no impulses"),
    }
}

fn stacked_balls_rest_by_linear_law(backend: Backend) {
    stacked_balls_rest_with_the_overlaps_of_the_closed_form(ContactLaw::Linear, backend);
}

fn stacked_balls_rest_by_hertz_mindlin_law(backend: Backend) {
    stacked_balls_rest_with_the_overlaps_of_the_closed_form(ContactLaw::HertzMindlin, backend);
}

/// A capsule whose axis points down an incline cannot roll. Gravity is tilted by a slope of 0.4: with mu = 0.5 it stays where it
/// is, and creeps by less than 2e-4 units/s; with mu = 0.3 it slides with g (sin - mu cos).
fn a_capsule_stays_on_an_incline_up_to_its_friction(law: ContactLaw, backend: Backend) {
    let slope = 0.4_f32;
    let cos = 1.0 / (1.0 + slope * slope).sqrt();
    for (mu, stays) in [(0.5, true), (0.3, false)] {
        let mut scene = scene_with(law);
        scene.settings.gravity = 10.0;
        scene.settings.gravity_direction = glam::Vec3::new(slope * cos, -cos, 0.0);
        let material = soft(&mut scene, "soft");
        pair(&mut scene, material, material, 0.1, mu);
        scene.add_box(Cuboid::between([-5.0, -1.0, -2.0], [20.0, 0.0, 2.0]).material(material)).expect("a valid box");
        let capsule = Capsule::new([0.0, 0.499, 0.0], [2.0, 0.499, 0.0], 0.5).density(1.0).material(material);
        let id = scene.add_capsule(capsule).expect("a valid capsule");
        let end = scene.capsule(id).expect("the capsule").end1;
        let mut simulation = simulation(scene, backend);
        let x = |simulation: &mut Simulation, time: f32| {
            simulation
                .run(crate::common::on(backend, 4000, 300), time / crate::common::on(backend, 4000.0, 300.0))
                .expect("steps");
            let sphere = simulation.sync().expect("the state").sphere(end).expect("an end");
            [f64::from(sphere.position.x), f64::from(sphere.velocity.x)]
        };
        let settled = x(&mut simulation, crate::common::on(backend, 1.0, 0.3));
        let after = x(&mut simulation, crate::common::on(backend, 1.0, 0.3));
        if stays {
            let crept = (after[0] - settled[0]).abs();
            assert!(crept < crate::common::on(backend, 2e-4, 1e-3), "{law}: crept {crept}");
        } else {
            let time = crate::common::on(backend, 1.0, 0.3);
            let acceleration = 10.0 * f64::from(cos * (slope - mu));
            assert_close(after[1] - settled[1], acceleration * time, 0.02, "gain of velocity");
        }
    }
}

fn a_capsule_stays_on_an_incline_by_linear_law(backend: Backend) {
    a_capsule_stays_on_an_incline_up_to_its_friction(ContactLaw::Linear, backend);
}

fn a_capsule_stays_on_an_incline_by_hertz_mindlin_law(backend: Backend) {
    a_capsule_stays_on_an_incline_up_to_its_friction(ContactLaw::HertzMindlin, backend);
}

/// Balls of e = 1 with strong friction in a box lose energy only by sliding: the sum of kinetic, potential and contact energy
/// never grows. For Hertz and Mindlin's law the energy of the tangential springs is left out, so a little is missing while contacts are
/// pressed.
#[test]
fn tangential_springs_create_no_energy() {
    for law in [ContactLaw::Linear, ContactLaw::HertzMindlin] {
        let mut scene = scene_with(law);
        scene.settings.gravity = 10.0;
        let material = scene.add_material(Material::new("m").density(1.0).young(1e5).poisson(0.25)).expect("a material");
        let elastic = Pair::default().restitution(1.0).friction(0.8).stiffness(1e4);
        scene.set_pair(material, material, elastic).expect("a valid pair");
        for (low, high) in
            [([-3.0, -1.0, -3.0], [3.0, 0.0, 3.0]), ([-3.0, 0.0, -3.0], [-2.0, 4.0, 3.0]), ([2.0, 0.0, -3.0], [3.0, 4.0, 3.0])]
        {
            scene.add_box(Cuboid::between(low, high).material(material)).expect("a valid box");
        }
        for k in 0..12_u8 {
            let (column, row) = (f32::from(k % 3), f32::from(k / 3));
            let position = [1.2 * column - 1.2 + 0.1 * row, 0.7 + 1.1 * row, 0.13 * column - 0.1 * row];
            let sphere: Sphere = ball(&scene, material, position, 0.5).velocity([1.0 - column, 0.0, 0.2 * row]);
            scene.add_sphere(sphere).expect("a valid sphere");
        }
        let mut simulation = simulation(scene, Backend::Cpu);
        let total = |simulation: &mut Simulation| {
            let energy = simulation.energy().expect("energies");
            // The energy of the tangential springs is known for the linear law, whose stiffness is 2/7 of the normal one.
            let stiffness = if law == ContactLaw::Linear { 1e4 * 2.0 / 7.0 } else { 0.0 };
            let contacts = simulation.contacts().expect("contacts");
            let springs =
                contacts.iter().filter_map(|contact| contact.springs).map(|springs| springs.displacement.length_squared());
            let tangential: f64 = springs.map(|square| 0.5 * stiffness * f64::from(square)).sum();
            energy.kinetic + energy.potential + energy.contact + tangential
        };
        let start = total(&mut simulation);
        let mut least = start;
        for _ in 0..60 {
            simulation.run(400, 5e-5).expect("steps");
            let now = total(&mut simulation);
            assert!(now < least + 0.004 * start.abs(), "{law}: {now} after {least}");
            least = least.min(now);
        }
        assert!(least < 0.98 * start, "{law}: friction must have worked, {least} of {start}");
        let bodies = simulation.contacts().expect("contacts");
        assert!(bodies.iter().all(|contact| matches!(contact.a, Body::Sphere(_))));
    }
}

/// A shaft full of grains, with a material that is so many times as stiff as one with which they sink into each other.
fn shaft(law: ContactLaw, stiffer: f64) -> Scene {
    let mut scene = scene_with(law);
    scene.settings.gravity = 10.0;
    let stiffer = stiffer as f32;
    let material = Material::new("m").density(1.0).young(1e4 * stiffer).poisson(0.25);
    let material = scene.add_material(material).expect("a material");
    // Without friction at the walls, which would carry a part of the weight.
    let own = Pair::default().restitution(0.2).friction(0.0).stiffness(150.0 * stiffer);
    scene.set_pair(material, material, own).expect("a valid pair");
    let walls =
        [[[-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]], [[-2.0, 0.0, -2.0], [-0.42, 4.0, 2.0]], [[0.42, 0.0, -2.0], [2.0, 4.0, 2.0]]];
    let more = [[[-0.42, 0.0, -2.0], [0.42, 4.0, -0.42]], [[-0.42, 0.0, 0.42], [0.42, 4.0, 2.0]]];
    for [low, high] in walls.into_iter().chain(more) {
        scene.add_box(Cuboid::between(low, high).material(material)).expect("a valid box");
    }
    for k in 0..192_u16 {
        let [x, y, z] = [k % 4, k / 16, k / 4 % 4].map(|place| 0.205 * f32::from(place));
        let shift = 0.002 * f32::from(k % 5);
        let position = [x - 0.31 + shift, 0.11 + y, z - 0.31 + 0.5 * shift];
        scene.add_sphere(ball(&scene, material, position, 0.1)).expect("a valid sphere");
    }
    scene
}

/// The deepest overlap in a shaft of grains is what `soft_material` warns of, within a factor of two, and grains of a material
/// that is stiffer by the factor that it gives overlap by about 5 % at most.
#[test]
fn soft_materials_are_warned_of() {
    for law in [ContactLaw::Linear, ContactLaw::HertzMindlin] {
        let deepest = |stiffer: f64| {
            let mut simulation = simulation(shaft(law, stiffer), Backend::Cpu);
            simulation.run(8000, 5e-4 / stiffer.sqrt() as f32).expect("steps");
            f64::from(simulation.resting_overlap().expect("an overlap").radii)
        };
        let warning = shaft(law, 1.0).soft_material().expect("a warning");
        assert!(warning.overlap > 0.05 * warning.radius && warning.load > 5.0, "{warning:?}");
        let ratio = deepest(1.0) * warning.radius / warning.overlap;
        assert!((0.5..2.0).contains(&ratio), "{law}: {ratio} of {warning}");
        let stiffer = 1.01 * warning.factor;
        assert_eq!(shaft(law, stiffer).soft_material(), None);
        let overlap = deepest(stiffer);
        // Contacts of a packing do not carry equal shares: the deepest one of the linear law has 6.1 %.
        assert!((0.015..0.07).contains(&overlap), "{law}: {overlap}");
        // The warning reaches users.
        let concerns = shaft(law, 1.0).concerns(1e-5, Integrator::SymplecticEuler);
        assert!(concerns.iter().any(|text| text.contains("times as stiff")), "{concerns:?}");
    }
}

both!(
    stacked_balls_rest_by_linear_law,
    stacked_balls_rest_by_hertz_mindlin_law,
    a_capsule_stays_on_an_incline_by_linear_law,
    a_capsule_stays_on_an_incline_by_hertz_mindlin_law,
);
