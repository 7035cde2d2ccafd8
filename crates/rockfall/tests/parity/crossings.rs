//! Contacts that begin and end within a step (docs/physics section 3.10): random pairs after a long step, in groups of their own.

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::layout::{ENTRY_COLLIDES, ENTRY_OVERLAPS};
use rockfall::model::status::REBUILD_REQUESTED;
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run};
use rockfall::{BroadPhase, Cuboid, Integrator, Polygon, Rod, Scene, Sphere, Tether};

use crate::assert_scenario_matches;
use crate::decisions::{Findings, entries};
use crate::trace::{Scenario, Trace, with_step_settings};

/// Time step of the step that led to the state, in s.
const LONG: f32 = 0.05;

fn vector(random: &mut Pcg64Mcg, most: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-most..most)))
}

/// Spheres that have met or missed another object, or several, within the step. Some are tethered, some meet a fixed sphere whose
/// surface moves.
fn scene(seed: u64, rods: bool) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    (scene.settings.continuous_collisions, scene.settings.gravity) = (true, 3.0);
    // So large that contacts in which bodies pass each other have an approach velocity below it for a while.
    scene.settings.activation_threshold = 12.0;
    for group in 0..240_u16 {
        let velocity = vector(&mut random, 30.0);
        // On the way back from here, the sphere was near the origin within the step.
        let place = 0.6 * LONG * velocity + vector(&mut random, 0.4);
        let ball = Sphere::new(place, random.random_range(0.1..0.4)).mass(1.5).velocity(velocity).group(group);
        let ball = scene.add_sphere(ball).unwrap();
        if group % 7 == 0 {
            scene.add_tether(Tether::new(ball, vector(&mut random, 1.0), 4.0).length(0.5)).unwrap();
        }
        for _ in 0..random.random_range(1..3) {
            let (corner, other) = (vector(&mut random, 0.5), vector(&mut random, 6.0));
            match group % 4 {
                0 => drop(scene.add_sphere(Sphere::new(corner, 0.3).velocity(other).group(group)).unwrap()),
                1 => {
                    let fixed = Sphere::new(corner, 0.3).fixed().velocity(other).group(group);
                    scene.add_sphere(fixed).unwrap();
                }
                2 => {
                    let size = Vec3::new(0.3, 0.02, 0.4);
                    scene.add_box(Cuboid::between(corner - size, corner + size).group(group)).unwrap();
                }
                _ => {
                    let [left, right] = [Vec3::new(0.9, 0.1, 0.2), Vec3::new(0.1, 0.2, 0.9)];
                    let sides = if random.random_bool(0.5) { [left, right] } else { [right, left] };
                    scene.add_polygon(Polygon::new(corner - 0.4, sides[0], sides[1]).group(group)).unwrap();
                    // Its neighbour continues it, or bends away from it.
                    let bend = if group % 8 == 3 { Vec3::ZERO } else { Vec3::new(0.0, 0.2, -0.1) };
                    let neighbour = Polygon::new(corner - 0.4 + sides[0], sides[0] + bend, sides[1]);
                    scene.add_polygon(neighbour.group(group)).unwrap();
                }
            }
        }
    }
    if rods {
        let ends = [-0.3, 0.3].map(|x| scene.add_sphere(Sphere::new([x, 0.8, 0.0], 0.2).velocity([9.0, 0.0, 0.0])).unwrap());
        scene.add_rod(Rod::new(ends[0], ends[1], 0.1).length(0.6)).unwrap();
    }
    scene
}

fn world_after_step(seed: u64, rods: bool) -> World {
    let mut world = with_step_settings(World::build(&scene(seed, rods)).unwrap());
    world.step.constants.dt = LONG;
    world.set_pair_rows(world.movers() * 4);
    world.status.lengths_due = 0;
    world
}

/// Scenarios of the stages that deal with crossings, and of the first forces of RK4.
pub(crate) fn trace(seed: u64, rods: bool) -> Trace {
    let mut world = world_after_step(seed, rods);
    let mut scenarios = Vec::new();
    let concerned = ["update_aabbs", "find_crossings", "find_collisions", "commit_collisions", "loads"];
    let runs = Phase::STEP.iter().flat_map(|phase| phase.stages(Integrator::Rk4, BroadPhase::BruteForce));
    let runs: Vec<Run> = runs.filter(|run| run.applies(&world.step)).copied().collect();
    for run in runs.iter().copied() {
        if run.stage.name == "find_crossings" {
            // Contacts that have just begun exert no force. After the collisions few of them are left.
            let loads = runs.iter().find(|run| run.stage.name == "loads").expect("the stage");
            scenarios.push(Scenario { runs: vec![*loads], before: world.clone() });
        }
        if run.stage.name == "loads" {
            // Collisions have moved the spheres.
            world.status.rebuild = REBUILD_REQUESTED;
            runs.iter().filter(|run| run.stage.name == "update_aabbs").for_each(|run| run.on_cpu(&mut world));
        }
        if concerned.contains(&run.stage.name) && run.pass == 0 {
            scenarios.push(Scenario { runs: vec![run], before: world.clone() });
        }
        if run.stage.name == "loads" {
            break;
        }
        run.on_cpu(&mut world);
    }
    assert_eq!(world.status.rejected, 0);
    Trace { scenarios, findings: Findings::default(), after: world }
}

/// The world after a stage, on the CPU.
fn after(trace: &Trace, stage: &str) -> World {
    let Scenario { runs, before } = trace.scenarios.iter().find(|scenario| scenario.is(stage)).expect("the stage");
    let mut after = before.clone();
    runs[0].on_cpu(&mut after);
    after
}

#[test]
fn backends_agree_on_crossings() {
    for (seed, rods) in [(1, false), (2, true)] {
        let trace = trace(seed, rods);
        trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(seed, scenario));
        let found = after(&trace, "find_crossings");
        let n = found.step.layout.spheres as usize;
        let (low, high) = (&found.states[2][..n], &found.states[2][2 * n..]);
        let count = |range: std::ops::Range<u32>| {
            let others = low.iter().zip(high).filter(|(low, _)| low.w >= 0.0);
            others.filter(|(low, high)| range.contains(&(low.w as u32 | (high.w as u32 % 65536) << 16))).count()
        };
        let (spheres, boxes) = (found.step.layout.spheres, found.step.layout.spheres + found.step.layout.rods);
        let kinds = [0..spheres, boxes..boxes + found.step.layout.boxes, boxes + found.step.layout.boxes..u32::MAX].map(count);
        assert!(kinds.iter().all(|kind| *kind >= 8), "crossings of spheres, boxes and polygons: {kinds:?}");
        let [before, committed] = ["commit_collisions", "loads"].map(|stage| {
            let scenario = trace.scenarios.iter().rfind(|scenario| scenario.is(stage)).expect("the stage");
            scenario.before.states[0].clone()
        });
        assert!(before.iter().zip(&committed).filter(|(before, after)| before != after).count() > 60);
    }
}

/// Contacts of a sphere do not collide while a crossing of it is handled.
#[test]
fn crossings_put_off_other_collisions() {
    let trace = trace(1, false);
    let put_off = entries(&after(&trace, "find_collisions"));
    let mut without = trace.scenarios.iter().find(|scenario| scenario.is("find_collisions")).expect("the stage").before.clone();
    let n = without.step.layout.spheres as usize;
    without.states[2][..n].iter_mut().for_each(|row| row.w = -1.0);
    let run = trace.scenarios.iter().find(|scenario| scenario.is("find_collisions")).expect("the stage").runs[0];
    run.on_cpu(&mut without);
    let all = entries(&without);
    let both = ENTRY_OVERLAPS | ENTRY_COLLIDES;
    let changed =
        put_off.iter().zip(&all).filter(|(now, alone)| now.word & both == ENTRY_OVERLAPS && alone.word & both == both);
    assert!(changed.count() >= 2, "no collision is put off");
}
