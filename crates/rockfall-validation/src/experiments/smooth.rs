//! Smooth walls: balls that swing in a tube and in a bowl, that go round in a cone, and that roll down a plane.

use std::f64::consts::TAU;

use rockfall::glam::DVec3;
use rockfall::{ContactLaw, Integrator, Material, MaterialId, Pair, Polygon, Scene, Simulation, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f64 = 9.81;
/// Radius of the walls and of the balls in the tube and in the bowl.
const WALL: f64 = 0.1;
const BALL: f64 = 0.01;

/// Hard balls with the law `linear`, and their material.
fn balls(friction: f32) -> Result<(Scene, MaterialId)> {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::Linear, false, GRAVITY as f32);
    });
    let glass = scene.add_material(Material::new("glass").density(2_500.0))?;
    scene.set_pair(glass, glass, Pair::default().restitution(0.5).friction(friction).stiffness(1e4))?;
    Ok((scene, glass))
}

fn state(simulation: &mut Simulation) -> Result<(DVec3, DVec3)> {
    let ball = simulation.spheres()?[0];
    Ok((ball.position.as_dvec3(), ball.velocity.as_dvec3()))
}

/// Balls that swing at the bottom of a tube or a bowl, rolling or sliding, over one period.
fn swings(outcome: &mut Outcome) -> Result<()> {
    const AMPLITUDE: f64 = 0.05;
    let reach = WALL - BALL;
    let tube = || Polygon::cylinder([0.0, 0.0, -0.1], [0.0, 0.0, 1.0], WALL as f32, 0.2).inside(true);
    let bowl = || Polygon::ball([0.0; 3], WALL as f32).inside(true);
    let mut chart = Chart::new(
        "smooth-swing",
        "Balls at the bottom of a smooth tube",
        Axis::linear("time (s)"),
        Axis::linear("angle (rad)"),
    );
    for (place, (name, wall, friction)) in
        [("tube, rolling", tube(), 0.8), ("tube, sliding", tube(), 0.0), ("bowl, rolling", bowl(), 0.8)].into_iter().enumerate()
    {
        let (mut scene, glass) = balls(friction)?;
        scene.add_polygon(wall.material(glass))?;
        let start = [reach * AMPLITUDE.sin(), -reach * AMPLITUDE.cos(), 0.0].map(|x| x as f32);
        scene.add_sphere(Sphere::new(start, BALL as f32).density(2_500.0).material(glass))?;
        let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
        let share = if friction > 0.0 { 5.0 / 7.0 } else { 1.0 };
        let rate = (share * GRAVITY / reach).sqrt() * (1.0 - AMPLITUDE * AMPLITUDE / 16.0);
        let (samples, dt) = (48, 2e-5_f32);
        let steps = (TAU / rate / f64::from(samples) / f64::from(dt)).round() as u64;
        let (mut measured, mut off) = (vec![(0.0, AMPLITUDE)], 0.0_f64);
        for sample in 1..=samples {
            simulation.run(steps, dt)?;
            let (x, _) = state(&mut simulation)?;
            let (time, angle) = (f64::from(sample) * steps as f64 * f64::from(dt), x.x.atan2(-x.y));
            off = off.max((angle - AMPLITUDE * (rate * time).cos()).abs());
            measured.push((time, angle));
        }
        outcome.check(format!("{name}: greatest difference of the angle (rad)"), 0.0, off, 0.01 * AMPLITUDE);
        if place < 2 {
            let theory = curve(0.0, TAU / rate, 200, |time| AMPLITUDE * (rate * time).cos());
            chart = chart.add(place, Mark::Line, format!("{name}, theory"), theory).add(place, Mark::Points, name, measured);
        }
    }
    outcome.charts.push(chart);
    Ok(())
}

/// A ball without friction goes round in a cone of 45 degrees at the height h above the apex of the cone of its centre.
fn orbit(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    const HEIGHT: f64 = 0.6;
    let (mut scene, glass) = balls(0.0)?;
    let cone = Polygon::cone([0.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.1, 1.1], 1.0).inside(true);
    scene.add_polygon(cone.material(glass))?;
    let (radius, mass) = (0.05, 2.0);
    // The contact carries m g / sin 45.
    let overlap = mass * GRAVITY * 2.0_f64.sqrt() / 1e4;
    let apex = (radius - overlap) * 2.0_f64.sqrt();
    let speed = (GRAVITY * HEIGHT).sqrt();
    let ball = Sphere::new([HEIGHT as f32, (apex + HEIGHT) as f32, 0.0], radius as f32).mass(mass as f32);
    scene.add_sphere(ball.velocity([0.0, 0.0, speed as f32]).material(glass))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let turns = effort.pick(1, 5_u32);
    let period = TAU * HEIGHT / speed;
    let steps = 20_000;
    let mut rise = 0.0_f64;
    for _ in 0..4 * turns {
        simulation.run(steps / 4, (period / steps as f64) as f32)?;
        rise = rise.max((state(&mut simulation)?.0.y - apex - HEIGHT).abs());
    }
    let (x, _) = state(&mut simulation)?;
    outcome.check("cone: greatest change of the height (units)", 0.0, rise, 1e-3 * HEIGHT);
    outcome.check(format!("cone: angle after {turns} turns (rad)"), 0.0, x.z.atan2(x.x), 0.01);
    Ok(())
}

/// A ball rolls down a plane with 5/7 of the acceleration of one that slides.
fn slope(outcome: &mut Outcome) -> Result<()> {
    const ANGLE: f64 = 0.4;
    let (mut scene, glass) = balls(0.5)?;
    let normal = DVec3::new(ANGLE.sin(), ANGLE.cos(), 0.0);
    scene.add_polygon(Polygon::plane([3.0 * ANGLE.cos() as f32, -3.0 * ANGLE.sin() as f32, 0.0], normal.as_vec3()).material(glass))?;
    scene.add_sphere(Sphere::new((BALL * normal).as_vec3(), BALL as f32).density(2_500.0).material(glass))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    simulation.run(20_000, 2e-5)?;
    let expected = 5.0 / 7.0 * GRAVITY * ANGLE.sin() * 0.4;
    outcome.check("plane: velocity after 0.4 s (units/s)", expected, state(&mut simulation)?.1.length(), 2e-3 * expected);
    Ok(())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        swings(&mut outcome)?;
        orbit(&mut outcome, effort)?;
        slope(&mut outcome)?;
        Ok(outcome)
    })
}
