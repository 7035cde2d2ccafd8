//! The creatures in scenes/creatures walk the distance that their comments claim.

mod common;

use std::path::Path;

use common::distance;
use rockfall::Scene;

#[test]
fn creatures_walk_as_far_as_they_claim_also_at_half_the_time_step() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/creatures");
    let mut found = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let claimed = text.lines().nth(1).unwrap().split(" moves ").nth(1).unwrap();
        let claimed: f64 = claimed.split(' ').next().unwrap().parse().unwrap();
        let scene = Scene::parse(&text, &path).unwrap().scene;
        let walked = distance(&scene, 0.005, 400, 2000);
        assert!((walked / claimed - 1.0).abs() < 0.01, "{}: {walked}, claimed {claimed}", path.display());
        let finer = distance(&scene, 0.0025, 800, 4000);
        assert!(finer > 0.7 * claimed, "{}: {finer} at half the time step, claimed {claimed}", path.display());
        found += 1;
    }
    assert_eq!(found, 5);
}
