//! What a world keeps beside the scene when it is packed again: springs of contacts, rates of velocity Verlet, and residues of
//! velocities (docs/physics section 5.10).

use std::collections::HashMap;

use glam::Vec4;

use crate::checkpoint::KeptSpring;
use crate::model::layout::{RESIDUE_REGION, RESIDUE_ROW, RIGID_ROWS};
use crate::model::world::World;
use crate::scene::{Scene, SphereId};
use crate::simulation::Simulation;
use crate::simulation::rates::put_rates;
use crate::simulation::springs::put_springs;

/// A row of residues.
pub(crate) type ResidueRow = [u32; 4];

/// What is put into a world that was just packed. Without a part of it, the world starts without that part.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kept<'a> {
    pub(super) springs: &'a [KeptSpring],
    /// Of all spheres in insertion order, then of all rigid bodies; so are the residues.
    pub(super) rates: &'a [[f32; 6]],
    pub(super) residues: &'a [ResidueRow],
}

impl Kept<'_> {
    pub(super) fn put(&self, world: &mut World, scene: &Scene) {
        put_springs(world, scene, self.springs);
        put_rates(world, self.rates);
        put_residues(world, self.residues);
    }
}

/// Gives a world residues. Where they do not belong to its spheres, or its velocities have none, they are left out.
pub(super) fn put_residues(world: &mut World, residues: &[ResidueRow]) {
    let (n, bodies) = (world.step.layout.spheres as usize, world.step.layout.rigid_bodies as usize);
    if !world.step.has_residues() || residues.len() != n + bodies {
        return;
    }
    let (of_spheres, of_bodies) = residues.split_at(n);
    for slot in 0..n {
        let index = world.insertion_index(slot);
        world.states[0][RESIDUE_REGION as usize * n + slot] = row_of(of_spheres[index]);
    }
    for (rows, residues) in world.rigid_bodies.chunks_exact_mut(RIGID_ROWS as usize).zip(of_bodies) {
        rows[RESIDUE_ROW as usize] = row_of(*residues);
    }
}

fn row_of(words: ResidueRow) -> Vec4 {
    Vec4::from_array(words.map(f32::from_bits))
}

/// The residues of a world, of its spheres in insertion order and then of its rigid bodies. Empty if velocities have none.
fn residues_of(world: &World) -> Vec<ResidueRow> {
    if !world.step.has_residues() {
        return Vec::new();
    }
    let (n, bits) = (world.step.layout.spheres as usize, |row: Vec4| row.to_array().map(f32::to_bits));
    let mut residues = vec![[0; 4]; n];
    for slot in 0..n {
        residues[world.insertion_index(slot)] = bits(world.states[0][RESIDUE_REGION as usize * n + slot]);
    }
    residues.extend(world.rigid_bodies.chunks_exact(RIGID_ROWS as usize).map(|rows| bits(rows[RESIDUE_ROW as usize])));
    residues
}

impl Simulation {
    /// The residues of all spheres of the scene, then of all rigid bodies, from the state that was read back last. Those of `edited`
    /// spheres, of new spheres, and, where bodies have come or gone, of bodies are 0.
    pub(super) fn residues(&self, edited: &[SphereId]) -> Vec<ResidueRow> {
        let packed = residues_of(&self.world);
        if packed.is_empty() {
            return packed;
        }
        let (of_spheres, of_bodies) = packed.split_at(self.packed.len());
        let mut residues = if self.packed.iter().copied().eq(self.scene.sphere_ids()) {
            of_spheres.to_vec()
        } else {
            let by_id: HashMap<&SphereId, &ResidueRow> = self.packed.iter().zip(of_spheres).collect();
            self.scene.sphere_ids().map(|id| by_id.get(&id).copied().copied().unwrap_or_default()).collect()
        };
        for index in edited.iter().filter_map(|id| self.scene.spheres.index(*id).ok()) {
            residues[index] = [0; 4];
        }
        let bodies = self.scene.whole_bodies().count();
        let of_bodies = if of_bodies.len() == bodies { of_bodies.to_vec() } else { vec![[0; 4]; bodies] };
        residues.extend(of_bodies);
        residues
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Backend, Options, Sphere};

    #[test]
    fn an_edit_clears_the_residues_of_its_sphere() {
        let mut scene = Scene::new();
        let add = |k: u8| scene.add_sphere(Sphere::new([f32::from(k), 0.0, 0.0], 0.1).velocity([0.3, 1.7, 0.0])).unwrap();
        let ids = [0, 1, 2, 3].map(add);
        let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
        simulation.run(5, 1e-7).unwrap();
        let before = simulation.checkpoint().unwrap().residues;
        assert!(before.iter().all(|row| row[1] & !0x4000_03ff != 0), "{before:x?}");
        simulation.set_velocity(ids[1], [0.3, 1.7, 0.0]).unwrap();
        simulation.set_position(ids[2], [2.5, 0.0, 0.0]).unwrap();
        assert_eq!(simulation.checkpoint().unwrap().residues, [before[0], [0; 4], before[2], before[3]]);
        // The scene is packed again.
        simulation.remove_sphere(ids[0]).unwrap();
        assert_eq!(simulation.checkpoint().unwrap().residues, [[0; 4], before[2], before[3]]);
        simulation.set_time_step(0.01).unwrap();
        assert_eq!(simulation.checkpoint().unwrap().residues, Vec::<ResidueRow>::new());
    }
}
