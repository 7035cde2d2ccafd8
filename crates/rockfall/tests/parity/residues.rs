//! Residues of velocities (docs/physics section 5.10), stage by stage on both backends.
//!
//! Steps are so short that they change velocities by less than the last place, so that residues are what is compared. The residues are
//! decoded here once more from the specification.

use std::cell::RefCell;
use std::sync::LazyLock;

use rockfall::glam::{DVec3, Vec3, Vec4};
use rockfall::model::buffer::Buffer;
use rockfall::model::layout::{RESIDUE_REGION, RESIDUE_ROW, RIGID_ROWS, SLICE};
use rockfall::model::status::REBUILD_REQUESTED;
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run, SORT_MEMORY};
use rockfall::{BroadPhase, ContactLaw, Integrator, Material, Pair, Placement, Scene, Shape, Sphere};

use crate::broken::{Mistake, with_mistake};
use crate::device::{GPU, on_gpu};

/// A buffer of a state, and the exact velocities and angular momenta in it.
type Motions = (Buffer, Vec<[DVec3; 2]>);

const DT: f32 = 1e-8;
/// Radius of single spheres. Those of bodies follow from the state of the body, with rounding.
const RADIUS: f32 = 0.5;

/// Rows of balls that touch their neighbours, and under a law with history dimers that touch each other.
fn scene(law: ContactLaw) -> Scene {
    let mut scene = Scene::new();
    (scene.settings.contact_law, scene.settings.collisions, scene.settings.gravity) = (law, false, 9.81);
    (scene.settings.linear_damping, scene.settings.angular_damping) = (0.3, 0.2);
    let stuff = scene.add_material(Material::new("stuff").density(1.0).young(1e3).poisson(0.3)).unwrap();
    scene.set_pair(stuff, stuff, Pair::default().restitution(0.4).friction(0.4).stiffness(30.0)).unwrap();
    let shape = Shape::new().material(stuff).sphere([-0.3, 0.0, 0.0], 0.45).sphere([0.3, 0.1, 0.0], 0.4).density(1.0);
    let shape = scene.add_shape(shape).unwrap();
    for k in 0..48_u8 {
        let velocity = [1, 2, 3].map(|n| (f32::from(k) * 0.7 + n as f32).sin() * f32::from(k % 5 + 1));
        let place = [0.97 * f32::from(k % 8), 3.0 * f32::from(k / 8), 0.1];
        let ball = Sphere::new(place, RADIUS).density(1.0).velocity(velocity).angular_momentum(velocity.map(|v| 0.1 * v));
        scene.add_sphere(ball.material(stuff)).unwrap();
        if k % 8 == 3 && law != ContactLaw::Thesis {
            let placed = Placement::new(shape).at([1.45 * f64::from(k / 8), -4.0, 2.0]).velocity(velocity);
            scene.add_body(placed.angular_momentum(velocity)).unwrap();
        }
    }
    scene
}

type Stages = (Vec<Run>, World);

/// All stages of the last of some steps, each with the world before it.
fn stages(law: ContactLaw, integrator: Integrator) -> Vec<Stages> {
    let mut world = World::build_in_space(&scene(law)).unwrap();
    world.set_integrator(integrator);
    world.set_residues(true);
    world.set_time_step(DT);
    world.set_pair_rows(world.movers().div_ceil(SLICE) * 64);
    if law != ContactLaw::Thesis {
        world.set_history_pool(256);
    }
    let step = world.step;
    let phases = [Phase::UpdateAabbs, Phase::BroadPhase, Phase::UpdatePositions];
    let mut all = Vec::new();
    for number in 0..7 {
        world.status.rebuild |= REBUILD_REQUESTED;
        for run in phases.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::Grid)).filter(|run| run.applies(&step)) {
            if number == 6 {
                all.push((vec![*run], world.clone()));
            }
            run.on_cpu(&mut world);
            assert_eq!(world.status.rejected, 0, "{}", run.stage.name);
        }
    }
    assert!(world.status.last_contacts > 40, "{} contacts", world.status.last_contacts);
    let mut sorted = world.clone();
    sorted.status.rebuild = REBUILD_REQUESTED;
    // Another order than that in which the spheres are now.
    sorted.states[0][..world.step.layout.spheres as usize].reverse();
    all.push((SORT_MEMORY.to_vec(), sorted));
    all
}

static STAGES: LazyLock<Vec<Stages>> = LazyLock::new(|| {
    let all = [
        (ContactLaw::HertzMindlin, Integrator::VelocityVerlet),
        (ContactLaw::Linear, Integrator::SymplecticEuler),
        (ContactLaw::Thesis, Integrator::Rk4),
    ];
    all.into_iter().flat_map(|(law, integrator)| stages(law, integrator)).collect()
});

/// A number of 19 bits with a sign, times 2^-41 of the greatest power of 2 in a number.
fn part(bits: u32, of: f32) -> f64 {
    let signed = f64::from((bits << 13) as i32 >> 13);
    let power = f64::from(f32::from_bits(of.to_bits() & 0x7f80_0000));
    signed * power * 2_f64.powi(-41)
}

/// Velocity and angular momentum with the residues of a row.
fn exact(velocity: Vec3, momentum: Vec3, row: Vec4) -> [DVec3; 2] {
    let words = row.to_array().map(f32::to_bits);
    let axis = |k: usize| {
        let upper = words[3] >> (18 - 9 * k) & 0x1ff;
        let of_momentum = words[k] & 0x3ff | upper << 10;
        let [v, l] = [velocity[k], momentum[k]];
        [f64::from(v) + part(words[k] >> 10 & 0x7_ffff, v), f64::from(l) + part(of_momentum, l)]
    };
    let [x, y, z] = [0, 1, 2].map(axis);
    [0, 1].map(|k| DVec3::new(x[k], y[k], z[k]))
}

/// Velocities and angular momenta of a state and of the rigid bodies with their residues; in stage states of RK4 the increments.
fn exact_motions(world: &World) -> Vec<Motions> {
    let (n, first) = (world.step.layout.spheres as usize, RESIDUE_REGION as usize);
    let is_stage_of_rk4 = |state: usize| state > 0 && world.states[state].len() == (first + 2) * n;
    let of = |state: usize| -> Vec<[DVec3; 2]> {
        let rows = &world.states[state];
        let row = |region: usize, slot: usize| rows[region * n + slot];
        let motion = |slot: usize| match rows.len().cmp(&((first + 1) * n)) {
            std::cmp::Ordering::Less => [DVec3::ZERO; 2],
            _ if is_stage_of_rk4(state) => [first, first + 1].map(|region| row(region, slot).truncate().as_dvec3()),
            _ => exact(row(1, slot).truncate(), row(2, slot).truncate(), row(first, slot)),
        };
        (0..n).filter(|slot| row(0, *slot).w == RADIUS).map(motion).collect()
    };
    let bodies = world.rigid_bodies.chunks_exact(RIGID_ROWS as usize);
    let bodies = bodies.map(|rows| exact(rows[2].truncate(), rows[3].truncate(), rows[RESIDUE_ROW as usize])).collect();
    let states = [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4].into_iter().enumerate();
    states.map(|(state, buffer)| (buffer, of(state))).chain([(Buffer::RigidBodies, bodies)]).collect()
}

/// Buffers in which the backends differ. An increment of a step is about 1e-7, and the last place of a velocity as much.
fn differing(cpu: &World, gpu: &World) -> Vec<Buffer> {
    let is_near = |one: &[DVec3; 2], other: &[DVec3; 2]| (0..2).all(|k| (one[k] - other[k]).abs().max_element() <= 1e-11);
    let both = exact_motions(cpu).into_iter().zip(exact_motions(gpu));
    let differ = |((buffer, one), (_, other)): (Motions, Motions)| {
        let is_same = one.iter().zip(&other).all(|(one, other)| is_near(one, other));
        (!is_same).then_some(buffer)
    };
    both.filter_map(differ).collect()
}

fn on_cpu((runs, before): &Stages) -> World {
    let mut cpu = before.clone();
    runs.iter().for_each(|run| run.on_cpu(&mut cpu));
    cpu
}

#[test]
fn backends_agree_on_residues() {
    let mut moved = Vec::new();
    for stages in STAGES.iter() {
        let (runs, before) = stages;
        let cpu = on_cpu(stages);
        let mut found = differing(&cpu, &on_gpu(&GPU, before, runs));
        // The backends sort memory in other scratch arrays.
        found.retain(|buffer| runs.len() == 1 || *buffer == Buffer::Start);
        assert!(found.is_empty(), "{} pass {}: {found:?}", runs[0].stage.name, runs[0].pass);
        if !differing(&cpu, before).is_empty() {
            moved.push(runs[0].stage.name);
        }
    }
    // The stage states of RK4 hardly differ from those of the step before. Every sort moves residues too.
    let expected = ["drift", "kick", "move_bodies", "key_spheres", "symplectic_euler", "move_bodies", "key_spheres", "finish"];
    assert_eq!(moved, [&expected[..], &["key_spheres"]].concat(), "stages that change residues");
}

static MISTAKES: [Mistake; 7] = [
    Mistake("kick", 3, "kick.wgsl", "start[RESIDUE_REGION * step.spheres + i] = residues;", "", Buffer::Start),
    Mistake("drift", 0, "residue.wgsl", "sum.low + number.low", "sum.low", Buffer::Y4),
    Mistake(
        "symplectic_euler",
        0,
        "residue.wgsl",
        "& vec3u(0x3ffu)) | (upper << vec3u(10u))",
        "& vec3u(0x3ffu))",
        Buffer::Start,
    ),
    Mistake("finish", 3, "finished.wgsl", "put_start(RESIDUE_REGION, i, residues);", "", Buffer::Start),
    Mistake("advance", 1, "next_state.wgsl", "weight = 2.0 * weight;", "", Buffer::Y3),
    Mistake(
        "move_bodies",
        5,
        "move_bodies.wgsl",
        "increased_pose(body, DRIFTED_ROW,",
        "increased_pose(body, RESIDUE_ROW,",
        Buffer::RigidBodies,
    ),
    Mistake(
        "settle_spheres",
        0,
        "settle_spheres.wgsl",
        "RESIDUE_REGION * step.spheres + i];",
        "RESIDUE_REGION * step.spheres];",
        Buffer::Start,
    ),
];

#[test]
fn kernels_with_a_mistake_in_residues_are_rejected() {
    for mistake in &MISTAKES {
        let Mistake(stage, pass, _, _, wrong, buffer) = mistake;
        let is_meant = |(runs, _): &&Stages| runs.iter().any(|run| run.stage.name == *stage && run.pass == *pass);
        let made = RefCell::new(None);
        let is_rejected = STAGES.iter().filter(is_meant).any(|stages| {
            let (runs, before) = stages;
            let broken = with_mistake(runs, mistake, &mut made.borrow_mut());
            differing(&on_cpu(stages), &on_gpu(&GPU, before, &broken)).contains(buffer)
        });
        assert!(is_rejected, "{stage} accepts {wrong}");
    }
}
