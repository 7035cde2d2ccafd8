//! Devices that are too small or lost: an error that says what to do, and nothing that panics. (`memory.rs` has one without memory.)

#![cfg(feature = "gpu")]

mod common;

use common::device::device;
use rockfall::{BroadPhase, Error, Options, Result, Scene, Simulation, Sphere};

/// Balls that all touch each other.
fn heap(count: u16) -> Scene {
    let mut scene = Scene::new();
    for k in 0..count {
        scene.add_sphere(Sphere::new([0.001 * f32::from(k), 0.0, 0.0], 5.0)).unwrap();
    }
    scene
}

fn open(scene: Scene, device: &(wgpu::Device, wgpu::Queue)) -> Result<Simulation> {
    Simulation::on_device(scene, Options::new().broad_phase(BroadPhase::BruteForce), &device.0, &device.1)
}

/// The message of a failure that names these words and what to do.
#[track_caller]
fn is_told<T>(result: Result<T>, words: &[&str]) {
    let error = result.err().expect("it must fail");
    let known = matches!(error, Error::Device(_) | Error::DeviceLimit { .. } | Error::NoAdapter(_));
    let text = error.to_string();
    assert!(known && words.iter().all(|word| text.contains(word)), "{text}");
    assert!(text.contains("--backend cpu") || text.contains("the CPU backend"), "it does not say what to do: {text}");
}

#[test]
fn limits_that_are_too_low_are_named() {
    let device = device(|limits| limits.max_storage_buffers_per_shader_stage = 4);
    is_told(open(heap(10), &device), &["max_storage_buffers_per_shader_stage is 4", "needs 8"]);
}

#[test]
fn a_scene_that_is_larger_than_the_device_allows_is_refused() {
    // No room for more bindings than the arrays have.
    let device = device(|limits| {
        limits.max_storage_buffer_binding_size = 1 << 16;
        limits.max_storage_buffers_per_shader_stage = 8;
    });
    let told = ["the scene does not fit", "the pair lists", "65536", "max_storage_buffers_per_shader_stage"];
    is_told(open(heap(3000), &device), &told);
}

/// The lists of 32 balls fit, those of 600 that all meet do not: 600 x 600 entries of 4 bytes.
#[test]
fn lists_that_outgrow_the_device_leave_the_bodies_as_they_were() {
    let device = device(|limits| {
        limits.max_storage_buffer_binding_size = 1 << 18;
        limits.max_storage_buffers_per_shader_stage = 8;
    });
    let mut simulation = open(heap(600), &device).unwrap();
    let before = simulation.spheres().unwrap();
    is_told(simulation.run(3, 0.01), &["the pair lists", "262144"]);
    assert_eq!(simulation.report().steps, 0);
    assert_eq!(simulation.spheres().unwrap(), before);
    // With fewer of them it goes on.
    let ids: Vec<_> = simulation.scene().sphere_ids().skip(20).collect();
    for id in ids {
        simulation.remove_sphere(id).unwrap();
    }
    simulation.run(3, 0.01).unwrap();
    assert_eq!(simulation.report().steps, 3);
}

#[test]
fn the_loss_of_a_caller_s_device_is_told() {
    let device = device(|_| {});
    let mut simulation = open(heap(10), &device).unwrap();
    simulation.run(2, 0.01).unwrap();
    device.0.destroy();
    is_told(simulation.run(2, 0.01), &["the device was lost"]);
    is_told(simulation.spheres(), &["the device was lost"]);
    is_told(open(heap(10), &device), &["the device was lost"]);
}

#[test]
fn the_loss_of_the_library_s_own_device_is_told() {
    let options = Options::new().backend(rockfall::Backend::Gpu);
    let mut simulation = Simulation::with_options(heap(10), options).unwrap();
    simulation.run(2, 0.01).unwrap();
    simulation.gpu_view().unwrap().gpu().device().destroy();
    is_told(simulation.run(2, 0.01), &["the device was lost"]);
    is_told(simulation.spheres(), &["the device was lost"]);
    let ball = simulation.scene().sphere_ids().next().unwrap();
    simulation.set_velocity(ball, [1.0, 0.0, 0.0]).unwrap();
    is_told(simulation.sync().map(|_| ()), &["the device was lost"]);
}
