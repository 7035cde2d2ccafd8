//! Long runs do not take more and more memory. A test binary of its own, so that no other test's memory is measured.
#![cfg(target_os = "linux")]

use rockfall::{Backend, Options, Scene, Simulation, Sphere, Spring};

#[macro_use]
mod common;

use common::*;

/// Memory of this process that is in use, in KiB.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).expect("a line");
    line.split_whitespace().nth(1).and_then(|kib| kib.parse().ok()).expect("a number")
}

/// Two bodies on a spring over a floor that they hit again and again.
fn two_bodies() -> Scene {
    let mut scene = with(|settings| settings.restitution = 1.0);
    floor_box(&mut scene);
    let [a, b] = spheres(&mut scene, [Sphere::new([0.0, 1.0, 0.0], 0.5), Sphere::new([0.3, 2.5, 0.0], 0.5)]);
    scene.add_spring(Spring::new(a, b, 20.0, 1.5)).expect("a valid spring");
    scene
}

/// A leak of one small allocation a step, 16 bytes at least, would be 14 MB over 900,000 steps.
fn memory_stays(backend: Backend) {
    let (first, last, allowed) = on(backend, (100_000, 1_000_000, 4 << 10), (300, 3_000, 8 << 10));
    let mut simulation = Simulation::with_options(two_bodies(), Options::new().backend(backend)).expect("it opens");
    // In pieces as the command line does it, with the reads that a trace makes.
    let mut advance = |until: u64| {
        while simulation.report().steps < until {
            simulation.run(100, 0.01).expect("steps");
            simulation.energy().expect("energies");
        }
        (resident(), simulation.report())
    };
    let (before, _) = advance(first);
    let (after, report) = advance(last);
    println!("{backend}: {before} KiB after {first} steps, {after} KiB after {last}");
    assert!(report.total_collisions > 50, "{report:?}");
    assert!(after < before + allowed, "{before} KiB after {first} steps, {after} KiB after {last}");
}

/// One after the other: they would see each other's memory.
#[test]
fn memory_stays_the_same_over_many_steps() {
    memory_stays(Backend::Cpu);
    #[cfg(feature = "gpu")]
    memory_stays(Backend::Gpu);
}
