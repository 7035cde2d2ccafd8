//! Pair lists: the phases and settings with which they are built, and when they are out of date.
//!
//! [`ListPolicy`] decides for how many steps lists are built. It uses counts of work and the
//! distances by which bodies left their AABBs. This file passes it the facts of the scene and applies its decisions.

use crate::error::{Error, Result};
use crate::model::layout::{LAW_THESIS, most_pair_rows, words_of_rows};
use crate::model::status::{REJECTED_COLLISIONS, REJECTED_ESCAPED, REJECTED_PAIRS};
use crate::model::step::ListSettings;
use crate::model::world::World;
use crate::options::Optimization;
use crate::simulation::Simulation;
use crate::step::schedule::Phase;

mod cost;
mod policy;
mod trials;

use cost::ListFacts;
pub(super) use policy::ListPolicy;
#[cfg(test)]
pub(super) use policy::MIN_MARGIN;
use policy::margin_after_escape;

/// Distance by which AABBs are ahead of their bodies, in steps. Half a step ahead, they need to reach only half of the distance of one
/// step to either side.
const LEAD: f32 = 0.5;

impl Simulation {
    /// Whether the stages that rebuild lists can be left out of some steps, if `phases` are a whole step.
    pub(super) fn lists_may_wait(&self, is_step: bool) -> bool {
        is_step && self.engine.dispatches() && self.options.uses(Optimization::ListInterval) && self.scene.shear().is_none()
    }

    /// The facts of the scene on which the decisions of the policy depend.
    pub(super) fn list_facts(&self) -> ListFacts {
        let (step, traits) = (&self.world.step, self.world.step.traits());
        let movers = step.movers().max(1) as f32;
        let making = [Phase::UpdateAabbs, Phase::BroadPhase].into_iter();
        let runs = making.flat_map(|phase| phase.stages(self.integrator(), self.broad_phase_method()));
        let stages = runs.filter(|run| run.workgroups(step) > 0).count();
        ListFacts {
            movers,
            capacity: words_of_rows(step.layout.pair_rows) as f32 / movers,
            has_rods: traits.rods,
            has_long_lists: traits.has_long_lists(),
            has_history: traits.law != LAW_THESIS,
            broad_phase: self.broad_phase_method(),
            dispatches: if self.engine.dispatches() { stages as f32 } else { 0.0 },
        }
    }

    /// Gives the next steps the settings of the policy. Returns the interval and the version.
    ///
    /// AABBs are ahead of motion in whole steps alone. If phases run one by one, the collision phase may follow the broad phase, and
    /// an impulse may reverse the motion for which AABBs are placed ahead.
    pub(super) fn put_list_settings(&mut self, is_step: bool) -> (u32, u32) {
        let mut plan = self.lists.settings();
        if self.scene.shear().is_some() {
            // Images pass each other in every step.
            plan.lookahead = 1.0;
        }
        let has_lead = is_step && self.options.uses(Optimization::Lead);
        self.world.step.lists = ListSettings {
            margin_scale: plan.margin,
            lookahead: plan.lookahead,
            list_interval: plan.interval as f32,
            lead: if has_lead { LEAD } else { 0.0 },
        };
        (plan.interval, plan.version)
    }

    /// Gives a copy of an earlier state lists that hold as long as those of the simulation. More pairs do not change results.
    pub(super) fn put_lists_of_observation(&self, world: &mut World) {
        world.step.lists.lookahead = self.lists.settings().lookahead;
    }

    /// The phases that must run first because AABBs or lists do not match the scene.
    pub(super) fn overdue(&self, phases: &[Phase]) -> &'static [Phase] {
        let (mut aabbs_due, mut lists_due) = (self.aabbs_due, self.lists_due);
        for phase in phases {
            match phase {
                Phase::UpdateAabbs => aabbs_due = false,
                Phase::BroadPhase if aabbs_due => return &[Phase::UpdateAabbs],
                Phase::BroadPhase => lists_due = false,
                // The collisions of this step are done, so the lists are not read.
                Phase::HandleCollisions if self.status.collided != 0 => {}
                _ if lists_due => return &[Phase::UpdateAabbs, Phase::BroadPhase],
                _ => {}
            }
        }
        &[]
    }

    /// Records whether AABBs and lists match the scene.
    pub(super) fn note_lists(&mut self, phases: &[Phase], done: u64) {
        let rejected = self.status.rejected;
        if phases.contains(&Phase::UpdateAabbs) {
            self.aabbs_due = false;
        }
        if phases.contains(&Phase::BroadPhase) && (done > 0 || rejected & REJECTED_PAIRS == 0) {
            self.lists_due = false;
        }
        // If a step is rejected in or after its collisions, its AABBs and lists may be incomplete.
        self.lists_due |= rejected & (REJECTED_PAIRS | REJECTED_ESCAPED | REJECTED_COLLISIONS) != 0;
        self.aabbs_due |= rejected & (REJECTED_ESCAPED | REJECTED_COLLISIONS) != 0;
    }

    /// After lists did not fit: shortens them, or makes their memory a quarter larger than needed.
    pub(super) fn make_lists_fit(&mut self) -> Result<()> {
        let (facts, needed) = (self.list_facts(), self.status.pair_rows_needed);
        if self.lists.overflowed(&facts, words_of_rows(needed) as f32 / facts.movers) {
            return Ok(());
        }
        let rows = room_for(needed, self.world.movers())?;
        let before = self.world.step.layout.pair_rows;
        self.world.set_pair_room(rows);
        self.engine.complete(&mut self.world);
        let grown = self.engine.resize_lists(&self.world);
        if grown.is_err() {
            // The simulation may go on with fewer objects, so the world must not keep the size that could not be allocated.
            self.world.set_pair_room(before);
        }
        grown
    }
}

/// Number of rows to allocate for entries when `needed` rows are needed.
pub(super) fn room_for(needed: u32, movers: u32) -> Result<u32> {
    let most = most_pair_rows(movers);
    if needed > most {
        let bytes = |rows: u32| 4 * words_of_rows(rows);
        return Err(Error::DeviceLimit { what: "the pair lists", needed: bytes(needed), limit: bytes(most) });
    }
    Ok(needed.saturating_add(needed.div_ceil(4)).min(most))
}

/// Enlarges the AABBs of a world outside of a simulation after a body left its own.
pub(super) fn widen_after_escape(world: &mut World, escape: f32, attempts: u32) {
    let margin = &mut world.step.lists.margin_scale;
    *margin = margin_after_escape(*margin, escape, attempts);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::layout::{MAX_PAIR_ROWS, SLICE, max_objects};
    use crate::simulation::drive::COLLISIONS_FIRST;

    /// If the collisions of a repeated step are done, no lists are built before the collision phase.
    #[test]
    #[cfg(not(target_family = "wasm"))]
    fn done_collisions_need_no_lists() {
        let mut scene = crate::Scene::new();
        scene.add_sphere(crate::Sphere::new([0.0; 3], 1.0)).unwrap();
        let mut simulation = Simulation::with_options(scene, crate::Options::new().backend(crate::Backend::Cpu)).unwrap();
        (simulation.aabbs_due, simulation.lists_due) = (true, true);
        assert_eq!(simulation.overdue(&COLLISIONS_FIRST), [Phase::UpdateAabbs, Phase::BroadPhase]);
        simulation.status.collided = 1;
        assert!(simulation.overdue(&COLLISIONS_FIRST).is_empty());
        assert_eq!(simulation.overdue(&[Phase::UpdatePositions]), [Phase::UpdateAabbs, Phase::BroadPhase]);
    }

    #[test]
    fn lists_grow_up_to_what_32_bits_can_number() {
        let most = u32::MAX;
        assert_eq!(room_for(1_000, most).unwrap(), 1_250);
        // A quarter more exceeds the maximum number of rows, or 32 bits.
        for needed in [MAX_PAIR_ROWS / 8 * 7, MAX_PAIR_ROWS] {
            assert_eq!(room_for(needed, most).unwrap(), MAX_PAIR_ROWS);
        }
        assert!(matches!(room_for(MAX_PAIR_ROWS + 1, most), Err(Error::DeviceLimit { .. })));
        assert!(matches!(room_for(u32::MAX, most), Err(Error::DeviceLimit { .. })));
        // Fewer movers may have shorter lists: 64 MiB, or 4 KiB for each of them.
        assert_eq!(room_for(1 << 19, 10).unwrap(), 1 << 19);
        assert!(matches!(room_for((1 << 19) + 1, 10), Err(Error::DeviceLimit { limit: 0x400_0000, .. })));
        assert_eq!(room_for(1 << 20, 1 << 15).unwrap(), 1 << 20);
        // Counts and slice offsets of the maximum number of movers precede the entries.
        let slices = max_objects(false).div_ceil(SLICE);
        assert!(MAX_PAIR_ROWS.checked_add(slices + slices.div_ceil(SLICE) + 1).is_some());
    }
}
