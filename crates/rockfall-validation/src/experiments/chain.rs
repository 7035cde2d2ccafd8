//! A hanging chain of rods of fixed length.

use rockfall::{Integrator, Rod, Scene, Simulation, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, period, with};
use crate::{Effort, Outcome, Result};

const LINKS: u32 = 20;
const LINK: f64 = 0.1;
const SPAN: f64 = 1.2;

/// The argument at which a function that falls from `low` to `high` is `value`.
fn solve(low: f64, high: f64, value: f64, of: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if of(middle) > value {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

type Positions = Vec<(f64, f64)>;

/// Positions of the joints, from the angle of each link to the horizontal.
fn positions(angle: impl Fn(f64) -> f64) -> Positions {
    let mut all = vec![(-0.5 * SPAN, 0.0)];
    for link in 0..LINKS {
        let angle = angle(f64::from(link) - 0.5 * f64::from(LINKS - 1));
        let (x, y) = all[all.len() - 1];
        all.push((x + LINK * angle.cos(), y + LINK * angle.sin()));
    }
    all
}

/// Distance between the two ends of the chain.
fn width(angle: impl Fn(f64) -> f64) -> f64 {
    let positions = positions(angle);
    positions[positions.len() - 1].0 - positions[0].0
}

/// Initial positions, on an arc of a circle, which is not the shape at rest.
fn arc() -> Positions {
    let turn = solve(0.0, 6.0 / f64::from(LINKS), SPAN, |turn| width(|link| link * turn));
    positions(|link| link * turn)
}

/// Positions at rest. Each joint bears the weight of one sphere, so tan(angle) grows by m G/H from link to link.
fn at_rest() -> Positions {
    let ratio = solve(0.0, 100.0, SPAN, |ratio| width(|link| (link * ratio).atan()));
    positions(|link| (link * ratio).atan())
}

fn chain() -> Result<Scene> {
    let mut scene = with(|settings| settings.gravity = 1.0);
    let mut last = None;
    for (index, (x, y)) in (0..).zip(arc()) {
        let sphere = Sphere::new([x as f32, y as f32, 0.0], 0.02);
        let next = scene.add_sphere(if index == 0 || index == LINKS { sphere.fixed() } else { sphere })?;
        if let Some(last) = last {
            scene.add_rod(Rod::new(last, next, 0.01).length(LINK as f32))?;
        }
        last = Some(next);
    }
    Ok(scene)
}

/// Slowest mode of the chain out of its plane: the angular frequency over the root of G, and the shape.
///
/// The pull H / cos(angle) of a rod of length l exerts a force of pull / l times the difference of the displacements of its two
/// joints, so that m omega^2 z = K z. The least eigenvalue of K is found by inverse iteration.
fn slowest() -> (f64, Vec<f64>) {
    let ratio = solve(0.0, 100.0, SPAN, |ratio| width(|link| (link * ratio).atan()));
    let pull = |link: usize| (1.0 + (ratio * (link as f64 - 0.5 * f64::from(LINKS - 1))).powi(2)).sqrt() / (ratio * LINK);
    let joints = LINKS as usize - 1;
    let mut shape = vec![1.0; joints];
    let mut least = 0.0;
    for _ in 0..100 {
        // Thomas algorithm for K x = shape.
        let (mut over, mut x) = (vec![0.0; joints], vec![0.0; joints]);
        for k in 0..joints {
            let (before, value) = if k == 0 { (0.0, 0.0) } else { (over[k - 1], x[k - 1]) };
            let pivot = pull(k) + pull(k + 1) - pull(k) * before;
            over[k] = pull(k + 1) / pivot;
            x[k] = (shape[k] + pull(k) * value) / pivot;
        }
        for k in (0..joints - 1).rev() {
            x[k] += over[k] * x[k + 1];
        }
        let largest = x.iter().copied().fold(0.0, f64::max);
        least = 1.0 / largest;
        shape = x.iter().map(|value| value / largest).collect();
    }
    (least.sqrt(), shape)
}

/// Measured period of the slowest mode, over about four periods.
fn swing(mut simulation: Simulation, shape: &[f64]) -> Result<f64> {
    let ids: Vec<_> = simulation.scene().sphere_ids().collect();
    for (id, part) in ids[1..].iter().zip(shape) {
        simulation.set_velocity(*id, [0.0, 0.0, 0.01 * *part as f32])?;
    }
    let middle = ids[ids.len() / 2];
    let mut samples = Vec::new();
    for sample in 0..1_200_u32 {
        samples.push((f64::from(sample) / 64.0, f64::from(simulation.sphere(middle)?.position.z)));
        simulation.run(8, 1.0 / 512.0)?;
    }
    Ok(period(&samples))
}

/// Brings the chain to rest by kinetic damping: whenever the kinetic energy has passed a maximum, all velocities are set to 0.
fn relaxed() -> Result<(Simulation, Positions)> {
    let mut simulation = on_cpu(chain()?, Integrator::Rk4)?;
    let ids: Vec<_> = simulation.scene().sphere_ids().collect();
    let mut last = 0.0;
    for _ in 0..2_000 {
        simulation.run(2, 1.0 / 512.0)?;
        let kinetic = simulation.energy()?.kinetic;
        if kinetic < last {
            for id in &ids {
                simulation.set_velocity(*id, [0.0; 3])?;
            }
        }
        last = if kinetic < last { 0.0 } else { kinetic };
    }
    let spheres = simulation.spheres()?;
    let positions = spheres.iter().map(|sphere| (f64::from(sphere.position.x), f64::from(sphere.position.y))).collect();
    Ok((simulation, positions))
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let (simulation, found) = relaxed()?;
        let expected = at_rest();
        let departure = |(a, b): (&(f64, f64), &(f64, f64))| (a.0 - b.0).hypot(a.1 - b.1);
        let worst = found.iter().zip(&expected).map(departure).fold(0.0, f64::max);
        let start = found.iter().zip(&arc()).map(departure).fold(0.0, f64::max);
        let stretch = found.windows(2).map(|pair| (departure((&pair[0], &pair[1])) / LINK - 1.0).abs()).fold(0.0, f64::max);
        // The parameter c of the catenary: 2 c sinh(span / 2c) = length.
        let length = f64::from(LINKS) * LINK;
        let parameter = solve(0.1, 10.0, length, |c| 2.0 * c * (0.5 * SPAN / c).sinh());
        let height = |x: f64| parameter * ((x / parameter).cosh() - (0.5 * SPAN / parameter).cosh());
        let lowest = found.iter().map(|joint| joint.1).fold(0.0, f64::min);
        let mut outcome = Outcome::default();
        outcome.fact("moved", start);
        outcome.check("joints: largest distance from rest (units)", 0.0, worst, 3e-3);
        outcome.check("sag (units), against the smooth catenary", -height(0.0), -lowest, 5e-3);
        outcome.check("rods: largest relative error of the length", 0.0, stretch, 1.5e-3);
        let (frequency, shape) = slowest();
        let expected = std::f64::consts::TAU / frequency;
        outcome.check("swing out of the plane: period (s)", expected, swing(simulation, &shape)?, 5e-4 * expected);
        let axes = (Axis::linear("x (units)"), Axis::linear("y (units)"));
        outcome.charts.push(
            Chart::new("chain", "A hanging chain of 20 rods", axes.0, axes.1)
                .add(0, Mark::Line, "catenary", curve(-0.5 * SPAN, 0.5 * SPAN, 61, height))
                .add(5, Mark::Line, "where it began", arc())
                .add(1, Mark::Points, "joints", found),
        );
        Ok(outcome)
    })
}
