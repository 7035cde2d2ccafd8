//! Reads states and energies back.

use glam::{DVec3, Vec4};

use crate::error::Result;
use crate::model::muscles::MuscleClock;
use crate::model::world::World;
use crate::report::{Energy, SphereState};
use crate::scene::{Frame, Scene, Sphere, SphereId, Spring, SpringId, WholeBody};
use crate::simulation::observed::{Detail, view_and_lists};
use crate::simulation::{Simulation, engine};

impl Simulation {
    /// The scene: the objects with their current parameters. The state of the spheres is that of the last read; see
    /// [`Simulation::sync`].
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Reads the state of the spheres back, and returns the scene with all edits and the current state of every sphere.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the GPU fails, [`Error::DeviceLimit`](crate::Error::DeviceLimit) when edits
    /// have made the scene too large.
    pub fn sync(&mut self) -> Result<&Scene> {
        let device = self.engine.waiter();
        engine::block_on(device, self.sync_async())
    }

    /// The buffers on the GPU, for rendering and for other kernels; `None` on the CPU backend.
    ///
    /// [`layout`](crate::model::layout) and [`Buffer`](crate::model::buffer::Buffer) describe their layout. Sphere i in order
    /// of addition is stored at memory slot [`Simulation::slot`]`(i)`. An array that is larger than the device's limit for one
    /// binding is stored in several buffers ([`GpuWorld::chunks`](crate::exec::gpu::GpuWorld::chunks)).
    #[cfg(feature = "gpu")]
    pub fn gpu_view(&self) -> Option<&crate::exec::gpu::GpuWorld> {
        self.engine.gpu_world()
    }

    /// The arrays that the CPU backend runs on, with the same layout as the buffers on the GPU; `None` on the GPU backend. Frames of the
    /// contact law `rigid` on a GPU leave their states on the device until the next [`Simulation::sync`]; `None` until then.
    /// Spheres are stored in the order described at [`Simulation::slot`].
    pub fn cpu_view(&self) -> Option<&World> {
        match self.engine {
            engine::Engine::Cpu(ref device) => (device.is_none() || self.synced).then_some(&self.world),
            #[cfg(feature = "gpu")]
            engine::Engine::Gpu(_) => None,
        }
    }

    /// Copies the state and the orientations of the CPU backend to new memory, which the simulation uses from now on, and
    /// returns the old memory: `World::states[0]` and `World::orientations`, each at the address that [`Simulation::cpu_view`]
    /// showed. A program that shares this memory with others calls it before the next step or edit. `None` on the GPU backend.
    pub fn replace_cpu_state(&mut self) -> Option<[Vec<Vec4>; 2]> {
        self.cpu_view()?;
        let arrays = [&mut self.world.states[0], &mut self.world.orientations];
        Some(arrays.map(|array| {
            let copy = array.clone();
            std::mem::replace(array, copy)
        }))
    }

    /// A number that changes whenever memory is packed or sorted again: after objects were added or removed, and when spheres
    /// have moved far. Slots and indices from before are then invalid.
    pub fn memory_version(&self) -> u64 {
        self.packings
    }

    /// The memory slot of a sphere in every buffer that is indexed by spheres. `sphere` is the sphere's index in order of
    /// addition.
    pub fn slot(&self, sphere: usize) -> usize {
        let step = &self.world.step;
        match step.layout.slots_at {
            0 => sphere,
            at => self.world.topology[at as usize + sphere] as usize,
        }
    }

    /// The current state of one sphere.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when the sphere is not in the scene. Otherwise as for
    /// [`Simulation::sync`].
    pub fn sphere(&mut self, id: SphereId) -> Result<SphereState> {
        Ok(self.sync()?.sphere(id)?.into())
    }

    /// The current states of all spheres, in order of addition: one per sphere.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn spheres(&mut self) -> Result<Vec<SphereState>> {
        Ok(self.sync()?.spheres().iter().map(SphereState::from).collect())
    }

    /// The present rest length of a spring, in units. That of a muscle oscillates. Reads nothing back.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when the spring is not in the scene.
    pub fn rest_length(&self, id: SpringId) -> Result<f64> {
        Ok(rest_length(self.scene.spring(id)?, &self.muscle_clock))
    }

    /// The time of the muscles, in s: the sum of all time steps, each with the exact value of its `f32`.
    /// [`Report::time`](crate::Report::time) takes each as the decimal number that it is written as, such as 0.02.
    pub fn muscle_time(&self) -> f64 {
        self.muscle_clock.time()
    }

    /// Reads the state back, and returns a scene from which another simulation goes on where this one is: the phases of its
    /// muscles are the present ones, and so are the poses of its moving walls and the sequence of spheres of its inlets. A
    /// scene has no springs of contacts (docs/physics section 4.11), so with a contact law that keeps
    /// them the contacts begin anew; a [`Checkpoint`](crate::Checkpoint) keeps them.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn snapshot(&mut self) -> Result<Scene> {
        self.sync()?;
        Ok(self.last_snapshot())
    }

    /// [`Simulation::snapshot`] of the state that was read back last. Reads nothing back.
    pub fn last_snapshot(&self) -> Scene {
        let mut scene = self.scene.clone();
        let written = self.muscle_clock.written_time();
        scene.advance_muscles(self.muscle_clock.time());
        scene.advance_motions(written);
        scene.advance_inlets(written, self.flow.inlets.iter().map(|inlet| inlet.serial));
        scene
    }

    /// Energies and momenta of the current state. The energy of a spring is that at its present rest length. With symplectic Euler
    /// and collisions, the kinetic energy is that of the velocities at the time of the positions (docs/physics section 5.2).
    /// They depend on the time step: before the first step, [`Simulation::set_time_step`] gives it.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn energy(&mut self) -> Result<Energy> {
        let gravity = self.gravity().as_dvec3();
        let contact = self.contact_energy()?;
        let mut energy = bodies_energy(&self.scene, gravity);
        if self.world.step.is_half_step() && self.scene.settings.collisions {
            energy.kinetic = self.synchronised_kinetic_energy()?;
        }
        energy.spring = spring_energy(&self.scene, &self.muscle_clock)? + self.joint_energy()?;
        // An empty sum is -0.
        energy.contact = contact + 0.0;
        Ok(energy)
    }

    /// Kinetic energy at the time of the positions.
    fn synchronised_kinetic_energy(&mut self) -> Result<f64> {
        let (scene, world) = self.observed(Detail::Pairs)?;
        let view = view_and_lists(world).0.in_collisions();
        let movers = (0..).zip(scene.spheres()).filter(|(index, _)| view.is_integrated(*index));
        let loose: f64 = movers.map(|(index, sphere)| kinetic_energy(sphere, view.velocity(index).as_dvec3())).sum();
        Ok(loose + scene.whole_bodies().map(|body| body_energy(&body)).sum::<f64>())
    }
}

/// Kinetic energy of a sphere with this velocity.
fn kinetic_energy(sphere: &Sphere, velocity: DVec3) -> f64 {
    let mass = f64::from(sphere.mass);
    let inertia = 0.4 * mass * f64::from(sphere.radius).powi(2);
    0.5 * (mass * velocity.length_squared() + sphere.angular_momentum.as_dvec3().length_squared() / inertia)
}

/// Kinetic energy of a body that moves as a whole.
fn body_energy(WholeBody { kinetics, state, .. }: &WholeBody) -> f64 {
    let Frame { velocity, spin, .. } = Frame::of(state, kinetics);
    0.5 * (kinetics.mass * velocity.length_squared() + state.momentum.as_dvec3().dot(spin))
}

fn bodies_energy(scene: &Scene, gravity: DVec3) -> Energy {
    let mut energy = Energy::default();
    let loose = scene.sphere_ids().zip(scene.spheres()).filter(|(id, sphere)| !sphere.fixed && !scene.moves_with_body(*id));
    for (_, sphere) in loose {
        let mass = f64::from(sphere.mass);
        let (x, v, spin) = (DVec3::from_array(sphere.centre()), sphere.velocity.as_dvec3(), sphere.angular_momentum.as_dvec3());
        energy.kinetic += kinetic_energy(sphere, v + scene.image_in_box(x).1.as_dvec3());
        energy.potential -= mass * gravity.dot(x);
        energy.momentum += mass * v;
        energy.angular_momentum += mass * x.cross(v) + spin;
    }
    for body in scene.whole_bodies() {
        let (x, v, mass) = (body.state.position.wide(), body.state.velocity.as_dvec3(), body.kinetics.mass);
        energy.kinetic += body_energy(&body);
        energy.potential -= mass * gravity.dot(x);
        energy.momentum += mass * v;
        energy.angular_momentum += mass * x.cross(v) + body.state.momentum.as_dvec3();
    }
    energy
}

fn rest_length(spring: &Spring, clock: &MuscleClock) -> f64 {
    spring.length_at_phase(spring.muscle.map_or(0.0, |muscle| clock.turns(&muscle)))
}

fn spring_energy(scene: &Scene, clock: &MuscleClock) -> Result<f64> {
    let centre = |sphere: SphereId| scene.sphere(sphere).map(|sphere| DVec3::from_array(sphere.centre()));
    let elastic =
        |from: DVec3, to: DVec3, stiffness: f32, length: f64| 0.5 * f64::from(stiffness) * (from.distance(to) - length).powi(2);
    let mut total = 0.0;
    for spring in scene.springs() {
        total += elastic(centre(spring.a)?, centre(spring.b)?, spring.stiffness, rest_length(spring, clock));
    }
    for tether in scene.tethers() {
        total += elastic(centre(tether.sphere)?, tether.point.as_dvec3(), tether.stiffness, tether.length.into());
    }
    Ok(total)
}
