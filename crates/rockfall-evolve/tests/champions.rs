//! The creatures in scenes/creatures walk the distance that their comments claim.

use std::path::Path;

use rockfall::glam::DVec3;
use rockfall::{Backend, Options, Scene, Simulation};

/// Distance of the centre along the ground between two times, in s.
fn distance(scene: &Scene, dt: f32, from: f64, to: f64) -> f64 {
    let mut simulation = Simulation::with_options(scene.clone(), Options::new().backend(Backend::Cpu)).unwrap();
    let steps = |time: f64| (time / f64::from(dt)).round() as u64;
    let centre = |simulation: &mut Simulation| {
        let states = simulation.spheres().unwrap();
        states.iter().map(|state| state.position.as_dvec3()).sum::<DVec3>() / states.len() as f64
    };
    simulation.run(steps(from), dt).unwrap();
    let start = centre(&mut simulation);
    simulation.run(steps(to) - steps(from), dt).unwrap();
    let way = centre(&mut simulation) - start;
    way.x.hypot(way.z)
}

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
        let walked = distance(&scene, 0.005, 2.0, 10.0);
        assert!((walked / claimed - 1.0).abs() < 0.01, "{}: {walked}, claimed {claimed}", path.display());
        let finer = distance(&scene, 0.0025, 2.0, 10.0);
        assert!(finer > 0.7 * claimed, "{}: {finer} at half the time step, claimed {claimed}", path.display());
        found += 1;
    }
    assert_eq!(found, 5);
}
