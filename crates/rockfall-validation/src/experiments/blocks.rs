//! Boxes of rigid bodies: on an incline, in a stack, in an overhang, as leaning cards, rocking, as dominoes, and elastic impacts.

mod dominoes;
mod motion;
mod rest;

use rockfall::glam::Vec3;
use rockfall::{ContactLaw, Cuboid, MaterialId, Material, Pair, RigidBody, Scene, Shape, Simulation};

use crate::measure::{on_one_thread, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f32 = 9.81;
const DENSITY: f32 = 1_000.0;

/// A scene with the law `linear` and one material.
fn stage(gravity: Vec3, pair: Pair) -> Result<(Scene, MaterialId)> {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions) = (ContactLaw::Linear, false);
        (settings.gravity, settings.gravity_direction) = (gravity.length(), gravity.normalize_or(Vec3::NEG_Y));
    });
    let stuff = scene.add_material(Material::new("stuff").density(DENSITY))?;
    scene.set_pair(stuff, stuff, pair)?;
    Ok((scene, stuff))
}

/// Adds a floor, whose surface is the plane y = 0.
fn floor(scene: &mut Scene, stuff: MaterialId) -> Result<()> {
    scene.add_box(Cuboid::between([-20.0, -1.0, -20.0], [20.0, 0.0, 20.0]).material(stuff))?;
    Ok(())
}

/// A box with these edges about the origin.
fn block(stuff: MaterialId, edges: Vec3, rounding: f32) -> Shape {
    Shape::new().material(stuff).density(DENSITY).rounding(rounding).cuboid(Cuboid::between(-0.5 * edges, 0.5 * edges))
}

/// A 20th of half a period of a mass on so many contacts.
fn step(mass: f32, stiffness: f32, contacts: f32) -> f32 {
    0.05 * std::f32::consts::PI * (mass / (contacts * stiffness)).sqrt()
}

/// Runs for about a time. Returns the time of the steps.
fn run_for(simulation: &mut Simulation, time: f32, step: f32) -> Result<f64> {
    let steps = (time / step).round();
    simulation.run(steps as u64, step)?;
    Ok(f64::from(steps) * f64::from(step))
}

fn bodies(simulation: &mut Simulation) -> Result<Vec<RigidBody>> {
    Ok(simulation.sync()?.bodies().to_vec())
}

/// Angle between the axis y of a body and the vertical, rad.
fn tilt(body: &RigidBody) -> f64 {
    let up = body.orientation.as_dquat() * rockfall::glam::DVec3::Y;
    up.x.hypot(up.z).atan2(up.y)
}

/// Runs the experiment.
pub(super) fn run(_effort: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        rest::inclines(&mut outcome)?;
        rest::stack(&mut outcome)?;
        rest::overhang(&mut outcome)?;
        rest::cards(&mut outcome)?;
        motion::rocking(&mut outcome)?;
        dominoes::dominoes(&mut outcome)?;
        motion::impacts(&mut outcome)?;
        Ok(outcome)
    })
}
