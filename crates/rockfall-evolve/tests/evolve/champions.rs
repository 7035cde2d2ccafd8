//! The creatures in scenes/creatures walk the distance that their comments claim, also at smaller time steps and with disturbed starts.

use std::path::{Path, PathBuf};

use crate::common::{distance, distance_after};
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;
use rockfall::glam::Vec3;
use rockfall::{Scene, Simulation};

/// Share of the distance that must remain.
const KEPT: f64 = 0.7;

/// The creatures, with the distances that they claim, in units.
fn creatures() -> Vec<(PathBuf, Scene, f64)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/creatures");
    let creature = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let claimed = text.lines().nth(1).unwrap().split(" moves ").nth(1).unwrap();
        let claimed: f64 = claimed.split(' ').next().unwrap().parse().unwrap();
        let scene = Scene::parse(&text, &path).unwrap().scene;
        (path, scene, claimed)
    };
    let found: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| creature(entry.unwrap().path())).collect();
    assert_eq!(found.len(), 5);
    found
}

/// Moves every sphere by up to 0.0001 units along each axis, and not down.
fn disturb(simulation: &mut Simulation, seed: u64) {
    let mut random = Pcg64::seed_from_u64(seed);
    let spheres: Vec<_> = simulation.scene().sphere_ids().collect();
    for id in spheres {
        let offset = [-1e-4, 0.0, -1e-4].map(|least: f32| random.random_range(least..=1e-4));
        let position = simulation.scene().sphere(id).unwrap().position + Vec3::from_array(offset);
        simulation.set_position(id, position).unwrap();
    }
}

#[test]
fn creatures_walk_as_far_as_they_claim_also_at_smaller_time_steps() {
    for (path, scene, claimed) in creatures() {
        let walked = distance(&scene, 0.005, 400, 2000);
        assert!((walked / claimed - 1.0).abs() < 0.01, "{}: {walked}, claimed {claimed}", path.display());
        for parts in [2_u16, 4, 8] {
            let (dt, steps) = (0.005 / f32::from(parts), u64::from(parts));
            let finer = distance(&scene, dt, 400 * steps, 2000 * steps);
            assert!(finer > KEPT * claimed, "{}: {finer} at dt {dt}, claimed {claimed}", path.display());
        }
    }
}

/// These starts are not those of the audit.
#[test]
fn creatures_walk_as_far_as_they_claim_also_with_disturbed_starts() {
    for (path, scene, claimed) in creatures() {
        for (seed, parts) in (100..).zip([1_u16, 1, 1, 1, 2, 2, 4, 4]) {
            let (dt, steps) = (0.005 / f32::from(parts), u64::from(parts));
            let start = |simulation: &mut Simulation| disturb(simulation, seed);
            let walked = distance_after(&scene, start, dt, 400 * steps, 2000 * steps);
            assert!(walked > KEPT * claimed, "{}: {walked} at dt {dt}, seed {seed}, claimed {claimed}", path.display());
        }
    }
}
