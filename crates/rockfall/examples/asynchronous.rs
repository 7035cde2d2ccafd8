//! Runs steps without blocking. In a browser, the event loop drives the futures. A native program can drive them with
//! `rockfall::exec::gpu::block_on`, which waits for the device whenever they do.
//!
//! `cargo run --release -p rockfall --example asynchronous`

use rockfall::exec::gpu::{Gpu, block_on};
use rockfall::{Options, Scene, Simulation, Sphere};

async fn fall(gpu: &Gpu) -> rockfall::Result<f32> {
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([0.0, 10.0, 0.0], 0.5))?;
    let mut simulation = Simulation::on_device(scene, Options::new(), gpu.device(), gpu.queue())?;
    simulation.run_async(50, 0.02).await?;
    let scene = simulation.sync_async().await?;
    Ok(scene.spheres()[0].position.y)
}

fn main() -> rockfall::Result<()> {
    // `true` also accepts a software adapter.
    let gpu = Gpu::open_blocking(true)?;
    println!("height after a second: {:.3}", block_on(gpu.device(), fall(&gpu))?);
    Ok(())
}
