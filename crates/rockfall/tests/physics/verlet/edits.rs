//! The forces at the start of a step are those of the step before, unless an edit may have changed them.

use rockfall::glam::Vec3;
use rockfall::{
    Backend, Capsule, Checkpoint, ContactAction, ContactLaw, Cuboid, Integrator, Material, Options, Pair, Scene, Settings,
    Simulation, Sphere, SphereId, Spring, Tether,
};

use super::{state, verlet};
use crate::common::{on, spheres, with};

const DT: f32 = 1.0 / 64.0;

/// Two spheres of mass 1 at rest, 2 apart, after a step without forces.
fn resting(backend: Backend) -> (Simulation, [SphereId; 2]) {
    // Without a collision phase, which would evaluate the forces in every step.
    let mut scene = with(|settings| (settings.gravity, settings.collisions) = (0.0, false));
    let ids = spheres(&mut scene, [0.0_f32, 2.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1).mass(1.0)));
    let mut simulation = verlet(scene, backend);
    simulation.step(DT).expect("a step");
    (simulation, ids)
}

/// A force F that begins between two steps moves a body of mass 1 by F dt²/2 within the first of them. Without an evaluation at
/// its start the body would not move.
fn edits_take_effect_at_the_start_of_the_next_step(backend: Backend) {
    let force = 8.0;
    type Change = fn(&mut Simulation, [SphereId; 2]) -> rockfall::Result<()>;
    let changes: [(&str, Change); 5] = [
        ("an external force", |simulation, [id, _]| simulation.set_force(id, [8.0, 0.0, 0.0])),
        ("a spring", |simulation, [a, b]| simulation.add_spring(Spring::new(a, b, 8.0, 1.0)).map(drop)),
        ("a tether", |simulation, [a, _]| simulation.add_tether(Tether::new(a, [1.0, 0.0, 0.0], 8.0)).map(drop)),
        ("gravity", |simulation, _| {
            let along = simulation.settings().with(|settings| {
                settings.gravity = 8.0;
                settings.gravity_direction = Vec3::X;
            });
            simulation.set_settings(along)
        }),
        ("another body", |simulation, [a, _]| {
            let third = simulation.add_sphere(Sphere::new([3.0, 0.0, 0.0], 0.1))?;
            simulation.add_spring(Spring::new(a, third, 8.0, 2.0)).map(drop)
        }),
    ];
    for (what, change) in changes {
        let (mut simulation, ids) = resting(backend);
        change(&mut simulation, ids).expect(what);
        simulation.step(DT).expect("a step");
        let [x, _] = state(&mut simulation, ids[0]);
        let expected = 0.5 * f64::from(force * DT * DT);
        assert!((x.x - expected).abs() < 1e-6, "{what}: {} instead of {expected}", x.x);
    }
    // A position: the spring is stretched by 1.
    let (mut simulation, [a, b]) = resting(backend);
    simulation.add_spring(Spring::new(a, b, 8.0, 2.0)).expect("a spring");
    simulation.step(DT).expect("a step");
    simulation.set_position(b, [3.0, 0.0, 0.0]).expect("a position");
    simulation.step(DT).expect("a step");
    let [x, _] = state(&mut simulation, a);
    assert!((x.x - 0.5 * f64::from(force * DT * DT)).abs() < 1e-6, "a position: {}", x.x);
}

/// Balls, a capsule and springs on a floor, with collisions.
fn mixed() -> Scene {
    let mut scene = Scene::new();
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])).expect("a valid box");
    let places = [[0.0, 0.6, 0.0], [0.9, 1.2, 0.1], [-0.8, 1.6, 0.3]];
    let [a, b, _] = spheres(&mut scene, places.map(|place: [f32; 3]| Sphere::new(place, 0.5).velocity([0.3, -1.0, 0.0])));
    scene.add_spring(Spring::new(a, b, 40.0, 1.1).damping(0.4)).expect("a valid spring");
    scene.add_capsule(Capsule::new([-0.5, 3.0, 0.0], [0.6, 3.3, 0.2], 0.2)).expect("a valid capsule");
    scene
}

fn bits(simulation: &mut Simulation) -> Vec<u32> {
    let states = simulation.spheres().expect("spheres are read back");
    let of = |state: &rockfall::SphereState| {
        [state.position, state.velocity, state.angular_momentum].into_iter().flat_map(|vector| vector.to_array()).collect()
    };
    states.iter().flat_map(|state| -> Vec<f32> { of(state) }).map(f32::to_bits).collect()
}

/// A checkpoint holds the rates, and whether the next step must evaluate them again. With collisions every step does so.
fn checkpoints_before_and_after_edits_go_on_bit_for_bit(backend: Backend) {
    for collisions in on(backend, &[true, false][..], &[false]) {
        let mut scene = mixed();
        scene.settings.collisions = *collisions;
        let mut simulation = verlet(scene, backend);
        let first = simulation.scene().sphere_ids().next().expect("a sphere");
        for part in 0..4 {
            if part > 0 {
                simulation.run(7, 0.01).expect("steps");
            }
            if part == 2 {
                simulation.apply_impulse(first, [0.3, 0.2, 0.1]).expect("an impulse");
            }
            let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
            let mut resumed = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("valid")).expect("resumed");
            assert_eq!(resumed.checkpoint().expect("a checkpoint").to_bytes(), bytes, "collisions {collisions}, part {part}");
            for simulation in [&mut simulation, &mut resumed] {
                simulation.run(5, 0.01).expect("steps");
            }
            assert!(bits(&mut simulation) == bits(&mut resumed), "collisions {collisions}, part {part}");
        }
    }
}

/// Rates that a file does not have for every sphere, or that are not finite, are refused. A checkpoint of version 4 has none.
#[test]
fn damaged_rates_in_a_checkpoint_are_refused() {
    let mut simulation = verlet(mixed(), Backend::Cpu);
    simulation.run(3, 0.01).expect("steps");
    let good = simulation.checkpoint().expect("a checkpoint").to_bytes();
    let changed = |at: usize, word: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        let end = bytes.len() - 4;
        let sum = crc32fast::hash(&bytes[..end]);
        bytes[end..].copy_from_slice(&sum.to_le_bytes());
        Checkpoint::from_bytes(&bytes, "memory").map(drop).expect_err("refused").to_string()
    };
    // The numbers of residues and of words of hard contacts, the low parts of 5 positions and their number, the length of the
    // tags, the words of 5 spheres, a rod, a capsule, a spring and a box follow, the motion and the surface velocity of the box, 8 bytes of inlets and outlets, 8 of shapes and bodies, 8 of
    // implied bodies, 8 of joints, 8 of groups, 8 of sensors, and the checksum.
    let first =
        good.len() - 4 - 8 - 8 - 8 - 8 - 8 - 8 - 4 - 4 * (5 * 19 + 5 + 3 + 9 + 13 + 3) - 5 * 12 - 8 - 8 - 8 - 8 - 5 * 24;
    // With another number of them, what follows them is not understood: the fifth is read as residues.
    assert!(changed(first - 8, 4).contains("residue"), "{}", changed(first - 8, 4));
    assert!(changed(first, f32::NAN.to_bits()).contains("not finite"), "{}", changed(first, f32::NAN.to_bits()));
}

/// A ball that rests on a floor and sticks while it is pushed aside: its tangential spring grows by the slip of a step. An edit
/// between two steps, which evaluates the contact twice, must not advance the spring twice.
fn an_evaluation_after_an_edit_does_not_advance_springs(backend: Backend) {
    let displacement = |is_edited: bool| {
        let mut scene = Scene::new();
        scene.settings = Settings::default().with(|settings| {
            (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::HertzMindlin, false, 10.0);
        });
        let material = scene.add_material(Material::new("soft").density(1.0).young(1e5).poisson(0.25)).expect("a material");
        scene.set_pair(material, material, Pair::default().restitution(0.5).friction(0.8)).expect("a pair");
        scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]).material(material)).expect("a valid box");
        let ball = Sphere::new([0.0, 0.4999, 0.0], 0.5).density(1.0).material(material).velocity([0.001, 0.0, 0.0]);
        let id = scene.add_sphere(ball).expect("a valid sphere");
        let options = Options::new().backend(backend).integrator(Integrator::VelocityVerlet);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        for _ in 0..4 {
            if is_edited {
                let velocity = state(&mut simulation, id)[1].as_vec3();
                simulation.set_velocity(id, velocity).expect("the same velocity");
            }
            simulation.step(1e-4).expect("a step");
        }
        let contacts = simulation.contacts().expect("the contacts");
        let [contact] = &contacts[..] else { panic!("one contact") };
        assert!(matches!(contact.action, ContactAction::Force(_)));
        f64::from(contact.springs.expect("springs").displacement.x)
    };
    let (plain, edited) = (displacement(false), displacement(true));
    // 4 steps of 1e-4 s at 0.001 units/s, and no fifth by looking at the contact.
    assert!((plain - 4e-7).abs() < 0.06 * 4e-7, "{plain}");
    assert!((edited - plain).abs() < 0.02 * plain, "{edited} after edits, {plain} without");
}

both!(
    edits_take_effect_at_the_start_of_the_next_step,
    checkpoints_before_and_after_edits_go_on_bit_for_bit,
    an_evaluation_after_an_edit_does_not_advance_springs,
);
