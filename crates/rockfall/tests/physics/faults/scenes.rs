//! Scenes from text, and sums over their spheres.

use std::path::Path;

use rockfall::glam::DVec3;
use rockfall::{Backend, Integrator, Options, Scene, Simulation, SphereState};

/// Parses a scene in the text format.
pub(crate) fn scene(text: &str) -> Scene {
    Scene::parse(text, Path::new("inline")).expect("a valid scene").scene
}

pub(crate) fn open(text: &str, backend: Backend) -> Simulation {
    opened(scene(text), backend, Integrator::Rk4)
}

pub(crate) fn opened(scene: Scene, backend: Backend, integrator: Integrator) -> Simulation {
    Simulation::with_options(scene, Options::new().backend(backend).integrator(integrator)).expect("the simulation opens")
}

fn moving(spheres: &[SphereState]) -> impl Iterator<Item = &SphereState> {
    spheres.iter().filter(|sphere| !sphere.fixed)
}

/// Kinetic energy, including that of the spins.
pub(crate) fn kinetic(spheres: &[SphereState]) -> f64 {
    let of = |sphere: &SphereState| {
        let (mass, radius) = (f64::from(sphere.mass), f64::from(sphere.radius));
        let spin = sphere.angular_momentum.as_dvec3();
        0.5 * mass * sphere.velocity.as_dvec3().length_squared() + 0.5 * spin.length_squared() / (0.4 * mass * radius * radius)
    };
    moving(spheres).map(of).sum()
}

/// Angular momentum about the origin.
pub(crate) fn angular(spheres: &[SphereState]) -> DVec3 {
    let of = |sphere: &SphereState| {
        f64::from(sphere.mass) * sphere.position.as_dvec3().cross(sphere.velocity.as_dvec3())
            + sphere.angular_momentum.as_dvec3()
    };
    moving(spheres).map(of).sum()
}

/// Energy of the spheres in gravity G along -y, with heights measured from `ground`.
pub(crate) fn in_gravity(spheres: &[SphereState], gravity: f64, ground: f64) -> f64 {
    let height = |sphere: &SphereState| f64::from(sphere.mass) * gravity * (f64::from(sphere.position.y) - ground);
    kinetic(spheres) + moving(spheres).map(height).sum::<f64>()
}

/// Runs a number of steps and returns the spheres.
pub(crate) fn after(simulation: &mut Simulation, steps: u64, dt: f32) -> Vec<SphereState> {
    simulation.run(steps, dt).expect("steps");
    simulation.spheres().expect("spheres are read back")
}

#[track_caller]
pub(crate) fn within(actual: f64, expected: f64, part: f64, what: &str) {
    assert!((actual - expected).abs() <= part * expected.abs(), "{what}: {actual}, expected {expected} within {part} of it");
}

/// Random numbers that are the same in every run.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns the next number between `low` and `high` (SplitMix64).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * unit
    }
}
