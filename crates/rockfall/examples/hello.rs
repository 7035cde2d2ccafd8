//! Simulates a ball that falls on a floor and comes to rest.
//!
//! `cargo run --release -p rockfall --example hello`

use rockfall::{Cuboid, Scene, Simulation, Sphere};

fn main() -> rockfall::Result<()> {
    let mut scene = Scene::new();
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]))?;
    let ball = scene.add_sphere(Sphere::new([0.0, 2.0, 0.0], 0.5).mass(2.0))?;

    let mut simulation = Simulation::new(scene)?;
    println!("on {}", simulation.backend().device);
    for second in (0..=20).step_by(4) {
        println!("t = {second} s: height {:.3}", simulation.sphere(ball)?.position.y);
        simulation.run(200, 0.02)?;
    }
    Ok(())
}
