//! A device that has no memory left: an error that says what to do, and what is there already goes on. A test of its own, for
//! it leaves the whole process without.

#![cfg(all(feature = "gpu", target_os = "linux"))]

#[path = "common/device.rs"]
mod device;

use rockfall::{Error, Options, Scene, Simulation, Sphere};

/// What is left to the process, for what else the driver needs.
const ROOM: u64 = 256 << 20;
/// Words of lists: 1 GiB, which stands on the device alone.
const LISTS: u32 = 1 << 28;

fn scene() -> Scene {
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([0.0; 3], 0.5)).unwrap();
    scene
}

/// Bytes of addresses that the process has taken.
fn taken() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmSize:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<u64>().unwrap() * 1024
}

/// Lets the process have so many bytes of addresses.
fn allow(bytes: &str) {
    let process = std::process::id().to_string();
    let limit = format!("--as={bytes}:");
    let done = std::process::Command::new("prlimit").args(["--pid", &process, &limit]).status();
    assert!(done.expect("prlimit, of util-linux").success(), "{limit}");
}

/// A software adapter takes its memory from the process, whose share can be limited; that of a card cannot.
#[test]
fn memory_that_a_device_does_not_have_is_told() {
    let device = device::device(|_| {});
    let adapter = device.0.adapter_info();
    if adapter.device_type != wgpu::DeviceType::Cpu {
        println!("NOT TESTED: {} has memory of its own, which nothing here can take away", adapter.name);
        return;
    }
    let open = |words| Simulation::on_device(scene(), Options::new().pair_capacity(words), &device.0, &device.1);
    let mut simulation = open(1 << 10).unwrap();
    simulation.run(2, 0.01).unwrap();

    allow(&(taken() + ROOM).to_string());
    let refused = open(LISTS).map(|_| ());
    allow("unlimited");
    let Err(Error::Device(text)) = refused else { panic!("{refused:?}") };
    for words in ["out of memory", "fewer objects", "--backend cpu"] {
        assert!(text.contains(words), "{text}");
    }

    simulation.run(2, 0.01).unwrap();
    assert_eq!(simulation.report().steps, 4);
    drop(simulation);
    open(LISTS).expect("there is room again");
}
