//! A short scene or a small file cannot take all memory, and a file of a stranger cannot make the engine compute nonsense.

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, Checkpoint, Error, Options, Scene, Simulation, Sphere};

use crate::common::*;

/// The error of the first step of spheres that are almost in one place, where every pair overlaps and approaches.
fn refused(spheres: usize, backend: Backend) -> (&'static str, u64, u64) {
    let mut scene = Scene::new();
    for sphere in 0..spheres {
        let place = Vec3::new((sphere % 20) as f32, (sphere / 20 % 20) as f32, (sphere / 400) as f32);
        scene.add_sphere(Sphere::new(0.001 * place, 0.1).velocity(-0.01 * place)).expect("a valid sphere");
    }
    let mut simulation = simulation(scene, backend);
    match simulation.run(1, 0.01) {
        Err(Error::DeviceLimit { what, needed, limit }) => (what, needed, limit),
        other => panic!("{other:?}"),
    }
}

/// Their pairs grow with the square of their number.
fn spheres_in_one_place_are_refused(backend: Backend) {
    let (what, needed, limit) = refused(4500, backend);
    assert_eq!((what, limit), ("the pair lists", 64 << 20));
    assert!(needed > limit, "{needed}");
    if backend == Backend::Gpu {
        // On the CPU the lists bound the collisions.
        let (what, needed, limit) = refused(2100, backend);
        assert_eq!((what, limit), ("the listed collisions", 192 << 20));
        assert!(needed > limit, "{needed}");
    }
}

both_in_turn! {
    spheres_in_one_place_are_refused,
}

/// The words of a small checkpoint, in which every number that is replaced occurs once.
fn replaced(from: &[u32], to: &[u32]) -> Result<Checkpoint, String> {
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([0.0; 3], 0.5).orientation(Quat::from_xyzw(0.5, -0.5, 0.5, -0.5))).expect("a sphere");
    let options = Options::new().backend(Backend::Cpu).pair_capacity(0xab_cde0);
    let mut simulation = Simulation::with_options(scene, options).expect("it opens");
    let mut bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    let [from, to] = [from, to].map(|words| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>());
    let places: Vec<usize> = (0..bytes.len()).filter(|place| bytes[*place..].starts_with(&from)).collect();
    let [place] = places[..] else { panic!("{places:?}") };
    bytes[place..place + to.len()].copy_from_slice(&to);
    let end = bytes.len() - 4;
    let crc32 = crc32fast::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(&crc32.to_le_bytes());
    Checkpoint::from_bytes(&bytes, "a.ckpt").map_err(|error| error.to_string())
}

#[test]
fn a_checkpoint_cannot_ask_for_all_memory() {
    replaced(&[0xab_cde0], &[1 << 24]).expect("64 MiB");
    let error = replaced(&[0xab_cde0], &[u32::MAX]).expect_err("16 GiB");
    assert!(error.contains("pair lists of 4294967295 words, expected at most 16777216"), "{error}");
    // The writer asks for no more than the reader allows.
    let mut checkpoint = replaced(&[0xab_cde0], &[1 << 24]).expect("64 MiB");
    checkpoint.options.pair_capacity = Some(u32::MAX);
    Checkpoint::from_bytes(&checkpoint.to_bytes(), "b.ckpt").expect("64 MiB");
}

#[test]
fn an_orientation_of_a_checkpoint_is_checked() {
    let turn = [0.5_f32, -0.5, 0.5, -0.5].map(f32::to_bits);
    replaced(&turn, &[1.0_f32, 0.0, 0.0, 0.0].map(f32::to_bits)).expect("a unit quaternion");
    for bad in [f32::NAN, f32::INFINITY, 3.0, 0.0] {
        let error = replaced(&turn, &[bad, 0.0, 0.0, 0.0].map(f32::to_bits)).expect_err("no orientation");
        assert!(error.contains("expected a unit quaternion"), "{error}");
    }
}
