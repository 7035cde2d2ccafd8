//! Walls that move, conveyors and triangles (docs/physics sections 2.7 and 2.12): random bodies at random walls, in groups of their own,
//! with poses that no motion has to give.

use glam::{Mat3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::layout::POSE_FLOATS;
use rockfall::model::status::REBUILD_REQUESTED;
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run};
use rockfall::{BroadPhase, Cuboid, Integrator, Motion, MotionId, MotionTerm, Polygon, Precision, Rod, Scene, Sphere};

use crate::assert_scenario_matches;
use crate::decisions::Findings;
use crate::trace::{Scenario, Trace, with_step_settings};

/// Number of motions.
pub(crate) const BODIES: usize = 3;
/// Number of rows of the table of poses: the start, the middle and the end of a step.
pub(crate) const ROWS: u32 = 3;

fn vector(random: &mut Pcg64Mcg, most: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-most..most)))
}

/// A wall near the origin: a box, a polygon or a triangle, whose nearest side faces up.
fn add_wall(scene: &mut Scene, random: &mut Pcg64Mcg, group: u16, motion: Option<MotionId>) {
    let surface = if group.is_multiple_of(4) { vector(random, 2.0) } else { Vec3::ZERO };
    let turn = Quat::from_scaled_axis(vector(random, 0.4));
    let [x, z] = [turn * Vec3::X, turn * Vec3::Z].map(|edge| random.random_range(0.8..1.6) * edge);
    let corner = vector(random, 0.1) - 0.45 * (x + z);
    if group.is_multiple_of(3) {
        let down = -random.random_range(0.3..0.8) * (turn * Vec3::Y);
        let mut cuboid = Cuboid::new(corner, x, down, z).group(group).surface_velocity(surface);
        cuboid.motion = motion;
        scene.add_box(cuboid).unwrap();
    } else {
        let up = turn * Vec3::Y;
        let radius = random.random_range(0.8..1.2);
        let polygon = match group % 8 {
            1 | 2 => Polygon::triangle(corner, corner + z, corner + x),
            4 => Polygon::plane(corner, if motion.is_none() { Vec3::Y } else { up }),
            5 => Polygon::ball(corner + radius * up, radius).inside(true),
            7 => Polygon::cone(0.1 * up - radius * up - 0.5 * x, x, [radius, 0.8 * radius], x.length()),
            3 => Polygon::cylinder(radius * up - 0.5 * x, x, radius, x.length()).inside(true),
            _ => Polygon::new(corner, z, x),
        };
        let mut polygon = polygon.group(group).surface_velocity(surface);
        polygon.motion = motion;
        scene.add_polygon(polygon).unwrap();
    }
}

/// Period along each axis, of traces with periodic boundaries.
const PERIOD: f32 = 3.0;

/// Makes a scene periodic, with faces of the box near the walls. Every ball without a rod gets a second one, which is some periods
/// away and touches the image of the first one.
fn with_periods(mut scene: Scene, random: &mut Pcg64Mcg) -> Scene {
    scene.settings.precision = Precision::Double;
    (0..3).for_each(|axis| scene.set_periodic(axis, Some([-0.1, PERIOD - 0.1])).unwrap());
    let mut way = || PERIOD * Vec3::from_array(std::array::from_fn(|_| random.random_range(-2_i8..3).into()));
    let is_end = |id| scene.rods().iter().any(|rod| [rod.end1, rod.end2].contains(&id));
    let single: Vec<_> = scene.sphere_ids().filter(|id| !is_end(*id)).collect();
    for id in single {
        let mut ball = *scene.sphere(id).unwrap();
        ball.position += 1.7 * ball.radius * Vec3::Y + way();
        scene.add_sphere(ball).unwrap();
    }
    scene
}

fn scene(seed: u64, rods: bool, coulomb: f32) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    (scene.settings.gravity, scene.settings.coulomb_friction) = (3.0, coulomb);
    let motions = [0, 1, 2].map(|number| {
        let term = MotionTerm::translation([0.0, 0.0, f64::from(number)]);
        scene.add_motion(Motion::new(format!("body{number}"), term)).unwrap()
    });
    for group in 0..120_u16 {
        let motion = (group % 5 < 4).then(|| motions[usize::from(group) % BODIES]);
        for _ in 0..random.random_range(1..3) {
            add_wall(&mut scene, &mut random, group, motion);
        }
        let radius = random.random_range(0.15..0.3);
        let place = vector(&mut random, 0.25) * Vec3::new(1.0, 0.0, 1.0) + random.random_range(0.3..0.9) * radius * Vec3::Y;
        // A pair that separates fast has no force.
        let speed = if group.is_multiple_of(2) { 1.5 } else { 0.05 };
        let ball = Sphere::new(place, radius).mass(1.5).velocity(vector(&mut random, speed)).group(group);
        let ball = ball.angular_momentum(vector(&mut random, 0.05));
        let ball = scene.add_sphere(ball).unwrap();
        if rods && group % 6 == 1 {
            let other =
                Sphere::new(place + Vec3::new(0.9, 0.1, 0.2), 0.8 * radius).velocity(vector(&mut random, 1.0)).group(group);
            let other = scene.add_sphere(other).unwrap();
            scene.add_rod(Rod::new(ball, other, 0.7 * radius).group(group)).unwrap();
        }
    }
    scene
}

/// A table of poses: small turns and displacements, and velocities and accelerations of any direction.
pub(crate) fn poses(seed: u64) -> Vec<f32> {
    let mut random = Pcg64Mcg::seed_from_u64(seed ^ 0x5ea);
    let mut table = Vec::new();
    for _ in 0..ROWS as usize * BODIES {
        let turn = Mat3::from_quat(Quat::from_scaled_axis(vector(&mut random, 0.03))) - Mat3::IDENTITY;
        let rows = [0, 1, 2].map(|row| turn.row(row));
        let [point, shift, velocity] = [0.3, 0.02, 0.2].map(|most| vector(&mut random, most));
        let [acceleration, spin] = [20.0, 0.4].map(|most| vector(&mut random, most));
        for vector in rows.into_iter().chain([point, shift, velocity, acceleration, spin]) {
            table.extend(vector.extend(0.0).to_array());
        }
    }
    assert_eq!(table.len(), ROWS as usize * BODIES * POSE_FLOATS as usize);
    table
}

/// Scenarios of the stages in which walls move or count.
pub(crate) fn trace(seed: u64, integrator: Integrator, rods: bool, periodic: bool) -> Trace {
    let coulomb = if integrator == Integrator::SymplecticEuler { 0.3 } else { 0.0 };
    let scene = scene(seed, rods, coulomb);
    let scene = if periodic { with_periods(scene, &mut Pcg64Mcg::seed_from_u64(seed)) } else { scene };
    let mut world = World::build(&scene).unwrap();
    world.set_integrator(integrator);
    let mut world = with_step_settings(world);
    world.set_pair_rows(world.movers() * 4);
    world.poses = poses(seed);
    (world.step.constants.pose_rows, world.step.constants.pose_step) = (ROWS, world.status.steps);
    // So large that no wall leaves it within the step.
    world.step.lists.margin_scale = 40.0;
    world.status.lengths_due = 0;
    let concerned =
        ["move_walls", "update_aabbs", "count_pairs", "find_collisions", "rod_loads", "loads", "apply_friction_impulses"];
    let runs = Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::BruteForce));
    let runs: Vec<Run> = runs.filter(|run| run.applies(&world.step)).copied().collect();
    let mut scenarios = Vec::new();
    for run in runs {
        if concerned.contains(&run.stage.name) {
            scenarios.push(Scenario { runs: vec![run], before: world.clone() });
        }
        run.on_cpu(&mut world);
        if run.stage.name == "move_walls" {
            // Bounding boxes are those of the poses at the start, which have nothing to do with the others.
            world.status.rejected = 0;
            world.status.rebuild |= REBUILD_REQUESTED;
        }
    }
    Trace { scenarios, findings: Findings::default(), after: world }
}

/// Number of spheres on which a force acts after a scenario of `loads`.
fn forces(scenario: &Scenario) -> usize {
    let mut world = scenario.before.clone();
    scenario.runs.iter().for_each(|run| run.on_cpu(&mut world));
    let rods = 4 * world.step.layout.rods as usize;
    world.wrenches[rods..].iter().step_by(2).filter(|force| force.truncate().length() > 0.0).count()
}

/// Compares the stages of a trace, and returns how many forces act in each evaluation, on average.
fn check(seed: u64, integrator: Integrator, rods: bool, periodic: bool) -> usize {
    let trace = trace(seed, integrator, rods, periodic);
    trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(seed, scenario));
    let count = |name: &str| trace.scenarios.iter().filter(|scenario| scenario.is(name)).count();
    let passes = if integrator == Integrator::Rk4 { 2 } else { 1 };
    assert!(count("move_walls") >= passes && count("loads") >= passes, "{integrator}");
    let loads = trace.scenarios.iter().filter(|scenario| scenario.is("loads"));
    loads.map(forces).sum::<usize>() / count("loads")
}

#[test]
fn backends_agree_on_moving_walls() {
    assert!(check(1, Integrator::Rk4, false, false) > 10);
    assert!(check(2, Integrator::SymplecticEuler, true, false) > 10);
}

#[test]
fn backends_agree_on_periodic_boundaries() {
    assert!(check(3, Integrator::Rk4, false, true) > 40);
    assert!(check(4, Integrator::SymplecticEuler, true, true) > 40);
}
