//! Comparison of the engine with the witness over some frames.
//!
//! Both begin in the same state and run on their own. The tolerance follows from the rounding of f32: copies of the witness
//! run with random errors of up to three roundings (6e-8 each) in places, velocities, momenta, points of contact and ends
//! of joints of every substep. What these errors change, the rounding of the engine may change, too. A gap with an error
//! of one rounding of a
//! coordinate, divided by a substep, is an error of a velocity, so tolerances of velocities are far above the rounding of a
//! velocity. Where the copies differ much, a decision (a hit, a sweep more, another point) lies within rounding. Such frames
//! are counted and not compared, and end the comparison of the scene.

use std::cell::RefCell;
use std::fmt::{self, Write as _};

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rockfall::glam::DVec3;
use rockfall::{Backend, Options, Scene, Simulation};

use super::build::{Seen, solver, states};
use super::mistakes::Mistake;
use super::solver::{ROUNDING, Solver};

/// Number of copies with errors, and their number before a difference counts as a failure.
const COPIES: u64 = 6;
const MORE_COPIES: u64 = 40;
/// A difference may be this factor times the change by errors in the copies,
const SPREAD: f64 = 5.0;
/// and this number of roundings more.
const FLOOR: f64 = 16.0;
/// A frame that exceeds its tolerance by up to this factor is counted as close and is no failure. Few may be.
const CLOSE: f64 = 2.0;
/// A frame is undecided if its tolerance exceeds this fraction of the sizes of the scene.
const UNDECIDED: f64 = 0.003;

const FIELDS: [&str; 4] = ["position", "velocity", "angular momentum", "orientation"];

#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) scenes: usize,
    pub(crate) frames: usize,
    pub(crate) undecided: usize,
    /// Frames that exceed the tolerance by a factor of at most [`CLOSE`].
    pub(crate) close: usize,
    pub(crate) impacts: usize,
    pub(crate) points: usize,
    pub(crate) rejections: usize,
    /// Largest difference in units of the tolerance, and as it is for each field.
    pub(crate) worst: f64,
    pub(crate) largest: [f64; 4],
    /// Largest tolerance of each field.
    pub(crate) widest: [f64; 4],
    pub(crate) failures: Vec<String>,
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scenes, frames, undecided, close, impacts, points, rejections, worst, .. } = self;
        write!(f, "{scenes} scenes: {frames} frames compared, {undecided} undecided, {close} close, ")?;
        write!(f, "{impacts} impacts, {points} points, ")?;
        let shown = |all: &[f64; 4]| all.map(|one| format!("{one:.1e}")).join(" ");
        let (largest, widest) = (shown(&self.largest), shown(&self.widest));
        write!(f, "{rejections} repeats; largest difference {worst:.2} of the tolerance, {largest} of {widest}")
    }
}

/// Sizes of a scene: coordinates, velocities, and for each body its angular momentum at such a velocity.
struct Sizes {
    place: f64,
    speed: f64,
    momenta: Vec<f64>,
}

fn sizes(world: &Solver) -> Sizes {
    let moving = || world.bodies.iter().filter(|body| body.has_mass);
    let place = moving().map(|body| body.state.x.abs().max_element() + body.rho).fold(0.0, f64::max);
    let step = world.g.length() * world.h;
    let speed = moving().map(|body| body.state.v.length().max(body.state.w.length() * body.rho)).fold(step, f64::max);
    let momenta = moving().map(|body| body.l.length().max(speed * body.moments.max_element() / body.rho)).collect();
    Sizes { place, speed, momenta }
}

fn wide(v: DVec3) -> [f64; 4] {
    [v.x, v.y, v.z, 0.0]
}

fn differences(one: &Seen, two: &Seen) -> [f64; 4] {
    let same = if one.q.dot(two.q) < 0.0 { -1.0 } else { 1.0 };
    let (a, b) = (one.q.to_array(), two.q.to_array());
    let turns: [f64; 4] = std::array::from_fn(|k| a[k] - same * b[k]);
    let all = [wide(one.x - two.x), wide(one.v - two.v), wide(one.l - two.l), turns];
    all.map(|field| field.into_iter().map(f64::abs).fold(0.0, f64::max))
}

/// A scene whose comparison is asked for.
pub(crate) struct Trial<'a> {
    pub(crate) name: String,
    pub(crate) scene: &'a Scene,
    pub(crate) frames: usize,
    pub(crate) dt: f32,
    pub(crate) mistake: Option<Mistake>,
}

impl Trial<'_> {
    fn copies(&self, start: &Solver, count: std::ops::Range<u64>) -> Vec<Solver> {
        count
            .map(|seed| Solver {
                noise: Some(RefCell::new(Pcg64Mcg::seed_from_u64(seed))),
                mistake: self.mistake,
                ..start.clone()
            })
            .collect()
    }

    /// Compares all frames.
    pub(crate) fn run(&self, tally: &mut Tally) {
        let options = Options::new().backend(Backend::Cpu);
        let mut simulation = Simulation::with_options(self.scene.clone(), options).expect("a valid scene");
        let start = solver(self.scene);
        let mut witness = Solver { mistake: self.mistake, ..start.clone() };
        let mut copies = self.copies(&start, 0..COPIES);
        tally.scenes += 1;
        for frame in 0..self.frames {
            simulation.run(1, self.dt).expect("a frame");
            witness.advance(self.dt.into());
            copies.iter_mut().for_each(|copy| copy.advance(self.dt.into()));
            let engine = states(&mut simulation);
            let Some(mut allowed) = tolerances(&witness, &copies) else {
                tally.undecided += 1;
                break;
            };
            if failing(&witness, &engine, &allowed) {
                let mut more = self.copies(&start, COPIES..MORE_COPIES);
                more.iter_mut().for_each(|copy| (0..=frame).for_each(|_| copy.advance(self.dt.into())));
                copies.extend(more);
                let Some(wider) = tolerances(&witness, &copies) else {
                    tally.undecided += 1;
                    break;
                };
                allowed = wider;
            }
            tally.count(&witness);
            if let Some(text) = tally.compare(&witness, &engine, &allowed) {
                let counts = format!("{} impacts, {} repeats", witness.impacts, witness.rejections);
                tally.failures.push(format!("{} frame {frame}, {counts}\n{text}{}", self.name, described(&witness)));
                break;
            }
        }
        tally.impacts += witness.impacts;
        tally.rejections += witness.rejections;
    }
}

fn failing(witness: &Solver, engine: &[Seen], allowed: &[[f64; 4]]) -> bool {
    let far = |((one, two), allowed): ((&Seen, &Seen), &[f64; 4])| {
        let far = differences(one, two);
        (0..4).any(|field| far[field] > allowed[field] || far[field].is_nan())
    };
    witness.seen().iter().zip(engine).zip(allowed).any(far)
}

/// Tolerances of the fields of each body; `None` where the frame is undecided.
fn tolerances(witness: &Solver, copies: &[Solver]) -> Option<Vec<[f64; 4]>> {
    let sizes = sizes(witness);
    let expected = witness.seen();
    let mut spread = vec![[0.0_f64; 4]; expected.len()];
    for copy in copies {
        for (most, (one, two)) in spread.iter_mut().zip(copy.seen().iter().zip(&expected)) {
            for (most, far) in most.iter_mut().zip(differences(one, two)) {
                *most = most.max(far);
            }
        }
    }
    let mut allowed = Vec::new();
    for (spread, momentum) in spread.into_iter().zip(&sizes.momenta) {
        let size = [sizes.place, sizes.speed, *momentum, 1.0];
        let of = |field: usize| SPREAD * spread[field] + FLOOR * ROUNDING * size[field];
        let all: [f64; 4] = std::array::from_fn(of);
        if (0..4).any(|field| all[field] > UNDECIDED * size[field] || all[field].is_nan()) {
            return None;
        }
        allowed.push(all);
    }
    Some(allowed)
}

impl Tally {
    fn count(&mut self, witness: &Solver) {
        self.frames += 1;
        let points = witness.blocks.iter().flat_map(|block| &block.pairs).flat_map(|pair| &pair.points);
        self.points += points.filter(|point| point.normal > 0.0).count();
    }

    fn compare(&mut self, witness: &Solver, engine: &[Seen], allowed: &[[f64; 4]]) -> Option<String> {
        let (mut text, mut most) = (String::new(), 0.0_f64);
        assert_eq!(witness.seen().len(), engine.len(), "the numbers of bodies");
        for (at, ((one, two), allowed)) in witness.seen().iter().zip(engine).zip(allowed).enumerate() {
            let far = differences(one, two);
            for field in 0..4 {
                let ratio = if far[field].is_nan() { f64::INFINITY } else { far[field] / allowed[field] };
                self.worst = self.worst.max(ratio);
                most = most.max(ratio);
                self.largest[field] = self.largest[field].max(far[field]);
                self.widest[field] = self.widest[field].max(allowed[field]);
                if ratio > 1.0 {
                    let name = FIELDS[field];
                    let _ = writeln!(text, "  body {} {name}: {:.2e} of {:.2e}", at + 1, far[field], allowed[field]);
                    let _ = writeln!(text, "    engine {two:?}\n    witness {one:?}");
                }
            }
        }
        self.close += usize::from(most > 1.0 && most <= CLOSE);
        (most > CLOSE).then_some(text)
    }
}

fn described(witness: &Solver) -> String {
    let mut text = format!("  g {} mu {} e {} substeps {}\n", witness.g, witness.mu, witness.e, witness.substeps);
    for (at, body) in witness.bodies.iter().enumerate().filter(|(_, body)| body.has_mass) {
        let _ = writeln!(text, "  body {at} m {} J {} rho {}", body.mass, body.moments, body.rho);
    }
    for link in &witness.links {
        let _ = writeln!(text, "  {link:?}");
    }
    for block in &witness.blocks {
        let _ = writeln!(text, "  block {:?} colour {}", block.bodies, block.colour);
        for pair in &block.pairs {
            let of = |point: &super::solver::Point| (point.id, point.s, point.normal, point.tangent.length());
            let _ =
                writeln!(text, "    {:?} n {:.6} {:?}", pair.colliders, pair.n, pair.points.iter().map(of).collect::<Vec<_>>());
        }
    }
    text
}
