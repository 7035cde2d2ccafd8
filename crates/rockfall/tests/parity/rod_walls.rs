//! Rods whose axes touch edges of polygons and smooth walls (docs/physics section 2.19): random rods at random walls, in groups of
//! their own.

use glam::{Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::layout::ENTRY_OVERLAPS;
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run};
use rockfall::{BroadPhase, Integrator, Polygon, Rod, Scene, Sphere};

use crate::assert_scenario_matches;
use crate::decisions::{Findings, entries};
use crate::trace::{Scenario, Trace, with_step_settings};

/// Number of groups.
const GROUPS: u16 = 120;

fn vector(random: &mut Pcg64Mcg, most: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-most..most)))
}

/// Walls that stand out at the origin, before they are turned: what they are depends on the group.
fn walls(random: &mut Pcg64Mcg, group: u16) -> Vec<Polygon> {
    let down = random.random_range(0.05..1.0);
    let [one, two] = [Vec3::new(0.1, 0.0, -1.0), Vec3::new(-0.1, 0.0, 1.3)];
    match group % 8 {
        // A ridge, a flat pair and a groove.
        0..3 => {
            let bend = [-down, 0.0, down][usize::from(group % 8)];
            let feet = [Vec3::new(-1.4, bend, 0.1), Vec3::new(1.5, bend, -0.2)];
            vec![Polygon::triangle(one, two, feet[0]), Polygon::triangle(two, one, feet[1])]
        }
        3 => {
            let foot = [[-1.0, -1.0], [1.0, -0.8], [1.1, 1.0], [-0.9, 1.2]].map(|[x, z]| Vec3::new(x, -down, z));
            (0..4).map(|k| Polygon::triangle(Vec3::ZERO, foot[k], foot[(k + 1) % 4])).collect()
        }
        4 => vec![Polygon::new(one, Vec3::new(-1.4, -0.3 * down, 0.1), two - one)],
        // Two parallelograms that share an edge.
        5 => vec![
            Polygon::new(one, Vec3::new(-1.4, -down, 0.1), two - one),
            Polygon::new(one, two - one, Vec3::new(1.5, -down, 0.2)),
        ],
        6 => vec![Polygon::ball([0.0, -down, 0.0], down)],
        _ => {
            let radii = [0.6, random.random_range(0.2..0.6)];
            vec![Polygon::cone([0.0, -0.5 * (radii[0] + radii[1]), -0.7], [0.0, 0.0, 1.0], radii, 1.4)]
        }
    }
}

fn scene(seed: u64) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    scene.settings.gravity = 3.0;
    for group in 0..GROUPS {
        let turn = Quat::from_scaled_axis(vector(&mut random, 0.5));
        for mut wall in walls(&mut random, group) {
            (wall.corner, wall.left, wall.right) = (turn * wall.corner, turn * wall.left, turn * wall.right);
            scene.add_polygon(wall.group(group)).unwrap();
        }
        let radius = random.random_range(0.15..0.25);
        let middle = vector(&mut random, 0.1) * Vec3::new(1.0, 0.0, 1.0) + random.random_range(0.75..0.95) * radius * Vec3::Y;
        let half = Vec3::new(random.random_range(0.4..0.7), random.random_range(-0.05..0.05), random.random_range(-0.3..0.3));
        let speed = if group % 16 < 8 { 1.5 } else { 0.05 };
        let ends = [-1.0, 1.0].map(|side| {
            let end = Sphere::new(turn * (middle + side * half), radius).mass(1.5).velocity(vector(&mut random, speed));
            scene.add_sphere(end.angular_momentum(vector(&mut random, 0.05)).group(group)).unwrap()
        });
        let rod = Rod::new(ends[0], ends[1], radius).group(group);
        scene.add_rod(if group % 3 == 0 { rod } else { rod.length(2.0 * half.length()) }).unwrap();
    }
    scene
}

/// Scenarios of the stages that find and evaluate contacts.
pub(crate) fn trace(seed: u64, integrator: Integrator) -> Trace {
    let mut world = World::build(&scene(seed)).unwrap();
    world.set_integrator(integrator);
    let mut world = with_step_settings(world);
    world.set_pair_rows(world.movers() * 16);
    world.status.lengths_due = 0;
    let concerned = ["count_pairs", "find_collisions", "commit_collisions", "rod_loads", "loads", "apply_friction_impulses"];
    let runs = Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::BruteForce));
    let runs: Vec<Run> = runs.filter(|run| run.applies(&world.step)).copied().collect();
    let mut scenarios = Vec::new();
    for run in runs {
        if concerned.contains(&run.stage.name) && run.pass == 0 {
            scenarios.push(Scenario { runs: vec![run], before: world.clone() });
        }
        run.on_cpu(&mut world);
    }
    assert_eq!(world.status.rejected, 0);
    Trace { scenarios, findings: Findings::default(), after: world }
}

#[test]
fn backends_agree_on_rods_over_walls() {
    for (seed, integrator) in [(1, Integrator::Rk4), (2, Integrator::SymplecticEuler)] {
        let trace = trace(seed, integrator);
        trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(seed, scenario));
        let after = &trace.after;
        let movers = after.step.layout.spheres..after.movers();
        let touching = entries(after)
            .into_iter()
            .filter(|entry| movers.contains(&(entry.mover as u32)) && entry.word & ENTRY_OVERLAPS != 0);
        let touching = touching.count();
        assert!(touching > usize::from(GROUPS) / 3, "{touching} rods touch walls");
    }
}
