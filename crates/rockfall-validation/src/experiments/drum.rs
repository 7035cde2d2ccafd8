//! Dynamic angle of repose in a drum that turns slowly.

use rockfall::Simulation;
use rockfall::generate::Drum;

use crate::chart::{Axis, Chart, Mark};
use crate::granular::{GRAVITY, simulation};
use crate::measure::{mean, on_one_thread};
use crate::{Effort, Outcome, Result};

/// Time step, in s: 13 % of the Rayleigh time of a grain.
const STEP: f32 = 5e-5;
/// Froude number w² R / G.
const FROUDE: f64 = 0.01;
/// Angle by which the drum has turned when the grains fall into place, in degrees.
const START: f64 = 20.0;
/// Angle by which the drum has turned when the measurement begins, in degrees.
const STEADY: f64 = 45.0;

/// A slice of a drum with smooth ends, about three diameters long.
fn slice(facets: u32, friction: f32) -> Drum {
    let mut drum = Drum::new(400);
    (drum.facets, drum.friction) = (facets, friction);
    (drum.length, drum.filling, drum.rough_ends) = (0.3, 0.45, false);
    drum
}

fn turn_to(simulation: &mut Simulation, degrees: f64) -> Result<()> {
    let mut settings = *simulation.settings();
    settings.gravity_direction = Drum::down(degrees.to_radians());
    Ok(simulation.set_settings(settings)?)
}

/// Angle, in degrees, from the direction of gravity to that of the centre of mass. It is the slope of a plane surface, because
/// the centre of mass then lies on the normal of the surface through the axis.
fn slope(simulation: &mut Simulation) -> Result<f64> {
    let down = simulation.settings().gravity_direction.as_dvec3();
    let spheres = simulation.spheres()?;
    let centre: rockfall::glam::DVec3 = spheres.iter().map(|sphere| sphere.position.as_dvec3()).sum();
    Ok((down.x * centre.y - down.y * centre.x).atan2(down.dot(centre)).to_degrees())
}

/// Turns a drum up to an angle in degrees. Returns the slopes at the angles.
fn slopes(drum: Drum, until: f64) -> Result<Vec<(f64, f64)>> {
    /// Steps between two changes of gravity, and changes between two samples.
    const STEPS: u64 = 50;
    const SAMPLE: u32 = 10;
    let mut simulation = simulation(drum.scene(3)?)?;
    let speed = (FROUDE * GRAVITY / f64::from(drum.drum_radius()?)).sqrt().to_degrees();
    turn_to(&mut simulation, START)?;
    simulation.run(4_000, STEP)?;
    let mut points = Vec::new();
    let mut turned = START;
    while turned < until {
        for _ in 0..SAMPLE {
            turned += speed * f64::from(STEP) * STEPS as f64;
            turn_to(&mut simulation, turned)?;
            simulation.run(STEPS, STEP)?;
        }
        points.push((turned, slope(&mut simulation)?));
    }
    Ok(points)
}

/// Mean slope in the steady flow.
fn steady(points: &[(f64, f64)]) -> f64 {
    mean(&points.iter().filter(|point| point.0 > STEADY).map(|point| point.1).collect::<Vec<_>>())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(move || {
        let until = effort.pick(110.0, 300.0);
        let mut outcome = Outcome::default();
        let axes = (Axis::linear("angle by which the drum has turned (degrees)"), Axis::linear("slope of the surface (degrees)"));
        let mut chart = Chart::new("drum", "Grains in a drum that turns slowly", axes.0, axes.1);
        let mut means = Vec::new();
        for (colour, facets) in effort.pick(&[24, 48][..], &[24, 48, 96]).iter().enumerate() {
            let points = slopes(slice(*facets, 0.65), until)?;
            means.push(steady(&points));
            chart = chart.add(colour, Mark::Points, format!("{facets} polygons"), points);
        }
        let most = means.iter().copied().fold(f64::MIN, f64::max);
        let least = means.iter().copied().fold(f64::MAX, f64::min);
        outcome.check("mean slope (degrees)", 32.5, mean(&means), 7.5);
        outcome.check("largest difference between numbers of polygons (degrees)", 0.0, most - least, effort.pick(4.0, 2.0));
        let smooth = slopes(slice(48, 0.0), effort.pick(80.0, until))?;
        outcome.check("mu = 0: mean slope (degrees)", 0.0, steady(&smooth), 2.0);
        outcome.charts.push(chart.add(4, Mark::Points, "mu = 0", smooth));
        outcome.fact("radius", 1e3 * f64::from(slice(48, 0.65).drum_radius()?));
        outcome.fact("until", until);
        Ok(outcome)
    })
}
