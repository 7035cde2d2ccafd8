//! A gas of inelastic grains in a box whose images slide: its temperature, its flow, and a pair that meets across the face.

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::Vec3;
use rockfall::{ContactLaw, Integrator, Material, MaterialId, Pair, Scene, Shear, Simulation, Sphere, SphereState};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Spheres along an edge of the box, and the part of the volume that they fill.
const ALONG: usize = 5;
const FILLED: f64 = 0.2;
const RESTITUTION: f64 = 0.9;
/// Rate of the shear.
const RATE: f64 = 1.0;
/// Duration of a contact, and the time step.
const CONTACT: f64 = 0.01;
const STEP: f32 = 1e-3;

/// An empty sheared box, for smooth spheres of diameter 1 and mass 1.
fn empty(length: f32, shear: Option<Shear>) -> Result<(Scene, MaterialId)> {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::Linear, false, 0.0);
    });
    let stuff = scene.add_material(Material::new("stuff").density((6.0 / PI) as f32))?;
    let stiffness = 0.5 * (PI / CONTACT).powi(2);
    scene.set_pair(
        stuff,
        stuff,
        Pair::default().stiffness(stiffness as f32).restitution(RESTITUTION as f32).friction(0.0),
    )?;
    (0..3).try_for_each(|axis| scene.set_periodic(axis, Some([0.0, length])))?;
    scene.set_shear(shear)?;
    Ok((scene, stuff))
}

/// The gas, with the velocity of the flow and a temperature above that of the steady state.
fn gas(length: f32) -> Result<Scene> {
    let mut random = Pcg64Mcg::seed_from_u64(4);
    let (mut scene, stuff) = empty(length, Some(Shear::new(1, 0, RATE as f32)))?;
    let spacing = length / ALONG as f32;
    for index in 0..ALONG.pow(3) {
        let place = [index % ALONG, index / ALONG % ALONG, index / (ALONG * ALONG)].map(|place| (place as f32 + 0.5) * spacing);
        let own = Vec3::from_array(std::array::from_fn(|_| random.random_range(-3.0..3.0_f32)));
        let velocity = own + Vec3::new(RATE as f32 * place[1], 0.0, 0.0);
        scene.add_sphere(Sphere::new(place, 0.5).velocity(velocity).material(stuff))?;
    }
    Ok(scene)
}

/// The states of the images in the box.
fn in_box(simulation: &mut Simulation) -> Result<Vec<SphereState>> {
    let mut states = simulation.spheres()?.to_vec();
    states.iter_mut().for_each(|state| state.bring_into_box(simulation.scene()));
    Ok(states)
}

/// The granular temperature: a third of the mean square of the velocities relative to a flow with the velocity `drift` at the height 0.
fn temperature(states: &[SphereState], drift: f64) -> f64 {
    let square = |state: &SphereState| {
        let flow = Vec3::new((RATE * f64::from(state.position.y) + drift) as f32, 0.0, 0.0);
        f64::from((state.velocity - flow).length_squared())
    };
    states.iter().map(square).sum::<f64>() / (3.0 * states.len() as f64)
}

/// Slope of the velocity of the flow over the height, by least squares, and its value at the height 0.
fn profile(states: &[SphereState]) -> [f64; 2] {
    let count = states.len() as f64;
    let mean = |of: &dyn Fn(&SphereState) -> f64| states.iter().map(of).sum::<f64>() / count;
    let height = |state: &SphereState| f64::from(state.position.y);
    let speed = |state: &SphereState| f64::from(state.velocity.x);
    let (y, v) = (mean(&height), mean(&speed));
    let slope = mean(&|state| (height(state) - y) * (speed(state) - v)) / mean(&|state| (height(state) - y).powi(2));
    [slope, v - slope * y]
}

/// Temperature at which the viscosity heats as much as collisions cool (Enskog).
fn steady() -> f64 {
    let at_contact = (1.0 - FILLED / 2.0) / (1.0 - FILLED).powi(3);
    let dense = FILLED * at_contact;
    let dilute = 5.0 * PI.sqrt() / 96.0;
    let viscosity = dilute * ((1.0 + 1.6 * dense).powi(2) / at_contact + 768.0 / (25.0 * PI) * FILLED * dense);
    let cooling = 12.0 / PI.sqrt() * (1.0 - RESTITUTION * RESTITUTION) * FILLED * dense;
    viscosity / cooling * RATE * RATE
}

fn sheared_gas(outcome: &mut Outcome) -> Result<()> {
    let length = (ALONG.pow(3) as f64 * PI / 6.0 / FILLED).cbrt() as f32;
    let mut simulation = on_cpu(gas(length)?, Integrator::SymplecticEuler)?;
    let (mut measured, mut mean, mut slope) = (Vec::new(), 0.0, 0.0);
    let (samples, first) = (80, 20);
    let drift = |states: &[SphereState]| profile(states)[1];
    for sample in 0..samples {
        let states = in_box(&mut simulation)?;
        let strain = 0.25 * f64::from(sample);
        let now = temperature(&states, drift(&states));
        measured.push((strain, now));
        if sample >= first {
            mean += now / f64::from(samples - first);
            slope += profile(&states)[0] / f64::from(samples - first);
        }
        simulation.run((0.25 / f64::from(STEP)) as u64, STEP)?;
    }
    outcome.check("sheared gas: mean temperature in units of d² γ̇²", steady(), mean, 0.2 * steady());
    outcome.check("sheared gas: slope of the velocity of the flow", RATE, slope, 0.05);
    outcome.charts.push(
        Chart::new("shear-gas", "A sheared gas of inelastic grains", Axis::linear("strain"), Axis::linear("temperature"))
            .add(0, Mark::Line, "steady state of kinetic theory", curve(0.0, 20.0, 2, |_| steady()))
            .add(1, Mark::Points, "measured", measured),
    );
    Ok(())
}

/// Velocities after a pair met across the face, and as inside.
fn across(outcome: &mut Outcome) -> Result<()> {
    const LENGTH: f32 = 8.0;
    let shear = Shear::new(1, 0, RATE as f32).with_turns(0.125);
    let mut found = Vec::new();
    for is_across in [true, false] {
        let (mut scene, stuff) = empty(LENGTH, is_across.then_some(shear))?;
        // The box above is displaced by 1 and has the velocity 8.
        let (image, drift) = (Vec3::new(1.0, LENGTH, 0.0), Vec3::new(LENGTH, 0.0, 0.0));
        let (one, other) = (Vec3::new(4.0, 7.4, 4.0), Vec3::new(2.0, 0.7, 4.2));
        let velocity = Vec3::new(-7.2, -1.0, 0.0);
        let [other, velocity, down] = if is_across { [other, velocity, Vec3::ZERO] } else { [other + image, velocity + drift, Vec3::new(0.0, -4.0, 0.0)] };
        scene.add_sphere(Sphere::new(one + down, 0.5).material(stuff))?;
        scene.add_sphere(Sphere::new(other + down, 0.5).velocity(velocity).material(stuff))?;
        let mut simulation = on_cpu(scene, Integrator::SymplecticEuler)?;
        simulation.run(1_250, STEP)?;
        found.push(simulation.spheres()?.iter().map(|state| state.velocity).collect::<Vec<_>>());
    }
    let moved = found[1][0].length();
    outcome.check("pair: 1 if the first sphere was hit", 1.0, f64::from(u8::from(moved > 0.3)), 0.0);
    let off = f64::from((found[0][0] - found[1][0]).length());
    outcome.check("pair across the face: difference of velocity from that inside", 0.0, off, 2e-3);
    Ok(())
}

pub(super) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        across(&mut outcome)?;
        sheared_gas(&mut outcome)?;
        Ok(outcome)
    })
}
