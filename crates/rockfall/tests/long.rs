//! Long runs do not use more and more memory. This is a test binary of its own, so that only its own memory is
//! measured.
#![cfg(target_os = "linux")]

use rockfall::{Backend, Options, Scene, Simulation, Sphere, Spring};

mod common;

use common::*;

/// Resident memory of this process in KiB.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("/proc/self/status");
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).expect("a line");
    line.split_whitespace().nth(1).and_then(|kib| kib.parse().ok()).expect("a number")
}

/// Two bodies on a spring above a floor that they hit repeatedly. They never come to rest.
fn two_bodies() -> Scene {
    let mut scene = with(|settings| {
        (settings.restitution, settings.contact_damping, settings.friction) = (1.0, 0.0, 0.0);
    });
    floor_box(&mut scene);
    let [a, b] = spheres(&mut scene, [Sphere::new([0.0, 1.0, 0.0], 0.5), Sphere::new([0.3, 2.5, 0.0], 0.5)]);
    scene.add_spring(Spring::new(a, b, 20.0, 1.5)).expect("a valid spring");
    scene
}

/// Runs in portions and reads energies, as the command line does.
fn advance(simulation: &mut Simulation, until: u64) {
    while simulation.report().steps < until {
        simulation.run(100, 0.01).expect("steps");
        simulation.energy().expect("energies");
    }
}

/// A leak of one small allocation per step, at least 16 bytes, would be 14 MB over 900,000 steps.
#[test]
fn a_million_steps_use_no_more_memory_than_a_hundred_thousand() {
    let mut simulation = Simulation::with_options(two_bodies(), Options::new().backend(Backend::Cpu)).expect("it opens");
    // With two bodies, more threads would only wait for each other.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let [before, after] = [100_000, 1_000_000].map(|steps| {
        pool.install(|| advance(&mut simulation, steps));
        resident()
    });
    println!("{before} KiB after 100,000 steps, {after} KiB after 1,000,000");
    assert!(simulation.report().total_collisions > 1_000, "{:?}", simulation.report());
    assert!(after < before + (4 << 10), "{before} KiB after 100,000 steps, {after} KiB after 1,000,000");
}
