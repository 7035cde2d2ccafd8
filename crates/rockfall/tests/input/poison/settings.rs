//! Special numbers in every setting, by its field and by its name.

use rockfall::glam::Vec3;
use rockfall::{Backend, Error, Settings, Sphere};

use super::fields::{POISONS, check_accepted, finite, not_negative};
use crate::common::*;

struct Constant {
    name: &'static str,
    accepts: fn(f32) -> bool,
    put: fn(&mut Settings, f32),
}

const CONSTANTS: &[Constant] = &[
    Constant { name: "activation_threshold", accepts: not_negative, put: |settings, p| settings.activation_threshold = p },
    Constant { name: "restitution", accepts: |p| (0.0..=1.0).contains(&p), put: |settings, p| settings.restitution = p },
    Constant { name: "contact_damping", accepts: not_negative, put: |settings, p| settings.contact_damping = p },
    Constant { name: "contact_force", accepts: not_negative, put: |settings, p| settings.contact_force = p },
    Constant { name: "friction", accepts: not_negative, put: |settings, p| settings.friction = p },
    Constant { name: "coulomb_friction", accepts: not_negative, put: |settings, p| settings.coulomb_friction = p },
    Constant { name: "collision_friction", accepts: not_negative, put: |settings, p| settings.collision_friction = p },
    Constant { name: "linear_damping", accepts: not_negative, put: |settings, p| settings.linear_damping = p },
    Constant { name: "angular_damping", accepts: not_negative, put: |settings, p| settings.angular_damping = p },
    Constant { name: "gravity", accepts: finite, put: |settings, p| settings.gravity = p },
    Constant {
        name: "resting_overlap",
        accepts: |p| p == 0.0 || (1e-6..=0.5).contains(&p),
        put: |settings, p| settings.resting_overlap = p,
    },
    Constant { name: "mesh_angle", accepts: |p| (0.6..=15.0).contains(&p), put: |settings, p| settings.mesh_angle = p },
    Constant {
        name: "gravity_direction",
        accepts: |p| p.is_finite() && p != 0.0,
        put: |settings, p| settings.gravity_direction = Vec3::new(0.0, p, 0.0),
    },
];

fn heap(backend: Backend) -> rockfall::Simulation {
    let mut scene = rockfall::Scene::new();
    floor_box(&mut scene);
    spheres(&mut scene, [0.45, 1.4, 2.3].map(|y| Sphere::new([0.0, y, 0.0], 0.5).velocity([0.5, -2.0, 0.0])));
    dumbbell(&mut scene, [1.0, 2.0].map(|x| Sphere::new([x, 0.4, 0.0], 0.5)), 0.3);
    simulation(scene, backend)
}

fn check_every_setting(backend: Backend, poisons: &[f32]) {
    for Constant { name, accepts, put } in CONSTANTS {
        for poison in poisons {
            let mut simulation = heap(backend);
            let before = *simulation.settings();
            let mut settings = before;
            put(&mut settings, *poison);
            let answer = simulation.set_settings(settings);
            if !check_accepted(name, *poison, accepts(*poison), &answer) {
                assert_eq!(*simulation.settings(), before, "{name}");
                continue;
            }
            for _ in 0..4 {
                match simulation.step(0.02) {
                    Ok(_) | Err(Error::NonFinite { .. }) => {}
                    Err(error) => panic!("{name} = {poison:e}: {error}"),
                }
            }
            for state in simulation.spheres().unwrap() {
                let finite = state.position.is_finite() && state.velocity.is_finite() && state.angular_momentum.is_finite();
                assert!(finite && state.orientation.is_finite(), "{name} = {poison:e}: {state:?}");
            }
        }
    }
}

#[test]
fn every_setting_rejects_or_contains_every_special_number() {
    check_every_setting(Backend::Cpu, &POISONS);
}

#[cfg(feature = "gpu")]
#[test]
fn every_setting_rejects_or_contains_the_worst_numbers_on_the_gpu() {
    check_every_setting(Backend::Gpu, &[f32::NAN, f32::MAX]);
}

#[test]
fn setting_by_name_accepts_the_same_numbers() {
    for Constant { name, accepts, .. } in CONSTANTS {
        for poison in POISONS {
            let value = if *name == "gravity_direction" { format!("0,{poison},0") } else { poison.to_string() };
            check_accepted(name, poison, accepts(poison), &Settings::default().set(name, &value));
        }
    }
    let others = ["collisions", "continuous_collisions", "contact_pull", "contact_law", "precision"];
    let numbers = Settings::NAMES.len() - others.len();
    assert_eq!(CONSTANTS.len(), numbers, "every numeric setting needs a line in CONSTANTS");
}
