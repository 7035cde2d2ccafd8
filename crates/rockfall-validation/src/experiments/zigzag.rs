//! A zigzag stack between two walls, against statics.

use rockfall::{Body, ContactAction, Cuboid, Integrator, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Time step in s.
const STEP: f32 = 0.002;
const BALLS: usize = 10;

/// Pressures of the ball at each level on its wall and on the contact below it, and the remaining kinetic energy.
fn stacked(stiffness: f32, step: f32, integrator: Integrator) -> Result<([[f64; 2]; BALLS], f64)> {
    let mut scene = with(|settings| {
        settings.friction = 0.0;
        settings.contact_force = stiffness;
        settings.contact_damping = 12.5 * (stiffness / 1000.0).sqrt();
    });
    scene.add_box(Cuboid::between([-3.0, -3.0, -3.0], [3.0, 0.0, 3.0]))?;
    for side in [-1.8, 1.8_f32] {
        scene.add_box(Cuboid::between([side - 1.0, 0.0, -3.0], [side + 1.0, 30.0, 3.0]))?;
    }
    // The initial gap is about 0.001: the centres are 0.6 apart horizontally and 0.8008 vertically.
    let ids: Vec<_> = (0..BALLS)
        .map(|level| {
            scene.add_sphere(Sphere::new([if level % 2 == 0 { -0.3 } else { 0.3 }, 0.5 + 0.8008 * level as f32, 0.0], 0.5))
        })
        .collect::<rockfall::Result<_>>()?;
    let mut simulation = on_cpu(scene, integrator)?;
    simulation.run((40.0 / step) as u64, step)?;
    let mut pressures = [[0.0; 2]; BALLS];
    for contact in simulation.contacts()? {
        let ContactAction::Force(force) = contact.action else {
            return Err("zigzag: the stack still has collisions after 40 s".into());
        };
        let pressure = f64::from(force.length());
        let level = |body: Body| ids.iter().position(|id| body == Body::Sphere(*id));
        match (level(contact.a), level(contact.b)) {
            (Some(a), Some(b)) => pressures[a.max(b)][1] += pressure,
            (Some(a), None) if contact.normal.y.abs() > 0.5 => pressures[a][1] += pressure,
            (Some(a), None) => pressures[a][0] += pressure,
            _ => {}
        }
    }
    Ok((pressures, simulation.energy()?.kinetic))
}

/// Pressures by statics. With k balls above it, the contact below a ball bears (k + 1) / cos.
fn statics() -> [[f64; 2]; BALLS] {
    let mut pressures = [[0.0; 2]; BALLS];
    for (level, [wall, below]) in pressures.iter_mut().enumerate() {
        let above = (BALLS - 1 - level) as f64;
        // The contacts with the neighbours have tan = 0.6 / 0.8 and cos = 0.8.
        *wall = 0.75 * if level == 0 { above } else { 2.0 * above + 1.0 };
        *below = if level == 0 { above + 1.0 } else { (above + 1.0) / 0.8 };
    }
    pressures
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        let expected = statics();
        let mut shown = None;
        for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
            let (found, kinetic) = stacked(50_000.0, STEP, integrator)?;
            let part = |of: usize| {
                let departure = |(found, expected): (&[f64; 2], &[f64; 2])| (found[of] / expected[of] - 1.0).abs();
                found.iter().zip(&expected).map(departure).fold(0.0, f64::max)
            };
            outcome.check(format!("{integrator}: pressure on the walls / statics - 1, worst case"), 0.0, part(0), 0.01);
            outcome.check(format!("{integrator}: pressure on the contact below / statics - 1, worst case"), 0.0, part(1), 0.01);
            // With symplectic Euler the kinetic energy is that of v + G h/2 (docs/physics section 5.2).
            let late = if integrator == Integrator::SymplecticEuler { 0.5 * STEP } else { 0.0 };
            let at_rest = 0.5 * BALLS as f64 * f64::from(late).powi(2);
            outcome.check(format!("{integrator}: kinetic energy at rest"), at_rest, kinetic, 1e-6);
            shown.get_or_insert(found);
        }
        let axes = (Axis::linear("level of the ball"), Axis::linear("pressure (mass units/s²)"));
        let mut chart = Chart::new("zigzag", "A zigzag stack of ten balls", axes.0, axes.1);
        for (of, name) in ["wall", "below"].into_iter().enumerate() {
            let points =
                |pressures: &[[f64; 2]; BALLS]| pressures.iter().enumerate().map(|(level, p)| (level as f64, p[of])).collect();
            chart = chart.add(of, Mark::Line, format!("{name}, statics"), points(&expected));
            chart = chart.add(of, Mark::Points, name, points(&shown.unwrap_or_default()));
        }
        outcome.charts.push(chart);
        Ok(outcome)
    })
}
