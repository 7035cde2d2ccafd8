//! Compares the speed of rockfall's CPU backend with rapier3d: spheres or boxes settle in a walled box, in alternating runs in
//! one process.
//!
//! Both engines get the same bodies, box, gravity, restitution, friction and time step. rapier3d solves with 4 iterations and
//! never puts a body to sleep, because rockfall moves every body in every step. Both use all threads. For boxes rockfall takes
//! the contact law `rigid` with the substeps that it chooses. The overlaps of both are measured alike: by rockfall, from the
//! final poses.

use std::time::Instant;

use clap::Parser;
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, Rotation, Vector};
use rockfall::generate::Benchmark;
use rockfall::glam::{DVec3, Quat};
use rockfall::{Backend, Cuboid, Integrator, Options, RigidBody, RunDefaults, Scene, Simulation, Sphere};

/// Steps per second of rockfall and of rapier3d on the CPU, and their ratio.
#[derive(Debug, Parser)]
struct Arguments {
    /// Number of spheres in the box
    #[arg(long, default_value_t = 10_000)]
    spheres: u32,
    /// Number of boxes in the box, in place of spheres
    #[arg(long)]
    boxes: Option<u32>,
    /// Number of timed steps in each run
    #[arg(long, default_value_t = 100)]
    steps: u64,
    /// Steps before the timed ones; the spheres are still falling then
    #[arg(long, default_value_t = 100)]
    warmup: u64,
    /// Number of runs of each engine, alternating; the median is reported
    #[arg(long, default_value_t = 5)]
    runs: u32,
    /// Time step in seconds [default: 0.02 for spheres, 1/60 for boxes]
    #[arg(long)]
    dt: Option<f32>,
    /// Integrator of rockfall: rk4 or symplectic-euler
    #[arg(long, default_value_t = Integrator::Rk4)]
    integrator: Integrator,
}

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    let scene = match arguments.boxes {
        None => Benchmark::Pile.generate(arguments.spheres, 1)?,
        Some(boxes) => hard_boxes(boxes)?,
    };
    let dt = arguments.dt.unwrap_or(if arguments.boxes.is_some() { 1.0 / 60.0 } else { 0.02 });
    let mut rapier = Rapier::new(&scene, dt)?;
    let options = Options::new().backend(Backend::Cpu).integrator(arguments.integrator);
    let mut rockfall = Simulation::with_options(scene, options)?;
    rockfall.run(arguments.warmup, dt)?;
    rapier.run(arguments.warmup);

    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..arguments.runs {
        let start = Instant::now();
        rockfall.run(arguments.steps, dt)?;
        ours.push(start.elapsed().as_secs_f64());
        let start = Instant::now();
        rapier.run(arguments.steps);
        theirs.push(start.elapsed().as_secs_f64());
    }
    let speed = |seconds: &mut Vec<f64>| {
        seconds.sort_by(f64::total_cmp);
        let of = |seconds: f64| arguments.steps as f64 / seconds;
        let (median, last) = (seconds.len() / 2, seconds.len() - 1);
        (of(seconds[median]), of(seconds[last]), of(seconds[0]))
    };
    println!(
        "{} {} settling in a walled box, {}, dt {} s, median (minimum to maximum) of {} runs of {} steps",
        arguments.boxes.unwrap_or(arguments.spheres),
        if arguments.boxes.is_some() { "boxes" } else { "spheres" },
        rockfall.backend().device,
        dt,
        arguments.runs,
        arguments.steps
    );
    let print = |name: &str, seconds: &mut Vec<f64>| {
        let (median, least, greatest) = speed(seconds);
        println!("{name:<28} {median:9.1} steps/s ({least:.1} to {greatest:.1})");
        median
    };
    let method = match rockfall.substeps() {
        Some(substeps) => format!("rockfall, {substeps} substeps"),
        None => format!("rockfall, {}", arguments.integrator),
    };
    let ours = print(&method, &mut ours);
    let theirs = print("rapier3d, 4 iterations", &mut theirs);
    println!("rockfall is {:.2} times as fast as rapier3d", ours / theirs);
    if arguments.boxes.is_some() {
        return compare_boxes(&mut rockfall, &rapier);
    }
    // A plausibility check: the piles of both engines should have about the same height.
    let heights =
        (mean_height(&rockfall.spheres()?.iter().map(|sphere| sphere.position.y).collect::<Vec<_>>()), rapier.mean_height());
    println!("mean height at the end: rockfall {:.3}, rapier3d {:.3}", heights.0, heights.1);
    Ok(())
}

/// Bricks that fall into a walled box, for the contact law `rigid`.
fn hard_boxes(count: u32) -> Result<Scene, Failure> {
    let mut scene = Benchmark::Boxes.generate(count, 1)?;
    scene.run = RunDefaults::default();
    Ok(scene)
}

/// Prints how high the boxes of both engines lie, how deep they overlap and how many have left the box.
fn compare_boxes(rockfall: &mut Simulation, rapier: &Rapier) -> Result<(), Failure> {
    let ours = rockfall.sync()?.clone();
    let mut theirs = ours.clone();
    let ids: Vec<_> = theirs.body_ids().collect();
    for (id, (_, body)) in ids.into_iter().zip(rapier.moving()) {
        let (place, turn) = (body.translation(), body.rotation());
        theirs.update_body(id, |own| {
            own.set_centre(DVec3::new(place.x.into(), place.y.into(), place.z.into()));
            own.orientation = Quat::from_xyzw(turn.x, turn.y, turn.z, turn.w).normalize();
        })?;
    }
    for (name, scene) in [("rockfall", ours), ("rapier3d", theirs)] {
        let heights: Vec<f32> = scene.bodies().iter().map(|body| body.position.y).collect();
        let lost = heights.iter().filter(|height| **height < 0.0).count();
        let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu))?;
        let mut overlaps: Vec<f32> = simulation.contacts()?.iter().map(|contact| contact.overlap).collect();
        overlaps.sort_by(f32::total_cmp);
        let deepest = overlaps.get(overlaps.len() * 99 / 100).copied().unwrap_or_default();
        let height = mean_height(&heights);
        println!("{name:<10} mean height {height:.3}, 99th percentile of overlaps {deepest:.4}, {lost} fell below the floor");
    }
    Ok(())
}

fn mean_height(heights: &[f32]) -> f64 {
    heights.iter().map(|height| f64::from(*height)).sum::<f64>() / heights.len() as f64
}

struct Rapier {
    world: PhysicsWorld,
}

impl Rapier {
    fn new(scene: &Scene, dt: f32) -> Result<Self, Failure> {
        let mut world = PhysicsWorld::new();
        let gravity = scene.settings.gravity * scene.settings.gravity_direction;
        world.gravity = Vector::new(gravity.x, gravity.y, gravity.z);
        world.integration_parameters.num_solver_iterations = 4;
        world.integration_parameters.dt = dt;
        let surface = (scene.settings.restitution, scene.settings.coulomb_friction);
        for (id, sphere) in scene.sphere_ids().zip(scene.spheres()) {
            if scene.body_of_sphere(id).is_none() {
                Self::add_sphere(&mut world, sphere, surface.0);
            }
        }
        for body in scene.bodies() {
            let [i, j, k] = scene.shape(body.shape)?.boxes[0].cuboid.edges.map(|edge| 0.5 * edge.length());
            Self::add_brick(&mut world, body, [i, j, k], surface);
        }
        for cuboid in scene.boxes() {
            Self::add_box(&mut world, cuboid, surface, !scene.bodies().is_empty());
        }
        Ok(Self { world })
    }

    /// Adds a brick of mass 1 whose centre of mass is its middle.
    fn add_brick(world: &mut PhysicsWorld, body: &RigidBody, half: [f32; 3], (restitution, friction): (f32, f32)) {
        let [x, y, z] = body.position.to_array();
        let turn = Rotation::from_xyzw(body.orientation.x, body.orientation.y, body.orientation.z, body.orientation.w);
        let pose = Pose::from_parts(Vector::new(x, y, z), turn);
        let moving = RigidBodyBuilder::dynamic().pose(pose).can_sleep(false);
        let collider = ColliderBuilder::cuboid(half[0], half[1], half[2]).mass(1.0);
        world.insert(moving, collider.restitution(restitution).friction(friction));
    }

    fn add_sphere(world: &mut PhysicsWorld, sphere: &Sphere, restitution: f32) {
        let [x, y, z] = sphere.position.to_array();
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(x, y, z)).can_sleep(false);
        let ball = ColliderBuilder::ball(sphere.radius).mass(sphere.mass).restitution(restitution);
        world.insert(body, ball);
    }

    /// Adds a box whose edges are parallel to the axes.
    fn add_box(world: &mut PhysicsWorld, cuboid: &Cuboid, (restitution, friction): (f32, f32), has_friction: bool) {
        let edges = cuboid.edges;
        let half = 0.5 * (edges[0].abs() + edges[1].abs() + edges[2].abs());
        let centre = cuboid.corner + 0.5 * (edges[0] + edges[1] + edges[2]);
        let body = RigidBodyBuilder::fixed().translation(Vector::new(centre.x, centre.y, centre.z));
        let collider = ColliderBuilder::cuboid(half.x, half.y, half.z).restitution(restitution);
        // Spheres keep the default of rapier3d.
        world.insert(body, if has_friction { collider.friction(friction) } else { collider });
    }

    /// The bodies that move, in order of addition.
    fn moving(&self) -> impl Iterator<Item = (RigidBodyHandle, &rapier3d::prelude::RigidBody)> {
        self.world.bodies.iter().filter(|(_, body)| body.is_dynamic())
    }

    fn run(&mut self, steps: u64) {
        for _ in 0..steps {
            self.world.step();
        }
    }

    fn mean_height(&self) -> f64 {
        mean_height(&self.moving().map(|(_, body)| body.translation().y).collect::<Vec<_>>())
    }
}
