//! Sets states, rest lengths and forces of worlds.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::fine::Fine;
use crate::report::SphereState;
use crate::scene::finite;
use crate::simulation::Simulation;
use crate::worlds::{WorldPath, Worlds};

impl Worlds {
    /// Sets position, velocity, angular momentum and orientation of all spheres of a world, one state per sphere in order of
    /// addition. A fixed sphere may be moved too. The other fields of the states are ignored.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world that does not exist, another number of states than spheres, or a value that is not finite.
    /// Nothing is changed then. [`Error::Device`] when the GPU fails.
    pub fn set_states(&mut self, world: usize, states: &[SphereState]) -> Result<()> {
        let simulation = &mut self.current(world)?.simulation;
        let ids: Vec<_> = simulation.scene().sphere_ids().collect();
        check_count("states", states.len(), ids.len(), "one state per sphere of the world")?;
        for state in states {
            for (field, vector) in [
                ("state.position", state.position),
                ("state.position_low", state.position_low),
                ("state.velocity", state.velocity),
                ("state.angular_momentum", state.angular_momentum),
            ] {
                finite(field, vector)?;
            }
            if !state.orientation.is_normalized() {
                let value = format!("{}", state.orientation);
                return Err(Error::Invalid { field: "state.orientation", value, expected: "a unit quaternion" });
            }
        }
        for (id, state) in ids.into_iter().zip(states) {
            simulation.set_place(id, Fine::sum(state.position, state.position_low))?;
            simulation.set_velocity(id, state.velocity)?;
            simulation.set_angular_momentum(id, state.angular_momentum)?;
            simulation.set_orientation(id, state.orientation)?;
        }
        simulation.flush()?;
        self.changed(world);
        Ok(())
    }

    /// Sets the rest lengths of all springs of a world, in units, one per spring in order of addition. They hold until they are
    /// changed. The rest length of a muscle oscillates about it.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world that does not exist, another number of lengths than springs, or a length that is negative or
    /// not finite. Nothing is changed then. [`Error::Device`] when the GPU fails.
    pub fn set_rest_lengths(&mut self, world: usize, lengths: &[f32]) -> Result<()> {
        let springs = self.scene(world)?.springs().len();
        check_count("rest lengths", lengths.len(), springs, "one length per spring of the world")?;
        check_lengths(lengths)?;
        let alone = self.are_lengths_alone(&[world])?;
        self.worlds[world].simulation.set_rest_lengths(lengths)?;
        self.lengths_changed(world, alone[0]);
        Ok(())
    }

    /// Sets the external forces on all spheres of a world, in mass units/s², one per sphere in order of addition. They act until
    /// they are changed.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world that does not exist, another number of forces than spheres, or a force that is not finite.
    /// Nothing is changed then.
    pub fn set_forces(&mut self, world: usize, forces: &[Vec3]) -> Result<()> {
        let simulation = &mut self.current(world)?.simulation;
        check_count("forces", forces.len(), simulation.scene().spheres().len(), "one force per sphere of the world")?;
        forces.iter().try_for_each(|force| finite("force", *force))?;
        set_forces(simulation, forces)?;
        self.changed(world);
        Ok(())
    }

    /// Sets the rest lengths of all springs of all worlds: those of world 0, then those of world 1, and so on. See
    /// [`Worlds::set_rest_lengths`].
    ///
    /// # Errors
    /// [`Error::Invalid`] for another number of lengths than springs, or a length that is negative or not finite. Nothing is changed
    /// then. [`Error::Device`] when the GPU fails.
    pub fn set_all_rest_lengths(&mut self, lengths: &[f32]) -> Result<()> {
        let counts: Vec<usize> = self.worlds.iter().map(|world| world.simulation.scene().springs().len()).collect();
        check_count("rest lengths", lengths.len(), counts.iter().sum(), "one length per spring of all worlds")?;
        check_lengths(lengths)?;
        let everyone: Vec<usize> = (0..self.len()).collect();
        let alone = self.are_lengths_alone(&everyone)?;
        let done = self.for_all(&counts, lengths, Simulation::set_rest_lengths);
        everyone.into_iter().zip(alone).for_each(|(world, alone)| self.lengths_changed(world, alone));
        done
    }

    /// Sets the external forces on all spheres of all worlds: those of world 0, then those of world 1, and so on. See
    /// [`Worlds::set_forces`].
    ///
    /// # Errors
    /// [`Error::Invalid`] for another number of forces than spheres, or a force that is not finite. Nothing is changed then.
    /// [`Error::Device`] when the GPU fails.
    pub fn set_all_forces(&mut self, forces: &[Vec3]) -> Result<()> {
        let counts: Vec<usize> = self.worlds.iter().map(|world| world.simulation.scene().spheres().len()).collect();
        check_count("forces", forces.len(), counts.iter().sum(), "one force per sphere of all worlds")?;
        forces.iter().try_for_each(|force| finite("force", *force))?;
        self.set_in_all(&counts, forces, set_forces)
    }

    /// Gives each world its part of `values`. `counts` has the number of values of each world.
    fn set_in_all<T: Sync>(
        &mut self,
        counts: &[usize],
        values: &[T],
        set: impl Fn(&mut Simulation, &[T]) -> Result<()> + Sync,
    ) -> Result<()> {
        self.refresh()?;
        let done = self.for_all(counts, values, set);
        (0..self.len()).for_each(|world| self.changed(world));
        done
    }

    /// Calls `set` for the simulation of each world with its part of `values`.
    fn for_all<T: Sync>(
        &mut self,
        counts: &[usize],
        values: &[T],
        set: impl Fn(&mut Simulation, &[T]) -> Result<()> + Sync,
    ) -> Result<()> {
        let mut rest = values;
        let parts: Vec<&[T]> = counts.iter().map(|count| rest.split_off(..*count).unwrap_or_default()).collect();
        self.worlds.par_iter_mut().zip(parts).try_for_each(|(world, part)| set(&mut world.simulation, part))
    }

    /// Whether rest lengths of each of these worlds are written without anything else. If a world on the device needs more, all states
    /// are read back first.
    fn are_lengths_alone(&mut self, worlds: &[usize]) -> Result<Vec<bool>> {
        let alone: Vec<bool> = worlds.iter().map(|world| self.worlds[*world].simulation.takes_rest_lengths()).collect();
        let needs_more = |(world, alone): (&usize, &bool)| !alone && self.worlds[*world].path == WorldPath::Device;
        if worlds.iter().zip(&alone).any(needs_more) {
            self.refresh()?;
        }
        Ok(alone)
    }

    /// Notes that rest lengths of a world were set, and `alone` if nothing else was packed with them.
    fn lengths_changed(&mut self, world: usize, alone: bool) {
        if !alone {
            self.changed(world);
            return;
        }
        self.worlds[world].calm = 0;
        #[cfg(feature = "gpu")]
        if let Some(batch) = &mut self.batch {
            batch.lengths_changed(world);
        }
    }
}

fn set_forces(simulation: &mut Simulation, forces: &[Vec3]) -> Result<()> {
    let ids: Vec<_> = simulation.scene().sphere_ids().collect();
    ids.into_iter().zip(forces).try_for_each(|(id, force)| simulation.set_force(id, *force))
}

fn check_lengths(lengths: &[f32]) -> Result<()> {
    match lengths.iter().find(|length| !(length.is_finite() && **length >= 0.0)) {
        Some(bad) => {
            let expected = "a finite number, not negative";
            Err(Error::Invalid { field: "spring.length", value: bad.to_string(), expected })
        }
        None => Ok(()),
    }
}

fn check_count(field: &'static str, found: usize, wanted: usize, expected: &'static str) -> Result<()> {
    if found == wanted {
        return Ok(());
    }
    Err(Error::Invalid { field, value: format!("{found} for {wanted}"), expected })
}
