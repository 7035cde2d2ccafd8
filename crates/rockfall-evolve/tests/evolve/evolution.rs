//! Whole evolutions: reproducible, resumable, and with progress.

use crate::common::distance;
use rand::SeedableRng as _;
use rand_pcg::Pcg64;
use rockfall::{Backend, Options, WorldPath, Worlds};
use rockfall_evolve::{Body, Evolution, Genome, Goal, Ground, Plan, Trial};

fn plan(body: Body, seed: u64) -> Plan {
    Plan {
        population: 24,
        seed,
        body,
        goal: Goal::Distance,
        seconds: 2.0,
        dt: 0.005,
        integrator: "rk4".to_owned(),
        ground: String::new(),
    }
}

fn trial(plan: &Plan) -> Trial {
    let mut trial = Trial::new(plan.goal, plan.seconds, plan.dt, Ground::level(10.0).unwrap());
    trial.options = Options::new().backend(Backend::Cpu);
    trial
}

fn evolved(body: Body, seed: u64, generations: usize) -> Evolution {
    let plan = plan(body, seed);
    let mut evolution = Evolution::new(plan.clone(), trial(&plan));
    for _ in 0..generations {
        evolution.generation(&|| false).unwrap().unwrap();
    }
    evolution
}

#[test]
fn the_same_seed_gives_the_same_champion_and_fitness_grows() {
    for body in [Body::Lattice, Body::Free] {
        let [a, b] = [evolved(body, 5, 4), evolved(body, 5, 4)];
        assert!(a.champion() == b.champion() && a.archive() == b.archive());
        assert_eq!(a.history(), b.history());
        let champions: Vec<f64> = a.history().iter().map(|generation| generation.champion).collect();
        assert!(champions.is_sorted() && champions[3] > 0.1, "{body}: {champions:?}");
        assert!(a.archive().len() > 3);
        assert!(evolved(body, 6, 1).archive() != evolved(body, 5, 1).archive());
    }
}

#[test]
fn a_resumed_evolution_is_the_same_as_one_that_went_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("evolution.json");
    let whole = evolved(Body::Lattice, 8, 4);
    let mut first = evolved(Body::Lattice, 8, 2);
    // Stopping in the middle of a generation leaves it out.
    assert_eq!(first.generation(&|| true).unwrap(), None);
    first.save(&path).unwrap();
    let mut second = Evolution::load(&path, |plan| Ok(trial(plan))).unwrap();
    for _ in 0..2 {
        second.generation(&|| false).unwrap().unwrap();
    }
    assert_eq!((whole.champion(), whole.archive(), whole.history()), (second.champion(), second.archive(), second.history()));
    let text = std::fs::read_to_string(&path).unwrap();
    for bad in [
        text.replace("rockfall evolution", "something else"),
        text.replace("\"version\":3", "\"version\":9"),
        text[1..].to_owned(),
    ] {
        std::fs::write(&path, bad).unwrap();
        assert!(Evolution::load(&path, |plan| Ok(trial(plan))).is_err());
    }
}

/// The scene of the champion does what the history claims, in a simulation of its own.
#[test]
fn the_champion_walks_the_distance_that_the_history_claims() {
    let evolution = evolved(Body::Lattice, 5, 3);
    let champion = evolution.champion().unwrap();
    let scene = champion.genome.scene(&evolution.trial().ground).unwrap();
    let text = scene.to_text();
    let scene = rockfall::Scene::parse(&text, "best.txt".as_ref()).unwrap().scene;
    let distance = distance(&scene, 0.005, evolution.trial().settling_steps(), evolution.trial().steps());
    assert!((distance / champion.outcome.distance - 1.0).abs() < 1e-6, "{distance} {champion:?}");
    let audit = champion.audit;
    let others = [audit.fitness_at_half_step, audit.fitness_at_quarter_step, audit.fitness_when_disturbed];
    assert!(audit.passed && others.iter().all(|fitness| *fitness >= 0.7 * champion.outcome.fitness), "{champion:?}");
}

/// Islands take the better creatures of each other, and go on to the same result every time.
#[test]
fn an_evolution_adopts_the_fitter_creatures_of_another() {
    let merged = || {
        let (mut one, other) = (evolved(Body::Lattice, 5, 2), evolved(Body::Lattice, 6, 3));
        let adopted = one.adopt(&other).unwrap();
        (one, other, adopted)
    };
    let (mut one, other, adopted) = merged();
    assert!(adopted > 0 && one.archive().len() >= other.archive().len());
    let fittest = |evolution: &Evolution| evolution.archive().ranked()[0].1.outcome.fitness;
    assert!(fittest(&one) >= fittest(&other));
    assert_eq!(one.adopt(&other).unwrap(), 0);
    let (mut again, ..) = merged();
    for evolution in [&mut one, &mut again] {
        evolution.generation(&|| false).unwrap().unwrap();
    }
    assert_eq!((one.archive(), one.champion()), (again.archive(), again.champion()));
    let error = one.adopt(&evolved(Body::Free, 5, 1)).unwrap_err();
    assert!(error.to_string().contains("an evolution with the same body"), "{error}");
}

/// On a GPU, creatures run side by side, also those with as many springs as there may be.
#[test]
fn the_largest_creatures_fit_into_workgroups() {
    let ground = Ground::level(10.0).unwrap();
    for body in [Body::Lattice, Body::Free] {
        let mut random = Pcg64::seed_from_u64(3);
        let mut largest = Genome::random(&mut random, body);
        let mut scenes = vec![largest.scene(&ground).unwrap()];
        for _ in 0..4_000 {
            let child = largest.mutated(&mut random);
            let scene = child.scene(&ground).unwrap();
            if scene.springs().len() >= scenes.last().unwrap().springs().len() {
                largest = child;
                scenes.push(scene);
            }
        }
        let scenes = scenes.split_off(scenes.len() - 5);
        assert!(scenes[4].springs().len() > Worlds::BODY_MUSCLES - 3, "{body}: {}", scenes[4].springs().len());
        let mut worlds = Worlds::new(scenes, Options::new().backend(Backend::Gpu)).unwrap();
        for world in 0..worlds.len() {
            assert_eq!(worlds.report(world, None).unwrap().path, WorldPath::Device, "{body}: {world}");
        }
    }
}
