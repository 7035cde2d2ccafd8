//! Rigid bodies (docs/physics sections 1.5, 4.16 and 5.9): random clumps that touch floors, balls and each other, in groups of their own.

use glam::{DVec3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::layout::{AFTER_DRIFT, AFTER_EULER, AFTER_KICK};
use rockfall::model::world::World;
use rockfall::step::schedule::{PLACE, Phase, Run};
use rockfall::{
    BroadPhase, ContactLaw, Cuboid, Integrator, Material, MaterialId, Pair, Placement, Scene, Shape, Sphere, Tether,
};

use crate::assert_scenario_matches;
use crate::decisions::Findings;
use crate::trace::{Scenario, Trace, with_step_settings};

fn vector(random: &mut Pcg64Mcg, most: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-most..most)))
}

/// What the bodies of a scene are made of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parts {
    Balls,
    Rods,
}

/// A shape of two to four balls, or of a capsule and balls, with three different moments of inertia.
fn shape(random: &mut Pcg64Mcg, material: MaterialId, group: u16, parts: Parts) -> Shape {
    let mut shape = Shape::new().material(material).group(group).density(random.random_range(800.0..1200.0));
    if parts == Parts::Rods {
        shape = shape.capsule(vector(random, 0.1) - 0.25 * Vec3::X, vector(random, 0.1) + 0.25 * Vec3::X, 0.13);
    }
    for place in 0..random.random_range(2..5_u8) {
        let along = 0.12 * (f32::from(place) - 1.0);
        shape = shape.sphere(Vec3::new(along, 0.05, 0.0) + vector(random, 0.08), random.random_range(0.1..0.16));
    }
    shape
}

/// Every group has a floor, a body that overlaps it a little, a ball beside the body, and in every third group a second body.
fn scene(seed: u64, law: ContactLaw, parts: Parts) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    (scene.settings.gravity, scene.settings.collisions, scene.settings.linear_damping) = (3.0, false, 0.2);
    scene.settings.angular_damping = 0.1;
    scene.settings.set("contact_law", &law.to_string()).unwrap();
    let material = scene.add_material(Material::new("stuff").density(1000.0).young(1e5).poisson(0.3)).unwrap();
    scene
        .set_pair(
            material,
            material,
            Pair::default().restitution(0.6).friction(0.4).rolling_friction(0.1).characteristic_velocity(1.0),
        )
        .unwrap();
    for group in 0..40_u16 {
        let shape = scene.add_shape(shape(&mut random, material, group, parts)).unwrap();
        let mut place = |above: f32| {
            let at = (Vec3::new(0.0, above, 0.0) + vector(&mut random, 0.05)).as_dvec3();
            let turn = Quat::from_scaled_axis(vector(&mut random, 2.0));
            let placed = Placement::new(shape).at(at).turned(turn);
            placed.velocity(vector(&mut random, 0.5)).spin(vector(&mut random, 3.0))
        };
        scene.add_body(place(0.2)).unwrap();
        if group.is_multiple_of(3) {
            scene.add_body(place(0.5)).unwrap();
        }
        let side = 0.3 * (Quat::from_rotation_y(f32::from(group)) * Vec3::X) + Vec3::new(0.0, 0.2, 0.0);
        let ball = Sphere::new(side, 0.12).density(1000.0).velocity(vector(&mut random, 0.5)).material(material).group(group);
        scene.add_sphere(ball).unwrap();
        let floor = Cuboid::between([-2.0, -1.0, -2.0], [2.0, 0.1, 2.0]).material(material).group(group);
        scene.add_box(floor).unwrap();
    }
    assert!(scene.bodies().iter().all(|body| DVec3::from_array(body.centre()).is_finite()));
    scene
}

/// Scenarios of the stages that move bodies, and in which they touch.
pub(crate) fn trace(seed: u64, integrator: Integrator, law: ContactLaw, parts: Parts) -> Trace {
    let mut world = World::build_in_space(&scene(seed, law, parts)).unwrap();
    world.set_integrator(integrator);
    let mut world = with_step_settings(world);
    world.set_pair_rows(world.movers() * 4);
    world.step.constants.dt = 0.001;
    world.step.lists.margin_scale = 40.0;
    world.status.lengths_due = 0;
    let concerned = [
        "update_aabbs",
        "count_pairs",
        "fill_pairs",
        "move_bodies",
        "rod_loads",
        "loads",
        "advance",
        "finish",
        "symplectic_euler",
        "drift",
        "kick",
        "turn",
    ];
    let runs = Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::BruteForce));
    let runs: Vec<Run> = PLACE.iter().chain(runs).filter(|run| run.applies(&world.step)).copied().collect();
    let mut scenarios = Vec::new();
    for run in runs {
        if concerned.contains(&run.stage.name) {
            scenarios.push(Scenario { runs: vec![run], before: world.clone() });
        }
        run.on_cpu(&mut world);
    }
    assert_eq!(world.status.rejected, 0);
    Trace { scenarios, findings: Findings::default(), after: world }
}

/// The stage `synchronise` with symplectic Euler, in a scene in which tethers pull some of the bodies.
pub(crate) fn trace_of_accelerations(seed: u64) -> Trace {
    let mut scene = scene(seed, ContactLaw::Linear, Parts::Rods);
    for body in scene.bodies().to_vec().iter().step_by(3) {
        let [one, .., last] = *body.spheres() else { continue };
        for (sphere, stiffness) in [(one, 20.0), (last, 45.0)] {
            scene.add_tether(Tether::new(sphere, [0.1, 0.2, 0.0], stiffness).length(0.1)).unwrap();
        }
    }
    let mut world = World::build(&scene).unwrap();
    world.set_integrator(Integrator::SymplecticEuler);
    let mut after = with_step_settings(world);
    let before = after.clone();
    let stages = Phase::HandleCollisions.stages(Integrator::SymplecticEuler, BroadPhase::BruteForce);
    let run = *stages.iter().find(|run| run.stage.name == "synchronise").expect("a stage");
    run.on_cpu(&mut after);
    Trace { scenarios: vec![Scenario { runs: vec![run], before }], findings: Findings::default(), after }
}

#[test]
fn backends_agree_on_accelerations_of_bodies() {
    let trace = trace_of_accelerations(13);
    let [scenario] = &trace.scenarios[..] else { panic!("one scenario") };
    assert!(scenario.before.step.layout.free_at != 0 && scenario.before.states[0] != trace.after.states[0]);
    assert_scenario_matches(13, scenario);
}

fn check(seed: u64, integrator: Integrator, law: ContactLaw, parts: Parts, passes: &[u32]) {
    let trace = trace(seed, integrator, law, parts);
    let moved = trace.scenarios.iter().filter(|scenario| scenario.is("move_bodies"));
    assert_eq!(moved.map(|scenario| scenario.runs[0].pass).filter(|pass| *pass < 7).collect::<Vec<_>>(), passes);
    assert!(trace.after.status.last_contacts > 60, "{} contacts", trace.after.status.last_contacts);
    trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(seed, scenario));
}

#[test]
fn backends_agree_on_bodies_with_symplectic_euler() {
    check(2, Integrator::SymplecticEuler, ContactLaw::Linear, Parts::Balls, &[AFTER_EULER]);
}

#[test]
fn backends_agree_on_bodies_with_velocity_verlet() {
    check(3, Integrator::VelocityVerlet, ContactLaw::HertzMindlin, Parts::Rods, &[AFTER_DRIFT, AFTER_KICK]);
}
