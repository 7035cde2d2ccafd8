//! Motion by less than the distance of neighbouring f32 numbers, a wave in stiff beads, and collisions of symplectic Euler.

use rockfall::{ContactLaw, Cuboid, Integrator, Material, Pair, Scene, Sphere, SphereId, Spring};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Radius of a bead in m, Young's modulus in Pa, Poisson's ratio, and density in kg/m³: steel.
const RADIUS: f32 = 0.00475;
const YOUNG: f32 = 193e9;
const POISSON: f32 = 0.3;
const DENSITY: f32 = 8000.0;
const BEADS: usize = 60;
/// Speed of the first bead, in m/s.
const SPEED: f32 = 0.1;
/// Time step in s, and number of steps.
const STEP: f32 = 4e-7;
const STEPS: u32 = 4_000;

/// Beads in a row that touch, of which the first moves towards the others. The row begins at `place`.
fn beads(place: f64) -> Result<Scene> {
    let mut scene = with(|settings| (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::HertzMindlin, false, 0.0));
    let steel = scene.add_material(Material::new("steel").young(YOUNG).poisson(POISSON).density(DENSITY))?;
    scene.set_pair(steel, steel, Pair::default().restitution(1.0).friction(0.0))?;
    for bead in 0..BEADS {
        let centre = [place + 2.0 * f64::from(RADIUS) * bead as f64, 0.0, 0.0];
        let speed = if bead == 0 { SPEED } else { 0.0 };
        let sphere = Sphere::new([0.0; 3], RADIUS).density(DENSITY).material(steel).velocity([speed, 0.0, 0.0]);
        scene.add_sphere(sphere.centred_at(centre))?;
    }
    Ok(scene)
}

/// The same beads in f64, by Hertz's law and velocity Verlet: their velocities at the end.
fn beads_in_f64() -> Vec<f64> {
    let [radius, young, poisson, dt] = [RADIUS, YOUNG, POISSON, STEP].map(f64::from);
    let mass = f64::from(Sphere::new([0.0; 3], RADIUS).density(DENSITY).mass);
    let stiffness = 4.0 / 3.0 * young / (2.0 * (1.0 - poisson * poisson)) * (0.5 * radius).sqrt();
    let mut x: Vec<f64> = (0..BEADS).map(|bead| 2.0 * radius * bead as f64).collect();
    let mut v = vec![0.0; BEADS];
    v[0] = f64::from(SPEED);
    let accelerations = |x: &[f64]| {
        let mut a = vec![0.0; BEADS];
        for bead in 1..BEADS {
            let force = stiffness * (2.0 * radius - (x[bead] - x[bead - 1])).max(0.0).powf(1.5);
            a[bead - 1] -= force / mass;
            a[bead] += force / mass;
        }
        a
    };
    let mut a = accelerations(&x);
    for _ in 0..STEPS {
        for bead in 0..BEADS {
            v[bead] += 0.5 * dt * a[bead];
            x[bead] += dt * v[bead];
        }
        a = accelerations(&x);
        v.iter_mut().zip(&a).for_each(|(v, a)| *v += 0.5 * dt * a);
    }
    v
}

fn chain(outcome: &mut Outcome) -> Result<()> {
    let exact = beads_in_f64();
    let peak = exact.iter().copied().fold(0.0, f64::max);
    let number = |values: &[f64]| (0_u8..).zip(values).map(|(bead, v)| (f64::from(bead), *v)).collect::<Vec<_>>();
    let axes = (Axis::linear("bead"), Axis::linear("velocity (m/s)"));
    let mut chart = Chart::new("silent-chain", "A wave in steel beads", axes.0, axes.1).add(0, Mark::Line, "f64", number(&exact));
    for (colour, place) in (0..).zip([0.0, 1.0]) {
        let mut simulation = on_cpu(beads(place)?, Integrator::VelocityVerlet)?;
        let before = simulation.energy()?.total();
        simulation.run(STEPS.into(), STEP)?;
        let velocities: Vec<f64> = simulation.spheres()?.iter().map(|bead| bead.velocity.x.into()).collect();
        let worst = velocities.iter().zip(&exact).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
        outcome.check(format!("wave, {place} m from the origin: greatest difference of a velocity (peaks)"), 0.0, worst / peak, 0.005);
        outcome.check(format!("wave, {place} m from the origin: relative change of the energy"), 0.0, simulation.energy()?.total() / before - 1.0, 0.01);
        chart = chart.add(colour, Mark::Points, format!("{place} m from the origin"), number(&velocities));
    }
    outcome.charts.push(chart);
    Ok(())
}

/// A ball alone that moves at `speed` from `place`: the distance that it covers in `steps` steps of `dt`, over that of the speed.
fn covered(integrator: Integrator, place: f32, speed: f32, dt: f32, steps: u32) -> Result<f64> {
    let mut scene = with(|settings| settings.gravity = 0.0);
    let id = scene.add_sphere(Sphere::new([place, 0.0, 0.0], 0.01).velocity([speed, 0.0, 0.0]))?;
    let mut simulation = on_cpu(scene, integrator)?;
    simulation.run(steps.into(), dt)?;
    let moved = simulation.sphere(id)?.centre()[0] - f64::from(place);
    Ok(moved / (f64::from(speed) * f64::from(dt) * f64::from(steps)))
}

fn slow(outcome: &mut Outcome) -> Result<()> {
    let integrators = [Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet];
    // The step is 3e-8, 5e-9 and 1e-9 of the coordinate. Half of the distance of neighbouring f32 numbers is 3e-8 to 6e-8 of it.
    for (integrator, (place, speed)) in integrators.into_iter().zip([(0.6, 0.02), (1.0, 0.005), (5.0, 0.005)]) {
        let what = format!("{integrator}: distance / v t, at {speed} m/s, {place} m from the origin");
        outcome.check(what, 1.0, covered(integrator, place, speed, 1e-6, 100_000)?, 0.01);
    }
    Ok(())
}

/// Energies over time, relative to the first.
fn energies(scene: Scene, integrator: Integrator, dt: f32, samples: u32, between: u64) -> Result<Vec<(f64, f64)>> {
    let mut simulation = on_cpu(scene, integrator)?;
    // Without contacts, because collisions are handled when bodies overlap already.
    let energy = |simulation: &mut rockfall::Simulation| {
        simulation.energy().map(|energy| energy.kinetic + energy.potential + energy.spring)
    };
    let first = energy(&mut simulation)?;
    (1..=samples)
        .map(|sample| {
            simulation.run(between, dt)?;
            Ok((f64::from(sample) * between as f64 * f64::from(dt), energy(&mut simulation)? / first))
        })
        .collect()
}

/// An elastic ball above a floor.
fn ball() -> Result<Scene> {
    let mut scene = with(|settings| (settings.gravity, settings.restitution, settings.friction, settings.contact_damping) = (5.0, 1.0, 0.0, 0.0));
    scene.add_sphere(Sphere::new([0.0, 2.2, 0.0], 0.5).velocity([0.3, 0.0, 0.0]))?;
    scene.add_box(Cuboid::between([-500.0, -5.0, -500.0], [500.0, 0.0, 500.0]))?;
    Ok(scene)
}

/// Four triangles of springs in an elastic cube of width 3 without gravity.
fn triangles() -> Result<Scene> {
    let mut scene = with(|settings| (settings.gravity, settings.restitution, settings.friction, settings.contact_damping) = (0.0, 1.0, 0.0, 0.0));
    for side in [-3.5_f32, 1.5] {
        for axis in 0..3 {
            let (mut low, mut high) = ([-3.5_f32; 3], [3.5_f32; 3]);
            (low[axis], high[axis]) = (side, side + 2.0);
            scene.add_box(Cuboid::between(low, high))?;
        }
    }
    for number in 0..4_u8 {
        let turn = f32::from(number) * 1.7;
        let (x, z) = (if number % 2 == 0 { -0.7 } else { 0.7 }, if number < 2 { -0.7 } else { 0.7 });
        let corner = |corner: u8| {
            let angle = turn + f32::from(corner) * 2.094;
            Sphere::new([x + 0.29 * angle.cos(), 0.29 * angle.sin(), z], 0.12).velocity([1.5 * turn.sin(), 1.5 * turn.cos(), 0.4 - 0.3 * turn])
        };
        let ids = (0..3).map(|place| scene.add_sphere(corner(place))).collect::<rockfall::Result<Vec<SphereId>>>()?;
        for (one, other) in [(0, 1), (1, 2), (2, 0)] {
            scene.add_spring(Spring::new(ids[one], ids[other], 40.0, 0.5))?;
        }
    }
    Ok(scene)
}

fn euler(outcome: &mut Outcome) -> Result<()> {
    let worst = |energies: &[(f64, f64)]| energies.iter().map(|energy| (energy.1 - 1.0).abs()).fold(0.0, f64::max);
    let axes = (Axis::linear("time (s)"), Axis::linear("energy over that at the start"));
    let mut chart = Chart::new("silent-energy", "Triangles of springs in an elastic cube, steps of 10 ms", axes.0, axes.1);
    for (colour, integrator, bound) in [(0, Integrator::Rk4, 0.05), (1, Integrator::SymplecticEuler, 0.3)] {
        let of_ball = energies(ball()?, integrator, 0.02, 100, 200)?;
        outcome.check(format!("elastic ball, {integrator}: greatest relative change of the energy in 400 s"), 0.0, worst(&of_ball), 0.01);
        let of_springs = energies(triangles()?, integrator, 0.01, 80, 50)?;
        outcome.check(format!("springs, {integrator}: greatest relative change of the energy in 40 s"), 0.0, worst(&of_springs), bound);
        chart = chart.add(colour, Mark::Line, integrator.to_string(), of_springs);
    }
    outcome.charts.push(chart);
    Ok(())
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        chain(&mut outcome)?;
        slow(&mut outcome)?;
        euler(&mut outcome)?;
        Ok(outcome)
    })
}
