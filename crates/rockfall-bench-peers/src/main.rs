//! Compares the speed of rockfall's CPU backend with rapier3d: spheres settle in a walled box, in alternating runs in one
//! process.
//!
//! Both engines get the same spheres, box, gravity, restitution and time step. rapier3d solves with 4 iterations and never puts
//! a body to sleep, because rockfall moves every body in every step. Both use all threads.

use std::time::Instant;

use clap::Parser;
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder, Vector};
use rockfall::generate::Benchmark;
use rockfall::{Backend, Cuboid, Integrator, Options, Scene, Simulation, Sphere};

/// Steps per second of rockfall and of rapier3d on the CPU, and their ratio.
#[derive(Debug, Parser)]
struct Arguments {
    /// Number of spheres in the box
    #[arg(long, default_value_t = 10_000)]
    spheres: u32,
    /// Number of timed steps in each run
    #[arg(long, default_value_t = 100)]
    steps: u64,
    /// Steps before the timed ones; the spheres are still falling then
    #[arg(long, default_value_t = 100)]
    warmup: u64,
    /// Number of runs of each engine, alternating; the median is reported
    #[arg(long, default_value_t = 5)]
    runs: u32,
    /// Time step in seconds
    #[arg(long, default_value_t = 0.02)]
    dt: f32,
    /// Integrator of rockfall: rk4 or symplectic-euler
    #[arg(long, default_value_t = Integrator::Rk4)]
    integrator: Integrator,
}

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    let scene = Benchmark::Pile.generate(arguments.spheres, 1)?;
    let mut rapier = Rapier::new(&scene, arguments.dt);
    let options = Options::new().backend(Backend::Cpu).integrator(arguments.integrator);
    let mut rockfall = Simulation::with_options(scene, options)?;
    rockfall.run(arguments.warmup, arguments.dt)?;
    rapier.run(arguments.warmup);

    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..arguments.runs {
        let start = Instant::now();
        rockfall.run(arguments.steps, arguments.dt)?;
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
        "{} spheres settling in a walled box, {}, dt {} s, median (minimum to maximum) of {} runs of {} steps",
        arguments.spheres,
        rockfall.backend().device,
        arguments.dt,
        arguments.runs,
        arguments.steps
    );
    let print = |name: &str, seconds: &mut Vec<f64>| {
        let (median, least, greatest) = speed(seconds);
        println!("{name:<28} {median:9.1} steps/s ({least:.1} to {greatest:.1})");
        median
    };
    let ours = print(&format!("rockfall, {}", arguments.integrator), &mut ours);
    let theirs = print("rapier3d, 4 iterations", &mut theirs);
    println!("rockfall is {:.2} times as fast as rapier3d", ours / theirs);
    // A plausibility check: the piles of both engines should have about the same height.
    let heights =
        (mean_height(&rockfall.spheres()?.iter().map(|sphere| sphere.position.y).collect::<Vec<_>>()), rapier.mean_height());
    println!("mean height at the end: rockfall {:.3}, rapier3d {:.3}", heights.0, heights.1);
    Ok(())
}

fn mean_height(heights: &[f32]) -> f64 {
    heights.iter().map(|height| f64::from(*height)).sum::<f64>() / heights.len() as f64
}

struct Rapier {
    world: PhysicsWorld,
}

impl Rapier {
    fn new(scene: &Scene, dt: f32) -> Self {
        let mut world = PhysicsWorld::new();
        let gravity = scene.settings.gravity * scene.settings.gravity_direction;
        world.gravity = Vector::new(gravity.x, gravity.y, gravity.z);
        world.integration_parameters.num_solver_iterations = 4;
        world.integration_parameters.set_dt(dt);
        for sphere in scene.spheres() {
            Self::add_sphere(&mut world, sphere, scene.settings.restitution);
        }
        for cuboid in scene.boxes() {
            Self::add_box(&mut world, cuboid, scene.settings.restitution);
        }
        Self { world }
    }

    fn add_sphere(world: &mut PhysicsWorld, sphere: &Sphere, restitution: f32) {
        let [x, y, z] = sphere.position.to_array();
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(x, y, z)).can_sleep(false);
        let ball = ColliderBuilder::ball(sphere.radius).mass(sphere.mass).restitution(restitution);
        world.insert(body, ball);
    }

    /// Adds a box whose edges are parallel to the axes.
    fn add_box(world: &mut PhysicsWorld, cuboid: &Cuboid, restitution: f32) {
        let edges = cuboid.edges;
        let half = 0.5 * (edges[0].abs() + edges[1].abs() + edges[2].abs());
        let centre = cuboid.corner + 0.5 * (edges[0] + edges[1] + edges[2]);
        let body = RigidBodyBuilder::fixed().translation(Vector::new(centre.x, centre.y, centre.z));
        let collider = ColliderBuilder::cuboid(half.x, half.y, half.z).restitution(restitution);
        world.insert(body, collider);
    }

    fn run(&mut self, steps: u64) {
        for _ in 0..steps {
            self.world.step();
        }
    }

    fn mean_height(&self) -> f64 {
        let bodies = self.world.bodies.iter().filter(|(_, body)| body.is_dynamic());
        mean_height(&bodies.map(|(_, body)| body.translation().y).collect::<Vec<_>>())
    }
}
