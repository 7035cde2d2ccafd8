//! Reading back.

use glam::{DVec3, Vec3};

use crate::error::Result;
use crate::model::world::World;
use crate::report::{Energy, SphereState};
use crate::scene::{Scene, SphereId};
use crate::simulation::{Simulation, engine};

impl Simulation {
    /// The scene: objects with their present parameters. The state of spheres is that of the last read; see
    /// [`Simulation::sync`].
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The scene as it is now, with all edits and the present state of every sphere.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the GPU failed.
    pub fn sync(&mut self) -> Result<&Scene> {
        let device = self.engine.waiter();
        engine::block_on(device, self.sync_async())
    }

    /// The buffers on the GPU, for rendering and other kernels; `None` on the CPU backend. Their layout is that of
    /// [`layout`](crate::model::layout) and [`Buffer`](crate::model::buffer::Buffer). Sphere i in order of addition stands at memory slot
    /// [`Simulation::slot`]`(i)`. An array that is larger than one binding may be stands in several buffers
    /// ([`GpuWorld::chunks`](crate::exec::gpu::GpuWorld::chunks)).
    #[cfg(feature = "gpu")]
    pub fn gpu_view(&self) -> Option<&crate::exec::gpu::GpuWorld> {
        self.engine.gpu_world()
    }

    /// The memory that the CPU backend runs on, of the same layout as the GPU's; `None` on the GPU backend. Spheres stand in
    /// it as in [`Simulation::gpu_view`].
    pub fn cpu_view(&self) -> Option<&World> {
        match self.engine {
            engine::Engine::Cpu => Some(&self.world),
            #[cfg(feature = "gpu")]
            engine::Engine::Gpu(_) => None,
        }
    }

    /// Changes whenever memory is packed anew or put in order: after objects were added or removed, and when spheres have moved
    /// far. Slots and indices from before mean nothing then.
    pub fn memory_version(&self) -> u64 {
        self.packings
    }

    /// The memory slot of a sphere, by its index in order of addition, in every buffer that is indexed by spheres.
    pub fn slot(&self, sphere: usize) -> usize {
        let step = &self.world.step;
        match step.slots_at {
            0 => sphere,
            at => self.world.topology[at as usize + sphere] as usize,
        }
    }

    /// One sphere as it is now.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when it is not in the scene,
    /// [`Error::Device`](crate::Error::Device) when the GPU failed.
    pub fn sphere(&mut self, id: SphereId) -> Result<SphereState> {
        Ok(self.sync()?.sphere(id)?.into())
    }

    /// All spheres as they are now, in order of addition.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the GPU failed.
    pub fn spheres(&mut self) -> Result<Vec<SphereState>> {
        Ok(self.sync()?.spheres().iter().map(SphereState::from).collect())
    }

    /// Energies and momenta of the present state.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the GPU failed.
    pub fn energy(&mut self) -> Result<Energy> {
        let gravity = self.gravity().as_dvec3();
        let contact = self.contact_energy()?;
        let mut energy = spheres_energy(&self.scene, gravity);
        energy.spring = spring_energy(&self.scene)?;
        energy.contact = contact;
        Ok(energy)
    }
}

fn spheres_energy(scene: &Scene, gravity: DVec3) -> Energy {
    let mut energy = Energy::default();
    for sphere in scene.spheres().iter().filter(|sphere| !sphere.fixed) {
        let mass = f64::from(sphere.mass);
        let inertia = 0.4 * mass * f64::from(sphere.radius).powi(2);
        let (x, v, spin) = (sphere.position.as_dvec3(), sphere.velocity.as_dvec3(), sphere.angular_momentum.as_dvec3());
        energy.kinetic += 0.5 * (mass * v.length_squared() + spin.length_squared() / inertia);
        energy.potential -= mass * gravity.dot(x);
        energy.momentum += mass * v;
        energy.angular_momentum += mass * x.cross(v) + spin;
    }
    energy
}

fn spring_energy(scene: &Scene) -> Result<f64> {
    let elastic = |from: Vec3, to: Vec3, stiffness: f32, length: f32| {
        0.5 * f64::from(stiffness) * (from.as_dvec3().distance(to.as_dvec3()) - f64::from(length)).powi(2)
    };
    let mut total = 0.0;
    for spring in scene.springs() {
        let (a, b) = (scene.sphere(spring.a)?, scene.sphere(spring.b)?);
        total += elastic(a.position, b.position, spring.stiffness, spring.length);
    }
    for tether in scene.tethers() {
        total += elastic(scene.sphere(tether.sphere)?.position, tether.point, tether.stiffness, tether.length);
    }
    Ok(total)
}
