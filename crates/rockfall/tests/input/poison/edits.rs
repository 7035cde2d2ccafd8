//! Special numbers in every edit of a simulation, and in the time step.

use rockfall::glam::Quat;
use rockfall::{Backend, Error, Muscle, Result, Rod, Scene, Simulation, Sphere, SphereId, Spring, Tether};

use super::fields::{POISONS, check_accepted, finite, not_negative, positive};
use crate::common::*;

/// An edit, or a call with a number, and the numbers that it accepts.
struct Edit {
    name: &'static str,
    accepts: fn(f32) -> bool,
    make: fn(&mut Simulation, SphereId, f32) -> Result<()>,
}

/// Two balls that touch, with a rod, a spring and a tether, and a third ball that falls. The third is in another group:
/// if a spring throws the ends of the rod 1e20 apart, rounding in f32 could make the rod touch any body of its group.
fn scene() -> (Scene, SphereId) {
    let mut scene = Scene::new();
    let ball = |x: f32, y: f32| Sphere::new([x, y, 0.0], 0.5).velocity([0.0, 0.5, 0.0]);
    let [a, b, _] = spheres(&mut scene, [ball(0.0, 0.0), ball(0.9, 0.0), ball(0.0, 500.0).group(1)]);
    scene.add_rod(Rod::new(a, b, 0.1)).unwrap();
    scene.add_spring(Spring::new(a, b, 10.0, 1.0)).unwrap();
    scene.add_tether(Tether::new(b, [0.0; 3], 10.0)).unwrap();
    (scene, a)
}

macro_rules! first {
    ($simulation:ident, $ids:ident) => {
        $simulation.scene().$ids().next().unwrap()
    };
}

const EDITS: &[Edit] = &[
    Edit { name: "position", accepts: finite, make: |simulation, id, p| simulation.set_position(id, [p, 0.0, 0.0]) },
    Edit { name: "velocity", accepts: finite, make: |simulation, id, p| simulation.set_velocity(id, [p, 0.0, 0.0]) },
    Edit {
        name: "angular_momentum",
        accepts: finite,
        make: |simulation, id, p| simulation.set_angular_momentum(id, [0.0, p, 0.0]),
    },
    Edit {
        name: "orientation",
        accepts: |_| false,
        make: |simulation, id, p| simulation.set_orientation(id, Quat::from_xyzw(p, 0.6, 0.6, 0.0)),
    },
    Edit { name: "impulse", accepts: finite, make: |simulation, id, p| simulation.apply_impulse(id, [p, 0.0, 0.0]) },
    Edit { name: "force", accepts: finite, make: |simulation, id, p| simulation.set_force(id, [0.0, p, 0.0]) },
    Edit {
        name: "rod.radius",
        accepts: positive,
        make: |simulation, _, p| {
            let id = first!(simulation, rod_ids);
            simulation.update_rod(id, |rod| rod.radius = p)
        },
    },
    Edit {
        name: "rod.length",
        accepts: positive,
        make: |simulation, _, p| {
            let id = first!(simulation, rod_ids);
            simulation.update_rod(id, |rod| rod.length = Some(p))
        },
    },
    Edit {
        name: "spring.stiffness",
        accepts: not_negative,
        make: |simulation, _, p| {
            let id = first!(simulation, spring_ids);
            simulation.update_spring(id, |spring| spring.stiffness = p)
        },
    },
    Edit {
        name: "spring.length",
        accepts: not_negative,
        make: |simulation, _, p| {
            let id = first!(simulation, spring_ids);
            simulation.update_spring(id, |spring| spring.length = p)
        },
    },
    Edit {
        name: "spring.damping",
        accepts: not_negative,
        make: |simulation, _, p| {
            let id = first!(simulation, spring_ids);
            simulation.update_spring(id, |spring| spring.damping = p)
        },
    },
    Edit {
        name: "muscle.frequency",
        accepts: not_negative,
        make: |simulation, _, p| {
            let id = first!(simulation, spring_ids);
            simulation.update_spring(id, |spring| spring.muscle = Some(Muscle::new(0.1, p, 0.0)))
        },
    },
    Edit {
        name: "tether.point",
        accepts: finite,
        make: |simulation, _, p| {
            let id = first!(simulation, tether_ids);
            simulation.update_tether(id, |tether| tether.point.z = p)
        },
    },
    Edit {
        name: "tether.stiffness",
        accepts: not_negative,
        make: |simulation, _, p| {
            let id = first!(simulation, tether_ids);
            simulation.update_tether(id, |tether| tether.stiffness = p)
        },
    },
    Edit {
        name: "tether.length",
        accepts: not_negative,
        make: |simulation, _, p| {
            let id = first!(simulation, tether_ids);
            simulation.update_tether(id, |tether| tether.length = p)
        },
    },
    Edit {
        name: "tether.damping",
        accepts: not_negative,
        make: |simulation, _, p| {
            let id = first!(simulation, tether_ids);
            simulation.update_tether(id, |tether| tether.damping = p)
        },
    },
];

/// Makes an edit and runs some steps. The falling ball must not be affected.
fn edit(simulation: &mut Simulation, make: impl FnOnce(&mut Simulation) -> Result<()>) -> Result<()> {
    simulation.step(DT)?;
    make(simulation)?;
    for _ in 0..3 {
        match simulation.step(DT) {
            Ok(_) => {}
            Err(Error::NonFinite { sphere, .. }) => assert!(sphere < 2, "the falling ball must not be reported"),
            Err(error) => panic!("{error}"),
        }
    }
    for state in simulation.spheres()? {
        let finite = state.position.is_finite() && state.velocity.is_finite() && state.angular_momentum.is_finite();
        assert!(finite && state.orientation.is_finite(), "{state:?}");
    }
    Ok(())
}

fn check_every_edit(backend: Backend, poisons: &[f32]) {
    let (scene, id) = scene();
    let open = || simulation(scene.clone(), backend);
    let mut undisturbed = open();
    undisturbed.step(DT).unwrap();
    let after_a_step = undisturbed.spheres().unwrap();
    let mut undisturbed = open();
    edit(&mut undisturbed, |_| Ok(())).unwrap();
    let alone = undisturbed.spheres().unwrap()[2];
    for Edit { name, accepts, make } in EDITS {
        for poison in poisons {
            let mut simulation = open();
            let made = edit(&mut simulation, |simulation| make(simulation, id, *poison));
            if check_accepted(name, *poison, accepts(*poison), &made) {
                let beside = simulation.spheres().unwrap()[2];
                assert_eq!(beside, alone, "{name} = {poison:e}: the falling ball moves differently");
            } else {
                assert_eq!(
                    simulation.spheres().unwrap(),
                    after_a_step,
                    "{name} = {poison:e}: rejected, but not without effect"
                );
            }
        }
    }
}

#[test]
fn every_edit_rejects_or_contains_every_special_number() {
    check_every_edit(Backend::Cpu, &POISONS);
}

#[cfg(feature = "gpu")]
#[test]
fn every_edit_rejects_or_contains_the_worst_numbers_on_the_gpu() {
    check_every_edit(Backend::Gpu, &[f32::NAN, f32::MAX]);
}

/// The states stay finite with any time step.
#[test]
fn the_time_step_rejects_or_contains_every_special_number() {
    type Call = fn(&mut Simulation, f32) -> Result<()>;
    let calls: [Call; 5] = [
        |simulation, dt| simulation.step(dt).map(drop),
        |simulation, dt| simulation.run(3, dt).map(drop),
        |simulation, dt| simulation.profile(3, dt).map(drop),
        |simulation, dt| simulation.update_positions(dt),
        |simulation, dt| simulation.set_time_step(dt).and_then(|()| simulation.update_aabbs()),
    ];
    for call in calls {
        for poison in POISONS {
            let mut simulation = simulation(scene().0, Backend::Cpu);
            let before = simulation.spheres().unwrap();
            let answer = match call(&mut simulation, poison) {
                // Gravity alone, or a spring that is too stiff for the time step, may carry a body beyond the range of
                // f32.
                Err(Error::NonFinite { .. }) => Ok(()),
                answer => answer,
            };
            if !check_accepted("dt", poison, positive(poison), &answer) {
                assert_eq!(simulation.spheres().unwrap(), before);
            }
            assert!(simulation.spheres().unwrap().iter().all(|state| state.position.is_finite()));
        }
    }
}
