//! Samples of worlds while they run.

use std::ops::ControlFlow;

use rockfall::generate::{Kind, creature};
use rockfall::glam::Vec3;
use rockfall::{Backend, Error, Options, Scene, Sphere, SphereState, Tether, Worlds};

use crate::common::*;

const DT: f32 = 0.005;

type Samples = Vec<(u64, Vec<Vec<u32>>)>;

/// The samples of `run_sampled`, as bits.
fn sampled(worlds: &mut Worlds, steps: u64, every: u64) -> Samples {
    let mut samples = Samples::new();
    let done = worlds.run_sampled(steps, DT, every, |sample| {
        assert_eq!((sample.len(), sample.is_empty()), (3, false));
        samples.push((sample.steps(), (0..sample.len()).map(|world| bits(&sample.states(world))).collect()));
        ControlFlow::Continue(())
    });
    assert_eq!(done.expect("steps"), steps);
    samples
}

/// The same from one call after the other.
fn one_by_one(worlds: &mut Worlds, steps: u64, every: u64) -> Samples {
    let mut samples = Samples::new();
    let mut done = 0;
    while done < steps {
        let portion = every.min(steps - done);
        worlds.run(portion, DT).expect("steps");
        done += portion;
        let states: Vec<Vec<SphereState>> = worlds.all_states().expect("states");
        samples.push((done, states.iter().map(|states| bits(states)).collect()));
    }
    samples
}

/// Three creatures. The first has a fixed sphere, the second stops being finite.
fn creatures() -> Vec<Scene> {
    let mut scenes: Vec<Scene> = (0..3).map(|seed| creature(8, seed).expect("a creature")).collect();
    // It only turns.
    let fixed = Sphere::new([0.0, 9.0, 0.0], 0.1).angular_momentum([0.0, 0.01, 0.0]).fixed();
    scenes[0].add_sphere(fixed).expect("a fixed sphere");
    let id = scenes[1].sphere_ids().next().expect("a sphere");
    let at = scenes[1].sphere(id).expect("a sphere").position;
    scenes[1].add_tether(Tether::new(id, at + Vec3::X, 3e38)).expect("a tether");
    scenes
}

/// A sample shows the same as `all_states`, also of a world that a report has found to be stopped, before and after more steps.
fn a_sample_shows_the_present_states(backend: Backend) {
    let seen = |worlds: &mut Worlds| {
        let sampled = worlds.sample(|sample| sample.all_states()).expect("a sample");
        sampled.iter().map(|states| bits(states)).collect::<Vec<_>>()
    };
    let [mut worlds, mut others] = [0, 1].map(|_| Worlds::new(creatures(), Options::new().backend(backend)).expect("worlds"));
    let expected =
        |others: &mut Worlds| others.all_states().expect("states").iter().map(|states| bits(states)).collect::<Vec<_>>();
    assert_eq!(seen(&mut worlds), expected(&mut others), "before any step");
    for steps in [12, 5, 3] {
        worlds.run(steps, DT).expect("steps");
        others.run(steps, DT).expect("steps");
        if steps == 12 {
            assert!(worlds.report(1, None).expect("a report").stopped.is_some());
            worlds.run(2, DT).expect("steps");
            others.run(2, DT).expect("steps");
        }
        assert_eq!(seen(&mut worlds), expected(&mut others), "{steps}");
        // A state that is set is seen before the next step.
        let states = others.states(2).expect("states");
        worlds.set_states(0, &others.states(0).expect("states")).expect("states");
        worlds.set_states(2, &states).expect("states");
        assert_eq!(seen(&mut worlds), expected(&mut others), "{steps}");
    }
    let mut none = Worlds::new([], Options::new().backend(backend)).expect("no worlds");
    none.run(3, DT).expect("steps");
    assert!(none.sample(|sample| sample.is_empty()).expect("a sample"));
}

fn samples_are_those_of_single_calls(backend: Backend) {
    // On a GPU, samples of creatures are on their way while the next steps run. With a chain, whose rods need a simulation of its own,
    // they are not.
    let mut mixed = creatures();
    mixed[2] = Kind::Chain.generate(3, 1).expect("a chain");
    for scenes in [creatures(), mixed] {
        let make = || Worlds::new(scenes.clone(), Options::new().backend(backend)).expect("worlds");
        let (mut together, mut apart) = (make(), make());
        for (steps, every) in [(11, 4), (3, 8), (4, 1), (0, 2)] {
            let found = sampled(&mut together, steps, every);
            assert_eq!(found, one_by_one(&mut apart, steps, every), "{steps} steps, every {every}");
            assert_eq!(found.last().map_or(0, |(steps, _)| *steps), steps);
        }
        let stopped = [&mut together, &mut apart].map(|worlds| worlds.report(1, None).expect("a report").stopped);
        assert!(stopped[0].is_some() && stopped[0] == stopped[1], "{stopped:?}");
        // What is set while a world is stopped is seen.
        let mut moved = together.states(1).expect("states");
        moved[0].position += Vec3::Y;
        for worlds in [&mut together, &mut apart] {
            worlds.set_states(1, &moved).expect("states");
        }
        assert_eq!(sampled(&mut together, 3, 2), one_by_one(&mut apart, 3, 2));
        let reports = [&mut together, &mut apart].map(|worlds| worlds.report(2, None).expect("a report").report);
        assert_eq!((reports[0].steps, reports[0].time), (21, reports[1].time));
    }
}

fn a_run_can_be_stopped(backend: Backend) {
    let mut worlds = Worlds::new(creatures(), Options::new().backend(backend)).expect("worlds");
    let mut seen = 0;
    let done = worlds.run_sampled(100, DT, 3, |sample| {
        seen = sample.steps();
        if seen == 6 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let done = done.expect("steps");
    assert_eq!(seen, 6);
    assert!((6..=9).contains(&done), "{done}");
    assert_eq!(worlds.report(2, None).expect("a report").report.steps, done);
    // The worlds go on from there.
    assert_eq!(sampled(&mut worlds, 4, 2).len(), 2);
}

both! {
    samples_are_those_of_single_calls,
    a_sample_shows_the_present_states,
    a_run_can_be_stopped,
}

#[test]
fn wrong_numbers_are_errors() {
    let mut worlds = Worlds::new(creatures(), Options::new().backend(Backend::Cpu)).expect("worlds");
    let go_on = |_: &rockfall::Sample<'_>| ControlFlow::Continue(());
    assert!(matches!(worlds.run_sampled(2, DT, 0, go_on), Err(Error::Invalid { field: "every", .. })));
    assert!(matches!(worlds.run_sampled(2, f32::NAN, 1, go_on), Err(Error::Invalid { field: "dt", .. })));
    assert_eq!(worlds.report(0, None).expect("a report").report.steps, 0);
}
