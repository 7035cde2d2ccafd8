//! Random bodies, and sums over them.

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestCaseError, TestRng, TestRunner};
use rockfall::{Backend, Capsule, Options, Rod, Scene, Simulation, Sphere, SphereId, SphereState};

pub(crate) type Outcome = Result<(), TestCaseError>;

/// Tests a property on cases that are the same every time. Nothing is written to disk.
pub(crate) fn check<S: Strategy>(cases: u32, strategy: S, property: impl Fn(S::Value) -> Outcome) {
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let result = TestRunner::new_with_rng(config, rng).run(&strategy, property);
    if let Err(error) = result {
        panic!("{error}");
    }
}

pub(crate) fn vector(size: f32) -> impl Strategy<Value = Vec3> {
    [-size..size, -size..size, -size..size].prop_map(Vec3::from_array)
}

pub(crate) fn direction() -> impl Strategy<Value = Vec3> {
    vector(1.0).prop_filter("a direction", |v| (0.1..1.0).contains(&v.length())).prop_map(Vec3::normalize)
}

/// A sphere within `spread` of the origin whose velocity components are at most `speed`.
pub(crate) fn ball(spread: f32, speed: f32) -> impl Strategy<Value = Sphere> {
    let state = (vector(spread), vector(speed), vector(4.0));
    (state, 0.3_f32..4.0, 0.25_f32..0.6).prop_map(|((place, velocity, spin), mass, radius)| {
        let sphere = Sphere::new(place, radius).mass(mass).velocity(velocity);
        sphere.angular_momentum(spin * sphere.inertia())
    })
}

/// A random body: a sphere, a rod or a capsule.
#[derive(Clone, Debug)]
pub(crate) enum Thing {
    Sphere(Sphere),
    Rod { ends: [Sphere; 2], radius: f32, fixed: bool },
    Capsule { capsule: Capsule, spins: [Vec3; 2], turning: Vec3 },
}

pub(crate) fn rod(spread: f32, speed: f32, fixed: bool) -> impl Strategy<Value = Thing> {
    let ends = (ball(spread, speed), direction(), 0.7_f32..1.8, vector(speed));
    (ends, 0.15_f32..0.3).prop_map(move |((one, direction, length, velocity), radius)| {
        let mut other = one.velocity(velocity).angular_momentum(0.5 * one.angular_momentum.turned());
        other.position += length * direction;
        let mut ends = [one, other];
        ends.iter_mut().for_each(|end| end.radius *= 0.5);
        Thing::Rod { ends, radius, fixed }
    })
}

/// Returns another vector of the same length.
trait Turned {
    fn turned(self) -> Self;
}

impl Turned for Vec3 {
    fn turned(self) -> Self {
        Self::new(self.y, -self.x, self.z)
    }
}

pub(crate) fn capsule(spread: f32, speed: f32) -> impl Strategy<Value = Thing> {
    let place = (vector(spread), direction(), 0.5_f32..1.5, 0.2_f32..0.4);
    let motion = (0.3_f32..4.0, vector(speed), vector(0.05), vector(0.05), vector(speed));
    (place, motion).prop_map(|((end, axis, length, radius), (mass, velocity, spin1, spin2, turning))| Thing::Capsule {
        capsule: Capsule::new(end, end + length * axis, radius).mass(mass).velocity(velocity),
        spins: [spin1, spin2],
        turning: turning - turning.dot(axis) * axis,
    })
}

pub(crate) fn thing(spread: f32, speed: f32) -> impl Strategy<Value = Thing> {
    prop_oneof![
        3 => ball(spread, speed).prop_map(Thing::Sphere),
        1 => rod(spread, speed, true),
        1 => rod(spread, speed, false),
        2 => capsule(spread, speed),
    ]
}

impl Thing {
    /// Adds the body and returns its spheres.
    pub(crate) fn add(&self, scene: &mut Scene) -> Vec<SphereId> {
        match self {
            Self::Sphere(sphere) => vec![scene.add_sphere(*sphere).unwrap()],
            Self::Rod { ends, radius, fixed } => {
                let ids = ends.map(|end| scene.add_sphere(end).unwrap());
                let rod = Rod::new(ids[0], ids[1], *radius);
                let length = ends[0].position.distance(ends[1].position);
                scene.add_rod(if *fixed { rod.length(length) } else { rod }).unwrap();
                ids.to_vec()
            }
            // A capsule is added as two spheres and a rod, so that its ends may have different velocities and spins.
            Self::Capsule { capsule, spins, turning } => {
                let end = |place, sign: f32, spin| {
                    let velocity = capsule.velocity + sign * *turning;
                    let end = Sphere::new(place, capsule.radius).mass(0.5 * capsule.mass);
                    end.velocity(velocity).angular_momentum(spin)
                };
                let ends = [end(capsule.end1, -1.0, spins[0]), end(capsule.end2, 1.0, spins[1])];
                let (radius, fixed) = (capsule.radius, true);
                Self::Rod { ends, radius, fixed }.add(scene)
            }
        }
    }

    /// Changes every sphere of the body.
    pub(crate) fn map(&self, change: impl Fn(Sphere) -> Sphere) -> Self {
        let mut scene = Scene::new();
        self.add(&mut scene);
        let [one, other] = [0, 1].map(|k| change(scene.spheres()[k.min(scene.spheres().len() - 1)]));
        match scene.rods().first() {
            None => Self::Sphere(one),
            Some(rod) => Self::Rod { ends: [one, other], radius: rod.radius, fixed: rod.length.is_some() },
        }
    }
}

/// A scene without gravity.
pub(crate) fn weightless(things: &[Thing]) -> Scene {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    for thing in things {
        thing.add(&mut scene);
    }
    scene
}

pub(crate) fn simulation(scene: Scene, backend: Backend) -> Simulation {
    #[cfg(feature = "gpu")]
    let _device = rockfall::gpu::SharedDevice::new();
    Simulation::with_options(scene, Options::new().backend(backend))
        .expect("the simulation opens; the GPU backend needs an adapter such as lavapipe")
}

/// Sums over the moving spheres in f64, and sums of the magnitudes of the terms, which measure rounding errors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    pub(crate) momentum: DVec3,
    /// Sum of m x.
    pub(crate) centre: DVec3,
    pub(crate) angular: DVec3,
    /// Of the translation only.
    pub(crate) kinetic: f64,
    /// Of translation and rotation.
    pub(crate) energy: f64,
    pub(crate) momentum_size: f64,
    pub(crate) centre_size: f64,
    pub(crate) angular_size: f64,
}

pub(crate) fn sums(spheres: &[SphereState]) -> Sums {
    let mut all = Sums::default();
    for sphere in spheres.iter().filter(|sphere| !sphere.fixed) {
        let (m, x, v) = (f64::from(sphere.mass), sphere.position.as_dvec3(), sphere.velocity.as_dvec3());
        let spin = sphere.angular_momentum.as_dvec3();
        let inertia = 0.4 * m * f64::from(sphere.radius).powi(2);
        all.momentum += m * v;
        all.centre += m * x;
        all.angular += m * x.cross(v) + spin;
        all.kinetic += 0.5 * m * v.length_squared();
        all.energy += 0.5 * (m * v.length_squared() + spin.length_squared() / inertia);
        all.momentum_size += m * v.length();
        all.centre_size += m * x.length();
        all.angular_size += m * x.length() * v.length() + spin.length();
    }
    all
}
