//! Energy of a spring pair over many steps.

use rockfall::Integrator::{self, Rk4, SymplecticEuler, VelocityVerlet};
use rockfall::{Sphere, Spring};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Time step h. With k = 2 and unit masses, omega = 2 and h omega = 0.2.
const STEP: f32 = 0.1;
const OMEGA: f64 = 2.0;
const SAMPLES: u64 = 50;

/// Samples of the step number, the energy and the invariant of the integrator (symplectic Euler or velocity Verlet), the latter two
/// relative to their first values.
type Sampled = Vec<(f64, f64, f64)>;

fn sampled(integrator: Integrator, steps: u64) -> Result<Sampled> {
    let mut scene = with(|settings| settings.gravity = 0.0);
    let a = scene.add_sphere(Sphere::new([-0.75, 0.0, 0.0], 0.1))?;
    let b = scene.add_sphere(Sphere::new([0.75, 0.0, 0.0], 0.1))?;
    scene.add_spring(Spring::new(a, b, 2.0, 1.0))?;
    let mut simulation = on_cpu(scene, integrator)?;
    let mut all = Vec::new();
    for sample in 0..=SAMPLES {
        if sample > 0 {
            simulation.run(steps / SAMPLES, STEP)?;
        }
        let spheres = simulation.spheres()?;
        let x = f64::from(spheres[1].position.x) - f64::from(spheres[0].position.x) - 1.0;
        let v = f64::from(spheres[1].velocity.x) - f64::from(spheres[0].velocity.x);
        let energy = v * v + OMEGA * OMEGA * x * x;
        let z = f64::from(STEP) * OMEGA;
        let invariant = match integrator {
            VelocityVerlet => energy - 0.25 * z * z * OMEGA * OMEGA * x * x,
            _ => energy - z * OMEGA * x * v,
        };
        all.push((simulation.report().steps as f64, energy, invariant));
    }
    let first = all[0];
    Ok(all.into_iter().map(|(step, energy, invariant)| (step, energy / first.1, invariant / first.2)).collect())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    let steps = effort.pick(20_000, 100_000);
    on_one_thread(move || {
        let z = f64::from(STEP) * OMEGA;
        // |R(iz)|² of one RK4 step.
        let kept = 1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0;
        let rk4 = sampled(Rk4, steps)?;
        let euler = sampled(SymplecticEuler, steps)?;
        let verlet = sampled(VelocityVerlet, steps)?;
        let last = rk4[rk4.len() - 1];
        let drift = |samples: &Sampled| samples.iter().map(|sample| (sample.2 - 1.0).abs()).fold(0.0, f64::max);
        let swing = |samples: &Sampled| samples.iter().map(|sample| (sample.1 - 1.0).abs()).fold(0.0, f64::max);
        let mut outcome = Outcome::default();
        outcome.fact("steps", steps as f64);
        outcome.check(format!("RK4: energy left after {steps} steps, E/E0"), kept.powf(steps as f64), last.1, 2e-3);
        outcome.check("Euler: largest relative drift of its invariant", 0.0, drift(&euler), 2e-3);
        // The bound follows from |x v| <= E / (2 omega), E = v² + omega² x².
        outcome.check("Euler: swing of the energy, within h omega / (2 - h omega)", 0.0, swing(&euler), z / (2.0 - z));
        outcome.check("Verlet: largest relative drift of its invariant", 0.0, drift(&verlet), 2e-3);
        // The pair begins at rest, where the energy is at its greatest.
        outcome.check("Verlet: swing of the energy, within (h omega)² / 4", 0.0, swing(&verlet), 0.25 * z * z + 2e-3);
        let theory = rk4.iter().map(|sample| (sample.0, kept.powf(sample.0))).collect();
        let measured = |samples: &Sampled| samples.iter().map(|sample| (sample.0, sample.1)).collect::<Vec<_>>();
        let invariant: Vec<_> = euler.iter().map(|sample| (sample.0, sample.2)).collect();
        let chart = Chart::new("drift", "Energy of a spring pair, h omega = 0.2", Axis::linear("step"), Axis::linear("E / E0"))
            .add(0, Mark::Line, "RK4, |R|^(2n)", theory)
            .add(0, Mark::Points, "RK4", measured(&rk4))
            .add(1, Mark::Points, "symplectic Euler", measured(&euler))
            .add(2, Mark::Points, "symplectic Euler, its invariant", invariant)
            .add(3, Mark::Points, "velocity Verlet", measured(&verlet));
        outcome.charts.push(chart);
        Ok(outcome)
    })
}
