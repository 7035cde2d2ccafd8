//! Writes the table of muscles.

use crate::model::layout::MUSCLE_WORDS;
use crate::model::muscles::MuscleClock;
use crate::model::world::World;
use crate::scene::Scene;

impl World {
    /// Writes the table of muscles for a clock, unless the present table is the same. Returns whether it was written. `scene` is
    /// the scene that the topology was packed from.
    pub(crate) fn set_muscles(&mut self, scene: &Scene, clock: &MuscleClock) -> bool {
        self.set_muscle_time(clock);
        let is_same = self.muscles_for.is_some_and(|known| known.has_table_of(clock));
        if self.step.layout.muscles_at == 0 || is_same {
            return false;
        }
        self.muscles_for = Some(*clock);
        let table = &mut self.topology[self.step.layout.muscles_at as usize..];
        for (record, spring) in table.chunks_exact_mut(MUSCLE_WORDS as usize).zip(scene.springs()) {
            record.copy_from_slice(&clock.record(spring.muscle));
        }
        true
    }
}
