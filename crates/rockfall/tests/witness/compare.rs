//! Comparison of the engine with the witness, step by step. Each step of the witness starts from the state of the
//! engine.
//!
//! The tolerance is found by running the witness from states that differ by rounding errors of f32: rounding may change
//! the outcome as much as these differences do. Where they change it much, a decision lies within rounding of its
//! limit. Such steps are undecided; they are counted but not compared.

use std::fmt::{self, Write as _};

use rockfall::glam::DVec3;
use rockfall::{Backend, Integrator, Options, Report, Simulation, SphereState};

use crate::collide::Pressed;
use crate::perturb::{EPS, perturbed, scale};
use crate::scenes::{Plan, Regime, together};
use crate::world::{Ball, Body, Constants, Mistake, World};

/// Number of perturbed states per step.
const RUNS: u64 = 8;
/// Number of perturbed states before a difference counts as a failure.
const MORE_RUNS: u64 = 64;
/// A difference may be this factor times the change by rounding in the witness,
const SPREAD: f64 = 3.0;
/// and this factor in a network. Its lengths may differ by up to 1e-5, depending on the order of sweeps, of which only
/// a few are sampled.
const NETWORK_SPREAD: f64 = 5.0;
/// Relative error of the lengths of rods in networks: what is left of 1e-5 after the sweep that found it.
const NETWORK: f64 = 1e-6;
/// Additional tolerance in units in the last place of the positions and velocities of the scene, for the operations
/// that compute the outcome.
const ROUNDING: f64 = 8.0;
/// In one of some ten thousand steps, rounding exceeds the tolerance by up to this factor: in a network, with heavy bodies next to light
/// ones, or with rods that are almost parallel. Such steps are counted.
const CLOSE: f64 = 2.0;
/// A step is undecided if its tolerance exceeds this fraction of the scale of its velocities.
const UNDECIDED: f64 = 0.01;

/// Counts of compared steps, and the differences found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) scenes: usize,
    pub(crate) compared: usize,
    pub(crate) undecided: usize,
    pub(crate) collisions: usize,
    pub(crate) lone: usize,
    /// Largest difference, in units of the tolerance.
    pub(crate) worst: f64,
    /// Steps that exceed the tolerance by a factor of at most [`CLOSE`].
    pub(crate) close: usize,
    pub(crate) failures: Vec<String>,
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scenes, compared, undecided, collisions, lone, worst, close, .. } = self;
        write!(f, "{scenes} scenes: {compared} steps compared, {undecided} undecided, {close} close, ")?;
        write!(f, "{collisions} collisions, {lone} of them lone; the largest difference is {worst:.2} of the tolerance")
    }
}

/// Which part of a step is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    Step,
    Collisions,
    Positions,
}

/// Outcome of a part of a step for one cluster.
struct Outcome {
    world: World,
    pressed: Vec<Pressed>,
}

impl Outcome {
    fn collisions(&self) -> usize {
        self.pressed.iter().filter(|contact| contact.collides).count()
    }
}

fn run(mut world: World, part: Part, lengths_due: bool) -> Outcome {
    let pressed = match part {
        Part::Step => world.step(lengths_due),
        Part::Collisions => world.handle_collisions(true),
        Part::Positions => {
            world.update_positions(lengths_due);
            Vec::new()
        }
    };
    Outcome { world, pressed }
}

/// Fields of a ball that are compared.
const FIELDS: [&str; 4] = ["position", "velocity", "angular momentum", "orientation"];

fn fields(ball: &Ball) -> [[f64; 4]; 4] {
    let q = ball.q;
    let wide = |v: DVec3| [v.x, v.y, v.z, 0.0];
    [wide(ball.x), wide(ball.v), wide(ball.l), [q.x, q.y, q.z, q.w]]
}

fn field_differences(one: &Ball, two: &Ball) -> [f64; 4] {
    let (a, b) = (fields(one), fields(two));
    let same = |field: usize| if field == 3 && one.q.dot(two.q) < 0.0 { -1.0 } else { 1.0 };
    std::array::from_fn(|field| (0..4).map(|k| (a[field][k] - same(field) * b[field][k]).abs()).fold(0.0, f64::max))
}

/// Tolerance of each field of each ball, or `None` if the step is undecided.
fn tolerances(world: &World, part: Part, lengths_due: bool, outcome: &Outcome, runs: u64) -> Option<Vec<[f64; 4]>> {
    let (before, after) = (scale(world), scale(&outcome.world));
    let speed = before.speed.max(after.speed);
    let (balls, expected) = (&world.balls, &outcome.world.balls);
    let mut spread = vec![[0.0_f64; 4]; balls.len()];
    let mut lost = outcome.world.lost;
    for seed in 0..runs {
        let other = run(perturbed(world, seed), part, lengths_due);
        lost |= other.world.lost || other.collisions() != outcome.collisions();
        for (most, (one, two)) in spread.iter_mut().zip(other.world.balls.iter().zip(expected)) {
            for (most, far) in most.iter_mut().zip(field_differences(one, two)) {
                *most = most.max(far);
            }
        }
    }
    let positions = part != Part::Collisions;
    let in_network = |at: usize| matches!(world.body.get(at), Some(Some(Body::Network(_))));
    // SHAKE divides the rounding error of positions by the time step. In a network, a part of the length tolerance is
    // divided by it too.
    let off = |at: usize| {
        let mut rods = world.bars.iter().filter(|bar| positions && bar.length.is_some() && bar.ends.contains(&at));
        let network = in_network(at);
        let length =
            rods.next().map(|bar| 3.0 * EPS * before.place + if network { NETWORK * bar.length.unwrap_or(0.0) } else { 0.0 });
        length.unwrap_or(0.0)
    };
    let tolerances: Vec<[f64; 4]> = balls
        .iter()
        .enumerate()
        .map(|(at, ball)| {
            let speed_error = off(at) / world.dt;
            let speed_floor = ROUNDING * EPS * speed + speed_error;
            let floors = [
                ROUNDING * EPS * (before.place + speed * world.dt) + off(at),
                speed_floor,
                ball.inertia() / ball.radius * speed_floor,
                ROUNDING * EPS * (1.0 + speed / ball.radius * world.dt) + speed_floor * world.dt / ball.radius,
            ];
            let factor = if in_network(at) { NETWORK_SPREAD } else { SPREAD };
            std::array::from_fn(|field| floors[field] + factor * spread[at][field])
        })
        .collect();
    let wide = |(tolerance, ball): (&[f64; 4], &Ball)| {
        let size = ball.radius;
        let least = speed.max(0.3 * size);
        let limits = [0.1 * size, least, least * ball.inertia() / ball.radius, 1.0];
        tolerance.iter().zip(limits).any(|(tolerance, limit)| *tolerance > UNDECIDED * limit)
    };
    lost |= tolerances.iter().zip(balls).any(wide);
    (!lost).then_some(tolerances)
}

/// Compares the engine with the witness on the clusters of a plan for a number of steps.
pub(crate) struct Trial<'a> {
    pub(crate) name: String,
    pub(crate) plan: &'a Plan,
    pub(crate) backend: Backend,
    pub(crate) steps: usize,
    pub(crate) mistake: Option<Mistake>,
    /// Whether phases 3 and 4 are called and compared separately.
    pub(crate) phases: bool,
}

/// State of the engine after a part of a step.
struct Made<'a> {
    step: usize,
    part: Part,
    lengths_due: bool,
    states: &'a [SphereState],
    report: Report,
}

impl Trial<'_> {
    pub(crate) fn run(&self, tally: &mut Tally) {
        let options = Options::new().backend(self.backend).integrator(self.plan.integrator);
        let mut simulation = Simulation::with_options(together(self.plan), options).expect("the simulation opens");
        let world = |cluster| World { mistake: self.mistake, ..World::of(cluster, self.plan.integrator, 0.0) };
        let mut worlds: Vec<World> = self.plan.clusters.iter().map(world).collect();
        tally.scenes += worlds.len();
        let mut due = true;
        let always_due = self.plan.integrator == Integrator::VelocityVerlet;
        for step in 0..self.steps {
            if always_due {
                evaluate_again(&mut simulation);
            }
            let Regime { settings, dt } = self.plan.regimes[step % self.plan.regimes.len()];
            simulation.set_settings(settings).expect("valid settings");
            simulation.set_time_step(dt).expect("a time step");
            for world in &mut worlds {
                (world.set, world.dt) = (Constants::of(&settings, self.plan.integrator), dt.into());
            }
            let by_phases = self.phases && settings.collisions;
            let parts: &[Part] = if by_phases { &[Part::Collisions, Part::Positions] } else { &[Part::Step] };
            for &part in parts {
                load(&mut worlds, &mut simulation);
                if part != Part::Positions {
                    for world in &mut worlds {
                        world.note_pulled();
                    }
                }
                if engine(&mut simulation, part, dt).is_err() {
                    return;
                }
                let (states, report) = (simulation.spheres().expect("spheres are read back"), simulation.report());
                let made = Made { step, part, lengths_due: due, states: &states, report };
                self.judge(&worlds, &made, tally);
                due = always_due || due && part == Part::Collisions;
            }
        }
    }

    fn judge(&self, worlds: &[World], made: &Made, tally: &mut Tally) {
        let &Made { step, part, lengths_due, states, report } = made;
        let mut first = 0;
        let (mut collisions, mut known) = (0, true);
        for (cluster, world) in worlds.iter().enumerate() {
            let outcome = run(world.clone(), part, lengths_due);
            let next = first + world.balls.len();
            let own = &states[first..next];
            first = next;
            collisions += outcome.collisions();
            let differing = |runs: u64| {
                let allowed = tolerances(world, part, lengths_due, &outcome, runs)?;
                Some(differences(&outcome.world, own, &allowed))
            };
            let mut found = differing(RUNS);
            if found.as_ref().is_some_and(|found| found.0 > 1.0) {
                found = differing(MORE_RUNS);
            }
            let Some((worst, text)) = found else {
                tally.undecided += 1;
                known = false;
                continue;
            };
            tally.compared += 1;
            tally.collisions += outcome.collisions();
            tally.lone += outcome.pressed.iter().filter(|contact| contact.lone).count();
            tally.worst = tally.worst.max(worst);
            if worst > 1.0 && worst <= CLOSE {
                tally.close += 1;
            } else if worst > CLOSE {
                let place = format!("{} cluster {cluster} step {step} {part:?}: {worst:.1} times the tolerance", self.name);
                tally.failures.push(format!("{place}\n{text}{}", describe(world, &outcome.pressed)));
            }
        }
        if known && part == Part::Step && report.collisions as usize != collisions {
            let (name, seen) = (&self.name, report.collisions);
            tally.failures.push(format!("{name} step {step}: {seen} collisions, the witness finds {collisions}\n"));
        }
    }
}

/// Makes the next step evaluate the forces at its start: the witness does not know those of the step before.
fn evaluate_again(simulation: &mut Simulation) {
    let first = simulation.scene().sphere_ids().next();
    if let Some(id) = first {
        let velocity = simulation.sync().expect("the state").sphere(id).expect("the sphere").velocity;
        simulation.set_velocity(id, velocity).expect("the same velocity");
    }
}

fn load(worlds: &mut [World], simulation: &mut Simulation) {
    let states = simulation.spheres().expect("spheres are read back");
    let time = simulation.report().time;
    worlds.iter_mut().for_each(|world| world.place_walls(time));
    for (ball, state) in worlds.iter_mut().flat_map(|world| &mut world.balls).zip(&states) {
        ball.set(state);
    }
}

fn engine(simulation: &mut Simulation, part: Part, dt: f32) -> rockfall::Result<()> {
    match part {
        Part::Step => simulation.step(dt).map(|_| ()),
        Part::Collisions => simulation.handle_collisions(),
        Part::Positions => simulation.update_positions(dt),
    }
}

/// Returns the largest difference in units of the tolerance, and a description of all that exceed it.
fn differences(world: &World, states: &[SphereState], allowed: &[[f64; 4]]) -> (f64, String) {
    let (mut worst, mut text) = (0.0_f64, String::new());
    for (at, ((ball, state), allowed)) in world.balls.iter().zip(states).zip(allowed).enumerate() {
        let mut seen = ball.clone();
        seen.set(state);
        let far = field_differences(ball, &seen);
        for field in 0..4 {
            let ratio = far[field] / allowed[field];
            let ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
            worst = worst.max(ratio);
            if ratio > 1.0 {
                let (name, allowed) = (FIELDS[field], allowed[field]);
                let (engine, witness) = (fields(&seen)[field], fields(ball)[field]);
                let _ =
                    writeln!(text, "  sphere {at} {name}: engine {engine:?}\n    witness {witness:?} allowed {allowed:.2e}");
            }
        }
    }
    (worst, text)
}

/// Describes the state and the contacts that the witness used.
pub(crate) fn describe(world: &World, contacts: &[Pressed]) -> String {
    let mut text = String::new();
    let set = &world.set;
    let _ = writeln!(text, "  dt {} {set:?}", world.dt);
    for (at, ball) in world.balls.iter().enumerate() {
        let body = world.body[at];
        let _ = writeln!(text, "  {at} {body:?} m {} r {} x {} v {} l {}", ball.mass, ball.radius, ball.x, ball.v, ball.l);
    }
    for bar in &world.bars {
        let _ = writeln!(text, "  rod {:?} r {} length {:?}", bar.ends, bar.radius, bar.length);
    }
    for (pair, line) in world.touches() {
        let u = world.closing(&pair, &line);
        let (a, b, feature, at, o, c) = (pair.a, pair.b, pair.feature, line.at, line.o, world.threshold(&pair));
        let _ = write!(text, "  {a:?} {b:?} {feature:?} n {} o {o:.6} at {at:.4?} u {u:.5} c {c:.3}", line.n);
        if let Some(contact) = contacts.iter().find(|contact| contact.pair == pair) {
            let (collides, lone, tau, j) = (contact.collides, contact.lone, contact.tau, contact.j);
            let _ = write!(text, " collides {collides} lone {lone} tau {tau:.6} j {j:.6}");
        }
        text.push('\n');
    }
    text
}
