//! Runs a simulation on a graphics device that the program has opened itself, as a game would.
//!
//! `cargo run --release -p rockfall --example own_device`

use rockfall::{Options, Scene, Simulation, Sphere, wgpu};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    // The limits of the adapter allow larger scenes than the default limits.
    let wanted = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&wanted))?;

    let mut scene = Scene::new();
    let ball = scene.add_sphere(Sphere::new([0.0, 10.0, 0.0], 0.5))?;
    let mut simulation = Simulation::on_device(scene, Options::new(), &device, &queue)?;
    simulation.run(50, 0.02)?;
    println!("{}: height {:.3}", adapter.get_info().name, simulation.sphere(ball)?.position.y);

    // The program's own shaders can bind the buffers of the simulation.
    let world = simulation.gpu_view().expect("this simulation runs on a GPU");
    let state = world.buffer(rockfall::model::buffer::Buffer::Start)?;
    println!("size of the state buffer: {} bytes", state.size());
    Ok(())
}
