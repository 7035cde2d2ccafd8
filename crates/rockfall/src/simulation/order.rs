//! Decides when memory is sorted again: when the disorder since the last sorting has cost more than sorting does.

use crate::error::Result;
use crate::model::layout::ORDER_SAMPLE;
use crate::model::status::{REBUILD_REQUESTED, Status};
use crate::options::Optimization;
use crate::settings::BroadPhase;
use crate::simulation::Simulation;
#[cfg(not(target_family = "wasm"))]
use crate::simulation::engine;
use crate::simulation::kept::Kept;
use crate::step::schedule::{MEASURE_ORDER, SORT_MEMORY};

/// Steps between two measurements of the order.
const LOOK_AFTER: u64 = 256;
/// Cost of one more binary digit of the distance in memory, as a fraction of the time of a step. On a large GPU, steps of a
/// million spheres in random order take 4.7 times as long as in spatial order, with 10 digits more; steps of 17 million spheres
/// take 9 times as long, with 14 digits more.
const COST_OF_A_DIGIT: f32 = 0.4;
/// Change in digits that comes from longer or shorter lists, not from disorder. Bodies that fall into a heap change the digits
/// by more; memory is then sorted once without need.
const NOISE: f32 = 0.5;
/// Cost of sorting, in steps.
const COST_OF_SORTING: f32 = 20.0;

/// Disorder of the memory since it was last sorted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Disorder {
    /// Step of the last measurement.
    measured_at: u64,
    /// Least mean number of binary digits of the distance in memory of two neighbours, measured since the last sorting.
    at_best: Option<f32>,
    /// Cost of the disorder since the last sorting, in steps.
    owed: f32,
}

impl Disorder {
    /// The disorder of memory that was sorted at step `step`.
    pub(super) fn sorted_at(step: u64) -> Self {
        Self { measured_at: step, ..Self::default() }
    }

    /// Steps until the next measurement; 0 if it is due.
    fn due_in(&self, step: u64) -> u64 {
        (self.measured_at + LOOK_AFTER).saturating_sub(step)
    }

    /// Takes a measurement at a step, `None` if too few spheres have neighbours. Returns whether to sort now.
    fn look(&mut self, step: u64, digits: Option<f32>) -> bool {
        let steps = (step - self.measured_at) as f32;
        self.measured_at = step;
        let Some(digits) = digits else { return false };
        let best = self.at_best.map_or(digits, |best| best.min(digits));
        self.at_best = Some(best);
        self.owed += COST_OF_A_DIGIT * (digits - best - NOISE).max(0.0) * steps;
        self.owed > COST_OF_SORTING
    }
}

impl Simulation {
    /// Sorts the spheres in memory into spatial order, so that spheres near in space are near in memory.
    ///
    /// With many spheres this multiplies the speed. The simulation does so by itself when disorder has cost more than sorting.
    /// Call it after moving all bodies by edits, to avoid that delay. Results do not depend on it, but [`Simulation::slot`]
    /// changes. With the brute-force broad phase, and without
    /// [`Optimization::SpatialOrder`], spheres stay in order of addition.
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
    /// As for [`Simulation::sort_memory`].
    pub async fn sort_memory_async(&mut self) -> Result<()> {
        self.flush_async().await?;
        if !self.options.uses(Optimization::SpatialOrder) {
            return Ok(());
        }
        match self.broad_phase_method() {
            BroadPhase::Grid => self.sort_in_place().await,
            BroadPhase::SortAndSkip => {
                self.pull().await?;
                let springs = self.springs().await?;
                let rates = self.rates().await?;
                self.rebuild(&Kept { springs: &springs, rates: &rates, residues: &self.residues(&[]) })
            }
            _ => Ok(()),
        }
    }

    /// Measures the order of memory at intervals, and sorts it when that pays.
    pub(super) async fn keep_order(&mut self) -> Result<()> {
        let step = self.report.steps;
        if self.world.order.is_empty() || self.lists_due || self.disorder.due_in(step) > 0 {
            return Ok(());
        }
        self.world.status = Status { rejected: 0, order_entries: 0, order_digits: 0, ..self.status };
        self.engine.run(&mut self.world, MEASURE_ORDER).await?;
        let Status { order_entries, order_digits, .. } = self.world.status;
        let sampled = self.world.step.layout.spheres.min(ORDER_SAMPLE) / 2;
        // If few spheres have neighbours, disorder costs nothing and cannot be measured.
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

    /// Sorts where the engine keeps the state. The host reads back only the new order.
    async fn sort_in_place(&mut self) -> Result<()> {
        self.world.status = Status { rejected: 0, rebuild: REBUILD_REQUESTED, ..self.status };
        self.engine.run(&mut self.world, SORT_MEMORY).await?;
        self.engine.download_topology(&mut self.world).await?;
        self.world.take_order();
        self.packings += 1;
        self.disorder = Disorder::sorted_at(self.report.steps);
        self.aabbs_due = true;
        self.lists_due = true;
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
    fn memory_that_stays_in_order_is_never_sorted() {
        assert_eq!(steps_until_sorted(|step| 9.0 + 0.2 * (step as f32 * 0.001).sin()), None);
    }

    #[test]
    fn memory_that_loses_its_order_faster_is_sorted_sooner() {
        // At one digit in 10,000 steps, the noise is exceeded after 5,000 steps, and 0.4 t^2 / 20,000 reaches 20 after 1,000
        // more.
        let slowly = steps_until_sorted(|step| 9.0 + step as f32 / 10_000.0).unwrap();
        assert!((6_000..7_000).contains(&slowly), "{slowly}");
        let fast = steps_until_sorted(|step| 9.0 + step as f32 / 1_000.0).unwrap();
        assert!(fast < slowly, "{fast}");
    }
}
