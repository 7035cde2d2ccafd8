//! What the integration tests share.
//!
//! Every test is a function of a backend; `both!` makes a test of it for each. On the GPU a test fails where there is no
//! adapter: nothing is skipped.

#![allow(dead_code, unused_macros, reason = "every test binary uses a part of this")]

use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, Cuboid, Integrator, Options, Polygon, Rod, RodId, Scene, Settings, Simulation, Sphere, SphereId, SphereState,
};

#[cfg(feature = "gpu")]
pub(crate) mod device;
pub(crate) mod mixed;

/// Tests of all these functions of a backend, in the modules `cpu` and `gpu`. A function that is left out is dead code,
/// which the compiler tells.
macro_rules! both {
    ($($name:ident),* $(,)?) => {
        mod cpu {
            $(
                #[test]
                fn $name() {
                    super::$name(rockfall::Backend::Cpu);
                }
            )*
        }

        #[cfg(feature = "gpu")]
        mod gpu {
            $(
                #[test]
                fn $name() {
                    super::$name(rockfall::Backend::Gpu);
                }
            )*
        }
    };
}

/// A time step that is a power of two, so that it adds no rounding of its own.
pub(crate) const DT: f32 = 1.0 / 64.0;

/// Tolerance of velocities that f32 works out of numbers of the order of 1 in a dozen operations. The worst of them is a normal
/// made of a distance of 0.05 between coordinates up to 5, which round by 5e-7.
pub(crate) const F32: f64 = 3e-5;

/// Tolerance of displacements: the rounding of coordinates up to 5, and that of a normal times an overlap of 0.1.
pub(crate) const F32_PLACE: f64 = 2e-6;

/// For how long bodies have overlapped where a test is about a lone collision. It is handled as it was at its time of contact, so scenes are
/// built as they were then, and moved on with [`late`]; what changes by dv in velocity then stands `LATE` dv elsewhere.
pub(crate) const LATE: f32 = 1.0 / 128.0;

/// A sphere some time on.
pub(crate) fn late_by(sphere: Sphere, time: f32) -> Sphere {
    Sphere { position: sphere.position + time * sphere.velocity, ..sphere }
}

/// A sphere `LATE` on.
pub(crate) fn late(sphere: Sphere) -> Sphere {
    late_by(sphere, LATE)
}

/// So many changes of velocity as displacements of what has overlapped for a time.
pub(crate) fn over<const N: usize>(time: f32, changes: [[f64; 3]; N]) -> [[f64; 3]; N] {
    changes.map(|change| change.map(|k| f64::from(time) * k))
}

/// How many steps: software Vulkan takes some 50 ms a step, the CPU less than one.
pub(crate) fn on<T>(backend: Backend, cpu: T, gpu: T) -> T {
    if backend == Backend::Gpu { gpu } else { cpu }
}

/// An empty scene without gravity.
pub(crate) fn weightless() -> Scene {
    with(|settings| settings.gravity = 0.0)
}

/// An empty scene with changed settings.
pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> Scene {
    let mut scene = Scene::new();
    change(&mut scene.settings);
    scene
}

pub(crate) fn simulation(scene: Scene, backend: Backend) -> Simulation {
    Simulation::with_options(scene, Options::new().backend(backend)).expect("the simulation opens")
}

pub(crate) fn euler(scene: Scene, backend: Backend) -> Simulation {
    let options = Options::new().backend(backend).integrator(Integrator::SymplecticEuler);
    Simulation::with_options(scene, options).expect("the simulation opens")
}

/// Adds spheres; their handles.
pub(crate) fn spheres<const N: usize>(scene: &mut Scene, spheres: [Sphere; N]) -> [SphereId; N] {
    spheres.map(|sphere| scene.add_sphere(sphere).expect("a valid sphere"))
}

/// Adds a rod of free length and its two spheres.
pub(crate) fn rod(scene: &mut Scene, ends: [Sphere; 2], radius: f32) -> RodId {
    let [one, two] = spheres(scene, ends);
    scene.add_rod(Rod::new(one, two, radius)).expect("a valid rod")
}

/// Adds two spheres held at their distance by a rod.
pub(crate) fn dumbbell(scene: &mut Scene, ends: [Sphere; 2], radius: f32) -> RodId {
    let length = ends[0].position.distance(ends[1].position);
    let [one, two] = spheres(scene, ends);
    scene.add_rod(Rod::new(one, two, radius).length(length)).expect("a valid rod")
}

/// A box whose upper face is the plane y = 0, between -5 and 5.
pub(crate) fn floor_box(scene: &mut Scene) {
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])).expect("a valid box");
}

/// A polygon in the plane y = 0, between -5 and 5, that faces up.
pub(crate) fn floor_polygon(scene: &mut Scene) {
    scene.add_polygon(Polygon::new([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0])).expect("a valid polygon");
}

/// The spheres after phase 3 alone.
pub(crate) fn collide(scene: Scene, backend: Backend) -> Vec<SphereState> {
    let mut simulation = simulation(scene, backend);
    simulation.handle_collisions().expect("phase 3 runs");
    simulation.spheres().expect("spheres are read back")
}

/// What acts on a sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    pub(crate) force: DVec3,
    pub(crate) torque: DVec3,
}

/// Net force and torque on every sphere, from one step of symplectic Euler with collisions off:
/// v' = v + dt F/m and L' = L + dt T, without any error of integration.
pub(crate) fn loads(mut scene: Scene, backend: Backend) -> Vec<Load> {
    scene.settings.collisions = false;
    let before = scene.spheres().to_vec();
    let mut simulation = euler(scene, backend);
    simulation.step(DT).expect("a step");
    loads_between(&before, &simulation.spheres().expect("spheres are read back"))
}

/// Forces and torques from two states that lie `DT` apart.
pub(crate) fn loads_between(before: &[Sphere], after: &[SphereState]) -> Vec<Load> {
    let rate = |new: Vec3, old: Vec3| (new.as_dvec3() - old.as_dvec3()) / f64::from(DT);
    before
        .iter()
        .zip(after)
        .map(|(old, new)| Load {
            force: f64::from(old.mass) * rate(new.velocity, old.velocity),
            torque: rate(new.angular_momentum, old.angular_momentum),
        })
        .collect()
}

#[track_caller]
pub(crate) fn close(actual: impl Into<f64>, expected: f64, tolerance: f64, what: &str) {
    let actual = actual.into();
    assert!((actual - expected).abs() <= tolerance, "{what}: {actual}, expected {expected} within {tolerance}");
}

/// A vector of f32 or f64, to compare.
pub(crate) trait Vector {
    fn wide(self) -> DVec3;
}

impl Vector for Vec3 {
    fn wide(self) -> DVec3 {
        self.as_dvec3()
    }
}

impl Vector for DVec3 {
    fn wide(self) -> DVec3 {
        self
    }
}

#[track_caller]
pub(crate) fn near(actual: impl Vector, expected: impl Into<DVec3>, tolerance: f64, what: &str) {
    let (actual, expected) = (actual.wide(), expected.into());
    assert!((actual - expected).abs().max_element() <= tolerance, "{what}: {actual}, expected {expected} within {tolerance}");
}

/// Compares velocities of spheres, in order of addition.
#[track_caller]
pub(crate) fn velocities<const N: usize>(spheres: &[SphereState], expected: [[f64; 3]; N]) {
    assert_eq!(spheres.len(), N, "number of spheres");
    for (index, (sphere, expected)) in spheres.iter().zip(expected).enumerate() {
        near(sphere.velocity, expected, F32, &format!("velocity of sphere {index}"));
    }
}

/// Compares by how much spheres were moved.
#[track_caller]
pub(crate) fn displacements<const N: usize>(before: &[Sphere], spheres: &[SphereState], expected: [[f64; 3]; N]) {
    assert_eq!(spheres.len(), N, "number of spheres");
    for (index, ((old, sphere), expected)) in before.iter().zip(spheres).zip(expected).enumerate() {
        let moved = sphere.position.as_dvec3() - old.position.as_dvec3();
        near(moved, expected, F32_PLACE, &format!("displacement of sphere {index}"));
    }
}

/// Asserts that phase 3 leaves a scene bit for bit as it is.
#[track_caller]
pub(crate) fn untouched(scene: Scene, backend: Backend) {
    let before: Vec<SphereState> = scene.spheres().iter().map(SphereState::from).collect();
    assert_eq!(collide(scene, backend), before, "phase 3 must not change this scene");
}

/// Asserts that bodies ignore each other: no collision, and no contact either (a force between two parts of one body would cancel, and
/// show in the count alone).
#[track_caller]
pub(crate) fn uncounted(scene: Scene, backend: Backend) {
    untouched(scene.clone(), backend);
    let report = simulation(scene, backend).step(DT).expect("a step");
    assert_eq!((report.contacts, report.collisions), (0, 0), "nothing may touch here");
}

/// Forces that were found, in order of addition of the spheres.
#[track_caller]
pub(crate) fn forces<const N: usize>(loads: &[Load], expected: [[f64; 3]; N], tolerance: f64) {
    assert_eq!(loads.len(), N, "number of spheres");
    for (index, (load, expected)) in loads.iter().zip(expected).enumerate() {
        near(load.force, expected, tolerance, &format!("force on sphere {index}"));
    }
}

/// Torques that were found, in order of addition of the spheres.
#[track_caller]
pub(crate) fn torques<const N: usize>(loads: &[Load], expected: [[f64; 3]; N], tolerance: f64) {
    assert_eq!(loads.len(), N, "number of spheres");
    for (index, (load, expected)) in loads.iter().zip(expected).enumerate() {
        near(load.torque, expected, tolerance, &format!("torque on sphere {index}"));
    }
}
