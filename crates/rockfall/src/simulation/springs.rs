//! Carries the springs of contacts over edits and checkpoints (docs/physics.md section 4.11).

use crate::checkpoint::KeptSpring;
use crate::error::Result;
use crate::model::layout::FIRST_HISTORY_ROOM;
use crate::model::layout::HISTORY_WORDS;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::laws::contact::Spring;
use crate::physics::laws::history::{Histories, feature_bits, first_word, owner, pack, row_words};
use crate::scene::{AnyId, Scene};
use crate::simulation::Simulation;

/// The springs of a world, by the objects of their contacts. `ids` are the handles of the objects, by number, as they were when
/// the world was packed.
fn springs_of(world: &World, ids: &[AnyId]) -> Vec<KeptSpring> {
    let step = &world.step;
    let bits = feature_bits(step);
    let histories = Histories::of(world);
    let of_row = |row: u32| {
        histories.row(row).into_iter().map(move |(key, Spring { shift, overlap, moment })| {
            let (other, feature) = (key >> bits, key & ((1 << bits) - 1));
            let [a, b] = [row.min(other), row.max(other)].map(|number| ids[number as usize]);
            KeptSpring { a, b, feature, shift, overlap, moment }
        })
    };
    (0..step.movers()).flat_map(of_row).collect()
}

/// Gives a world that was packed from `scene` the springs of contacts. Those of objects that are not in the scene are left out.
pub(super) fn put_springs(world: &mut World, scene: &Scene, springs: &[KeptSpring]) {
    if world.step.history_room == 0 {
        return;
    }
    let mut rows: Vec<Vec<(u32, Spring)>> = vec![Vec::new(); world.movers() as usize];
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let mut slots: Vec<u32> = (0..world.movers()).collect();
    (0..world.step.spheres).for_each(|slot| slots[view.insertion_index(slot) as usize] = slot);
    let id_of = |number: u32| slots.get(number as usize).copied().unwrap_or(number);
    for kept in springs {
        let (Some(a), Some(b)) = (scene.number_of(kept.a), scene.number_of(kept.b)) else { continue };
        let is_first = owner(&view, id_of(a), id_of(b)) == id_of(a);
        let (row, other) = if is_first { (a, b) } else { (b, a) };
        let key = other << feature_bits(&world.step) | kept.feature;
        let KeptSpring { shift, overlap, moment, .. } = *kept;
        rows[row as usize].push((key, Spring { shift, overlap, moment }));
    }
    let most = rows.iter().map(Vec::len).max().unwrap_or_default() as u32;
    world.set_history_room(FIRST_HISTORY_ROOM.max(most));
    let words = row_words(&world.step);
    let first = first_word(world);
    for (row, records) in world.histories[first..].chunks_exact_mut(words).zip(rows) {
        for (words, (key, spring)) in row.chunks_exact_mut(HISTORY_WORDS as usize).zip(records) {
            pack(words, key, &spring);
        }
    }
}

impl Simulation {
    /// The springs of all contacts; none with the law of the thesis.
    pub(super) async fn springs(&mut self) -> Result<Vec<KeptSpring>> {
        if self.world.step.history_room == 0 {
            return Ok(Vec::new());
        }
        self.download_histories().await?;
        Ok(springs_of(&self.world, &self.packed_ids))
    }

    /// Makes room for more contacts per mover, after a step that was rejected for lack of it.
    pub(super) async fn grow_histories(&mut self) -> Result<()> {
        self.download_histories().await?;
        let room = self.world.step.history_room;
        // Rows take half of the memory of a scene of grains, so they grow by little.
        self.world.set_history_room(room + (room / 4).max(1));
        self.engine.resize_histories(&self.world)
    }

    async fn download_histories(&mut self) -> Result<()> {
        self.world.status.history_table = self.status.history_table;
        self.engine.download_histories(&mut self.world).await
    }
}
