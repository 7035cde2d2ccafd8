//! Writes the states of a swinging pendulum over time as an archive for NumPy.
//!
//! `cargo run --release -p rockfall-trajectory --example trajectory`

use rockfall::{Rod, Scene, Simulation, Sphere};
use rockfall_trajectory::{Format, Writer};

fn main() -> rockfall::Result<()> {
    let mut scene = Scene::new();
    let pivot = scene.add_sphere(Sphere::new([0.0, 2.0, 0.0], 0.05).fixed())?;
    let bob = scene.add_sphere(Sphere::new([1.0, 2.0, 0.0], 0.1))?;
    scene.add_rod(Rod::new(pivot, bob, 0.02).length(1.0))?;

    let path = std::env::temp_dir().join("pendulum.npz");
    let mut simulation = Simulation::new(scene)?;
    let mut writer = Writer::create(&path, Format::Npz)?;
    for _ in 0..100 {
        writer.frame(&mut simulation)?;
        simulation.run(2, 0.01)?;
    }
    writer.finish(simulation.scene())?;
    println!("{}: open it with numpy.load; position has the shape (100, 2, 3)", path.display());
    Ok(())
}
