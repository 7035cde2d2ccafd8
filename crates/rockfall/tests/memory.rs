//! A device without free memory: the error says what to do, and simulations that are already open continue. This is a
//! test binary of its own, because the test leaves the whole process without memory.

#![cfg(all(feature = "gpu", target_os = "linux"))]

#[path = "common/device.rs"]
mod device;

use rockfall::{Error, Options, Scene, Simulation, Sphere};

/// Bytes left to the process for other needs of the driver.
const ROOM: u64 = 256 << 20;
/// Words of list entries: 1 GiB, which is allocated on the device only.
const LISTS: u32 = 1 << 28;

fn scene() -> Scene {
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([0.0; 3], 0.5)).unwrap();
    scene
}

/// Size of the address space of the process in bytes.
fn address_space() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmSize:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<u64>().unwrap() * 1024
}

/// Limits the address space of the process to a number of bytes.
fn allow(bytes: &str) {
    let process = std::process::id().to_string();
    let limit = format!("--as={bytes}:");
    let done = std::process::Command::new("prlimit").args(["--pid", &process, &limit]).status();
    assert!(done.expect("prlimit, of util-linux").success(), "{limit}");
}

/// A software adapter allocates in the process, so its memory can be limited. That of a graphics card cannot.
#[test]
fn a_device_without_memory_is_reported() {
    let device = device::device(|_| {});
    let adapter = device.0.adapter_info();
    if adapter.device_type != wgpu::DeviceType::Cpu {
        println!("NOT TESTED: {} has its own memory, which this test cannot limit", adapter.name);
        return;
    }
    let open = |words| Simulation::on_device(scene(), Options::new().pair_capacity(words), &device.0, &device.1);
    let mut simulation = open(1 << 10).unwrap();
    simulation.run(2, 0.01).unwrap();

    allow(&(address_space() + ROOM).to_string());
    let refused = open(LISTS).map(|_| ());
    allow("unlimited");
    let Err(Error::Device(text)) = refused else { panic!("{refused:?}") };
    for words in ["out of memory", "fewer objects", "--backend cpu"] {
        assert!(text.contains(words), "{text}");
    }

    simulation.run(2, 0.01).unwrap();
    assert_eq!(simulation.report().steps, 4);
    drop(simulation);
    open(LISTS).expect("there is memory again");
}
