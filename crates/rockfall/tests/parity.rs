//! Every kernel against its CPU twin, stage by stage, on scenes with objects of every kind.
//!
//! Both start every stage from the same bits, those that the CPU left behind, so that differences do not add up.

#![cfg(feature = "gpu")]

use std::sync::LazyLock;

use glam::{Quat, Vec3, Vec4};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rockfall::gpu::{Gpu, GpuWorld, block_on};
use rockfall::layout::{ENTRY_COLLIDES, SLICE, Status, VOID_ESCAPED, VOID_PAIRS};
use rockfall::scene::{Capsule, Cuboid, Polygon, Rod, Sphere, Spring, Tether};
use rockfall::stage::{Buffer, Part, Phase, Run, Stage};
use rockfall::world::World;
use rockfall::{Integrator, Scene};

static GPU: LazyLock<Gpu> = LazyLock::new(open);

/// A test without an adapter fails: skipped it would prove nothing.
fn open() -> Gpu {
    Gpu::open_blocking(true).expect("these tests need a Vulkan driver, lavapipe will do")
}

/// A crowd of everything in a box of about `size`.
fn scene(seed: u64, size: f32, speed: f32) -> Scene {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut scene = Scene::new();
    let mut any = move |reach: f32| {
        Vec3::new(
            rng.random_range(-reach..reach),
            rng.random_range(-reach..reach),
            rng.random_range(-reach..reach),
        )
    };
    let mut spheres = Vec::new();
    for k in 0..60_u16 {
        let mut sphere = Sphere::new(any(size), 0.3 + 0.005 * f32::from(k))
            .mass(0.5 + 0.05 * f32::from(k))
            .velocity(any(speed))
            .angular_momentum(any(0.5))
            .orientation(Quat::from_scaled_axis(any(2.0)));
        if k % 11 == 3 {
            sphere = sphere.fixed();
        }
        if k % 13 == 5 {
            sphere = sphere.force(any(2.0));
        }
        if k % 17 == 7 {
            sphere = sphere.group(1);
        }
        spheres.push(scene.add_sphere(sphere).unwrap());
    }
    for _ in 0..12 {
        let end = any(size);
        let capsule = Capsule::new(end, end + any(1.0) + Vec3::splat(0.1), 0.3)
            .mass(1.5)
            .velocity(any(speed));
        let parts = scene.add_capsule(capsule).unwrap();
        let _ = parts;
    }
    // A chain, free rods, springs and tethers among the first spheres, fixed ones too.
    for k in 0..8 {
        scene.add_rod(Rod::new(spheres[k], spheres[k + 1], 0.1).length(0.8)).unwrap();
        scene.add_rod(Rod::new(spheres[k + 20], spheres[k + 30], 0.15)).unwrap();
        scene
            .add_spring(Spring::new(spheres[k + 3], spheres[k + 40], 20.0, 1.0).damping(0.5))
            .unwrap();
    }
    for k in 50..54 {
        scene
            .add_tether(Tether::new(spheres[k], any(size), 10.0).length(0.5).damping(0.2))
            .unwrap();
    }
    for _ in 0..3 {
        let turn = Quat::from_scaled_axis(any(2.0));
        let corner = any(size);
        scene
            .add_box(Cuboid::new(
                corner,
                turn * Vec3::X,
                turn * (1.5 * Vec3::Y),
                turn * (0.7 * Vec3::Z),
            ))
            .unwrap();
    }
    scene
        .add_polygon(Polygon::new(
            Vec3::new(-size, -size, -size),
            Vec3::new(0.0, 0.3, 2.0 * size),
            Vec3::new(2.0 * size, 0.0, 0.5),
        ))
        .unwrap();
    scene
}

/// Where the floats of a field differ by more than rounding can explain: more than `tolerance` of the field's largest
/// value (or of 1), and more than what the CPU's own value moves by when the bodies move by a rounding error. The
/// normal of two rods that all but cross, for one, has few good digits.
fn compare_floats(gpu: &Field, cpu: &Field, shaken: &[Vec<Field>], place: usize, wrong: &mut Vec<String>) {
    let Field { what, tolerance, values } = cpu;
    assert_eq!(gpu.values.len(), values.len(), "{what}");
    let scale = values.iter().fold(1.0_f32, |most, x| most.max(x.abs()));
    for (at, (g, c)) in gpu.values.iter().zip(values).enumerate() {
        let moves = |world: &Vec<Field>| (world[place].values[at] - c).abs();
        let sensitive = shaken.iter().map(moves).fold(0.0, f32::max);
        // Not `>`: NaN must count as a difference.
        let near = (g - c).abs() <= tolerance * scale + 4.0 * sensitive;
        if !near {
            wrong.push(format!(
                "{what}[{at}]: GPU {g}, CPU {c} (scale {scale}, sensitive by {sensitive})"
            ));
        }
    }
}

/// Floats of a world that must be the same up to rounding.
struct Field {
    what: String,
    tolerance: f32,
    values: Vec<f32>,
}

fn fields(world: &World) -> Vec<Field> {
    let mut all = Vec::new();
    let n = world.step.spheres as usize;
    for (k, what) in ["start", "y2", "y3", "y4"].iter().enumerate() {
        for (region, kind) in ["position", "velocity", "momentum"].iter().enumerate() {
            let values = floats(&world.states[k][region * n..(region + 1) * n]);
            all.push((format!("{what} {kind}"), 2e-5, values));
        }
    }
    let hulls = world.aabbs.iter().flat_map(|a| [a.min, a.max].concat()).collect();
    all.push(("aabbs".to_owned(), 1e-6, hulls));
    all.push(("wrenches".to_owned(), 2e-5, floats(&world.wrenches)));
    all.push(("orientations".to_owned(), 2e-6, floats(&world.orientations)));
    let weights = entries(world).iter().map(|entry| entry.2.unwrap_or(0.0)).collect();
    all.push(("weights".to_owned(), 1e-5, weights));
    let status = &world.status;
    let overlaps = [status.max_overlap, status.last_max_overlap].map(f32::from_bits).to_vec();
    all.push(("overlaps".to_owned(), 1e-5, overlaps));
    all.into_iter()
        .map(|(what, tolerance, values)| Field { what, tolerance, values })
        .collect()
}

/// The world with its bodies moved by about a rounding error.
fn shake(world: &World, rng: &mut Pcg64) -> World {
    let mut moved = world.clone();
    let n = world.step.spheres as usize;
    for state in &mut moved.states {
        for position in &mut state[..n] {
            let size = position.truncate().abs().max_element();
            let mut by = || size * rng.random_range(-2e-7..2e-7);
            *position += Vec4::new(by(), by(), by(), 0.0);
        }
    }
    moved
}

fn floats(vectors: &[Vec4]) -> Vec<f32> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}

/// The entries of all lists, with their weight where they collide.
fn entries(world: &World) -> Vec<(u32, u32, Option<f32>)> {
    let step = &world.step;
    let mut all = Vec::new();
    for mover in 0..world.movers() {
        let slice = world.lists[(step.slices_at + mover / SLICE) as usize];
        for e in 0..world.lists[mover as usize] {
            let slot = slice + e * SLICE + mover % SLICE;
            let word = world.lists[(step.entries_at + slot) as usize];
            let collides = word & ENTRY_COLLIDES != 0;
            all.push((mover, word, collides.then(|| world.weights[slot as usize])));
        }
    }
    all
}

/// Everything in which the GPU's world differs from the CPU's, after `run`.
fn differences(run: &Run, gpu: &World, cpu: &World, shaken: &[World]) -> Vec<String> {
    let mut wrong = Vec::new();
    let tags = |world: &World| -> Vec<(u32, u32)> { world.aabbs.iter().map(|a| (a.id, a.tag)).collect() };
    if tags(gpu) != tags(cpu) {
        wrong.push("ids or tags of the AABBs".to_owned());
    }
    let words = |world: &World| -> Vec<(u32, u32)> { entries(world).iter().map(|e| (e.0, e.1)).collect() };
    let head = cpu.step.entries_at as usize;
    if gpu.lists[..head] != cpu.lists[..head] {
        wrong.push("counts or offsets of the lists".to_owned());
    } else if words(gpu) == words(cpu) {
        let shaken: Vec<_> = shaken.iter().filter(|world| words(world) == words(cpu)).map(fields).collect();
        for (place, (g, c)) in fields(gpu).iter().zip(&fields(cpu)).enumerate() {
            compare_floats(g, c, &shaken, place, &mut wrong);
        }
    } else {
        for (g, c) in entries(gpu).iter().zip(entries(cpu)).filter(|(g, c)| g.1 != c.1) {
            wrong.push(format!("list of {}: GPU {:x}, CPU {:x}", g.0, g.1, c.1));
        }
    }
    let counters = |status: &Status| Status {
        escape_ratio: 0,
        max_overlap: 0,
        last_max_overlap: 0,
        ..*status
    };
    if counters(&gpu.status) != counters(&cpu.status) {
        wrong.push(format!("status: GPU {:?}\n        CPU {:?}", gpu.status, cpu.status));
    }
    wrong
        .iter()
        .map(|text| format!("{} {}: {text}", run.stage.name, run.pass))
        .collect()
}

/// Runs stages on the GPU from the world given.
fn on_gpu(gpu: &Gpu, from: &World, runs: &[Run]) -> World {
    let mut device = GpuWorld::new(gpu, from).unwrap();
    for buffer in Buffer::ALL {
        device.upload_buffer(from, buffer).unwrap();
    }
    device.run(runs, &from.step, 1).unwrap();
    let mut world = from.clone();
    block_on(gpu.device(), device.download(&mut world, &Buffer::ALL)).unwrap();
    world
}

/// The stages of a step, each alone but for those of the broad phase: between them the lists are not whole.
fn groups(integrator: Integrator) -> impl Iterator<Item = &'static [Run]> {
    Phase::STEP.iter().flat_map(move |phase| {
        let stages = phase.stages(integrator);
        stages.chunks(if *phase == Phase::BroadPhase { stages.len() } else { 1 })
    })
}

/// Steps of the CPU, every stage of them compared; the differences of the first stage that has any.
fn parity(gpu: &Gpu, scene: &Scene, integrator: Integrator, steps: u32, swap: impl Fn(Run) -> Run) -> Vec<String> {
    let mut cpu = World::build(scene).unwrap();
    cpu.step.dt = 0.005;
    let mut rng = Pcg64::seed_from_u64(1);
    let (mut contacts, mut collisions) = (0, 0);
    for attempt in 0..100 {
        let step = cpu.status.steps;
        if step == steps {
            break;
        }
        assert!(attempt < 99, "{:?}", cpu.status);
        for runs in groups(integrator) {
            let swapped: Vec<Run> = runs.iter().map(|run| swap(*run)).collect();
            let gpu_world = on_gpu(gpu, &cpu, &swapped);
            let mut shaken: Vec<_> = (0..8).map(|_| shake(&cpu, &mut rng)).collect();
            rockfall::cpu::run(&mut cpu, runs);
            for world in &mut shaken {
                rockfall::cpu::run(world, runs);
            }
            if cpu.status.void != 0 && gpu_world.status.void == cpu.status.void {
                // How far the other bodies of a void stage got is nobody's business: it will all be run again.
                break;
            }
            let wrong = differences(&runs[runs.len() - 1], &gpu_world, &cpu, &shaken);
            if !wrong.is_empty() {
                return wrong.iter().map(|text| format!("step {step}, {text}")).collect();
            }
            contacts = contacts.max(cpu.status.contacts);
            collisions = collisions.max(cpu.status.collisions);
        }
        if cpu.status.void != 0 {
            // What the simulation does for a step that is run again.
            if cpu.status.void & VOID_PAIRS != 0 {
                cpu.set_pair_capacity(cpu.status.pairs_needed * 2);
            }
            if cpu.status.void & VOID_ESCAPED != 0 {
                cpu.step.margin_scale *= 4.0;
            }
            let collided = cpu.status.collided;
            cpu.status.void = 0;
            cpu.status.escape_ratio = 0;
            cpu.status.contacts = 0;
            cpu.status.max_overlap = 0;
            cpu.status.collisions *= collided;
        }
    }
    assert!(
        contacts > 20 && collisions > 5,
        "{contacts} contacts and {collisions} collisions prove little"
    );
    Vec::new()
}

fn assert_parity(scene: &Scene, integrator: Integrator, steps: u32) {
    let wrong = parity(&GPU, scene, integrator, steps, |run| run);
    let shown: Vec<_> = wrong.iter().take(20).cloned().collect();
    assert!(wrong.is_empty(), "{} differences:\n{}", wrong.len(), shown.join("\n"));
}

#[test]
fn a_crowd_of_everything_with_rk4() {
    for seed in 0..16 {
        assert_parity(&scene(seed, 2.2, 3.0), Integrator::Rk4, 3);
    }
}

#[test]
fn a_crowd_of_everything_with_symplectic_euler() {
    for seed in 10..13 {
        assert_parity(&scene(seed, 2.2, 3.0), Integrator::SymplecticEuler, 3);
    }
}

#[test]
fn a_dense_crowd_with_pull_and_without_collisions() {
    let mut scene = scene(20, 1.6, 1.0);
    scene.settings.contact_pull = true;
    assert_parity(&scene, Integrator::Rk4, 2);
}

/// Where a distance is 0, two things are parallel, a parameter is exactly 0 or 1, or a body is inside another: what
/// happens there is decided by rule and must be the same rule.
#[test]
fn what_is_decided_by_rule() {
    let mut scene = Scene::new();
    let at = Vec3::new;
    let sphere = |scene: &mut Scene, x: f32, y: f32, z: f32| scene.add_sphere(Sphere::new(at(x, y, z), 0.25)).unwrap();
    // Spheres in one point.
    sphere(&mut scene, 0.0, 0.0, 0.0);
    sphere(&mut scene, 0.0, 0.0, 0.0);
    let rod = |scene: &mut Scene, from: Vec3, to: Vec3, length: Option<f32>| {
        let ends = [from, to].map(|end| scene.add_sphere(Sphere::new(end, 0.1).mass(2.0).velocity(0.5 * end)).unwrap());
        let rod = Rod::new(ends[0], ends[1], 0.2);
        let made = length.map_or(rod.clone(), |length| rod.length(length));
        scene.add_rod(made).unwrap();
        ends
    };
    // A sphere on a rod's axis, over its very end, rods that cross, parallel ones, one in line with another.
    rod(&mut scene, at(10.0, 0.0, 0.0), at(12.0, 0.0, 0.0), None);
    sphere(&mut scene, 11.0, 0.0, 0.0);
    sphere(&mut scene, 12.0, 0.3, 0.0);
    rod(&mut scene, at(11.5, 0.0, -1.0), at(11.5, 0.0, 1.0), Some(2.0));
    rod(&mut scene, at(10.5, 0.25, 0.0), at(13.0, 0.25, 0.0), Some(2.4));
    rod(&mut scene, at(12.0, 0.0, 0.0), at(14.0, 0.0, 0.0), None);
    // A box with spheres inside, on a face, at an edge, and rods through an edge, along one, inside, and by a vertex.
    scene
        .add_box(Cuboid::between(at(20.0, 0.0, 0.0), at(22.0, 2.0, 3.0)))
        .unwrap();
    sphere(&mut scene, 21.0, 1.0, 1.5);
    sphere(&mut scene, 20.1, 0.7, 1.0);
    sphere(&mut scene, 22.0, 1.0, 1.0);
    sphere(&mut scene, 22.1, 2.1, 1.0);
    rod(&mut scene, at(19.0, 1.0, 1.0), at(21.0, -1.0, 1.0), Some(2.8));
    rod(&mut scene, at(20.5, 2.1, 0.0), at(21.5, 2.1, 0.0), None);
    rod(&mut scene, at(20.05, 0.05, 1.0), at(20.05, 0.05, 2.0), Some(1.0));
    rod(&mut scene, at(21.0, 2.1, 3.1), at(23.0, 2.1, 3.1), None);
    rod(&mut scene, at(21.9, 1.9, -1.0), at(21.9, 1.9, 1.0), None);
    // A polygon: touched from the front, on the face, from behind, past its edge, leaving fast.
    scene
        .add_polygon(Polygon::new(at(30.0, 0.0, 0.0), at(0.0, 0.0, 4.0), at(4.0, 0.0, 1.0)))
        .unwrap();
    for (x, y, v) in [
        (31.0, 0.2, -1.0),
        (32.0, 0.0, 0.0),
        (33.0, -0.1, 0.0),
        (29.9, 0.1, 0.0),
        (32.5, 0.1, 9.0),
    ] {
        scene
            .add_sphere(Sphere::new(at(x, y, 2.0), 0.25).velocity(at(0.0, v, 0.0)))
            .unwrap();
    }
    // Capsules: two that collide end on, one with a fixed end, one hit at its end along the axis, a chain of two.
    for (x, v) in [(40.0, 3.0), (42.3, -3.0)] {
        let capsule = Capsule::new(at(x, 0.0, 0.0), at(x + 2.0, 0.0, 0.0), 0.2);
        scene.add_capsule(capsule.velocity(at(v, 0.0, 0.0))).unwrap();
    }
    let held = scene
        .add_sphere(Sphere::new(at(50.0, 0.0, 0.0), 0.2).fixed().velocity(at(0.0, 1.0, 0.0)))
        .unwrap();
    let free = scene.add_sphere(Sphere::new(at(51.0, 0.0, 0.0), 0.2)).unwrap();
    // Over the held end, where the rod cannot move either.
    scene.add_sphere(Sphere::new(at(50.0, 0.3, 0.0), 0.2).fixed()).unwrap();
    scene.add_rod(Rod::new(held, free, 0.2).length(1.0)).unwrap();
    scene
        .add_sphere(Sphere::new(at(51.3, 0.1, 0.0), 0.2).velocity(at(-4.0, 0.0, 0.0)))
        .unwrap();
    let far = scene.add_sphere(Sphere::new(at(51.0, 1.0, 0.0), 0.2)).unwrap();
    let farther = scene.add_sphere(Sphere::new(at(52.0, 1.0, 0.0), 0.2)).unwrap();
    scene.add_rod(Rod::new(free, far, 0.1).length(1.0)).unwrap();
    scene.add_rod(Rod::new(far, farther, 0.1).length(1.1)).unwrap();
    scene
        .add_sphere(Sphere::new(at(52.3, 1.1, 0.1), 0.2).velocity(at(-4.0, 0.0, 0.0)))
        .unwrap();
    // Three more in a heap, and a spring of no length.
    for k in 0..3 {
        let k = k as f32;
        scene
            .add_sphere(Sphere::new(at(60.0, 0.39 * k, 0.0), 0.2).velocity(at(0.0, -3.0 * k, 0.0)))
            .unwrap();
    }
    let one = sphere(&mut scene, 70.0, 0.0, 0.0);
    let two = sphere(&mut scene, 70.0, 0.0, 0.0);
    scene.add_spring(Spring::new(one, two, 10.0, 1.0)).unwrap();
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        assert_parity(&scene, integrator, 3);
    }
}

/// A spring beyond all reason: its bodies are stopped and named alike.
#[test]
fn bodies_that_stop_being_finite() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let mut scene = scene(30, 2.2, 3.0);
        let ids: Vec<_> = scene.sphere_ids().collect();
        scene.add_spring(Spring::new(ids[0], ids[9], 3e38, 0.1)).unwrap();
        scene.add_spring(Spring::new(ids[1], ids[12], 3e38, 0.1)).unwrap();
        let mut world = World::build(&scene).unwrap();
        world.step.dt = 0.02;
        world.step.margin_scale = 1e30;
        world.set_pair_capacity(1 << 16);
        let mut seen = false;
        for runs in groups(integrator) {
            let gpu_world = on_gpu(&GPU, &world, runs);
            rockfall::cpu::run(&mut world, runs);
            let (g, c) = (gpu_world.status, world.status);
            assert_eq!(
                (g.void, g.bad_body, g.bad_count, g.bad_step, g.first_bad),
                (c.void, c.bad_body, c.bad_count, c.bad_step, c.first_bad),
                "{} {}",
                runs[0].stage.name,
                runs[0].pass
            );
            seen |= c.bad_count > 0;
            assert!(gpu_world.states.iter().flatten().all(|vector| vector.is_finite()));
        }
        assert!(seen);
    }
}

/// The comparison is worth something only if it tells a wrong kernel: this one's arms are too long by a tenth.
#[test]
fn a_broken_kernel_is_told() {
    // Its own device: kernels are kept by name.
    let gpu = open();
    let broken = |run: Run| -> Run {
        if run.stage.name != "advance" {
            return run;
        }
        let mut parts: Vec<Part> = run.stage.parts.to_vec();
        for part in &mut parts {
            if part.file.ends_with("contact.wgsl") {
                let text = part.text.replace(
                    "select(overlap, 0.5 * overlap, b_moves)",
                    "select(overlap, 0.4 * overlap, b_moves)",
                );
                assert_ne!(text, part.text);
                part.text = text.leak();
            }
        }
        let stage = Stage {
            parts: parts.leak(),
            ..*run.stage
        };
        Run {
            stage: Box::leak(Box::new(stage)),
            ..run
        }
    };
    let wrong = parity(&gpu, &scene(0, 2.2, 3.0), Integrator::Rk4, 1, broken);
    assert!(
        wrong.iter().any(|text| text.contains("advance")),
        "a wrong kernel was not told"
    );
}
