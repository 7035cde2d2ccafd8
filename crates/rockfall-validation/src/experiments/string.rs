//! A plucked string of spheres and springs.

use std::f64::consts::{PI, TAU};

use rockfall::{Integrator, Scene, Sphere, Spring};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, period, with};
use crate::{Effort, Outcome, Result};

/// Number of spaces between the spheres, including the two fixed ones.
const SPACES: u32 = 40;
const SPACE: f64 = 0.2;
const MASS: f64 = 0.1;
const STIFFNESS: f64 = 200.0;
/// Tension of the string. The rest length of the springs is half of their stretched length.
const TENSION: f64 = STIFFNESS * 0.5 * SPACE;
const HEIGHT: f64 = 0.02;
/// Index of the sphere where the string is plucked, at a fifth of its length.
const PLUCKED: u32 = SPACES / 5;
const MODES: u32 = 8;
const STEP: f32 = 1.0 / 512.0;

fn plucked(index: u32) -> f64 {
    let part = |whole: u32, part: u32| f64::from(part) / f64::from(whole);
    HEIGHT * if index <= PLUCKED { part(PLUCKED, index) } else { part(SPACES - PLUCKED, SPACES - index) }
}

fn string() -> Result<Scene> {
    let mut scene = with(|settings| settings.gravity = 0.0);
    let mut last = None;
    for index in 0..=SPACES {
        let x = SPACE * (f64::from(index) - 0.5 * f64::from(SPACES));
        let sphere = Sphere::new([x as f32, plucked(index) as f32, 0.0], 0.02).mass(MASS as f32);
        let next = scene.add_sphere(if index == 0 || index == SPACES { sphere.fixed() } else { sphere })?;
        if let Some(last) = last {
            scene.add_spring(Spring::new(last, next, STIFFNESS as f32, 0.5 * SPACE as f32))?;
        }
        last = Some(next);
    }
    Ok(scene)
}

/// Amplitude of a mode in the displacements.
fn amplitude(mode: u32, displacements: impl Iterator<Item = f64>) -> f64 {
    let shape = |index: u32| (PI * f64::from(mode * index) / f64::from(SPACES)).sin();
    let sum: f64 = (0..=SPACES).zip(displacements).map(|(index, y)| shape(index) * y).sum();
    2.0 / f64::from(SPACES) * sum
}

/// Frequency of a mode, in Hz.
fn frequency(mode: f64) -> f64 {
    2.0 * (TENSION / (MASS * SPACE)).sqrt() * (0.5 * PI * mode / f64::from(SPACES)).sin() / TAU
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut simulation = on_cpu(string()?, Integrator::Rk4)?;
        let mut samples = vec![Vec::new(); MODES as usize];
        for step in 0..6_000_u32 {
            let spheres = simulation.spheres()?;
            for (mode, samples) in (1..).zip(&mut samples) {
                let displacements = spheres.iter().map(|sphere| f64::from(sphere.position.y));
                samples.push((f64::from(step) * f64::from(STEP), amplitude(mode, displacements)));
            }
            simulation.step(STEP)?;
        }
        let mut outcome = Outcome::default();
        let (mut points, mut amplitudes, mut expected) = (Vec::new(), Vec::new(), Vec::new());
        for (mode, samples) in (1..=MODES).zip(&samples) {
            let largest = samples.iter().map(|sample| sample.1.abs()).fold(0.0, f64::max);
            amplitudes.push((f64::from(mode), 1e3 * largest));
            let theory = amplitude(mode, (0..=SPACES).map(plucked)).abs();
            expected.push((f64::from(mode), 1e3 * theory));
            outcome.check(format!("mode {mode}: amplitude (1e-3 units)"), 1e3 * theory, 1e3 * largest, 0.03);
            // The fifth mode has a node where the string is plucked, so it has no frequency to measure.
            if mode != 5 {
                let found = 1.0 / period(samples);
                let theory = frequency(mode.into());
                outcome.check(format!("mode {mode}: frequency (Hz)"), theory, found, 1e-3 * theory);
                points.push((f64::from(mode), found));
            }
        }
        let axes = (Axis::linear("mode"), Axis::linear("frequency (Hz)"));
        outcome.charts.push(
            Chart::new("string-frequencies", "Modes of a plucked string", axes.0, axes.1)
                .add(0, Mark::Line, "spheres and springs", curve(1.0, MODES.into(), 29, frequency))
                .add(
                    5,
                    Mark::Line,
                    "smooth string",
                    curve(1.0, MODES.into(), 2, |mode| {
                        (TENSION * SPACE / MASS).sqrt() * mode / (2.0 * SPACE * f64::from(SPACES))
                    }),
                )
                .add(1, Mark::Points, "measured", points),
        );
        let axes = (Axis::linear("mode"), Axis::linear("amplitude (1e-3 units)"));
        outcome.charts.push(
            Chart::new("string-amplitudes", "A string plucked at a fifth", axes.0, axes.1)
                .add(0, Mark::Line, "theory", expected)
                .add(1, Mark::Points, "measured", amplitudes),
        );
        Ok(outcome)
    })
}
