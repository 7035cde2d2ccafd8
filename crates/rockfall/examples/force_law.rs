//! Defines forces: a trap, and a wind that turns. Changes a parameter in mid-run.
//!
//! `cargo run --release -p rockfall --example force_law`

use rockfall::{ForceLaw, Options, Scene, Simulation, Sphere};

/// The speed of the air turns about y with time. The drag grows with the square of the speed in it.
const WIND: &str = "
let air = speed * vec3f(cos(time), 0.0, sin(time));
let relative = air - velocity;
force = c * radius * radius * length(relative) * relative;
";

fn main() -> rockfall::Result<()> {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    let ball = scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.5).mass(2.0))?;
    // The function is optional: without it, the CPU backend evaluates the WGSL.
    let trap = ForceLaw::new("trap")
        .parameter("k", 4.0)
        .wgsl("force = -k * position;")
        .function(|body| -body.parameters[0] * body.position);
    let mut simulation = Simulation::with_options(scene, Options::new().force_law(trap))?;

    simulation.run(100, 0.01)?;
    println!("in the trap: {:.3}", simulation.sphere(ball)?.position);

    simulation.add_force_law(ForceLaw::new("wind").parameter("c", 0.6).parameter("speed", 3.0).wgsl(WIND))?;
    simulation.run(500, 0.01)?;
    println!("in the wind: {:.3}", simulation.sphere(ball)?.position);

    simulation.set_force_law_parameter("wind", "speed", 0.0)?;
    simulation.run(2_000, 0.01)?;
    println!("in calm air: {:.3}", simulation.sphere(ball)?.position);

    let mistake = ForceLaw::new("mistake").parameter("k", 1.0).wgsl("force = -k * positon;");
    if let Err(error) = simulation.add_force_law(mistake) {
        println!("{error}");
    }
    Ok(())
}
