//! Arrays that exceed the largest binding are stored in chunks. This does not change the results.

#![cfg(feature = "gpu")]

use crate::common::device::device;
use crate::common::mixed::{Run, assert_bitwise_identical, mixed};
use crate::common::{floor_box, with};
use rockfall::glam::{Quat, Vec3};
use rockfall::model::buffer::Buffer;
use rockfall::{
    Backend, BroadPhase, ContactLaw, Cuboid, Error, Integrator, Material, Options, Pair, Placement, RigidBody, Rod, Scene,
    Shape, Simulation, Sphere, SphereId, Tether,
};

/// Balls side by side that fall on a floor, with so many tethers that the topology buffer needs more than one chunk. No
/// two collisions share a body, because their records would need more chunks than a stage can bind. There are no rods,
/// because software Vulkan takes long to compile their kernels.
fn without_rods() -> Scene {
    let mut scene = with(|settings| settings.gravity = 10.0);
    floor_box(&mut scene);
    for ball in 0..150_u8 {
        let place = [f32::from(ball % 15), f32::from(ball / 15)].map(|k| 0.45 * k - 3.0);
        let fall = Sphere::new([place[0], 0.22 + 0.005 * f32::from(ball % 7), place[1]], 0.2).velocity([0.0, -2.0, 0.0]);
        scene.add_sphere(fall).expect("a valid sphere");
    }
    let balls: Vec<SphereId> = scene.sphere_ids().take(120).collect();
    for ball in balls {
        let above = scene.sphere(ball).expect("a ball").position + Vec3::Y;
        scene.add_tether(Tether::new(ball, above, 5.0)).expect("a valid tether");
    }
    scene
}

/// The mixed scene with additional rods, so that the rod forces need more than one chunk.
fn with_rods() -> Scene {
    let mut scene = mixed(120);
    let balls: Vec<SphereId> = scene.sphere_ids().take(120).collect();
    for pair in balls.chunks_exact(2) {
        scene.add_rod(Rod::new(pair[0], pair[1], 0.03)).expect("a valid rod");
    }
    scene
}

/// A simulation on a device whose bindings are limited to a number of bytes.
fn in_chunks(bytes: u64, scene: Scene, options: Options) -> Simulation {
    let (device, queue) = device(|limits| limits.max_storage_buffer_binding_size = bytes);
    Simulation::on_device(scene, options, &device, &queue).expect("a scene that fits in chunks")
}

fn whole(scene: Scene, options: Options) -> Simulation {
    let _device = rockfall::gpu::SharedDevice::new();
    Simulation::with_options(scene, options.backend(Backend::Gpu)).expect("a scene that fits")
}

fn chunks_of(simulation: &Simulation, buffer: Buffer) -> usize {
    simulation.gpu_view().expect("the GPU backend").chunks(buffer).len()
}

#[track_caller]
fn assert_split_except(simulation: &Simulation, whole_arrays: &[Buffer]) {
    for buffer in Buffer::ALL {
        let chunks = chunks_of(simulation, buffer);
        assert_eq!(chunks > 1, !whole_arrays.contains(&buffer), "{buffer:?}: {chunks}");
    }
}

/// Lists exceed their capacity, so steps are rejected and the lists are rebuilt in more chunks than at the start.
#[test]
fn chunks_of_every_array_give_bitwise_identical_results() {
    for (broad_phase, integrator) in [
        (BroadPhase::BruteForce, Integrator::Rk4),
        (BroadPhase::SortAndSkip, Integrator::Rk4),
        (BroadPhase::Grid, Integrator::Rk4),
        (BroadPhase::Grid, Integrator::SymplecticEuler),
        (BroadPhase::Grid, Integrator::VelocityVerlet),
    ] {
        let options = Options::new().integrator(integrator).broad_phase(broad_phase).pair_capacity(1);
        // The records of collisions would take more chunks than a device has bindings. Scenes with rods have them, below.
        let mut scene = without_rods();
        scene.settings.collisions = false;
        let mut chunked = in_chunks(2304, scene.clone(), options.clone());
        assert_eq!(chunks_of(&chunked, Buffer::Lists), 1);
        let mut whole = whole(scene, options);
        for simulation in [&mut chunked, &mut whole] {
            let contacts = simulation.run(4, 0.01).expect("steps").contacts;
            let report = simulation.run(16, 0.01).expect("steps");
            assert!(report.replays > 0 && contacts > 10, "{contacts} contacts, {report:?}");
        }
        let small = [
            Buffer::CollisionIndices,
            Buffer::Collisions,
            Buffer::Histories,
            Buffer::Poses,
            Buffer::ServoLoads,
            Buffer::Servos,
            Buffer::RigidBodies,
            Buffer::Status,
        ];
        // Only this integrator keeps rates.
        let rates = (integrator != Integrator::VelocityVerlet).then_some(Buffer::Rates);
        assert_split_except(&chunked, &small.into_iter().chain(rates).collect::<Vec<_>>());
        assert_split_except(&whole, &Buffer::ALL);
        assert_bitwise_identical(&Run::of(&mut chunked), &Run::of(&mut whole));
    }
}

/// Balls on strips, with a law whose springs need more chunks as the pool grows. Chains lead from chunk to chunk.
#[test]
fn springs_of_contacts_in_chunks_give_bitwise_identical_results() {
    let mut scene = with(|settings| {
        settings.gravity = 20.0;
        settings.contact_law = ContactLaw::Linear;
        settings.collisions = false;
    });
    let soft = scene.add_material(Material::new("soft").density(1.0).young(1e5).poisson(0.25)).expect("a valid material");
    scene.set_pair(soft, soft, Pair::default().restitution(0.3).friction(0.5).stiffness(3e2)).expect("a valid pair");
    for k in 0..60_u8 {
        let [x, z] = [k % 10, k / 10].map(|k| 0.45 * f32::from(k));
        let ball = Sphere::new([x, 0.199, z], 0.2).density(1.0).material(soft).velocity([0.5, 0.0, 0.0]);
        scene.add_sphere(ball).expect("a valid sphere");
    }
    for (row, k) in (0..6_u8).flat_map(|row| (0..12_u8).map(move |k| (row, k))) {
        // More and more strips along x. Each is in another direction: of strips in one plane, only one would count.
        let (sin, cos) = (0.15 * (f32::from(k) - 5.5)).sin_cos();
        let (down, across) = (Vec3::new(0.0, -cos, sin), Vec3::new(0.0, sin, cos));
        let axis = Vec3::new(0.3 * f32::from(k) - 1.0, 0.199, 0.45 * f32::from(row));
        let corner = axis + 0.199 * down + 0.02 * across;
        let strip = Cuboid::new(corner, (20.0 - axis.x) * Vec3::X, 0.05 * down, -0.04 * across);
        scene.add_box(strip.material(soft)).expect("a valid box");
    }
    let options = Options::new().integrator(Integrator::VelocityVerlet).broad_phase(BroadPhase::BruteForce);
    // 48 blocks.
    let mut chunked = in_chunks(6144, scene.clone(), options.clone());
    assert_eq!(chunks_of(&chunked, Buffer::Histories), 3);
    let mut whole = whole(scene, options);
    for simulation in [&mut chunked, &mut whole] {
        simulation.run(120, 1e-3).expect("steps");
        let springs = simulation.contacts().expect("contacts").iter().filter(|contact| contact.springs.is_some()).count();
        assert!(springs > 200, "{springs} springs");
    }
    assert!(chunks_of(&chunked, Buffer::Histories) > 5, "{} chunks", chunks_of(&chunked, Buffer::Histories));
    assert_bitwise_identical(&Run::of(&mut chunked), &Run::of(&mut whole));
}

/// Collisions are off, because their kernel takes a minute to compile. `tests/sources/kernels.rs` checks that it is valid in
/// chunks.
#[test]
fn rods_in_chunks_give_bitwise_identical_results() {
    for integrator in Integrator::ALL {
        let mut scene = with_rods();
        scene.settings.collisions = false;
        let options = Options::new().integrator(integrator).broad_phase(BroadPhase::Grid);
        let mut chunked = in_chunks(4096, scene.clone(), options.clone());
        let mut whole = whole(scene, options);
        for simulation in [&mut chunked, &mut whole] {
            let report = simulation.run(12, 0.01).expect("steps");
            assert!(report.contacts > 20, "{report:?}");
        }
        let small = [
            Buffer::Extents,
            Buffer::Orientations,
            Buffer::Rates,
            Buffer::Histories,
            Buffer::Poses,
            Buffer::ServoLoads,
            Buffer::Servos,
            Buffer::RigidBodies,
            Buffer::Status,
        ];
        assert_split_except(&chunked, &small);
        assert_bitwise_identical(&Run::of(&mut chunked), &Run::of(&mut whole));
    }
}

/// Dimers that fall on a floor.
#[test]
fn bodies_in_chunks_give_bitwise_identical_results() {
    let mut scene = with(|settings| {
        settings.set("contact_law", "linear").expect("a law");
        settings.gravity = 10.0;
    });
    let stuff = scene.add_material(Material::new("stuff").density(1000.0)).expect("a material");
    scene.set_pair(stuff, stuff, Pair::default().stiffness(1e4)).expect("a pair");
    scene.add_box(Cuboid::between([-9.0, -1.0, -9.0], [9.0, 0.0, 9.0]).material(stuff)).expect("a floor");
    let shape = Shape::new().material(stuff).sphere([-0.08, 0.0, 0.0], 0.1).sphere([0.08, 0.0, 0.0], 0.12);
    let shape = scene.add_shape(shape).expect("a shape");
    for body in 0..100_u8 {
        let [x, z] = [body % 10, body / 10].map(|k| 0.45 * f64::from(k) - 2.0);
        let turn = Quat::from_rotation_z(0.03 * f32::from(body));
        let placed = Placement::new(shape).at([x, 0.2, z]).turned(turn).velocity([0.3, -2.0, 0.0]).spin([1.0, 2.0, 0.0]);
        scene.add_body(placed).expect("a valid body");
    }
    let options = Options::new().integrator(Integrator::VelocityVerlet).broad_phase(BroadPhase::Grid);
    let mut chunked = in_chunks(6144, scene.clone(), options.clone());
    let mut whole = whole(scene, options);
    let [one, other] = [&mut chunked, &mut whole].map(|simulation| {
        let report = simulation.run(20, 0.005).expect("steps");
        assert!(report.contacts > 20, "{report:?}");
        simulation.sync().expect("the state").bodies().to_vec()
    });
    for buffer in [Buffer::RigidBodies, Buffer::Topology, Buffer::Start, Buffer::Wrenches] {
        assert!(chunks_of(&chunked, buffer) > 1, "{buffer:?}");
    }
    let state = |body: &RigidBody| (body.position, body.orientation, body.velocity, body.angular_momentum);
    assert!(one.iter().map(state).eq(other.iter().map(state)));
    assert_bitwise_identical(&Run::of(&mut chunked), &Run::of(&mut whole));
}

/// Edits between steps reach the right chunks, and reads include all chunks.
#[test]
fn edits_and_reads_go_through_all_chunks() {
    // Lists of 8 KiB: a device has enough bindings for that number of chunks.
    let options = || Options::new().broad_phase(BroadPhase::Grid).pair_capacity(2048);
    let mut scene = without_rods();
    scene.settings.collisions = false;
    let [chunked, whole] = [in_chunks(2304, scene.clone(), options()), whole(scene, options())].map(|mut simulation| {
        let ids: Vec<SphereId> = simulation.scene().sphere_ids().collect();
        simulation.run(2, 0.01).expect("steps");
        for id in ids.iter().step_by(7) {
            simulation.apply_impulse(*id, [0.3, 1.0, -0.2]).expect("a sphere");
            simulation.set_force(*id, [0.0, 20.0, 1.0]).expect("a sphere");
        }
        simulation.run(2, 0.01).expect("steps");
        for (number, id) in (0_u8..).zip(ids.iter().rev().step_by(9)) {
            simulation.remove_sphere(*id).expect("a sphere");
            for side in [-0.3, 0.3] {
                let place = [0.45 * f32::from(number) - 4.0, 6.0, side];
                simulation.add_sphere(Sphere::new(place, 0.2)).expect("a valid sphere");
            }
        }
        simulation.run(2, 0.01).expect("steps");
        simulation.sort_memory().expect("the memory is sorted");
        simulation.run(2, 0.01).expect("steps");
        Run::of(&mut simulation)
    });
    assert!(chunked.spheres.len() > 145);
    assert_bitwise_identical(&chunked, &whole);
}

#[test]
fn a_view_returns_the_chunks() {
    let simulation = in_chunks(2304, without_rods(), Options::new());
    let view = simulation.gpu_view().expect("the GPU backend");
    // 150 spheres of 64 bytes.
    let sizes: Vec<u64> = view.chunks(Buffer::Start).iter().map(|chunk| chunk.size()).collect();
    assert_eq!(sizes, [2304, 2304, 2304, 2304, 150 * 64 - 4 * 2304]);
    assert!(view.buffer(Buffer::Status).is_ok());
    let refused = view.buffer(Buffer::Start);
    assert!(
        matches!(&refused, Err(Error::Device(text)) if text.contains("the state") && text.contains("5 buffers")),
        "{refused:?}"
    );
    let sizes = view.buffer_sizes();
    let state = sizes.iter().find(|size| size.name == "the state").expect("the state must be listed");
    assert_eq!(state.bytes, 150 * 64);
}
