//! When memory is put in order again: once the disorder since the last time has cost more than the sorting will.

use crate::error::Result;
use crate::model::layout::ORDER_SAMPLE;
use crate::model::status::{REBUILD_REQUESTED, Status};
use crate::settings::BroadPhase;
use crate::simulation::{Simulation, engine};
use crate::step::schedule::{MEASURE_ORDER, SORT_MEMORY};

/// Steps between two looks at the order.
const LOOK_AFTER: u64 = 256;
/// What a binary digit more of distance in memory costs, in parts of a step: on a large GPU a million spheres in random order
/// take 4.7 times as long as in spatial order, at 10 digits more, 17 million 9 times as long at 14.
const COST_OF_A_DIGIT: f32 = 0.4;
/// Digits more or less that come from longer or shorter lists, not from disorder. A crowd that falls into a heap changes by more;
/// then memory is sorted once without need.
const NOISE: f32 = 0.5;
/// What sorting costs, in steps.
const COST_OF_SORTING: f32 = 20.0;

/// How far memory has come out of order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Disorder {
    looked_at: u64,
    /// Mean binary digits of the distance in memory of two neighbours, soon after sorting.
    at_best: Option<f32>,
    /// What the disorder has cost since, in steps.
    owed: f32,
}

impl Disorder {
    /// In order since this step.
    pub(super) fn sorted_at(step: u64) -> Self {
        Self { looked_at: step, ..Self::default() }
    }

    /// Steps until it is looked at next; 0: it is due.
    fn due_in(&self, step: u64) -> u64 {
        (self.looked_at + LOOK_AFTER).saturating_sub(step)
    }

    /// Takes what was found at a step, if anything; whether to sort now.
    fn look(&mut self, step: u64, digits: Option<f32>) -> bool {
        let steps = (step - self.looked_at) as f32;
        self.looked_at = step;
        let Some(digits) = digits else { return false };
        let best = self.at_best.map_or(digits, |best| best.min(digits));
        self.at_best = Some(best);
        self.owed += COST_OF_A_DIGIT * (digits - best - NOISE).max(0.0) * steps;
        self.owed > COST_OF_SORTING
    }
}

impl Simulation {
    /// Puts spheres into spatial order in memory, so that what is near in space is near in memory: worth a multiple of the speed
    /// where there are many. The simulation does so by itself when disorder has cost more than sorting; after all bodies were
    /// moved by hand it need not wait. Results do not depend on it; [`Simulation::slot`] changes. With the brute-force broad
    /// phase spheres stay in order of addition.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the GPU failed.
    #[cfg(not(target_family = "wasm"))]
    pub fn sort_memory(&mut self) -> Result<()> {
        let device = self.engine.waiter();
        engine::block_on(device, self.sort_memory_async())
    }

    /// [`Simulation::sort_memory`] without blocking.
    ///
    /// # Errors
    /// As there.
    pub async fn sort_memory_async(&mut self) -> Result<()> {
        self.flush_async().await?;
        match self.broad_phase_method() {
            BroadPhase::Grid => self.sort_where_it_is().await,
            BroadPhase::SortAndSkip => {
                self.pull().await?;
                self.rebuild()
            }
            _ => Ok(()),
        }
    }

    /// Looks at the order of memory now and then, and puts it right where that pays.
    pub(super) async fn keep_order(&mut self) -> Result<()> {
        let step = self.report.steps;
        if self.world.order.is_empty() || self.lists_due || self.disorder.due_in(step) > 0 {
            return Ok(());
        }
        self.world.status = Status { rejected: 0, order_entries: 0, order_digits: 0, ..self.status };
        self.engine.run(&mut self.world, MEASURE_ORDER).await?;
        let Status { order_entries, order_digits, .. } = self.world.status;
        let sampled = self.world.step.spheres.min(ORDER_SAMPLE) / 2;
        // Where few have neighbours, order costs nothing and shows in nothing.
        let digits = (order_entries >= sampled.max(1)).then(|| order_digits as f32 / order_entries as f32);
        if self.disorder.look(step, digits) {
            self.sort_memory_async().await?;
        }
        Ok(())
    }

    /// Steps that may be done before [`Simulation::keep_order`] is called again, at least 1.
    pub(super) fn in_order_for(&self) -> u64 {
        if self.world.order.is_empty() { u64::MAX } else { self.disorder.due_in(self.report.steps).max(1) }
    }

    /// On the device, where the state is; the host learns the new order alone.
    async fn sort_where_it_is(&mut self) -> Result<()> {
        self.world.status = Status { rejected: 0, rebuild: REBUILD_REQUESTED, ..self.status };
        self.engine.run(&mut self.world, SORT_MEMORY).await?;
        self.engine.download_words(&mut self.world).await?;
        self.world.take_order();
        self.packings += 1;
        self.disorder = Disorder::sorted_at(self.report.steps);
        self.aabbs_due = true;
        self.lists_due = true;
        self.has_stages = false;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps_until_sorted(digits: impl Fn(u64) -> f32) -> Option<u64> {
        let mut disorder = Disorder::sorted_at(0);
        (1..=400).map(|look| look * LOOK_AFTER).find(|step| disorder.look(*step, Some(digits(*step))))
    }

    #[test]
    fn what_stays_in_order_is_never_sorted() {
        assert_eq!(steps_until_sorted(|step| 9.0 + 0.2 * (step as f32 * 0.001).sin()), None);
    }

    #[test]
    fn the_faster_it_comes_out_of_order_the_sooner_it_is_sorted() {
        // A digit in 10,000 steps: the noise is exceeded after 5,000, and 0.4 t^2 / 20,000 comes to 20 after 1,000 more.
        let slowly = steps_until_sorted(|step| 9.0 + step as f32 / 10_000.0).unwrap();
        assert!((6_000..7_000).contains(&slowly), "{slowly}");
        let fast = steps_until_sorted(|step| 9.0 + step as f32 / 1_000.0).unwrap();
        assert!(fast < slowly, "{fast}");
    }
}
