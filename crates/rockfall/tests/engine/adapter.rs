//! The wgpu backend on the available adapter, which may be software: whole steps and errors. Nothing may panic or
//! block.

#![cfg(feature = "gpu")]

use crate::common::device;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use glam::Vec3;
use rockfall::exec::gpu::{Gpu, GpuWorld, block_on};
use rockfall::generate::Drum;
use rockfall::model::buffer::Buffer;
use rockfall::model::layout::FEW_STATICS;
use rockfall::model::status::{REJECTED_BEFORE, REJECTED_PAIRS};
use rockfall::model::world::World;
use rockfall::scene::{Capsule, Cuboid, Sphere};
use rockfall::step::schedule::{Phase, Run};
use rockfall::{Backend, BroadPhase, Error, Integrator, Options, Scene, Simulation};

/// Opens an adapter. Without one a test fails, because a skipped test would prove nothing.
fn open() -> Gpu {
    Gpu::open_blocking(true).expect("these tests need a Vulkan driver such as lavapipe")
}

fn step_stages(integrator: Integrator) -> Vec<Run> {
    Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::BruteForce)).copied().collect()
}

fn world(scene: &Scene) -> World {
    let mut world = World::build(scene).unwrap();
    world.step.constants.dt = 0.02;
    // A wide margin, so that no step is rejected because a body left its AABB.
    world.step.lists.margin_scale = 30.0;
    world
}

fn heap(count: u16) -> Scene {
    let mut scene = Scene::new();
    for k in 0..count {
        let k = f32::from(k);
        let place = Vec3::new(k % 5.0, 0.5 + (k / 25.0).floor(), (k / 5.0).floor() % 5.0) * 0.99;
        scene.add_sphere(Sphere::new(place, 0.5)).unwrap();
    }
    scene.add_capsule(Capsule::new((1.0, 9.0, 1.0), (2.0, 9.5, 1.0), 0.3)).unwrap();
    scene.add_box(Cuboid::between((-5.0, -1.0, -5.0), (10.0, 0.0, 10.0))).unwrap();
    scene
}

#[test]
fn a_sphere_falls_by_the_expected_distance() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let gpu = open();
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new((0.0, 10.0, 0.0), 0.5)).unwrap();
        let mut world = world(&scene);
        let mut device = GpuWorld::new(&gpu, &world).unwrap();
        device.run(&step_stages(integrator), &world.step, 50).unwrap();
        block_on(gpu.device(), device.download(&mut world, &Buffer::ALL)).unwrap();
        assert_eq!((world.status.rejected, world.status.steps), (0, 50));
        let fallen = 10.0 - world.states[0][0].y;
        // 1 s of G = 1 is half a unit; symplectic Euler falls half a step farther.
        let expected = if integrator == Integrator::Rk4 { 0.5 } else { 0.51 };
        assert!((fallen - expected).abs() < 1e-5, "{fallen}");
        assert!((world.states[0][1].y + 1.0).abs() < 1e-5);
    }
}

#[test]
fn the_same_input_gives_bitwise_identical_results() {
    let scene = heap(100);
    let ends: Vec<World> = (0..2)
        .map(|_| {
            let gpu = open();
            let mut world = world(&scene);
            world.set_pair_rows(1 << 11);
            let mut device = GpuWorld::new(&gpu, &world).unwrap();
            device.run(&step_stages(Integrator::Rk4), &world.step, 20).unwrap();
            block_on(gpu.device(), device.download(&mut world, &[Buffer::Start, Buffer::Orientations, Buffer::Status]))
                .unwrap();
            world
        })
        .collect();
    assert_eq!(ends[0].status.steps, 20);
    let touched = ends[0].status.last_contacts + ends[0].status.total_collisions_low;
    assert!(touched > 30, "{touched}");
    assert_eq!(ends[0].status, ends[1].status);
    let bits = |world: &World| -> Vec<u32> {
        let all = world.states[0].iter().chain(&world.orientations);
        all.flat_map(|vector| vector.to_array().map(f32::to_bits)).collect()
    };
    assert_eq!(bits(&ends[0]), bits(&ends[1]));
}

#[test]
fn lists_that_do_not_fit_reject_the_step_and_grow() {
    let gpu = open();
    let mut world = world(&heap(100));
    world.set_pair_rows(1);
    let mut device = GpuWorld::new(&gpu, &world).unwrap();
    let stages = step_stages(Integrator::Rk4);
    device.run(&stages, &world.step, 3).unwrap();
    let status = block_on(gpu.device(), device.read_status()).unwrap();
    assert_eq!((status.rejected & !REJECTED_BEFORE, status.steps), (REJECTED_PAIRS, 0));
    let mut after = world.clone();
    block_on(gpu.device(), device.download(&mut after, &[Buffer::Start])).unwrap();
    assert_eq!(after.states[0], world.states[0], "a rejected step moves nothing");

    world.set_pair_rows(status.pair_rows_needed);
    device.resize_lists(&world).unwrap();
    device.set_status(&world.status).unwrap();
    device.run(&stages, &world.step, 1).unwrap();
    let status = block_on(gpu.device(), device.read_status()).unwrap();
    assert_eq!((status.rejected, status.steps), (0, 1));
    assert!(status.last_contacts > 50);
}

/// The ball around a plate of a drum holds many grains that the plate is far from. They make no entries, and take no room.
#[test]
fn plates_take_no_room_in_the_lists_of_grains_far_from_them() {
    let mut world = World::build_in_space(&Drum::new(2000).scene(0).unwrap()).unwrap();
    world.step.constants.dt = Drum::STEP;
    assert!(world.step.layout.boxes + world.step.layout.polygons > FEW_STATICS, "the plates are in the grid");
    let lists = [Phase::UpdateAabbs, Phase::BroadPhase].into_iter();
    let runs: Vec<Run> = lists.flat_map(|phase| phase.stages(Integrator::VelocityVerlet, BroadPhase::Grid)).copied().collect();
    let gpu = open();
    let mut device = GpuWorld::new(&gpu, &world).unwrap();
    device.run(&runs, &world.step, 1).unwrap();
    let status = block_on(gpu.device(), device.read_status()).unwrap();
    runs.iter().for_each(|run| run.on_cpu(&mut world));
    assert!(world.status.pair_rows_needed > 0, "{:?}", world.status);
    assert_eq!((status.rejected, status.pair_rows_needed), (0, world.status.pair_rows_needed));
}

#[test]
fn a_device_that_is_destroyed_is_an_error() {
    let gpu = open();
    let mut world = world(&heap(100));
    let mut device = GpuWorld::new(&gpu, &world).unwrap();
    let stages = step_stages(Integrator::Rk4);
    device.run(&stages, &world.step, 10).unwrap();
    gpu.device().destroy();
    let read = block_on(gpu.device(), device.read_status());
    assert!(matches!(read, Err(Error::Device(_))), "{read:?}");
    let read = block_on(gpu.device(), device.download(&mut world, &[Buffer::Start]));
    assert!(matches!(read, Err(Error::Device(_))), "{read:?}");
    let run = device.run(&stages, &world.step, 1);
    assert!(matches!(run, Err(Error::Device(_))), "{run:?}");
    assert!(matches!(GpuWorld::new(&gpu, &world), Err(Error::Device(_))));
}

#[test]
fn a_caller_s_device_that_is_destroyed_is_an_error() {
    let opened = open();
    let gpu = Gpu::on_device(opened.device().clone(), opened.queue().clone());
    let world = world(&heap(10));
    let mut device = GpuWorld::new(&gpu, &world).unwrap();
    device.run(&step_stages(Integrator::Rk4), &world.step, 10).unwrap();
    gpu.device().destroy();
    let run = device.run(&step_stages(Integrator::Rk4), &world.step, 10);
    let read = block_on(gpu.device(), device.read_status());
    assert!(matches!(read, Err(Error::Device(_))), "{read:?}");
    assert!(matches!(run, Ok(()) | Err(Error::Device(_))), "{run:?}");
}

#[test]
fn a_read_of_a_device_that_is_destroyed_ends_with_an_error() {
    let gpu = open();
    let world = world(&heap(100));
    let mut device = GpuWorld::new(&gpu, &world).unwrap();
    device.run(&step_stages(Integrator::Rk4), &world.step, 200).unwrap();
    let mut read = pin!(device.read_status());
    // The call returns at once, although the answer is not there yet.
    let first = read.as_mut().poll(&mut Context::from_waker(Waker::noop()));
    assert!(matches!(first, Poll::Pending));
    gpu.device().destroy();
    let answer = block_on(gpu.device(), read);
    assert!(matches!(answer, Err(Error::Device(_))), "{answer:?}");
}

#[test]
fn arrays_that_do_not_fit_are_rejected_before_allocation() {
    // The smallest limits that WebGPU guarantees. On some devices the arrays would fit.
    let (device, queue) = device::device(|limits| {
        limits.max_storage_buffer_binding_size = 128 << 20;
        limits.max_storage_buffers_per_shader_stage = 8;
    });
    let gpu = Gpu::on_device(device, queue);
    let mut world = world(&heap(10));
    // 16 GiB of list entries. The host does not allocate them.
    world.step.layout.pair_rows = 1 << 27;
    let refused = GpuWorld::new(&gpu, &world).map(|_| ());
    assert!(matches!(refused, Err(Error::DeviceLimit { what: "the pair lists", .. })), "{refused:?}");
}

#[test]
fn indices_out_of_range_are_rejected() {
    let gpu = open();
    let mut world = world(&heap(10));
    world.topology[world.step.layout.rods_at as usize] = world.step.layout.spheres;
    let refused = GpuWorld::new(&gpu, &world).map(|_| ());
    assert!(matches!(&refused, Err(Error::Device(text)) if text.contains("rod")), "{refused:?}");
    let mut world = self::world(&heap(10));
    world.step.layout.large = world.step.layout.spheres + 1;
    let refused = GpuWorld::new(&gpu, &world).map(|_| ());
    assert!(matches!(&refused, Err(Error::Device(text)) if text.contains("large")), "{refused:?}");
}

#[test]
fn a_run_does_not_change_the_counts_of_a_world() {
    let gpu = open();
    let world = world(&heap(10));
    let mut device = GpuWorld::new(&gpu, &world).unwrap();
    let mut step = world.step;
    step.layout.spheres += 1000;
    step.constants.dt = 0.01;
    device.run(&step_stages(Integrator::Rk4), &step, 1).unwrap();
    assert_eq!(device.step().layout.spheres, world.step.layout.spheres);
    assert_eq!(device.step().constants.dt, 0.01);
}

#[test]
fn an_empty_world_runs() {
    let gpu = open();
    let world = world(&Scene::new());
    let mut device = GpuWorld::new(&gpu, &world).unwrap();
    device.run(&step_stages(Integrator::Rk4), &world.step, 2).unwrap();
    let status = block_on(gpu.device(), device.read_status()).unwrap();
    assert_eq!((status.rejected, status.steps), (0, 2));
}

#[test]
fn a_compile_error_names_the_file_and_line_of_the_kernel() {
    use rockfall::step::catalog::ALL;
    use rockfall::step::stage::Stage;
    use rockfall::step::wgsl::Wgsl;
    let gpu = open();
    let world = world(&heap(10));
    let mut device = GpuWorld::new(&gpu, &world).unwrap();
    let original = ALL.into_iter().find(|stage| stage.name == "turn").unwrap();
    let mut parts = original.parts();
    let last = parts.last_mut().unwrap();
    last.text = format!("{}\nfn broken() -> u32 {{ return 1.5; }}\n", last.text.trim_end()).leak();
    let line = last.text.lines().count();
    let stage = Box::leak(Box::new(Stage { wgsl: Wgsl::Parts(parts.leak()), ..*original }));
    let refused = device.prepare(&[Run { stage, pass: 0, when: rockfall::step::schedule::When::Always, every: 1 }]);
    let Err(Error::Device(text)) = refused else {
        panic!("{refused:?}");
    };
    assert!(text.contains(&format!("step/integrate/turn.wgsl:{line}")), "{text}");
}

/// The test counts allocations on the device. The memory of the process would be misleading, because lavapipe (Mesa
/// 22.3) keeps about 0.5 MB per step until the device is dropped.
#[test]
fn many_steps_do_not_add_allocations_on_the_device() {
    let mut simulation = Simulation::with_options(heap(20), Options::new().backend(Backend::Gpu)).unwrap();
    let allocated = [200, 800].map(|steps| {
        while simulation.report().steps < steps {
            simulation.run(50, 0.005).unwrap();
            simulation.energy().unwrap();
        }
        let report = simulation.gpu_view().unwrap().gpu().device().generate_allocator_report();
        let report = report.expect("the backend must report its allocations, as Vulkan and DX12 do");
        (report.allocations.len(), report.total_allocated_bytes)
    });
    assert!(allocated[0].0 > 10, "{allocated:?}");
    assert_eq!(allocated[0], allocated[1], "number and bytes of allocations");
}
