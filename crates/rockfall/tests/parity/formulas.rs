//! Compares the collisions of the CPU with the formulas of docs/physics section 3 in f64: lists, flags and outcome.

use std::collections::BTreeMap;

use rockfall::Integrator;
use rockfall::model::layout::{ENTRY_COLLIDES, ENTRY_OVERLAPS};
use rockfall::model::world::World;

use crate::bodies::Bodies;
use crate::decisions::{Contact, Findings, collisions, entries};
use crate::trace::{Scenario, Trace};
use crate::{plan, trace};

fn scenario<'a>(trace: &'a Trace, name: &str) -> &'a Scenario {
    trace.scenarios.iter().find(|scenario| scenario.runs[0].stage.name == name).expect(name)
}

type Pair = (usize, usize, usize);

fn by_pair(world: &World) -> BTreeMap<Pair, Contact> {
    let contacts = collisions(world, &mut Findings::default()).contacts;
    contacts.into_iter().map(|contact| ((contact.a, contact.b, contact.touch.feature), contact)).collect()
}

#[test]
fn pair_lists_and_flags_match_the_formulas() {
    for seed in 0..4 {
        let trace = trace(&plan(seed, Integrator::Rk4));
        let Scenario { runs, before } = scenario(&trace, "find_collisions");
        let mut world = before.clone();
        runs[0].on_cpu(&mut world);
        let world = &world;
        let expected = by_pair(world);
        let mut found = BTreeMap::new();
        for entry in entries(world) {
            let pair = (entry.mover.min(entry.other), entry.mover.max(entry.other), entry.feature);
            let sides = found.entry(pair).or_insert(0);
            *sides += 1;
            let contact = expected.get(&pair);
            let collides = contact.is_some_and(|contact| contact.collides);
            assert_eq!(entry.word & ENTRY_OVERLAPS != 0, contact.is_some(), "{pair:?}");
            assert_eq!(entry.word & ENTRY_COLLIDES != 0, collides, "{pair:?}");
        }
        // Every overlap must be in the list of each of its movers.
        for (pair, contact) in &expected {
            let movers = 1 + usize::from(contact.b < world.movers() as usize);
            assert_eq!(found.get(pair), Some(&movers), "{pair:?}");
        }
    }
}

#[test]
fn collisions_change_spheres_as_the_formulas_say() {
    for seed in 0..4 {
        let trace = trace(&plan(seed, Integrator::Rk4));
        let Scenario { runs, before } = scenario(&trace, "find_collisions");
        let mut after = before.clone();
        runs.iter().for_each(|run| run.on_cpu(&mut after));
        let (bodies, done) = (Bodies::new(before, 0), Bodies::new(&after, 0));
        let changes = collisions(before, &mut Findings::default()).changes;
        for (number, (ball, done)) in bodies.balls.iter().zip(&done.balls).enumerate() {
            let change = changes.get(&number).copied().unwrap_or_default();
            let is_near = |is: glam::DVec3, should: glam::DVec3, tolerance: f64| {
                assert!(
                    (is - should).length() < tolerance,
                    "seed {seed}, sphere {number} {:?}: {is} instead of {should}",
                    bodies.body_of[number]
                );
            };
            is_near(done.v - ball.v, change.v, 1e-3 * (1.0 + change.v.length()));
            is_near(done.x - ball.x, change.x, 1e-4);
            is_near(done.l - ball.l, change.l, 1e-3 * (1.0 + change.l.length()));
        }
    }
}
