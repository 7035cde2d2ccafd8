//! Low parts of positions and double precision (docs/physics section 5.8), stage by stage on both backends.
//!
//! The scene is thousands of units from the origin, where the low part of a position is as large as 0.0005. A kernel that leaves it out,
//! or that takes it for something else, gives results that differ by much more than the rounding of other numbers.

use std::cell::RefCell;
use std::sync::LazyLock;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::buffer::Buffer;
use rockfall::model::layout::{SLICE, SWEEPS_ON};
use rockfall::model::status::REBUILD_REQUESTED;
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run};
use rockfall::{
    BroadPhase, ContactLaw, Cuboid, Integrator, Material, Pair, Polygon, Precision, Rod, Scene, Sphere, SphereId, Spring,
    Tether,
};

use crate::broken::{Mistake, with_mistake};
use crate::compare::springs;
use crate::device::{GPU, on_gpu};
use crate::keys;
use crate::verdicts::Verdicts;

/// Where the scene is.
const PLACE: [f64; 3] = [4096.3, -5000.7, 8000.1];

/// What a scene has.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Balls with the law of Hertz and Mindlin.
    Balls,
    /// The same with rods of fixed and of free length.
    Rods,
    /// Balls and rods with the law of the thesis and collisions.
    Collisions,
}

/// Balls in layers that overlap a little, on a tilted box, a level box and a tilted polygon, with springs and a tether.
fn scene(kind: Kind, precision: Precision, seed: u64) -> Scene {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    let is_thesis = kind == Kind::Collisions;
    scene.settings.contact_law = if is_thesis { ContactLaw::Thesis } else { ContactLaw::HertzMindlin };
    scene.settings.collisions = is_thesis;
    scene.settings.precision = precision;
    scene.settings.gravity = 10.0;
    let material = scene.add_material(Material::new("m").young(1e4).poisson(0.3).density(1.0)).unwrap();
    let pair = Pair::default().restitution(0.4).friction(0.4).rolling_friction(0.1).twisting_friction(0.2);
    scene.set_pair(material, material, pair).unwrap();
    let at = |x: f64, y: f64, z: f64| [PLACE[0] + x, PLACE[1] + y, PLACE[2] + z];
    let rounded = |place: [f64; 3]| place.map(|coordinate| coordinate as f32);
    let mut ids = Vec::new();
    for k in 0..90_u8 {
        let (x, y, z) = (f64::from(k % 6), f64::from(k / 30), f64::from(k / 6 % 5));
        let mut near = |place: f64| 0.97 * place + rng.random_range(-0.02..0.02);
        let centre = at(near(x), near(y) + 0.48, near(z));
        let mut unit = || rng.random_range(-1.0_f32..1.0);
        let velocity = [unit(), unit(), unit()];
        let sphere = Sphere::new([0.0; 3], 0.5).density(1.0).material(material).centred_at(centre);
        ids.push(scene.add_sphere(sphere.velocity(velocity).angular_momentum(velocity.map(|v| 0.05 * v))).unwrap());
    }
    // The level box is below half of the balls, the tilted box and the polygon touch the others from the side and from below.
    scene.add_box(Cuboid::between(rounded(at(-2.0, -1.0, -2.0)), rounded(at(2.6, 0.0, 7.0))).material(material)).unwrap();
    let tilted = Cuboid::new(rounded(at(2.6, -1.0, -2.0)), [6.0, 0.06, 0.0], [-0.01, 1.0, 0.0], [0.0, 0.0, 9.0]);
    scene.add_box(tilted.material(material)).unwrap();
    let polygon = Polygon::new(rounded(at(-0.46, -1.0, -3.0)), [0.03, 6.0, 0.0], [0.0, 0.02, 9.0]).material(material);
    scene.add_polygon(polygon).unwrap();
    // Rods between neighbours of a row, so that they lie on the balls below them.
    for k in (0..90).step_by(6).filter(|_| kind != Kind::Balls) {
        let is_free = k % 12 == 0;
        for (one, other) in [(k, k + 1), (k + 3, k + 4)] {
            let distance = distance_between(&scene, ids[one], ids[other]);
            let rod = Rod::new(ids[one], ids[other], 0.45).material(material);
            let rod = if is_free { rod } else { rod.length(distance) };
            scene.add_rod(rod).unwrap();
        }
    }
    // Balls on the middles of the rods of the upper layer, which touch nothing else.
    for (x, z) in (0..10_u8).map(|k| (f64::from(k % 2) * 3.0 + 0.5, f64::from(k / 2))).filter(|_| kind != Kind::Balls) {
        let mut near = |place: f64| place + rng.random_range(-0.02..0.02);
        let centre = at(near(0.97 * x), near(3.34), near(0.97 * z));
        scene.add_sphere(Sphere::new([0.0; 3], 0.5).density(1.0).material(material).centred_at(centre)).unwrap();
    }
    for k in 0..10 {
        scene.add_spring(Spring::new(ids[k], ids[k + 61], 30.0, 1.0).damping(0.2)).unwrap();
    }
    scene.add_tether(Tether::new(ids[40], rounded(at(2.0, 4.0, 2.0)), 20.0).length(1.0)).unwrap();
    scene
}

/// Stages that are compared together, and the world before them.
type Stages = (Vec<Run>, World);

/// All stages of two steps. Those of collisions are compared together, because the backends divide the work in other ways.
fn stages(kind: Kind, precision: Precision, integrator: Integrator) -> Vec<Stages> {
    let mut world = World::build(&scene(kind, precision, 5)).unwrap();
    world.set_integrator(integrator);
    world.step.constants.dt = 2e-3;
    world.set_pair_rows(world.movers().div_ceil(SLICE) * 64);
    if kind != Kind::Collisions {
        world.set_history_pool(256);
    }
    world.step.layout.collision_room = 1024;
    world.step.constants.sweeps = SWEEPS_ON;
    let step = world.step;
    let mut all = Vec::new();
    let phases = [Phase::UpdateAabbs, Phase::BroadPhase, Phase::HandleCollisions, Phase::UpdatePositions];
    for _ in 0..2 {
        world.status.rebuild |= REBUILD_REQUESTED;
        for phase in phases.into_iter().filter(|phase| kind == Kind::Collisions || *phase != Phase::HandleCollisions) {
            let runs: Vec<Run> =
                phase.stages(integrator, BroadPhase::BruteForce).iter().filter(|run| run.applies(&step)).copied().collect();
            let size = if phase == Phase::HandleCollisions { runs.len() } else { 1 };
            for group in runs.chunks(size) {
                all.push((group.to_vec(), world.clone()));
                group.iter().for_each(|run| run.on_cpu(&mut world));
                assert_eq!(world.status.rejected, 0, "{}", group[0].stage.name);
            }
        }
    }
    assert!(world.status.last_contacts > 100, "{} contacts", world.status.last_contacts);
    assert!(kind != Kind::Collisions || world.status.total_collisions_low > 10, "collisions");
    all
}

static STAGES: LazyLock<Vec<Stages>> = LazyLock::new(|| {
    let [rk4, euler, verlet] = [Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet];
    let [single, double] = [Precision::Single, Precision::Double];
    let all = [
        (Kind::Balls, double, euler),
        (Kind::Balls, double, verlet),
        (Kind::Rods, double, verlet),
        (Kind::Collisions, double, rk4),
        (Kind::Collisions, single, rk4),
        (Kind::Balls, single, verlet),
        (Kind::Collisions, single, euler),
    ];
    all.into_iter().flat_map(|(kind, precision, integrator)| stages(kind, precision, integrator)).collect()
});

fn distance_between(scene: &Scene, one: SphereId, other: SphereId) -> f32 {
    let [one, other] = [one, other].map(|id| scene.sphere(id).unwrap().centre());
    (0..3).map(|axis| (one[axis] - other[axis]).powi(2)).sum::<f64>().sqrt() as f32
}

/// Positions of a state with their low parts.
fn centres(world: &World, state: usize) -> Vec<f64> {
    let n = world.step.layout.spheres as usize;
    let (high, low) = (&world.states[state][..n], &world.states[state][3 * n..]);
    let sums = high.iter().zip(low).map(|(high, low)| (high.truncate().as_dvec3() + low.truncate().as_dvec3()).to_array());
    sums.flatten().collect()
}

/// The first difference of two lists that is greater than the tolerance.
fn differs(one: &[f64], other: &[f64], tolerance: f64) -> Option<String> {
    if one.len() != other.len() {
        return Some(format!("{} and {} numbers", one.len(), other.len()));
    }
    let mut both = one.iter().zip(other).enumerate();
    // NaN differs from everything.
    let is_near = |a: f64, b: f64| (a - b).abs() <= tolerance;
    both.find(|(_, (a, b))| !is_near(**a, **b)).map(|(at, (a, b))| format!("{at}: {a} and {b}, {tolerance:e}"))
}

/// The first difference of each buffer. `place` is the relative error of positions.
fn differences(cpu: &World, gpu: &World, place: f64) -> Vec<(Buffer, String)> {
    let wide = |numbers: &[f32]| numbers.iter().copied().map(f64::from).collect::<Vec<f64>>();
    let flat = |rows: &[glam::Vec4]| rows.iter().flat_map(|row| row.to_array()).map(f64::from).collect::<Vec<f64>>();
    let bounds = |world: &World| world.aabbs.iter().flat_map(|aabb| [aabb.min, aabb.max].concat()).map(f64::from).collect();
    let mut found = Vec::new();
    let mut compare = |buffer: Buffer, one: Vec<f64>, other: Vec<f64>, relative: f64| {
        let most = one.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        found.extend(differs(&one, &other, relative * most).map(|text| (buffer, text)));
    };
    let n = cpu.step.layout.spheres as usize;
    for (state, buffer) in [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4].into_iter().enumerate() {
        compare(buffer, centres(cpu, state), centres(gpu, state), place);
        for region in [1, 2] {
            let rows = |world: &World| flat(&world.states[state][region * n..(region + 1) * n]);
            compare(buffer, rows(cpu), rows(gpu), 1e-5);
        }
    }
    let of_springs = |world: &World| wide(&springs(world).into_iter().flat_map(|(_, spring)| spring).collect::<Vec<_>>());
    compare(Buffer::Aabbs, bounds(cpu), bounds(gpu), 2e-7);
    compare(Buffer::Wrenches, flat(&cpu.wrenches), flat(&gpu.wrenches), 1e-5);
    compare(Buffer::Histories, of_springs(cpu), of_springs(gpu), 1e-5);
    compare(Buffer::Rates, wide(&cpu.rates), wide(&gpu.rates), 1e-5);
    compare(Buffer::Orientations, flat(&cpu.orientations), flat(&gpu.orientations), 1e-6);
    found
}

/// Relative error of positions after these stages. A displacement in a step is about 0.002 and has an error of 1e-10. The ends of a
/// capsule turn about its centre, which is 0.5 away, with an error of 6e-8.
fn place_error(runs: &[Run]) -> f64 {
    if runs[0].stage.name == "turn" { 1e-11 } else { 1e-12 }
}

#[test]
fn backends_agree_on_every_stage_with_double_precision() {
    let mut all = Vec::new();
    for (number, (runs, before)) in STAGES.iter().enumerate() {
        let mut cpu = before.clone();
        runs.iter().for_each(|run| run.on_cpu(&mut cpu));
        let found = differences(&cpu, &on_gpu(&GPU, before, runs), place_error(runs));
        if !found.is_empty() {
            all.push(format!("{number}: {} pass {}: {found:?}", runs[0].stage.name, runs[0].pass));
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

static MISTAKES: [Mistake; 16] = [
    Mistake("loads", 0, "fine.wgsl", "to.low - from_.low", "from_.low - to.low", Buffer::Wrenches),
    Mistake("loads", 0, "fine.wgsl", "return fine_moved(high, place.low);", "return high;", Buffer::Wrenches),
    Mistake(
        "loads",
        0,
        "geometry.wgsl",
        "apart = fine_sum(apart, product_of(vec3f(c.y)",
        "apart = fine_sum(apart, product_of(vec3f(c.x)",
        Buffer::Wrenches,
    ),
    Mistake("loads", 3, "geometry.wgsl", "radius - height - dot(rest", "radius + height - dot(rest", Buffer::Wrenches),
    Mistake("symplectic_euler", 0, "fine.wgsl", "kept(sum.low + place.low)", "place.low", Buffer::Start),
    Mistake(
        "loads",
        0,
        "attached.wgsl",
        "let distance = fine_apart(i, other)",
        "let distance = fine_apart(other, i)",
        Buffer::Wrenches,
    ),
    Mistake("drift", 0, "drift.wgsl", "vec4f(after.low, 0.0)", "vec4f(low_row(i), 0.0)", Buffer::Y4),
    Mistake("kick", 3, "kick.wgsl", "vec4f(after.low, 0.0)", "vec4f(0.0)", Buffer::Start),
    Mistake("finish", 3, "finished.wgsl", "vec4f(after.low, 0.0)", "vec4f(0.0)", Buffer::Start),
    Mistake("advance", 1, "next_state.wgsl", "low = start_row(3u, i).xyz", "low = vec3f(0.0)", Buffer::Y3),
    Mistake("apply_collisions", 0, "changes.wgsl", "vec4f(after.low, 0.0)", "vec4f(0.0)", Buffer::Start),
    Mistake("apply_collisions", 0, "collision_state.wgsl", "own.xyz + (", "(", Buffer::Start),
    Mistake("constrain", 3, "lengths.wgsl", "vec4f(after.low, 0.0)", "vec4f(0.0)", Buffer::Y4),
    Mistake("turn", 0, "turn.wgsl", "vec4f(new_x1.low, 0.0)", "vec4f(0.0)", Buffer::Start),
    Mistake(
        "rod_loads",
        3,
        "geometry.wgsl",
        "return fine_between(origin, sphere).high;",
        "return state[position_at(sphere)].xyz - state[position_at(origin)].xyz;",
        Buffer::Wrenches,
    ),
    Mistake("update_aabbs", 0, "update_aabbs.wgsl", "hull.max + room", "hull.max", Buffer::Aabbs),
];

#[test]
fn kernels_with_a_mistake_in_low_parts_are_rejected() {
    let verdicts = Verdicts::of("double");
    let code = keys::code(include_str!("double.rs"));
    for mistake in &MISTAKES {
        let Mistake(stage, pass, file, right, wrong, buffer) = mistake;
        let is_meant = |(runs, _): &&Stages| runs.iter().any(|run| run.stage.name == *stage && run.pass == *pass);
        let (runs, _) = STAGES.iter().find(is_meant).expect("the stage");
        let run = runs.iter().find(|run| run.stage.name == *stage).expect("the stage");
        assert!(run.stage.parts().iter().any(|part| part.file.ends_with(file) && part.text.contains(right)), "{file}: {right}");
        let made = RefCell::new(None);
        let broken = |runs: &[Run]| with_mistake(runs, mistake, &mut made.borrow_mut());
        let cpu = |(runs, before): &Stages| {
            let mut cpu = before.clone();
            runs.iter().for_each(|run| run.on_cpu(&mut cpu));
            cpu
        };
        let key = |stages: &&Stages| {
            let mut key = code;
            keys::add_world(&mut key, &stages.1);
            keys::add_world(&mut key, &cpu(stages));
            keys::of_kernels(key, &broken(&stages.0), &stages.1, mistake)
        };
        let rejects = |stages: &&Stages| {
            let (runs, before) = stages;
            let found = differences(&cpu(stages), &on_gpu(&GPU, before, &broken(runs)), place_error(runs));
            found.iter().any(|(place, _)| place == buffer)
        };
        let is_rejected = verdicts.rejects(&mistake.name(), STAGES.iter().filter(is_meant), key, rejects);
        assert!(is_rejected, "{stage} accepts {wrong}");
    }
    verdicts.finish();
}
