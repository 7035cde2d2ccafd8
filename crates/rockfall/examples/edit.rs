//! Changes a running simulation: applies an impulse, adds a body, changes a constant and removes a body.
//!
//! `cargo run --release -p rockfall --example edit`

use rockfall::{Cuboid, Scene, Simulation, Sphere};

fn main() -> rockfall::Result<()> {
    let mut scene = Scene::new();
    scene.add_box(Cuboid::between([-20.0, -1.0, -20.0], [20.0, 0.0, 20.0]))?;
    let first = scene.add_sphere(Sphere::new([0.0, 0.5, 0.0], 0.5))?;
    let mut simulation = Simulation::new(scene)?;

    simulation.apply_impulse(first, [3.0, 0.0, 0.0])?;
    simulation.run(50, 0.02)?;
    println!("x after the impulse: {:.3}", simulation.sphere(first)?.position.x);

    let second = simulation.add_sphere(Sphere::new([8.0, 0.5, 0.0], 0.5).mass(3.0))?;
    simulation.run(150, 0.02)?;
    println!(
        "x of both spheres after the collision: {:.3} and {:.3}",
        simulation.sphere(first)?.position.x,
        simulation.sphere(second)?.position.x
    );

    let settings = (*simulation.settings()).with(|settings| settings.gravity = -1.0);
    simulation.set_settings(settings)?;
    simulation.remove_sphere(second)?;
    simulation.run(100, 0.02)?;
    println!("height with reversed gravity: {:.3}", simulation.sphere(first)?.position.y);
    Ok(())
}
