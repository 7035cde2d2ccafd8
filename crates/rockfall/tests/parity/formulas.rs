//! The CPU's collisions against the formulas of physics.md section 3 in f64: lists, flags and the outcome.

use std::collections::BTreeMap;

use glam::DVec3;
use rockfall::Integrator;
use rockfall::layout::{ENTRY_COLLIDES, ENTRY_OVERLAPS};
use rockfall::world::World;

use crate::bodies::Bodies;
use crate::decisions::{Findings, Weighed, collisions, entries};
use crate::trace::{Scenario, Trace};
use crate::{plan, trace};

fn scenario<'a>(trace: &'a Trace, name: &str) -> &'a Scenario {
    trace.scenarios.iter().find(|scenario| scenario.run.stage.name == name).expect(name)
}

/// The world before the stage of this name.
fn before<'a>(trace: &'a Trace, name: &str) -> &'a World {
    &scenario(trace, name).before
}

type Pair = (usize, usize, usize);

fn by_pair(world: &World) -> BTreeMap<Pair, Weighed> {
    let weighed = collisions(world, &mut Findings::default());
    let pair = |weighed: &Weighed| (weighed.contact.a, weighed.contact.b, weighed.contact.touch.feature);
    weighed.into_iter().map(|weighed| (pair(&weighed), weighed)).collect()
}

#[test]
fn lists_and_flags_are_those_of_the_formulas() {
    for seed in 0..4 {
        let trace = trace(&plan(seed, Integrator::Rk4));
        let world = before(&trace, "apply_collisions");
        let expected = by_pair(world);
        let mut found = BTreeMap::new();
        for entry in entries(world) {
            let pair = (entry.mover.min(entry.other), entry.mover.max(entry.other), entry.feature);
            let sides = found.entry(pair).or_insert(0);
            *sides += 1;
            let weighed = expected.get(&pair);
            let collides = weighed.is_some_and(|weighed| weighed.contact.collides);
            assert_eq!(entry.word & ENTRY_OVERLAPS != 0, weighed.is_some(), "{pair:?}");
            assert_eq!(entry.word & ENTRY_COLLIDES != 0, collides, "{pair:?}");
        }
        // Every overlap stands in the list of each of its movers.
        for (pair, weighed) in &expected {
            let movers = 1 + usize::from(weighed.contact.b < world.movers() as usize);
            assert_eq!(found.get(pair), Some(&movers), "{pair:?}");
        }
    }
}

#[test]
fn impulses_and_displacements_are_those_of_the_formulas() {
    for seed in 0..4 {
        let trace = trace(&plan(seed, Integrator::Rk4));
        let world = before(&trace, "apply_collisions");
        let mut after = before(&trace, "commit_collisions").clone();
        scenario(&trace, "commit_collisions").run.on_cpu(&mut after);
        let (bodies, done) = (Bodies::new(world, 0), Bodies::new(&after, 0));
        let restitution = f64::from(world.step.restitution);
        let mut kicks = vec![(DVec3::ZERO, DVec3::ZERO); bodies.balls.len()];
        for Weighed { contact: k, weight, removed } in by_pair(world).values().filter(|w| w.contact.collides) {
            for (ball, g) in &k.shares {
                let share = bodies.balls[*ball].w * weight / k.w * *g;
                kicks[*ball].0 += share * (1.0 + restitution) * k.u;
                kicks[*ball].1 += if *removed { share * k.touch.overlap } else { DVec3::ZERO };
            }
        }
        for ((ball, (dv, dx)), done) in bodies.balls.iter().zip(kicks).zip(&done.balls) {
            assert!((ball.v + dv - done.v).length() < 1e-3 * (1.0 + dv.length()), "{} {dv} {}", ball.v, done.v);
            assert!((ball.x + dx - done.x).length() < 1e-4, "{} {dx} {}", ball.x, done.x);
        }
    }
}
