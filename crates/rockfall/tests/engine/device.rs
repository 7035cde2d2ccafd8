//! Devices with low limits, and devices that are lost: the error says what to do, and nothing panics. (`memory.rs`
//! tests a device without memory.)

#![cfg(feature = "gpu")]

use crate::common::device::device;
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

/// Asserts that a result is an error of the device whose message contains these words and says what to do.
#[track_caller]
fn assert_device_error<T>(result: Result<T>, words: &[&str]) {
    let error = result.err().expect("the call must fail");
    let known = matches!(error, Error::Device(_) | Error::DeviceLimit { .. } | Error::NoAdapter(_));
    let text = error.to_string();
    assert!(known && words.iter().all(|word| text.contains(word)), "{text}");
    assert!(text.contains("--backend cpu") || text.contains("the CPU backend"), "the message does not say what to do: {text}");
}

#[test]
fn limits_that_are_too_low_are_named() {
    let device = device(|limits| limits.max_storage_buffers_per_shader_stage = 4);
    assert_device_error(open(heap(10), &device), &["max_storage_buffers_per_shader_stage is 4", "needs 8"]);
}

#[test]
fn a_scene_larger_than_the_device_allows_is_rejected() {
    // No bindings are left for more chunks.
    let device = device(|limits| {
        limits.max_storage_buffer_binding_size = 1 << 16;
        limits.max_storage_buffers_per_shader_stage = 8;
    });
    let words = ["the scene does not fit", "the pair lists", "65536", "max_storage_buffers_per_shader_stage"];
    assert_device_error(open(heap(3000), &device), &words);
}

/// The lists of 32 balls fit, those of 600 balls that all touch do not: 600 x 600 entries of 4 bytes.
#[test]
fn lists_that_outgrow_the_device_leave_the_state_unchanged() {
    let device = device(|limits| {
        limits.max_storage_buffer_binding_size = 1 << 18;
        limits.max_storage_buffers_per_shader_stage = 8;
    });
    let mut simulation = open(heap(600), &device).unwrap();
    let before = simulation.spheres().unwrap();
    assert_device_error(simulation.run(3, 0.01), &["the pair lists", "262144"]);
    assert_eq!(simulation.report().steps, 0);
    assert_eq!(simulation.spheres().unwrap(), before);
    // With fewer balls the simulation continues.
    let ids: Vec<_> = simulation.scene().sphere_ids().skip(20).collect();
    for id in ids {
        simulation.remove_sphere(id).unwrap();
    }
    simulation.run(3, 0.01).unwrap();
    assert_eq!(simulation.report().steps, 3);
}

#[test]
fn the_loss_of_a_caller_s_device_is_reported() {
    let device = device(|_| {});
    let mut simulation = open(heap(10), &device).unwrap();
    simulation.run(2, 0.01).unwrap();
    device.0.destroy();
    assert_device_error(simulation.run(2, 0.01), &["the device was lost"]);
    assert_device_error(simulation.spheres(), &["the device was lost"]);
    assert_device_error(open(heap(10), &device), &["the device was lost"]);
}

#[test]
fn the_loss_of_the_library_s_own_device_is_reported() {
    let options = Options::new().backend(rockfall::Backend::Gpu);
    let mut simulation = Simulation::with_options(heap(10), options).unwrap();
    simulation.run(2, 0.01).unwrap();
    simulation.gpu_view().unwrap().gpu().device().destroy();
    assert_device_error(simulation.run(2, 0.01), &["the device was lost"]);
    assert_device_error(simulation.spheres(), &["the device was lost"]);
    let ball = simulation.scene().sphere_ids().next().unwrap();
    simulation.set_velocity(ball, [1.0, 0.0, 0.0]).unwrap();
    assert_device_error(simulation.sync().map(|_| ()), &["the device was lost"]);
}
