//! Spheres whose centre passes a polygon within a step (docs/physics section 2.20): random ways near random polygons, in groups of
//! their own.

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::layout::POSE_FLOATS;
use rockfall::model::status::{NO_BODY, REBUILD_REQUESTED};
use rockfall::model::world::World;
use rockfall::step::schedule::{PLACE, Phase, Run};
use rockfall::{BroadPhase, Capsule, Integrator, Motion, MotionTerm, Polygon, Scene, Sphere};

use crate::assert_scenario_matches;
use crate::decisions::Findings;
use crate::trace::{Scenario, Trace, with_step_settings};
use crate::walls::{BODIES, ROWS, poses};

/// Time step, in s.
const LONG: f32 = 0.05;

fn vector(random: &mut Pcg64Mcg, most: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-most..most)))
}

/// Groups of a polygon and three spheres that are near it in the middle of the step. Some polygons move.
fn scene(seed: u64, rods: bool) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    (scene.settings.gravity, scene.settings.collisions) = (3.0, false);
    let motions: Vec<_> = (0..BODIES)
        .map(|number| {
            scene.add_motion(Motion::new(format!("lift_{number}"), MotionTerm::translation([4.0, 6.0, -3.0]))).unwrap()
        })
        .collect();
    for group in 0..120_u16 {
        let corner = vector(&mut random, 0.3);
        let [one, other] = [vector(&mut random, 1.5), vector(&mut random, 1.5)];
        let wall = match group % 3 {
            0 => Polygon::new(corner, one, other),
            1 => Polygon::triangle(corner, corner + one, corner + other),
            _ => Polygon::plane(corner, one),
        };
        let wall = if group % 4 == 3 { wall.motion(motions[usize::from(group / 4) % BODIES]) } else { wall };
        scene.add_polygon(wall.group(group)).unwrap();
        for _ in 0..3 {
            let velocity = vector(&mut random, 30.0);
            let [along, across] = [random.random_range(-0.2..1.2), random.random_range(-0.2..1.2)];
            let target = corner + along * one + across * other - 0.5 * LONG * velocity;
            let ball = Sphere::new(target, random.random_range(0.1..0.3)).mass(1.5).velocity(velocity).group(group);
            scene.add_sphere(ball).unwrap();
        }
    }
    if rods {
        let capsule = Capsule::new([-0.3, 0.3, 0.0], [0.3, 0.3, 0.0], 0.1).velocity([2.0, -30.0, 1.0]);
        scene.add_capsule(capsule).unwrap();
    }
    scene
}

/// Scenarios of the stages that find passages and count them.
pub(crate) fn trace(seed: u64, integrator: Integrator, rods: bool) -> Trace {
    let mut world = World::build_in_space(&scene(seed, rods)).unwrap();
    world.set_integrator(integrator);
    let mut world = with_step_settings(world);
    world.step.constants.dt = LONG;
    world.step.lists.margin_scale = 1000.0;
    world.set_pair_rows(world.movers() * 4);
    world.status.lengths_due = 0;
    world.poses = poses(seed);
    // The velocities of the poses are so large that they decide what passes a wall.
    for pose in world.poses.chunks_mut(POSE_FLOATS as usize) {
        pose[20..23].iter_mut().for_each(|velocity| *velocity *= 50.0);
    }
    (world.step.constants.pose_rows, world.step.constants.pose_step) = (ROWS, world.status.steps);
    let concerned = ["loads", "find_passages", "end_step"];
    let runs = Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::BruteForce));
    let runs: Vec<Run> = PLACE.iter().chain(runs).filter(|run| run.applies(&world.step)).copied().collect();
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
    assert_eq!((world.status.rejected, world.status.steps), (0, 1));
    Trace { scenarios, findings: Findings::default(), after: world }
}

fn check(seed: u64, integrator: Integrator, rods: bool) {
    let trace = trace(seed, integrator, rods);
    let status = &trace.after.status;
    let spheres = trace.after.step.layout.spheres;
    assert!((40..spheres - 40).contains(&status.total_passages), "{} of {spheres}", status.total_passages);
    assert!(status.first_passing != NO_BODY && status.passage_step == 1, "{status:?}");
    trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(seed, scenario));
}

#[test]
fn backends_agree_on_passages_with_rk4() {
    check(1, Integrator::Rk4, false);
    check(2, Integrator::Rk4, true);
}

#[test]
fn backends_agree_on_passages_with_symplectic_euler() {
    check(3, Integrator::SymplecticEuler, false);
}

#[test]
fn backends_agree_on_passages_with_velocity_verlet() {
    check(4, Integrator::VelocityVerlet, false);
}
