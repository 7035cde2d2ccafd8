//! Carries the springs of contacts over edits and checkpoints (docs/physics section 4.11).

use crate::checkpoint::KeptSpring;
use crate::error::{Error, Result};
use crate::model::buffer::Buffer;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::laws::contact::Spring;
use crate::physics::laws::history::{
    BLOCK_WORDS, Chains, Histories, Record, feature_bits, first_word, further_blocks, largest_pool, owner, pack, pool_for,
};
use crate::scene::{AnyId, Scene};
use crate::simulation::Simulation;

/// The springs of a world, by the objects of their contacts. `ids` are the handles of the objects, by number, as they were when
/// the world was packed.
fn springs_of(world: &World, ids: &[AnyId]) -> Vec<KeptSpring> {
    let step = &world.step;
    let bits = feature_bits(step);
    let histories = Histories::of(world);
    let of_mover = |mover: u32| {
        histories.springs(mover).map(move |(key, Spring { shift, overlap, moment })| {
            let (other, feature) = (key >> bits, key & ((1 << bits) - 1));
            let [a, b] = [mover.min(other), mover.max(other)].map(|number| ids[number as usize]);
            KeptSpring { a, b, feature, shift, overlap, moment }
        })
    };
    (0..step.movers()).flat_map(of_mover).collect()
}

/// Gives a world that was packed from `scene` the springs of contacts. Those of objects that are not in the scene are left out.
pub(super) fn put_springs(world: &mut World, scene: &Scene, springs: &[KeptSpring]) {
    if world.histories.is_empty() {
        return;
    }
    let mut chains: Vec<Vec<Record>> = vec![Vec::new(); world.movers() as usize];
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let mut slots: Vec<u32> = (0..world.movers()).collect();
    (0..world.step.layout.spheres).for_each(|slot| slots[view.insertion_index(slot) as usize] = slot);
    let id_of = |number: u32| slots.get(number as usize).copied().unwrap_or(number);
    for kept in springs {
        let (Some(a), Some(b)) = (scene.number_of(kept.a), scene.number_of(kept.b)) else { continue };
        let is_first = owner(&view, id_of(a), id_of(b)) == id_of(a);
        let (mover, other) = if is_first { (a, b) } else { (b, a) };
        let key = other << feature_bits(&world.step) | kept.feature;
        let KeptSpring { shift, overlap, moment, .. } = *kept;
        chains[mover as usize].push(pack(key, &Spring { shift, overlap, moment }));
    }
    let needed = chains.iter().map(|records| further_blocks(records.len())).sum();
    world.set_history_pool(pool_for(needed, world.movers()));
    let (first, table, movers) = (first_word(world), world.history_words(), world.movers());
    let mut written = Chains::new(&mut world.histories[first..][..table], movers, 0);
    (0..).zip(&chains).for_each(|(mover, records)| written.put(mover, records));
}

impl Simulation {
    /// The springs of all contacts; none with the law of the thesis.
    pub(super) async fn springs(&mut self) -> Result<Vec<KeptSpring>> {
        if self.world.histories.is_empty() {
            return Ok(Vec::new());
        }
        self.download_histories().await?;
        Ok(springs_of(&self.world, &self.packed_ids))
    }

    /// Makes the pool of blocks of springs a quarter larger than a rejected step needed.
    pub(super) async fn grow_histories(&mut self) -> Result<()> {
        let (needed, before) = (self.status.history_needed, self.world.step.layout.history_pool);
        let most = largest_pool(self.world.movers());
        if needed > most {
            let bytes = |blocks: u32| 8 * BLOCK_WORDS as u64 * (u64::from(self.world.movers()) + u64::from(blocks));
            return Err(Error::DeviceLimit { what: Buffer::Histories.label(), needed: bytes(needed), limit: bytes(most) });
        }
        self.download_histories().await?;
        self.world.set_history_pool(pool_for(needed, self.world.movers()));
        let grown = self.engine.resize_histories(&self.world);
        if grown.is_err() {
            // The simulation may go on with fewer objects, so the world must not keep the size that could not be allocated.
            self.world.set_history_pool(before);
        }
        grown
    }

    async fn download_histories(&mut self) -> Result<()> {
        self.world.status.history_table = self.status.history_table;
        self.engine.download_histories(&mut self.world).await
    }
}
