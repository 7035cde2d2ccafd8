//! Frames of the contact law `rigid` on a device.

use crate::error::{Error, Result};
use crate::exec::gpu::{Gpu, catch};
use crate::rigid::frame::{FrameReport, bodies_alone, constants_alone};
use crate::rigid::gpu::world::GpuWorld;
use crate::rigid::world::{Body, RigidWorld};

/// A world on a device. The host has the states of its bodies after each call of the simulation; what is remembered of contacts is
/// read when something asks for it.
#[derive(Debug)]
pub(super) struct OnDevice {
    gpu: Gpu,
    world: GpuWorld,
    history_due: bool,
}

impl OnDevice {
    /// # Errors
    /// [`Error::Device`] when the device fails or has too little memory.
    pub(super) fn new(gpu: &Gpu, world: &RigidWorld) -> Result<Self> {
        gpu.check_limits()?;
        let world = catch(gpu.device(), || GpuWorld::new(&gpu.rigid(), world, &bodies_alone(world)))?.map_err(Error::Device)?;
        Ok(Self { gpu: gpu.clone(), world, history_due: false })
    }

    /// Takes over the states of all bodies and what is remembered of their contacts.
    ///
    /// # Errors
    /// [`Error::Device`] when the device fails or has too little memory.
    pub(super) fn put(&mut self, world: &RigidWorld) -> Result<()> {
        self.history_due = false;
        let own = &mut self.world;
        catch(self.gpu.device(), || own.put(world, &bodies_alone(world)))?.map_err(Error::Device)
    }

    /// Sets the states of the bodies from number 1 on, which have no mass.
    pub(super) fn drive(&self, bodies: &[Body]) {
        self.world.drive(bodies);
    }

    /// Takes over the muscles of the next frame.
    pub(super) fn set_muscles(&mut self, world: &RigidWorld) {
        self.world.set_muscles(&world.springs.muscles);
    }

    /// Takes over the time of the next frame for the forces of the program, in s.
    pub(super) fn set_law_time(&self, time: f32) {
        self.world.set_law_time(time);
    }

    /// Takes over the drives of the joints.
    pub(super) fn set_drives(&mut self, world: &RigidWorld) {
        self.world.set_drives(&world.joints.list);
    }

    /// Takes over the external forces and torques of the bodies.
    pub(super) fn set_loads(&self, world: &RigidWorld) {
        self.world.set_loads(&constants_alone(world));
    }

    /// Advances all bodies by a frame.
    pub(super) fn advance(&mut self, dt: f32, substeps: u32, keeps_going: bool) -> Result<FrameReport> {
        let world = &mut self.world;
        let report = catch(self.gpu.device(), || world.advance(dt, substeps, keeps_going))?.map_err(Error::Device)?;
        self.gpu.faults().check()?;
        self.history_due = true;
        Ok(report)
    }

    /// Reads the states of the bodies.
    pub(super) fn fetch(&self, world: &mut RigidWorld) -> Result<()> {
        self.world.download(world).map_err(Error::Device)
    }

    /// Reads what is remembered of the contacts, if that has changed.
    pub(super) fn fetch_history(&mut self, world: &mut RigidWorld) -> Result<()> {
        if std::mem::take(&mut self.history_due) {
            self.world.download_history(world).map_err(Error::Device)?;
        }
        Ok(())
    }
}
