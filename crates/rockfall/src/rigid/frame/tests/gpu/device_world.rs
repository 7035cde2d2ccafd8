//! A world on a device does what the twin does, from the search for contacts to what it remembers.

use super::super::colours::bond;
use super::super::scene::{DT, Scene};
use super::device::{apart, bits, open};
use super::{device, device_round};
use crate::rigid::frame::bodies_alone;
use crate::rigid::gpu::world::GpuWorld;

fn scenes() -> impl Iterator<Item = (&'static str, Scene, f32)> {
    device::scenes().into_iter().chain(device_round::scenes())
}

/// Whole frames, each from the state of the twin.
#[test]
fn worlds_agree() {
    let gpu = open();
    for (name, mut scene, seconds) in scenes() {
        scene.run(seconds);
        let (mut place, mut speed, before, mut repeats) = (0.0_f32, 0.0_f32, scene.repeats, 0);
        let mut on_device = GpuWorld::new(&gpu, &scene.world, &bodies_alone(&scene.world)).unwrap();
        for number in 0..8 {
            let mut other = scene.world.clone();
            on_device.put(&scene.world, &bodies_alone(&scene.world)).unwrap();
            let report = on_device.advance(DT, 4, true).unwrap();
            on_device.download(&mut other).unwrap();
            on_device.download_history(&mut other).unwrap();
            repeats += report.repeats;
            scene.step();
            let [one, two] = apart(&scene.world, &other);
            (place, speed) = (place.max(one), speed.max(two));
            let (twin, own) = (&scene.world.history, &other.history);
            if number < 3 {
                eprintln!(
                    "{name} {number}: {one:.1e} {two:.1e}, contacts {} {}, pairs {} {}, colours {} {}",
                    scene.last.contacts,
                    report.contacts,
                    twin.pairs.len(),
                    own.pairs.len(),
                    twin.colours.len(),
                    own.colours.iter().zip(&twin.colours).filter(|(a, b)| a == b).count(),
                );
            }
        }
        eprintln!("{name}: frames {place:.1e} apart, speeds {speed:.1e}, repeats {repeats} and {}", scene.repeats - before);
        // The points of a contact differ by their last bits, too.
        let (most, fastest) = match name {
            "great wall" => (1e-3, 5e-2),
            "elastic pile" => (1e-2, 1.0),
            // 1.1e-4 and 4.5e-3 on an H200.
            _ => (2e-4, 2e-2),
        };
        // A path may end at its margin up to rounding.
        let more = (scene.repeats - before).abs_diff(repeats);
        assert!(place < most && speed < fastest && more <= 1, "{name}");
    }
}

/// Two runs have the same bits, and so has a run that goes on from what another one has come to.
#[test]
fn runs_and_resumed_runs_have_the_same_bits() {
    let gpu = open();
    for (name, mut scene, seconds) in scenes() {
        scene.run(seconds);
        let run = |split: bool| {
            let mut world = scene.world.clone();
            let mut on_device = GpuWorld::new(&gpu, &world, &bodies_alone(&world)).unwrap();
            for _ in 0..5 {
                on_device.advance(DT, 4, true).unwrap();
                if split {
                    on_device.download(&mut world).unwrap();
                    on_device.download_history(&mut world).unwrap();
                    on_device.put(&world, &bodies_alone(&world)).unwrap();
                }
            }
            on_device.download(&mut world).unwrap();
            world
        };
        let one = run(false);
        assert!(bits(&one) == bits(&run(false)), "{name}: two runs");
        assert!(bits(&one) == bits(&run(true)), "{name}: resumed");
    }
}

/// Problem 52: the first frame gives the blocks of a great block of bricks the colours that the twin gives, and later frames keep them.
#[test]
fn colours_of_a_great_block_are_those_of_the_twin() {
    let gpu = open();
    let mut scene = bond(16);
    let mut other = scene.world.clone();
    let mut on_device = GpuWorld::new(&gpu, &other, &bodies_alone(&other)).unwrap();
    for frame in 0..2 {
        on_device.advance(DT, 4, true).unwrap();
        on_device.download_history(&mut other).unwrap();
        scene.step();
        assert!(scene.world.history.colours.len() > 10_000);
        assert!(scene.world.history.colours == other.history.colours, "frame {frame}");
    }
}
