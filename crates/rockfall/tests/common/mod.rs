//! Helpers shared by the integration tests.
//!
//! Every test is a function that takes a backend; `both!` instantiates it for each backend. Without a GPU adapter the
//! GPU tests fail; none is skipped.

#![allow(dead_code, unused_macros, reason = "each test program uses only a part of this module")]

use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, Cuboid, Integrator, Options, Polygon, Rod, RodId, Scene, Settings, Simulation, Sphere, SphereId, SphereState,
};

#[cfg(feature = "gpu")]
pub(crate) mod device;
pub(crate) mod mixed;

/// Instantiates test functions for both backends, in the modules `cpu` and `gpu`. All tests in modules `gpu` share one device and
/// its kernels. The compiler reports a function that is missing from the list as dead code.
macro_rules! both {
    ($($name:ident),* $(,)?) => {
        on_backends! { None, $($name),* }
    };
}

/// The same for tests that open many devices: those on the GPU run one after the other. Drivers can lock up when several threads open
/// and close devices at the same time.
macro_rules! both_in_turn {
    ($($name:ident),* $(,)?) => {
        on_backends! { Some(crate::common::turn()), $($name),* }
    };
}

/// Instantiates test functions for both backends. A test on the GPU holds `turn` while it runs.
macro_rules! on_backends {
    ($turn:expr, $($name:ident),*) => {
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
                    let _turn: Option<std::sync::MutexGuard<'static, ()>> = $turn;
                    let _device = rockfall::gpu::SharedDevice::new();
                    super::$name(rockfall::Backend::Gpu);
                }
            )*
        }
    };
}

/// The turn of a test that opens devices. It ends when this is dropped, after the devices.
pub(crate) fn turn() -> std::sync::MutexGuard<'static, ()> {
    static TURN: std::sync::Mutex<()> = std::sync::Mutex::new(());
    // A test that failed does not stop the others.
    TURN.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// All bits of the states of spheres.
pub(crate) fn bits(states: &[SphereState]) -> Vec<u32> {
    let of = |state: &SphereState| {
        let vectors = [state.position, state.position_low, state.velocity, state.angular_momentum];
        vectors.iter().flat_map(Vec3::to_array).chain(state.orientation.to_array()).map(f32::to_bits).collect::<Vec<_>>()
    };
    states.iter().flat_map(of).collect()
}

/// All bits of the states of the spheres of a simulation.
pub(crate) fn bits_of(simulation: &mut Simulation) -> Vec<u32> {
    bits(&simulation.spheres().expect("spheres are read back"))
}

/// A time step that is a power of two, so that it adds no rounding of its own.
pub(crate) const DT: f32 = 1.0 / 64.0;

/// Tolerance of velocities that are computed in f32 from numbers of the order of 1 in about a dozen operations. The
/// largest error is that of a normal computed from a distance of 0.05 between coordinates up to 5, which round by 5e-7.
pub(crate) const F32: f64 = 3e-5;

/// Tolerance of displacements: the rounding of coordinates up to 5, and that of a normal times an overlap of 0.1.
pub(crate) const F32_PLACE: f64 = 2e-6;

/// Time in seconds since first contact, in tests of a lone collision. A lone collision is computed at its time of
/// contact. So these tests build a scene at its time of contact and advance the bodies with [`late`]. A velocity change
/// dv then also displaces the body by `LATE` dv.
pub(crate) const LATE: f32 = 1.0 / 128.0;

/// Advances a sphere by a time at constant velocity.
pub(crate) fn late_by(mut sphere: Sphere, time: f32) -> Sphere {
    sphere.position += time * sphere.velocity;
    sphere
}

/// Advances a sphere by [`LATE`].
pub(crate) fn late(sphere: Sphere) -> Sphere {
    late_by(sphere, LATE)
}

/// Displacements that velocity changes cause over a time.
pub(crate) fn over<const N: usize>(time: f32, changes: [[f64; 3]; N]) -> [[f64; 3]; N] {
    changes.map(|change| change.map(|k| f64::from(time) * k))
}

/// Number of steps for a backend. A step takes about 50 ms on software Vulkan and less than 1 ms on the CPU backend.
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

/// Adds spheres and returns their handles.
pub(crate) fn spheres<const N: usize>(scene: &mut Scene, spheres: [Sphere; N]) -> [SphereId; N] {
    spheres.map(|sphere| scene.add_sphere(sphere).expect("a valid sphere"))
}

/// Adds a rod of free length and its two spheres.
pub(crate) fn rod(scene: &mut Scene, ends: [Sphere; 2], radius: f32) -> RodId {
    let [one, two] = spheres(scene, ends);
    scene.add_rod(Rod::new(one, two, radius)).expect("a valid rod")
}

/// Adds two spheres and a rod that keeps their distance.
pub(crate) fn dumbbell(scene: &mut Scene, ends: [Sphere; 2], radius: f32) -> RodId {
    let length = ends[0].position.distance(ends[1].position);
    let [one, two] = spheres(scene, ends);
    scene.add_rod(Rod::new(one, two, radius).length(length)).expect("a valid rod")
}

/// Adds a box whose upper face is the plane y = 0, from -5 to 5.
pub(crate) fn floor_box(scene: &mut Scene) {
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])).expect("a valid box");
}

/// Adds a polygon in the plane y = 0, from -5 to 5, that faces up.
pub(crate) fn floor_polygon(scene: &mut Scene) {
    scene.add_polygon(Polygon::new([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0])).expect("a valid polygon");
}

/// Runs phase 3 alone and returns the spheres.
pub(crate) fn collide(scene: Scene, backend: Backend) -> Vec<SphereState> {
    let mut simulation = simulation(scene, backend);
    simulation.handle_collisions().expect("phase 3 runs");
    simulation.spheres().expect("spheres are read back")
}

/// Force and torque on a sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    pub(crate) force: DVec3,
    pub(crate) torque: DVec3,
}

/// Net force and torque on every sphere, measured from one step of symplectic Euler with collisions off: v' = v + dt
/// F/m and L' = L + dt T, without an integration error.
pub(crate) fn loads(mut scene: Scene, backend: Backend) -> Vec<Load> {
    scene.settings.collisions = false;
    let before = scene.spheres().to_vec();
    let mut simulation = euler(scene, backend);
    simulation.step(DT).expect("a step");
    loads_between(&before, &simulation.spheres().expect("spheres are read back"))
}

/// Forces and torques computed from two states that are `DT` apart.
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

/// A vector of f32 or of f64, for comparisons in f64.
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

/// Compares the velocities of spheres in insertion order.
#[track_caller]
pub(crate) fn velocities<const N: usize>(spheres: &[SphereState], expected: [[f64; 3]; N]) {
    assert_eq!(spheres.len(), N, "number of spheres");
    for (index, (sphere, expected)) in spheres.iter().zip(expected).enumerate() {
        near(sphere.velocity, expected, F32, &format!("velocity of sphere {index}"));
    }
}

/// Compares the displacements of spheres with expected ones.
#[track_caller]
pub(crate) fn displacements<const N: usize>(before: &[Sphere], spheres: &[SphereState], expected: [[f64; 3]; N]) {
    assert_eq!(spheres.len(), N, "number of spheres");
    for (index, ((old, sphere), expected)) in before.iter().zip(spheres).zip(expected).enumerate() {
        let moved = sphere.position.as_dvec3() - old.position.as_dvec3();
        near(moved, expected, F32_PLACE, &format!("displacement of sphere {index}"));
    }
}

/// Asserts that phase 3 leaves a scene bitwise unchanged.
#[track_caller]
pub(crate) fn untouched(scene: Scene, backend: Backend) {
    let before: Vec<SphereState> = scene.spheres().iter().map(SphereState::from).collect();
    assert_eq!(collide(scene, backend), before, "phase 3 must not change this scene");
}

/// Asserts that bodies ignore each other: no collision and no contact. The contact count is needed because forces
/// between two parts of one body would cancel.
#[track_caller]
pub(crate) fn uncounted(scene: Scene, backend: Backend) {
    untouched(scene.clone(), backend);
    let report = simulation(scene, backend).step(DT).expect("a step");
    assert_eq!((report.contacts, report.collisions), (0, 0), "nothing may touch here");
}

/// Compares measured forces on the spheres in insertion order.
#[track_caller]
pub(crate) fn forces<const N: usize>(loads: &[Load], expected: [[f64; 3]; N], tolerance: f64) {
    assert_eq!(loads.len(), N, "number of spheres");
    for (index, (load, expected)) in loads.iter().zip(expected).enumerate() {
        near(load.force, expected, tolerance, &format!("force on sphere {index}"));
    }
}

/// Compares measured torques on the spheres in insertion order.
#[track_caller]
pub(crate) fn torques<const N: usize>(loads: &[Load], expected: [[f64; 3]; N], tolerance: f64) {
    assert_eq!(loads.len(), N, "number of spheres");
    for (index, (load, expected)) in loads.iter().zip(expected).enumerate() {
        near(load.torque, expected, tolerance, &format!("torque on sphere {index}"));
    }
}

/// A simulation of a scene on a backend.
pub(crate) fn open(scene: Scene, backend: Backend, integrator: Integrator) -> Simulation {
    let options = Options::new().backend(backend).integrator(integrator);
    Simulation::with_options(scene, options).expect("the simulation opens")
}
