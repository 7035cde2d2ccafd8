//! Inlets and outlets (docs/physics section 2.15).

use rockfall::glam::Vec3;
use rockfall::{
    Backend, Capsule, Checkpoint, ContactLaw, Cuboid, Flow, GrainKind, GrainMass, Inlet, Material, Options, Outlet, Pair,
    Radii, Rate, Scene, Shape, ShapeId, Simulation, SizedBy, Sphere, Spring, Tag,
};

use crate::common::{DT, bits_of};

/// Spheres fall from an inlet through a hole between two boxes into an outlet. Some of them lie on the boxes.
fn chute() -> Scene {
    let mut scene = Scene::new();
    for [from, to] in [[-2.0, -0.4], [0.4, 2.0]] {
        scene.add_box(Cuboid::between([from, -0.5, -1.0], [to, 0.0, 1.0])).expect("a box");
    }
    let feed = Inlet::new("feed", [[-1.0, 2.0, -0.8], [1.0, 2.6, 0.8]], Rate::Mass(60.0), 0.1);
    let kind = |name: &str, from, to| {
        GrainKind::spheres(0.1).name(name).radii(Radii::Uniform(from, to), SizedBy::Mass).tag(Tag::new().name(name))
    };
    let feed = feed.mix([(kind("coarse", 0.08, 0.16), 4.0), (kind("fine", 0.07, 0.08), 1.0)], SizedBy::Mass);
    scene.add_inlet(feed.density(500.0).velocity([0.0, -1.0, 0.0]).seed(3)).expect("an inlet");
    scene.add_outlet(Outlet::new("drain", [[-5.0, -4.0, -5.0], [5.0, -1.0, 5.0]])).expect("an outlet");
    scene
}

fn open(scene: &Scene, backend: Backend) -> Simulation {
    Simulation::with_options(scene.clone(), Options::new().backend(backend)).expect("the simulation opens")
}

both!(
    masses_balance_exactly,
    grains_do_not_depend_on_the_calls,
    a_resumed_run_is_identical,
    a_full_box_waits_and_reports,
    springs_of_other_contacts_are_kept,
    what_is_attached_leaves_too,
    phases_alone_are_a_step,
    bodies_come_in_and_leave,
    inlets_look_across_faces,
);

fn masses_balance_exactly(backend: Backend) {
    let mut scene = chute();
    let there =
        [0.3_f32, 7.7].map(|mass| scene.add_sphere(Sphere::new([mass - 4.0, 0.15, 0.0], 0.1).mass(mass)).expect("a sphere"));
    scene.add_sphere(Sphere::new([0.0, -2.0, 0.0], 0.1).fixed()).expect("a sphere");
    let mut simulation = open(&scene, backend);
    let start = simulation.flow();
    assert_eq!((start.spheres, start.mass), (2, f64::from(0.3_f32) + f64::from(7.7_f32)));
    for _ in 0..6 {
        simulation.run(40, DT).expect("steps");
        let Flow { inlets, outlets, spheres, mass, .. } = simulation.flow();
        assert_eq!(inlets[0].mass - outlets[0].mass, mass - start.mass, "not one bit is lost");
        assert_eq!(inlets[0].spheres - outlets[0].spheres + start.spheres, spheres);
        assert_eq!(simulation.scene().counts().spheres as u64, spheres + 1, "and a fixed one");
    }
    let Flow { inlets, outlets, .. } = simulation.flow();
    // 240 steps of 1/64 s, at 60 /s. The inlet acts every 5 steps, and a sphere has a mass of up to 8.6.
    assert!((225.0 - 60.0 * 5.0 / 64.0 - 8.6..=225.0).contains(&inlets[0].mass) && inlets[0].waiting <= 12, "{inlets:?}");
    assert!(outlets[0].spheres > 10, "{outlets:?}");
    assert!(there.iter().all(|id| simulation.sphere(*id).is_err()), "they fell past the floor");
}

fn grains_do_not_depend_on_the_calls(backend: Backend) {
    let scene = chute();
    let mut whole = open(&scene, backend);
    whole.run(200, DT).expect("steps");
    let mut parts = open(&scene, backend);
    for steps in [1, 1, 7, 50, 1, 30, 60, 49, 1] {
        parts.run(steps, DT).expect("steps");
        // What reads must not change anything.
        parts.energy().expect("energies");
    }
    assert_eq!(whole.flow(), parts.flow());
    assert!(whole.flow().outlets[0].spheres > 5, "{:?}", whole.flow());
    assert!(bits_of(&mut whole) == bits_of(&mut parts));
}

fn a_resumed_run_is_identical(backend: Backend) {
    let mut whole = open(&chute(), backend);
    whole.run(90, DT).expect("steps");
    let bytes = whole.checkpoint().expect("a checkpoint").to_bytes();
    let in_memory = whole.checkpoint().expect("a checkpoint");
    whole.run(90, DT).expect("steps");
    let expected = (whole.flow(), bits_of(&mut whole));
    let from_file = Checkpoint::from_bytes(&bytes, "file.ckpt").expect("a checkpoint");
    assert_eq!(from_file.to_bytes(), bytes);
    for checkpoint in [from_file, in_memory.clone()] {
        let mut resumed = Simulation::resume(checkpoint).expect("it resumes");
        resumed.run(90, DT).expect("steps");
        assert!((resumed.flow(), bits_of(&mut resumed)) == expected);
    }
    whole.restore(&in_memory).expect("it is restored");
    whole.run(90, DT).expect("steps");
    assert!((whole.flow(), bits_of(&mut whole)) == expected);
    let scene = whole.scene();
    let references: Vec<_> = scene.sphere_ids().map(|id| scene.reference(id).expect("a reference")).collect();
    assert!(references.is_sorted_by(|one, other| one < other), "references count on: {references:?}");
    let entered = whole.flow().inlets[0].spheres as u32;
    assert_eq!(references.last(), Some(&entered), "the last sphere came in last");
    assert!(scene.sphere_ids().all(|id| scene.tag(id).expect("in the scene").is_some()));
}

/// In a box without a way out there is room for few spheres.
fn a_full_box_waits_and_reports(backend: Backend) {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    let inlet = Inlet::new("feed", [[0.0; 3], [1.0; 3]], Rate::Number(64.0), 0.2).mass(2.0).every(1);
    scene.add_inlet(inlet.limit(200)).expect("an inlet");
    let mut simulation = open(&scene, backend);
    simulation.run(65, DT).expect("steps");
    // Before step 64, at 1 s, 64 spheres were due.
    let Flow { inlets, spheres, mass, .. } = simulation.flow();
    assert!((4..=18).contains(&spheres), "{spheres}");
    assert_eq!((inlets[0].spheres, inlets[0].mass, mass), (spheres, 2.0 * spheres as f64, 2.0 * spheres as f64));
    assert_eq!(inlets[0].waiting + spheres, 65, "65 spheres are due after step 65");
    assert_eq!(simulation.report().contacts, 0, "none overlaps another one");
    // Those that wait come in when there is room, up to the limit.
    let inside: Vec<_> = simulation.scene().sphere_ids().collect();
    simulation.remove_spheres(&inside).expect("they are there");
    simulation.run(1, DT).expect("a step");
    assert!(simulation.flow().spheres >= 4, "{:?}", simulation.flow());
    simulation.run(64 * 10, DT).expect("steps");
    let Flow { inlets, .. } = simulation.flow();
    assert_eq!(inlets[0].spheres + inlets[0].waiting, 200, "{inlets:?}");
}

/// A sphere at rest on a slope is held by the spring of its contact. It does not slide when spheres elsewhere come and go.
fn springs_of_other_contacts_are_kept(backend: Backend) {
    let dt = 1.0 / 4096.0;
    let mut scene = Scene::new();
    scene.settings.set("contact_law", ContactLaw::HertzMindlin.name()).expect("a law");
    scene.settings.gravity_direction = Vec3::new(0.3, -1.0, 0.0).normalize();
    let soft = scene.add_material(Material::new("soft").density(1000.0).young(1e6).poisson(0.25)).expect("a material");
    scene.set_pair(soft, soft, Pair::default().restitution(0.2).friction(0.8).rolling_friction(0.5)).expect("a pair");
    scene.add_box(Cuboid::between([-4.0, -1.0, -1.0], [4.0, 0.0, 1.0]).material(soft)).expect("a box");
    let resting = scene.add_sphere(Sphere::new([-2.0, 0.1, 0.0], 0.1).density(1000.0).material(soft)).expect("a sphere");
    let mut alone = open(&scene, backend);
    alone.run(3000, dt).expect("steps");
    let mut checkpoint = alone.checkpoint().expect("a checkpoint");
    let feed = Inlet::new("feed", [[2.0, 0.0, -0.5], [2.5, 0.5, 0.5]], Rate::Number(64.0), 0.05)
        .material(soft)
        .every(64)
        .velocity([3.0, 0.0, 0.0]);
    checkpoint.scene.add_inlet(feed.during(0.0, 10.0)).expect("an inlet");
    checkpoint.scene.add_outlet(Outlet::new("drain", [[2.6, -1.0, -2.0], [9.0, 3.0, 2.0]]).every(32)).expect("an outlet");
    let mut busy = Simulation::resume(checkpoint).expect("it resumes");
    let spring = |simulation: &mut Simulation| {
        let contacts = simulation.contacts().expect("contacts");
        let own = contacts.iter().find(|contact| contact.a == rockfall::Body::Sphere(resting)).expect("it rests");
        own.springs.expect("a law with history").displacement
    };
    let before = (spring(&mut alone), alone.sphere(resting).expect("a sphere").position);
    assert!(before.0.length() > 1e-6, "the spring holds the sphere: {before:?}");
    busy.run(2000, dt).expect("steps");
    alone.run(2000, dt).expect("steps");
    let flow = busy.flow();
    assert!(flow.inlets[0].spheres > 20 && flow.outlets[0].spheres > 0, "{flow:?}");
    let (here, there) = (busy.sphere(resting).expect("a sphere").position, alone.sphere(resting).expect("a sphere").position);
    assert!(here.distance(there) < 1e-6, "{here} {there}");
    assert!(spring(&mut busy).distance(spring(&mut alone)) < 1e-2 * before.0.length(), "{before:?} {:?}", spring(&mut busy));
}

fn what_is_attached_leaves_too(backend: Backend) {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    let at = |x: f32| Sphere::new([x, 0.0, 0.0], 0.1);
    let ids = [0.0, 1.0, 2.0, 3.0].map(|x| scene.add_sphere(at(x)).expect("a sphere"));
    scene.add_spring(Spring::new(ids[0], ids[1], 1.0, 1.0)).expect("a spring");
    scene.add_spring(Spring::new(ids[2], ids[3], 1.0, 1.0)).expect("a spring");
    // One end is in the box, but not the middle; of the other one the middle is.
    let stays = scene.add_capsule(Capsule::new([1.0, 2.0, 0.0], [2.0, 2.0, 0.0], 0.1)).expect("a capsule");
    let leaves = scene.add_capsule(Capsule::new([0.8, 4.0, 0.0], [1.6, 4.0, 0.0], 0.1).mass(3.0)).expect("a capsule");
    scene.add_outlet(Outlet::new("drain", [[0.5, -1.0, -1.0], [1.4, 9.0, 1.0]]).every(4)).expect("an outlet");
    let mut simulation = open(&scene, backend);
    simulation.run(1, DT).expect("a step");
    let scene = simulation.scene();
    assert!(scene.capsule(stays).is_ok() && scene.capsule(leaves).is_err());
    assert!(scene.sphere(ids[0]).is_ok() && scene.sphere(ids[1]).is_err());
    assert_eq!((scene.springs().len(), scene.rods().len()), (1, 1));
    let flow = simulation.flow();
    assert_eq!((flow.outlets[0].spheres, flow.outlets[0].mass), (3, 4.0));
    assert_eq!((flow.spheres, flow.mass), (5, 4.0), "three spheres of mass 1, and a capsule of mass 1");
}

fn phases_alone_are_a_step(backend: Backend) {
    let mut steps = open(&chute(), backend);
    steps.run(60, DT).expect("steps");
    let mut phases = open(&chute(), backend);
    for _ in 0..60 {
        phases.set_time_step(DT).expect("a time step");
        phases.update_aabbs().expect("a phase");
        phases.broad_phase().expect("a phase");
        phases.handle_collisions().expect("a phase");
        phases.update_positions(DT).expect("a phase");
    }
    assert!(steps.flow().spheres > 10);
    assert_eq!(steps.flow(), phases.flow());
    assert!(bits_of(&mut steps) == bits_of(&mut phases));
}

/// Radii come from the seed, and places too where the box is empty.
#[cfg(feature = "gpu")]
#[test]
fn both_backends_have_the_same_grains() {
    let _device = rockfall::gpu::SharedDevice::new();
    let grains = [Backend::Cpu, Backend::Gpu].map(|backend| {
        let mut simulation = open(&chute(), backend);
        simulation.run(30, DT).expect("steps");
        let sizes: Vec<_> = simulation.scene().spheres().iter().map(|sphere| (sphere.radius, sphere.mass)).collect();
        let last = simulation.spheres().expect("states").last().expect("a sphere").position;
        (simulation.flow(), sizes, last)
    });
    let [one, other] = grains;
    assert!(one.0.spheres > 5);
    assert_eq!((&one.0, &one.1), (&other.0, &other.1));
    assert!(one.2.distance(other.2) < 1e-4, "{} {}", one.2, other.2);
}

/// A run that begins with the saved text goes on with the next spheres of the sequence.
#[test]
fn a_saved_text_goes_on_with_the_sequence() {
    let mut whole = open(&chute(), Backend::Cpu);
    whole.run(50, DT).expect("steps");
    let entered = whole.flow().inlets[0].spheres;
    let text = whole.snapshot().expect("a scene").to_text();
    assert!(text.contains(&format!(" after={entered}\n")), "{text}");
    let saved = Scene::parse(&text, std::path::Path::new("saved.txt")).expect("it reads back").scene;
    let mut rest = open(&saved, Backend::Cpu);
    rest.run(50, DT).expect("steps");
    whole.run(50, DT).expect("steps");
    let masses = |simulation: &Simulation| simulation.scene().spheres().last().map(|sphere| sphere.mass);
    assert_eq!(whole.flow().inlets[0].spheres, entered + rest.flow().inlets[0].spheres);
    assert_eq!(masses(&whole), masses(&rest));
}

#[test]
fn worlds_refuse_inlets() {
    let error = rockfall::Worlds::new([Scene::new(), chute()], Options::new().backend(Backend::Cpu)).unwrap_err().to_string();
    assert!(error.contains("a scene with inlets or outlets for world 1"), "{error}");
}

#[test]
fn a_material_that_the_law_needs_is_demanded_at_the_start() {
    let mut scene = Scene::new();
    scene.settings.set("contact_law", "linear").expect("a law");
    scene.add_inlet(chute().inlets()[0].clone()).expect("an inlet");
    let error = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap_err().to_string();
    assert!(error.contains("linear without a material for sphere number 0"), "{error}");
}

/// Two spheres and a box as one body.
fn hammer(scene: &mut Scene) -> ShapeId {
    let head = Cuboid::between([-0.1, -0.05, -0.05], [0.1, 0.05, 0.05]);
    let shape = Shape::new().sphere([0.0, 0.2, 0.0], 0.06).sphere([0.0, 0.3, 0.0], 0.05).cuboid(head).density(400.0);
    scene.add_shape(shape.name("hammer")).expect("a shape")
}

fn bodies_come_in_and_leave(backend: Backend) {
    let mut scene = chute();
    let shape = hammer(&mut scene);
    let inlet = Inlet::of_bodies("hammers", [[-1.0, 3.0, -0.8], [1.0, 4.0, 0.8]], Rate::Number(20.0), shape);
    scene.add_inlet(inlet.velocity([0.0, -2.0, 0.0]).seed(5).tag(Tag::new().name("hammer"))).expect("an inlet");
    let mut simulation = open(&scene, backend);
    simulation.run(16, DT).expect("steps");
    let scene = simulation.scene();
    let turns: Vec<f32> = scene.bodies().iter().map(|body| body.orientation.w.abs()).collect();
    assert!(turns.len() >= 3 && turns.iter().all(|w| *w < 0.999), "they are turned: {turns:?}");
    for _ in 0..6 {
        simulation.run(30, DT).expect("steps");
        let Flow { inlets, outlets, spheres, mass, .. } = simulation.flow();
        assert_eq!(inlets[0].mass + inlets[1].mass - outlets[0].mass, mass, "not one bit is lost");
        assert_eq!(inlets[0].spheres + inlets[1].spheres - outlets[0].spheres, spheres);
        for (id, body) in simulation.scene().body_ids().zip(simulation.scene().bodies()) {
            assert_eq!(body.spheres().len(), 3);
            let tag = simulation.scene().tag(id).expect("in the scene").expect("a tag");
            assert_eq!(tag.name.as_deref(), Some("hammer"));
        }
    }
    let flow = simulation.flow();
    assert!(flow.inlets[1].spheres > 11, "{flow:?}");

    // A checkpoint has the shape of the inlet, and the run goes on with the same bodies.
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    let read = Checkpoint::from_bytes(&bytes, "file.ckpt").expect("a checkpoint");
    assert_eq!(read.to_bytes(), bytes);
    let mut resumed = Simulation::resume(read).expect("it resumes");
    for run in [&mut simulation, &mut resumed] {
        run.run(60, DT).expect("steps");
    }
    assert!((simulation.flow(), bits_of(&mut simulation)) == (resumed.flow(), bits_of(&mut resumed)));
}

#[test]
fn inlets_of_bodies_have_their_size_and_mass() {
    let mut scene = Scene::new();
    let shape = scene.add_shape(Shape::new().sphere([0.0; 3], 0.1).sphere([0.2, 0.0, 0.0], 0.1).mass(3.0)).expect("a shape");
    let corners = [[0.0; 3], [0.5, 0.5, 0.5]];
    scene.add_inlet(Inlet::of_bodies("in", corners, Rate::Mass(6.0), shape)).expect("an inlet");
    let kind = &scene.inlets()[0].kinds[0].0;
    assert_eq!((kind.radii, kind.mass), (Radii::Equal(f64::from(0.1_f32) + f64::from(0.2_f32) / 2.0), GrainMass::Mass(3.0)));
    // The sphere around it has the diameter 0.4.
    let small = Inlet::of_bodies("small", [[0.0; 3], [0.5, 0.39, 0.5]], Rate::Mass(6.0), shape);
    let error = scene.add_inlet(small).expect_err("it does not fit").to_string();
    assert!(error.contains("inlet.box"), "{error}");
    let volume =
        scene.add_inlet(Inlet::of_bodies("volume", corners, Rate::Volume(1.0), shape)).expect_err("refused").to_string();
    assert!(volume.contains("inlet.volume_rate"), "{volume}");
    let mut other = Scene::new();
    assert!(other.add_inlet(Inlet::of_bodies("in", corners, Rate::Mass(6.0), shape)).is_err(), "the shape is of another scene");
}

/// Through the face of a periodic box a sphere touches what is near the other face.
fn inlets_look_across_faces(backend: Backend) {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    scene.set_periodic(0, Some([0.0, 2.0])).expect("a periodic axis");
    for y in [0.2, 0.6] {
        scene.add_sphere(Sphere::new([1.95, y, 0.2], 0.2).fixed()).expect("a sphere");
    }
    scene.add_box(Cuboid::between([1.8, 0.8, 0.0], [2.2, 0.9, 0.4])).expect("a box");
    let inlet = Inlet::new("in", [[0.0, 0.0, 0.0], [0.5, 1.2, 0.4]], Rate::Number(6400.0), 0.05).every(1);
    scene.add_inlet(inlet).expect("an inlet");
    let mut simulation = open(&scene, backend);
    simulation.run(2, DT).expect("steps");
    assert!(simulation.flow().spheres > 30, "{:?}", simulation.flow());
    assert_eq!(simulation.contacts().expect("contacts").len(), 0, "none overlaps the images");
}
