//! Reads and writes the state as tables on the device.

use crate::error::{Error, Result};
use crate::exec::gpu::{GpuWorld, Table};
use crate::simulation::Simulation;
use crate::simulation::edit::Dirty;
#[cfg(not(target_family = "wasm"))]
use crate::simulation::engine;
use crate::simulation::kept::put_residues;

impl Simulation {
    /// Copies a field of all spheres or rigid bodies to a buffer on the device, in order of addition and without a copy through the host. Does
    /// not wait for the copy. It is done when the returned submission is.
    ///
    /// # Errors
    /// [`Error::Device`] on the CPU backend, when the device fails, or when the state is larger than the device's limit for one
    /// binding. [`Error::Invalid`] for [`Table::Forces`], and for a buffer that is too small.
    #[cfg(not(target_family = "wasm"))]
    pub fn read_table(&mut self, table: Table, into: &wgpu::Buffer) -> Result<wgpu::SubmissionIndex> {
        self.flush()?;
        if table.is_of_bodies() {
            return self.gpu_world()?.read_rows(table, self.scene.bodies().len() as u32, into);
        }
        self.gpu_world()?.read_table(table, into)
    }

    /// Sets a field of all spheres from a buffer on the device, in order of addition and without a copy through the host. The
    /// buffer must be complete when this is called, and stay as it is until the returned submission is done. Waits for a check
    /// of the numbers.
    ///
    /// # Errors
    /// As for [`Simulation::read_table`], but forces can be written. They act until they are changed. [`Error::Invalid`] for
    /// numbers that are not finite and for quaternions that are not unit quaternions. Nothing is changed then.
    #[cfg(not(target_family = "wasm"))]
    pub fn write_table(&mut self, table: Table, from: &wgpu::Buffer) -> Result<wgpu::SubmissionIndex> {
        let device = self.engine.waiter();
        engine::block_on(device, self.write_table_async(table, from))
    }

    /// [`Simulation::write_table`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::write_table`].
    pub async fn write_table_async(&mut self, table: Table, from: &wgpu::Buffer) -> Result<wgpu::SubmissionIndex> {
        if table.is_of_bodies() {
            let value = format!("{table:?}");
            return Err(Error::Invalid {
                field: "table",
                value,
                expected: "a field of spheres: those of rigid bodies can only be read",
            });
        }
        self.flush_async().await?;
        self.gpu_world()?.check_table(table, from).await?;
        if table == Table::Forces && !self.world.has_force_on_each {
            self.world.has_force_on_each = true;
            self.dirty = self.dirty.max(Dirty::Topology);
            self.flush_async().await?;
        }
        let submission = self.gpu_world()?.write_table(table, from)?;
        if table != Table::Forces {
            self.follow_written_spheres().await?;
        }
        if table == Table::Forces {
            self.forces_synced = false;
            self.status.forces_due = 1;
        } else {
            self.synced = false;
            self.mark_state_edited();
        }
        Ok(submission)
    }

    /// Lets capsules and frames that move as rigid bodies follow the states that were written to their spheres.
    async fn follow_written_spheres(&mut self) -> Result<()> {
        if self.scene.implied.len() == 0 {
            return Ok(());
        }
        self.synced = false;
        self.pull().await?;
        let ids: Vec<_> = self.scene.sphere_ids().collect();
        if !self.scene.follow_spheres(&ids) {
            self.dirty = Dirty::Everything;
            return self.flush_async().await;
        }
        let residues = self.residues(&[]);
        self.world.set_spheres(&self.scene);
        put_residues(&mut self.world, &residues);
        self.engine.upload_spheres(&self.world)
    }

    fn gpu_world(&self) -> Result<&GpuWorld> {
        self.gpu_view().ok_or_else(|| Error::Device("a table on the device needs the GPU backend".to_owned()))
    }

    /// Reads forces that were written on the device back into the scene.
    pub(super) async fn pull_forces(&mut self) -> Result<()> {
        if !self.forces_synced {
            self.engine.download_topology(&mut self.world).await?;
            self.world.read_forces(&mut self.scene, &self.packed);
            self.observation = None;
            self.forces_synced = true;
        }
        Ok(())
    }
}
