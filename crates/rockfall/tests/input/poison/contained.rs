//! An accepted number affects only the poisoned body. Bodies that do not touch it move as if it were not there.

use rockfall::glam::Vec3;
use rockfall::{
    Backend, BroadPhase, Capsule, Cuboid, Error, Integrator, Options, Scene, Simulation, Sphere, SphereState, Spring,
};

use super::fields::{FIELDS, POISONS, check_accepted};
use crate::common::bits;

const STEPS: u64 = 6;
const DT: f32 = 0.02;

/// Bodies that must not be affected: two balls that collide, one at rest, a capsule that hits a box, a ball on a
/// spring.
fn bystanders() -> Scene {
    let mut scene = Scene::new();
    // `auto` would choose the precision of the whole scene by its largest coordinate.
    scene.settings.precision = rockfall::Precision::Single;
    let at = Vec3::new(-3.0, 100.0, -70.0);
    let ball = |x: f32, y: f32, z: f32| Sphere::new(at + Vec3::new(x, y, z), 0.5);
    let two = [ball(0.0, 3.0, 0.0).velocity([4.0, 0.0, 0.0]), ball(1.05, 3.0, 0.1).velocity([-4.0, 0.0, 0.0])];
    let ids = [two[0], two[1], ball(3.0, 0.49, 0.0), ball(5.0, 3.0, 0.0)].map(|sphere| scene.add_sphere(sphere).unwrap());
    scene.add_capsule(Capsule::new(at + Vec3::new(0.0, 0.55, 3.0), at + Vec3::new(2.0, 0.8, 3.0), 0.5)).unwrap();
    scene.add_box(Cuboid::between(at - Vec3::new(9.0, 1.0, 9.0), at + Vec3::new(9.0, 0.0, 9.0))).unwrap();
    scene.add_spring(Spring::new(ids[2], ids[3], 30.0, 2.0)).unwrap();
    scene
}

const BYSTANDERS: usize = 6;

fn options(backend: Backend, integrator: Integrator, broad_phase: BroadPhase, keep_going: bool) -> Options {
    Options::new().backend(backend).integrator(integrator).broad_phase(broad_phase).keep_going(keep_going)
}

/// Returns the bystanders after the steps. Without `keep_going` a run stops when it reports a non-finite body; it is
/// then continued.
fn run(scene: Scene, options: Options, what: &str) -> Vec<SphereState> {
    let mut simulation = Simulation::with_options(scene, options.clone()).unwrap();
    while simulation.report().steps < STEPS {
        match simulation.run(STEPS - simulation.report().steps, DT) {
            Ok(_) => {}
            Err(Error::NonFinite { sphere, .. }) if !options.keep_going => {
                assert!(sphere >= BYSTANDERS, "{what}: bystander {sphere} is reported");
            }
            Err(error) => panic!("{what}: {error}"),
        }
    }
    let mut states = simulation.spheres().unwrap();
    for (index, state) in states.iter().enumerate() {
        let vectors = [state.position, state.velocity, state.angular_momentum];
        assert!(vectors.iter().all(|vector| vector.is_finite()), "{what}: sphere {index}: {state:?}");
        assert!(state.orientation.is_finite(), "{what}: sphere {index}: {state:?}");
    }
    states.truncate(BYSTANDERS);
    states
}

/// Every field with every special number, one at a time.
#[test]
fn every_field_rejects_or_contains_every_special_number() {
    let option_sets = |keep_going| {
        let integrators = Integrator::ALL;
        let broad_phases = [BroadPhase::BruteForce, BroadPhase::Grid];
        integrators.into_iter().flat_map(move |integrator| {
            broad_phases.map(|broad_phase| options(Backend::Cpu, integrator, broad_phase, keep_going))
        })
    };
    for options in option_sets(false).chain(option_sets(true)) {
        let alone = bits(&run(bystanders(), options.clone(), "no poison"));
        for field in FIELDS {
            for poison in POISONS {
                let mut scene = bystanders();
                let added = (field.add)(&mut scene, Vec3::ZERO, field.reaches.into(), poison);
                if check_accepted(field.name, poison, (field.accepts)(poison), &added) {
                    let what = format!("{} = {poison:e}, {options:?}", field.name);
                    let beside = bits(&run(scene, options.clone(), &what));
                    assert!(beside == alone, "{what}: a bystander moves differently");
                }
            }
        }
    }
}

/// All accepted numbers in one scene, 40 units apart. Objects that reach everything are in groups of their own.
fn crowd() -> Scene {
    let mut scene = bystanders();
    let mut place = 0_u16;
    for field in FIELDS {
        for poison in POISONS.into_iter().filter(|poison| (field.accepts)(*poison)) {
            place += 1;
            let group = if field.reaches { place } else { 0 };
            (field.add)(&mut scene, Vec3::Z * 40.0 * f32::from(place), group, poison).unwrap();
        }
    }
    assert!(place > 200, "{place}");
    scene
}

fn check_all_at_once(backend: Backend) {
    for integrator in Integrator::ALL {
        let options = options(backend, integrator, BroadPhase::Auto, true);
        let alone = bits(&run(bystanders(), options.clone(), "no poison"));
        assert!(bits(&run(crowd(), options, "all poisons")) == alone, "{integrator:?}: a bystander moves differently");
    }
}

#[test]
fn all_accepted_numbers_at_once_are_contained() {
    check_all_at_once(Backend::Cpu);
}

#[cfg(feature = "gpu")]
#[test]
fn all_accepted_numbers_at_once_are_contained_on_the_gpu() {
    check_all_at_once(Backend::Gpu);
}
