//! Rigid bodies (docs/physics sections 1.5, 4.16 and 5.9): random clumps that touch floors, balls and each other, in groups of their own.

use glam::{DVec3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::layout::{AFTER_DRIFT, AFTER_EULER, AFTER_KICK, RIGID_ROWS};
use rockfall::model::world::World;
use rockfall::step::schedule::{PLACE, Phase, Run};
use rockfall::{
    BroadPhase, ContactLaw, Cuboid, Integrator, Material, MaterialId, Pair, Placement, Scene, Shape, Sphere, Tether,
};

use crate::assert_scenario_matches;
use crate::decisions::{Findings, entries};
use crate::trace::{Scenario, Trace, grouped, with_step_settings};

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
        "apply_friction_impulses",
        "commit_friction_impulses",
        "push_bodies",
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

/// Every group has a body that falls on a floor, or on a ball below its lowest sphere or beside its first two. Most have one contact.
fn falling(seed: u64, parts: Parts) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    scene.settings.set("contact_law", "linear").unwrap();
    scene.settings.collisions = true;
    (scene.settings.gravity, scene.settings.activation_threshold, scene.settings.collision_friction) = (3.0, 0.1, 0.3);
    let material = scene.add_material(Material::new("stuff").density(1000.0)).unwrap();
    scene.set_pair(material, material, Pair::default().stiffness(1e3)).unwrap();
    for group in 0..40_u16 {
        let shape = scene.add_shape(shape(&mut random, material, group, parts)).unwrap();
        let turn = Quat::from_scaled_axis(vector(&mut random, 2.0));
        let velocity = vector(&mut random, 0.3) - Vec3::Y;
        let placed = Placement::new(shape).turned(turn).velocity(velocity).spin(vector(&mut random, 3.0));
        let body = scene.add_body(placed).unwrap();
        let members = scene.body(body).unwrap().spheres();
        let spheres: Vec<Sphere> = members.iter().map(|id| *scene.sphere(*id).unwrap()).collect();
        let bottom = |sphere: &Sphere| sphere.position.y - sphere.radius;
        let lowest = spheres.iter().min_by(|one, other| bottom(one).total_cmp(&bottom(other))).unwrap();
        let beside = (spheres[1].position - spheres[0].position).any_orthonormal_vector();
        let middle = 0.5 * (spheres[0].position + spheres[1].position);
        let [below, at_rod] = [lowest.position - (lowest.radius + 0.11) * Vec3::Y, middle - 0.24 * beside];
        let ball =
            |at: Vec3, velocity: Vec3| Sphere::new(at, 0.12).density(1000.0).velocity(velocity).material(material).group(group);
        match group % 4 {
            0 => drop(scene.add_sphere(ball(below, 0.5 * Vec3::Y)).unwrap()),
            1 => drop(scene.add_sphere(ball(at_rod, velocity + 1.5 * beside)).unwrap()),
            _ => {
                let top = bottom(lowest) + 0.01;
                let floor = Cuboid::between([-2.0, -1.5, -2.0], [2.0, top, 2.0]).material(material).group(group);
                scene.add_box(floor).unwrap();
            }
        }
    }
    scene
}

/// Plates of 25 balls that fall on floors. Each plate has more collisions than a record has neighbours, so that impulses are gathered.
pub(crate) fn trace_of_gathered(seed: u64) -> Trace {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    scene.settings.set("contact_law", "linear").unwrap();
    scene.settings.collisions = true;
    (scene.settings.gravity, scene.settings.activation_threshold) = (3.0, 0.1);
    let material = scene.add_material(Material::new("stuff").density(1000.0)).unwrap();
    scene.set_pair(material, material, Pair::default().stiffness(1e3)).unwrap();
    for group in 0..4_u16 {
        let mut shape = Shape::new().material(material).group(group).density(1000.0);
        for place in 0..25_u8 {
            let at = 0.25 * Vec3::new(f32::from(place / 5) - 2.0, 0.0, f32::from(place % 5) - 2.0);
            shape = shape.sphere(at + vector(&mut random, 0.002), 0.1);
        }
        let shape = scene.add_shape(shape).unwrap();
        let placed = Placement::new(shape).at(DVec3::new(0.0, 0.09, 0.0)).velocity(vector(&mut random, 0.2) - 2.0 * Vec3::Y);
        scene.add_body(placed.spin(vector(&mut random, 1.0))).unwrap();
        scene.add_box(Cuboid::between([-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]).material(material).group(group)).unwrap();
    }
    traced(&scene, Integrator::VelocityVerlet, 16)
}

/// The collision phase of a scene in which bodies collide, some of them held by tethers.
pub(crate) fn trace_of_collisions(seed: u64, integrator: Integrator, parts: Parts) -> Trace {
    let mut scene = falling(seed, parts);
    for body in scene.bodies().to_vec().iter().step_by(3) {
        let [one, .., last] = *body.spheres() else { continue };
        for (sphere, stiffness) in [(one, 20.0), (last, 45.0)] {
            scene.add_tether(Tether::new(sphere, [0.1, 0.2, 0.0], stiffness).length(0.1)).unwrap();
        }
    }
    traced(&scene, integrator, 4)
}

/// The collision phase of a scene, with a number of rows of pairs per mover.
fn traced(scene: &Scene, integrator: Integrator, rows: u32) -> Trace {
    let mut world = World::build(scene).unwrap();
    world.set_integrator(integrator);
    let mut world = with_step_settings(world);
    world.set_pair_rows(world.movers() * rows);
    world.step.constants.dt = 0.02;
    world.status.lengths_due = 0;
    let runs = Phase::STEP[..3].iter().flat_map(|phase| phase.stages(integrator, BroadPhase::BruteForce));
    let runs: Vec<Run> = PLACE.iter().chain(runs).filter(|run| run.applies(&world.step)).copied().collect();
    let mut scenarios = Vec::new();
    for group in grouped(&runs) {
        if ["synchronise", "find_collisions"].contains(&group[0].stage.name) {
            scenarios.push(Scenario { runs: group.clone(), before: world.clone() });
        }
        group.iter().for_each(|run| run.on_cpu(&mut world));
    }
    assert_eq!(world.status.rejected, 0);
    Trace { scenarios, findings: Findings::default(), after: world }
}

fn check_collisions(seed: u64, integrator: Integrator, parts: Parts) {
    let trace = trace_of_collisions(seed, integrator, parts);
    let [.., last] = &trace.scenarios[..] else { panic!("no scenario") };
    let turned =
        (0..trace.after.rigid_bodies.len()).filter(|row| trace.after.rigid_bodies[*row] != last.before.rigid_bodies[*row]);
    let [moved, pushed, turned] = turned.fold([0; 3], |[moved, pushed, turned], row| match row % RIGID_ROWS as usize {
        0 => [moved + 1, pushed, turned],
        3 => [moved, pushed + 1, turned],
        4 => [moved, pushed, turned + 1],
        _ => [moved, pushed, turned],
    });
    let is_enough = moved >= 6 && turned >= 6 && pushed >= moved + 4;
    assert!(is_enough, "{moved} are moved, {turned} turned, {pushed} pushed");
    trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(seed, scenario));
}

#[test]
fn backends_agree_on_collisions_of_balls_in_bodies() {
    check_collisions(6, Integrator::VelocityVerlet, Parts::Balls);
}

#[test]
fn backends_agree_on_collisions_of_rods_in_bodies() {
    check_collisions(13, Integrator::SymplecticEuler, Parts::Rods);
}

#[test]
fn backends_agree_on_impulses_that_bodies_gather() {
    let trace = trace_of_gathered(8);
    let [.., last] = &trace.scenarios[..] else { panic!("no scenario") };
    let colliding = entries(&last.before).len();
    assert!(colliding >= 4 * 20, "{colliding} entries");
    trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(8, scenario));
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
