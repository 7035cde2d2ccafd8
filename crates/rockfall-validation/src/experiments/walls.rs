//! Walls that move, conveyors and meshes: a racket, a closing wall, a belt, a turntable, a plate that shakes a ball, and a tube of triangles.

use std::f64::consts::{PI, TAU};

use rockfall::glam::DVec3;
use rockfall::{
    ContactLaw, Cuboid, Gauge, GaugeReading, Integrator, Material, MaterialId, Mesh, Meter, Motion, MotionId, MotionTerm, Pair, Polygon, Scene, Simulation, Sphere,
    Tag,
};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f32 = 9.81;

/// Elastic or inelastic balls without friction and gravity.
fn smooth(restitution: f32) -> Scene {
    with(|settings| {
        (settings.gravity, settings.restitution, settings.activation_threshold) = (0.0, restitution, 0.0);
        (settings.friction, settings.contact_damping) = (0.0, 0.0);
    })
}

/// Grains with the law `hertz-mindlin`, and their material.
fn grains(friction: f32) -> Result<(Scene, MaterialId)> {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::HertzMindlin, false, GRAVITY);
    });
    let rubber = scene.add_material(Material::new("rubber").density(1_000.0).young(1e7).poisson(0.3))?;
    scene.set_pair(rubber, rubber, Pair::default().restitution(0.3).friction(friction))?;
    Ok((scene, rubber))
}

fn slide(scene: &mut Scene, velocity: f64) -> Result<MotionId> {
    Ok(scene.add_motion(Motion::new("wall", MotionTerm::translation([velocity, 0.0, 0.0])))?)
}

fn velocity(simulation: &mut Simulation) -> Result<DVec3> {
    Ok(simulation.spheres()?[0].velocity.as_dvec3())
}

/// A racket at speed 1 hits a ball that comes with speed 2.
fn racket(outcome: &mut Outcome) -> Result<()> {
    for e in [1.0, 0.5, 0.0_f32] {
        let mut scene = smooth(e);
        let motion = slide(&mut scene, 1.0)?;
        scene.add_box(Cuboid::between([-1.0, -2.0, -2.0], [0.0, 2.0, 2.0]).motion(motion))?;
        scene.add_sphere(Sphere::new([1.0, 0.1, 0.0], 0.1).velocity([-2.0, 0.0, 0.0]))?;
        let mut simulation = on_cpu(scene, Integrator::Rk4)?;
        simulation.run(25, 0.02)?;
        let e = f64::from(e);
        outcome.check(format!("racket, e = {e}: velocity"), 1.0 + 3.0 * e, velocity(&mut simulation)?.x, 1e-5);
    }
    Ok(())
}

/// A ball between a wall at rest and one that closes in at 1/2: v_k = v_0 + k after k hits of it.
fn closing(outcome: &mut Outcome) -> Result<()> {
    let mut scene = smooth(1.0);
    let motion = slide(&mut scene, -0.5)?;
    scene.add_box(Cuboid::between([-1.0, -2.0, -2.0], [0.0, 2.0, 2.0]))?;
    scene.add_box(Cuboid::between([8.0, -2.0, -2.0], [9.0, 2.0, 2.0]).motion(motion))?;
    scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.1).velocity([1.0, 0.0, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    simulation.run(2_600, 0.005)?;
    let hits = simulation.report().total_collisions.div_ceil(2);
    outcome.check(format!("closing wall: speed after {hits} of its hits"), 1.0 + hits as f64, velocity(&mut simulation)?.length(), 1e-3);
    outcome.check("closing wall: 1 after at least 5 hits", 1.0, f64::from(u8::from(hits >= 5)), 0.0);
    Ok(())
}

/// A ball on a belt of speed 0.7 slips until it rolls at 2/7 of that.
fn belt(outcome: &mut Outcome) -> Result<()> {
    const SPEED: f64 = 0.7;
    let friction = 0.2;
    let (mut scene, rubber) = grains(friction)?;
    let belt = Cuboid::between([-3.0, -0.1, -3.0], [3.0, 0.0, 3.0]).surface_velocity([SPEED as f32, 0.0, 0.0]);
    scene.add_box(belt.material(rubber))?;
    scene.add_sphere(Sphere::new([-1.0, 0.05, 0.0], 0.05).mass(0.5).material(rubber))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let acceleration = f64::from(friction * GRAVITY);
    let slips = 2.0 * SPEED / (7.0 * acceleration);
    let theory = |time: f64| (acceleration * time).min(2.0 * SPEED / 7.0);
    let (samples, dt) = (30, 5e-5);
    let steps = (2.0 * slips / f64::from(samples) / f64::from(dt)).round() as u64;
    let (mut measured, mut off) = (Vec::new(), 0.0_f64);
    let mut meter = Meter::new(simulation.scene(), false, true);
    for sample in 1..=samples {
        simulation.run_metered(steps, dt, &mut meter)?;
        let (time, speed) = (f64::from(sample) * steps as f64 * f64::from(dt), velocity(&mut simulation)?.x);
        off = off.max((speed - theory(time)).abs());
        measured.push((time, speed));
    }
    outcome.check("belt: velocity, largest departure (units/s)", 0.0, off, 0.02 * SPEED);
    outcome.check("belt: final velocity (units/s)", 2.0 * SPEED / 7.0, velocity(&mut simulation)?.x, 0.005 * SPEED);
    let work = 2.0 * 0.5 * SPEED * SPEED / 7.0;
    outcome.check("belt: work on the ball (mass units²/s²)", work, meter.work, 0.01 * work);
    let axes = (Axis::linear("time (s)"), Axis::linear("velocity of the ball (units/s)"));
    outcome.charts.push(
        Chart::new("walls-belt", "A ball that is put on a belt", axes.0, axes.1)
            .add(0, Mark::Line, "theory", curve(0.0, 2.0 * slips, 200, theory))
            .add(1, Mark::Points, "measured", measured),
    );
    Ok(())
}

/// A ball that rolls on a turntable moves in a circle at 2/7 of the table's angular velocity.
fn turntable(outcome: &mut Outcome) -> Result<()> {
    const SPIN: f64 = 3.0;
    const RADIUS: f64 = 0.02;
    let (mut scene, rubber) = grains(0.8)?;
    let motion = scene.add_motion(Motion::new("table", MotionTerm::turn(SPIN, DVec3::Y, DVec3::ZERO)))?;
    scene.add_box(Cuboid::between([-1.0, -0.1, -1.0], [1.0, 0.0, 1.0]).material(rubber).motion(motion))?;
    // A circle of radius 0.2 about (0.1, 0, 0), from its farthest point: v = 2/7 SPIN y x (place - centre).
    let (centre, place) = (DVec3::new(0.1, 0.0, 0.0), DVec3::new(0.3, 0.0, 0.0));
    let rate = 2.0 * SPIN / 7.0;
    let velocity = rate * DVec3::Y.cross(place - centre);
    // The contact point of the ball has the velocity of the table.
    let spin = DVec3::Y.cross(velocity - SPIN * DVec3::Y.cross(place)) / RADIUS;
    let mass = 0.05;
    let ball = Sphere::new([place.x as f32, RADIUS as f32, 0.0], RADIUS as f32).mass(mass).velocity(velocity.as_vec3());
    let momentum = 0.4 * f64::from(mass) * RADIUS * RADIUS * spin;
    scene.add_sphere(ball.angular_momentum(momentum.as_vec3()).material(rubber))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let (period, samples, dt) = (TAU / rate, 60, 1e-4);
    let steps = (period / f64::from(samples) / f64::from(dt)).round() as u64;
    let (mut path, mut off) = (Vec::new(), 0.0_f64);
    for sample in 1..=samples {
        simulation.run(steps, dt)?;
        let found = simulation.spheres()?[0].position.as_dvec3();
        let angle = rate * f64::from(sample) * steps as f64 * f64::from(dt);
        let expected = centre + 0.2 * DVec3::new(angle.cos(), 0.0, -angle.sin());
        off = off.max((found - expected).with_y(0.0).length());
        path.push((found.x, -found.z));
    }
    outcome.check("turntable: largest distance from the circle (units)", 0.0, off, 0.03 * 0.2);
    let circle = (0..=200).map(|k| TAU * f64::from(k) / 200.0).map(|angle| (0.1 + 0.2 * angle.cos(), 0.2 * angle.sin()));
    outcome.charts.push(
        Chart::new("walls-turntable", "A ball that rolls on a turntable", Axis::linear("x (units)"), Axis::linear("-z (units)"))
            .add(0, Mark::Line, "theory", circle.collect())
            .add(1, Mark::Points, "measured", path),
    );
    Ok(())
}

/// The times of flight of a ball on a plate that shakes with the acceleration `gamma` G, over the period of the plate.
fn flights(gamma: f64, restitution: f64, count: usize) -> Result<Vec<f64>> {
    const FREQUENCY: f64 = 10.0;
    let mut scene = smooth(restitution as f32);
    scene.settings.gravity = GRAVITY;
    let (period, rate) = (1.0 / FREQUENCY, TAU * FREQUENCY);
    let amplitude = gamma * f64::from(GRAVITY) / (rate * rate);
    // The orbit of one period leaves where the plate has (1 - e) / (1 + e) G T / 2.
    let phase = (PI * (1.0 - restitution) / (1.0 + restitution) / gamma).acos() / TAU;
    let term = MotionTerm::oscillation([0.0, amplitude, 0.0], FREQUENCY).phase(phase);
    let motion = scene.add_motion(Motion::new("plate", term))?;
    scene.add_box(Cuboid::between([-1.0, -0.5, -1.0], [1.0, 0.0, 1.0]).motion(motion))?;
    let leaving = 0.5 * f64::from(GRAVITY) * period * 0.99;
    scene.add_sphere(Sphere::new([0.0, 0.01, 0.0], 0.01).velocity([0.0, leaving as f32, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let dt = (period / 400.0) as f32;
    let (mut hits, mut seen) = (vec![0.0], 0);
    while hits.len() <= count && simulation.report().time < 40.0 * count as f64 * period {
        simulation.run(1, dt)?;
        let report = simulation.report();
        if report.total_collisions > seen {
            seen = report.total_collisions;
            hits.push(report.time);
        }
    }
    Ok(hits.windows(2).map(|pair| (pair[1] - pair[0]) / period).collect())
}

fn plate(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    const RESTITUTION: f64 = 0.5;
    let count = effort.pick(80, 200);
    let last = |flights: &[f64]| flights[flights.len() - 12..].to_vec();
    let mut chart = Chart::new(
        "walls-plate",
        "Flights of a ball on a shaken plate, e = 0.5",
        Axis::linear("greatest acceleration of the plate / G"),
        Axis::linear("time of flight / period"),
    );
    let mut points = Vec::new();
    for gamma in [1.15, 1.25, 1.35, 1.45, 1.6, 1.7, 1.8] {
        let found = last(&flights(gamma, RESTITUTION, count)?);
        let spread = found.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        points.extend(found.iter().map(|flight| (gamma, *flight)));
        match gamma {
            1.35 => {
                outcome.check("plate, 1.35 G: largest difference of two flights (periods)", 0.0, spread, 0.01);
                let mean = found.iter().sum::<f64>() / found.len() as f64;
                outcome.check("plate, 1.35 G: mean flight (periods)", 1.0, mean, 0.002);
            }
            1.7 => outcome.check("plate, 1.7 G: 1 if flights alternate", 1.0, f64::from(u8::from(spread > 0.1)), 0.0),
            _ => {}
        }
    }
    chart = chart.add(1, Mark::Points, "measured", points);
    let doubles = ((PI / 3.0).powi(2) + (2.0 * 1.25 / 2.25_f64).powi(2)).sqrt();
    chart = chart.add(0, Mark::Line, "one period, up to the theory's limit", vec![(PI / 3.0, 1.0), (doubles, 1.0)]);
    outcome.charts.push(chart);
    Ok(())
}

/// Facets against a smooth tube: the frequency of a ball that rolls in it.
fn tube(outcome: &mut Outcome) -> Result<()> {
    const RADIUS: f64 = 0.01;
    let facets = 720;
    let (mut scene, rubber) = grains(0.8)?;
    scene.add_mesh(&Mesh::cylinder(0.1, 0.2, facets)?, |triangle| triangle.material(rubber))?;
    let reach = 0.1 * (PI / f64::from(facets)).cos() - RADIUS;
    let angle = 0.15_f64;
    let place = [(reach * angle.sin()) as f32, (-reach * angle.cos()) as f32, 0.1];
    scene.add_sphere(Sphere::new(place, RADIUS as f32).density(1_000.0).material(rubber))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let (dt, mut crossings, mut before) = (1e-4_f32, Vec::new(), f64::from(place[0]));
    for step in 1..=12_000 {
        simulation.run(1, dt)?;
        let x = f64::from(simulation.spheres()?[0].position.x);
        if before > 0.0 && x <= 0.0 {
            crossings.push((f64::from(step) - x / (x - before)) * f64::from(dt));
        }
        before = x;
    }
    let periods = (crossings.len() - 1) as f64;
    let measured = TAU * periods / (crossings[crossings.len() - 1] - crossings[0]);
    let theory = (5.0 * f64::from(GRAVITY) / (7.0 * reach)).sqrt() * (1.0 - angle * angle / 16.0);
    outcome.check("tube of triangles: frequency of a rolling ball (rad/s)", theory, measured, 0.01 * theory);
    Ok(())
}

/// The load on the floor of a box, and a plane of triangles against one of two.
fn floors(outcome: &mut Outcome) -> Result<()> {
    let run = |cells: u32| -> Result<(f64, DVec3)> {
        let (mut scene, rubber) = grains(0.4)?;
        let at = |x: u32, z: u32| x * (cells + 1) + z;
        let corner = |k: u32| 2.0 * k as f32 / cells as f32 - 1.0;
        let vertices = (0..=cells).flat_map(|x| (0..=cells).map(move |z| [corner(x), 0.0, corner(z)]));
        let squares = (0..cells).flat_map(|x| (0..cells).map(move |z| (x, z)));
        let halves = |(x, z)| [[at(x, z), at(x, z + 1), at(x + 1, z)], [at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)]];
        let mesh = Mesh::new(vertices.collect(), squares.flat_map(halves).collect())?;
        for id in scene.add_mesh(&mesh, |triangle| triangle.material(rubber))?.ids {
            scene.set_tag(id, Tag::new().name("floor"))?;
        }
        for (k, (x, z)) in [(0.0, 0.0), (0.3, 0.05), (-0.31, 0.2)].into_iter().enumerate() {
            let ball = Sphere::new([x, 0.11, z], 0.1).mass(1.0 + k as f32).velocity([0.2, 0.0, 0.1 * k as f32]);
            scene.add_sphere(ball.material(rubber))?;
        }
        scene.add_gauge(Gauge::wall("weight", "floor"))?;
        let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
        simulation.run(6_000, 2e-4)?;
        let [GaugeReading::Wall(load)] = simulation.gauges()?[..] else { return Err("expected the reading of a wall".into()) };
        Ok((load.force.y, simulation.spheres()?[2].position.as_dvec3()))
    };
    let ((force, one), (_, many)) = (run(1)?, run(16)?);
    outcome.check("floor: weight on a gauge (mass units/s²)", -6.0 * f64::from(GRAVITY), force, 1e-3 * 60.0);
    outcome.check("plane of 512 triangles: distance of a ball from that on 2 (units)", 0.0, (one - many).length(), 0.0);
    Ok(())
}

/// A ball on two polygons of a ramp that moves up gets its speed from the ramp alone.
fn lift(outcome: &mut Outcome) -> Result<()> {
    let mut scene = smooth(0.0);
    (scene.settings.gravity, scene.settings.contact_damping) = (GRAVITY, 12.5);
    let motion = scene.add_motion(Motion::new("lift", MotionTerm::translation([0.0, 0.4, 0.0])))?;
    for x in [-1.0, 0.0] {
        scene.add_polygon(Polygon::new([x, 0.0, -1.0], [0.0, 0.0, 2.0], [1.0, 0.0, 0.0]).motion(motion))?;
    }
    scene.add_sphere(Sphere::new([0.0, 0.1, 0.0], 0.1).velocity([0.0, 0.4, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(1_000, 0.005)?;
    let place = simulation.spheres()?[0].position.as_dvec3();
    outcome.check("lift: height after 5 s (units)", 2.1 - f64::from(GRAVITY) / 1000.0, place.y, 1e-3);
    Ok(())
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        racket(&mut outcome)?;
        closing(&mut outcome)?;
        belt(&mut outcome)?;
        turntable(&mut outcome)?;
        plate(&mut outcome, effort)?;
        tube(&mut outcome)?;
        floors(&mut outcome)?;
        lift(&mut outcome)?;
        Ok(outcome)
    })
}
