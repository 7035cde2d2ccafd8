//! The decisions of the constraint solver (docs/physics section 5.4): when the sweeps over a batch end, and whether a rod
//! has turned too far within the step. The sweeps are repeated here in f64.

use glam::DVec3;
use rockfall::model::world::World;

use crate::bodies::Bodies;
use crate::decisions::Findings;

const TOLERANCE: f64 = 1e-5;
const MAX_SWEEPS: usize = 400;
/// Largest error that counts as rounding, relative to the coordinates: four units in the last place.
const ROUNDED: f64 = 4.0 / 8_388_608.0;

/// Rule by which a sweep corrects rods.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rule {
    Lengths,
    Shake,
    Rattle,
}

/// Evaluates the decisions of `constrain` before the integration.
pub(crate) fn restore(world: &World, findings: &mut Findings) {
    for batch in 0..world.step.layout.batches {
        Sweeps::new(world, batch).run(Rule::Lengths, findings);
    }
}

/// Evaluates the decisions of `constrain` after the integration.
pub(crate) fn constrain(world: &World, findings: &mut Findings) {
    for batch in 0..world.step.layout.batches {
        let mut sweeps = Sweeps::new(world, batch);
        sweeps.run(Rule::Shake, findings);
        sweeps.run(Rule::Rattle, findings);
    }
}

struct Sweeps {
    bodies: Bodies,
    old: Vec<DVec3>,
    colours: Vec<Vec<usize>>,
}

impl Sweeps {
    fn new(world: &World, batch: u32) -> Self {
        let word = |at: usize| world.topology[at] as usize;
        let first = word((world.step.layout.batches_at + batch) as usize);
        let colours = (0..word(first)).map(|colour| {
            let range = word(first + 1 + colour)..word(first + 2 + colour);
            range.map(word).collect()
        });
        let mut bodies = Bodies::new(world, 0);
        // The velocity of a fixed sphere is that of its surface. Its centre is at rest.
        for ball in bodies.balls.iter_mut().filter(|ball| ball.w == 0.0) {
            ball.v = DVec3::ZERO;
        }
        Self { bodies, old: world.states[2].iter().map(|row| row.truncate().as_dvec3()).collect(), colours: colours.collect() }
    }

    fn run(&mut self, rule: Rule, findings: &mut Findings) {
        let single = self.colours.len() == 1;
        for sweep in 1..=MAX_SWEEPS {
            let mut worst: f64 = 0.0;
            for rod in self.colours.concat() {
                worst = worst.max(self.visit(rule, rod, findings));
            }
            if single {
                return;
            }
            if sweep < MAX_SWEEPS {
                let sphere = self.bodies.bars[self.colours[0][0]].ends[0];
                // The slack is relative to the tolerance, because the tolerance is smaller than the least slack.
                findings.decide("one more sweep", sphere, worst / TOLERANCE - 1.0);
            }
            if worst <= TOLERANCE {
                let many = if sweep > 1 { "swept often" } else { "swept once" };
                *findings.seen.entry(many.to_owned()).or_default() += 1;
                return;
            }
        }
    }

    /// Corrects one rod and returns its relative error before the correction.
    fn visit(&mut self, rule: Rule, rod: usize, findings: &mut Findings) -> f64 {
        let (ends, length) = (self.bodies.bars[rod].ends, self.bodies.bars[rod].length);
        let [one, two] = ends;
        let balls = &mut self.bodies.balls;
        let (w1, w2) = (balls[one].w, balls[two].w);
        let (w, dt) = (w1 + w2, self.bodies.dt);
        let d = balls[two].x - balls[one].x;
        let n = d.normalize();
        let mut along = n * ((d.length() - length) / w);
        let mut kick = DVec3::ZERO;
        let size = |one: DVec3, two: DVec3| ROUNDED * (one.abs().max_element() + two.abs().max_element());
        let without_rounding = |error: f64, rounding: f64| if error.abs() <= rounding { 0.0 } else { error.abs() };
        let mut error = without_rounding(d.length() - length, size(balls[one].x, balls[two].x)) / length;
        match rule {
            Rule::Lengths => {}
            Rule::Shake => {
                // The root g of |d - g w old| = l that is nearest to 0.
                let old = self.old[two] - self.old[one];
                let (p, q) = (d.dot(old) / old.length_squared(), (d.length_squared() - length * length) / old.length_squared());
                let discriminant = p * p - q;
                findings.decide("turned too far", one, discriminant.min(p));
                if discriminant >= 0.0 && p > 0.0 {
                    along = old * ((p - discriminant.sqrt()) / w);
                    kick = along / dt;
                } else {
                    *findings.seen.entry("turned too far".to_owned()).or_default() += 1;
                }
            }
            Rule::Rattle => {
                let opening = (balls[two].v - balls[one].v).dot(n);
                along = DVec3::ZERO;
                kick = n * (opening / w);
                error = without_rounding(opening, size(balls[one].v, balls[two].v)) * dt / length;
            }
        }
        balls[one].x += w1 * along;
        balls[two].x -= w2 * along;
        balls[one].v += w1 * kick;
        balls[two].v -= w2 * kick;
        error
    }
}
