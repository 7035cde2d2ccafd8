//! Joints and rigid bodies of worlds: what they do, their drives and their places.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::options::Backend;
use crate::scene::{Joint, RigidBody, Scene};
use crate::simulation::JointReading;
use crate::worlds::{World, Worlds};

impl Worlds {
    /// What all joints of a world do, in order of addition: see [`Simulation::joints`](crate::Simulation::joints).
    ///
    /// # Errors
    /// As for [`Worlds::snapshot`].
    pub fn joints(&mut self, world: usize) -> Result<Vec<JointReading>> {
        self.current(world)?.simulation.joints()
    }

    /// What all joints of all worlds do: one list per world.
    ///
    /// # Errors
    /// As for [`Worlds::all_states`].
    pub fn all_joints(&mut self) -> Result<Vec<Vec<JointReading>>> {
        self.refresh()?;
        let read = |world: &mut World| world.simulation.joints();
        match self.info.kind {
            Backend::Cpu => self.worlds.par_iter_mut().map(read).collect(),
            _ => self.worlds.iter_mut().map(read).collect(),
        }
    }

    /// Changes the drive, the limits and the strength of a joint of a world, from the next step on, until
    /// [`Worlds::reset`]. `joint` counts joints in order of
    /// addition.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world or a joint that does not exist. Otherwise as for
    /// [`Simulation::update_joint`](crate::Simulation::update_joint).
    pub fn update_joint(&mut self, world: usize, joint: usize, change: impl FnOnce(&mut Joint)) -> Result<()> {
        let mut change = Some(change);
        self.update_joints(world, &[joint], |_, joint| {
            if let Some(change) = change.take() {
                change(joint);
            }
        })
    }

    /// Changes joints of a world as [`Worlds::update_joint`] does. `change` gets the place in `joints`, and the joint.
    ///
    /// # Errors
    /// As for [`Worlds::update_joint`]. The joints before a wrong one are changed.
    pub fn update_joints(&mut self, world: usize, joints: &[usize], mut change: impl FnMut(usize, &mut Joint)) -> Result<()> {
        let simulation = &mut self.current(world)?.simulation;
        let ids: Vec<_> = simulation.scene().joint_ids().collect();
        let done = joints.iter().enumerate().try_for_each(|(place, joint)| {
            let id = ids.get(*joint).ok_or_else(|| Error::Invalid {
                field: "joint",
                value: format!("{joint} of {}", ids.len()),
                expected: "a number below that of joints",
            })?;
            simulation.update_joint(*id, |joint| change(place, joint))
        });
        self.drives_changed(world);
        done
    }

    /// Moves the bodies of a world so that its joints have these positions and speeds: see [`Scene::place_joints`].
    ///
    /// # Errors
    /// As for [`Simulation::place_joints`](crate::Simulation::place_joints), and for a world that does not exist.
    pub fn place_joints(&mut self, world: usize, positions: &[f32], speeds: &[f32]) -> Result<()> {
        self.move_bodies(world, |scene| scene.place_joints(positions, speeds))
    }

    /// Changes poses, motions and external forces of rigid bodies of a world. `bodies` counts them in order of addition. `change` gets the
    /// place in `bodies` and the body. `spins` are angular velocities along the axes of the world in rad/s, one per body;
    /// they replace the angular momenta.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world or a body that does not exist. Otherwise as for
    /// [`Simulation::update_body`](crate::Simulation::update_body). The bodies before a wrong one are changed.
    pub fn update_bodies(
        &mut self,
        world: usize,
        bodies: &[usize],
        spins: Option<&[Vec3]>,
        mut change: impl FnMut(usize, &mut RigidBody),
    ) -> Result<()> {
        let simulation = &mut self.current(world)?.simulation;
        let ids: Vec<_> = simulation.scene().body_ids().collect();
        let done = bodies.iter().enumerate().try_for_each(|(place, body)| {
            let id = ids.get(*body).ok_or_else(|| Error::Invalid {
                field: "body",
                value: format!("{body} of {}", ids.len()),
                expected: "a number below that of rigid bodies",
            })?;
            simulation.update_body(*id, |body| change(place, body))?;
            let spin = spins.and_then(|spins| spins.get(place));
            spin.map_or(Ok(()), |spin| simulation.move_bodies(|scene| scene.set_body_spin(*id, *spin)))
        });
        self.changed(world);
        done
    }

    fn move_bodies(&mut self, world: usize, change: impl FnOnce(&mut Scene) -> Result<()>) -> Result<()> {
        let done = self.current(world)?.simulation.move_bodies(change);
        self.changed(world);
        done
    }
}
