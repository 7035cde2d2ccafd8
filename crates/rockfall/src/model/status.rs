//! The block `status`: what the kernels report to the host and to later kernels.

use bytemuck::{Pod, Zeroable};

use crate::model::declare::{constants, words};

constants! {
    /// Bit of [`Status::rejected`]: the pair lists do not fit. They need [`Status::pair_rows_needed`] rows.
    pub const REJECTED_PAIRS: u32 = 1;
    /// Bits of [`Status::rejected`]: a body left its AABB before or during the step, so its list may lack a pair. A bit for each dispatch
    /// that finds this out, from [`ESCAPE_SHIFT`] on: the other threads of the dispatch go on, so that they all count, and what is reported does
    /// not depend on the order in which they run.
    pub const REJECTED_ESCAPED: u32 = 0x1ff00;
    /// The first of these bits. Its number is added to those below.
    pub const ESCAPE_SHIFT: u32 = 8;
    /// Number of the dispatch of `find_crossings` among those that find escapes.
    pub const ESCAPED_ON_PATHS: u32 = 0;
    /// Number of the dispatch of `find_collisions`.
    pub const ESCAPED_IN_COLLISIONS: u32 = 1;
    /// Number of the first dispatch of `loads`; the others follow.
    pub const ESCAPED_IN_LOADS: u32 = 2;
    /// Number of the dispatch of `move_walls` with pass 1; the others follow.
    pub const ESCAPED_ON_WALLS: u32 = 6;
    /// Bit of [`Status::rejected`]: the step was rejected before the last step of the submission, which did nothing but build lists.
    pub const REJECTED_BEFORE: u32 = 0x20000;
    /// Bit of [`Status::rejected`]: a body's state stopped being finite in an earlier step, and the simulation must not continue.
    pub const REJECTED_NON_FINITE: u32 = 4;

    /// Bit of [`Status::rejected`]: the pair lists need more rows than row numbers can count.
    pub const REJECTED_COUNT: u32 = 8;

    /// Bit of [`Status::rejected`]: there is no room for all collisions, or collisions share bodies and
    /// [`Constants::sweeps`](crate::model::step::Constants::sweeps) does not allow that.
    pub const REJECTED_COLLISIONS: u32 = 16;
    /// Bit of [`Status::rejected`], together with [`REJECTED_COLLISIONS`]: one workgroup cannot do all sweeps.
    pub const REJECTED_MANY: u32 = 32;

    /// Bit of [`Status::rejected`]: the contacts need more blocks than the pool of
    /// [`Buffer::Histories`](crate::model::buffer::Buffer::Histories) has. They need [`Status::history_needed`].
    pub const REJECTED_HISTORY: u32 = 64;
    /// Bit of [`Status::rejected`]: the impulses on a network of fixed-length rods could not be solved.
    pub const REJECTED_NETWORKS: u32 = 128;

    /// Bit of [`Status::rebuild`]: some body requests new lists.
    pub const REBUILD_REQUESTED: u32 = 1;
    /// Bit of [`Status::rebuild`]: the lists were rebuilt in this step.
    pub const REBUILD_DONE: u32 = 2;
    /// Both: new lists are requested, or some of the stages that build them are done.
    pub const REBUILD_UNDER_WAY: u32 = REBUILD_REQUESTED | REBUILD_DONE;

    /// Value of [`Status::bad_body`] when every body is finite.
    pub const NO_BODY: u32 = u32::MAX;
    /// Shift of the [`BadStage`](crate::error::BadStage) in [`Status::bad_body`].
    pub const BAD_STAGE_SHIFT: u32 = 29;

    /// Number of [`Counters`].
    pub const COUNTER_BLOCKS: u32 = 64;
}

words! {
    /// Counts of the current step. A device serializes atomic operations on one word, at some nanoseconds each. So the workgroups
    /// spread their counts over [`COUNTER_BLOCKS`] of these blocks, each in its own cache sector. `end_step` adds them up.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
    pub struct Counters {
        before {}
        words {
            /// Contacts of the step's first force evaluation.
            pub contacts: u32 => atomic,
            /// Bits of the deepest overlap of the step's first force evaluation.
            pub max_overlap: u32 => atomic,
            /// Collisions in the step.
            pub collisions: u32 => atomic,
            /// 1 when a sphere is so fast that it may pass a wall. Like the next two words, only in the first block.
            pub fast: u32 => atomic,
            /// Number of spheres whose centres have passed a wall in the step.
            pub passages: u32 => atomic,
            /// The bitwise complement of the least insertion index of these spheres; 0 without passages.
            pub passing: u32 => atomic,
        }
        after {
            /// Padding to 32 bytes.
            pub pad: [u32; Counters::PADDING],
        }
    }
}

impl Counters {
    /// Words of padding.
    pub(crate) const PADDING: usize = 2;

    /// Returns the counts of both together.
    pub fn and(self, other: Self) -> Self {
        Self {
            contacts: self.contacts + other.contacts,
            max_overlap: self.max_overlap.max(other.max_overlap),
            collisions: self.collisions + other.collisions,
            fast: self.fast | other.fast,
            passages: self.passages + other.passages,
            passing: self.passing.max(other.passing),
            pad: self.pad,
        }
    }
}

words! {
    /// What the kernels report to the host and to later kernels. Counts without `last` or `total` are those of the current step.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
    pub struct Status {
        before {
            /// Counts of the workgroups. On the CPU, the first block holds all counts.
            pub counters: [Counters; COUNTER_BLOCKS as usize],
        }
        words {
            /// `REJECTED_*` bits. While it is not 0, later stages do not change the bodies, until the host has handled the reason, or new
            /// lists let the next step repeat this one ([`Status::may_repeat`]).
            pub rejected: u32 => atomic,
            /// Number of rows that the entries of the pair lists need.
            pub pair_rows_needed: u32 => atomic,
            /// Largest distance of a body outside its AABB, in units of 0.02 r, stored as the bits of a float. Positive floats are
            /// ordered as their bits are.
            pub escape_ratio: u32 => atomic,
            /// Steps completed since the status was last reset.
            pub steps: u32,
            /// 2 when the collisions of the current step are done. 1 when they were done in a previous attempt at this step, so that
            /// they are not repeated.
            pub collided: u32 => atomic,
            /// 1 when rod lengths must be restored before the integration: in the first step and after edits.
            /// The end of a step clears it, so at the start of the collisions it is 0 when a step has led to the present state.
            pub lengths_due: u32,
            /// Velocity Verlet: 1 when the rates of the last force evaluation do not belong to the present state. They are then evaluated
            /// again before the integration: in the first step, after edits, and after the collision phase,
            /// whether or not there were collisions, so that bodies do not depend on collisions elsewhere.
            pub forces_due: u32,
            /// 1 when there are collisions in the current step.
            pub collides: u32 => atomic,
            /// Contacts of the last completed step.
            pub last_contacts: u32,
            /// Bits of the deepest overlap of the last completed step.
            pub last_max_overlap: u32,
            /// Collisions of the last completed step.
            pub last_collisions: u32,
            /// Collisions of all completed steps, low word.
            pub total_collisions_low: u32,
            /// Collisions of all completed steps, high word.
            pub total_collisions_high: u32,
            /// Least `stage << BAD_STAGE_SHIFT | insertion index` over the bodies that stopped being finite, or [`NO_BODY`]. The stage
            /// is a [`BadStage`](crate::error::BadStage).
            pub bad_body: u32 => atomic,
            /// Value of `steps` after the step in which the first body stopped being finite; 0 while there is none.
            pub bad_step: u32,
            /// Number of bodies that were stopped because their new state was not finite.
            pub bad_count: u32 => atomic,
            /// Number of such bodies in all completed steps.
            pub total_bad: u32,
            /// Value of `bad_body` in the step `bad_step`: the first body that stopped being finite, or [`NO_BODY`].
            pub first_bad: u32,
            /// `REBUILD_*` bits. While it is 0, the AABBs and lists of an earlier step still hold every pair.
            pub rebuild: u32 => atomic,
            /// Steps in which AABBs and lists were rebuilt, since the status was last reset.
            pub builds: u32,
            /// Number of list entries in the sample of `measure_order`.
            pub order_entries: u32 => atomic,
            /// Sum, over these entries, of the number of bits of the distance in memory between the two spheres.
            pub order_digits: u32 => atomic,
            /// Collisions listed in the current step. The step is rejected when there are more than there is room for.
            pub listed: u32 => atomic,
            /// 1 when collisions share bodies in the current step.
            pub clustered: u32 => atomic,
            /// Steps in which collisions shared bodies, since the status was last reset.
            pub clustered_steps: u32,
            /// Such steps with more than [`FEW_COLLISIONS`](crate::model::layout::FEW_COLLISIONS) collisions.
            pub many_steps: u32,
            /// Which of the two tables in [`Buffer::Histories`](crate::model::buffer::Buffer::Histories) has the springs before the step,
            /// 0 or 1. The end of a step exchanges the tables.
            pub history_table: u32,
            /// Blocks of the pool that the springs after the current step take, including those that it has no room for. The end of a step
            /// resets it, also that of a rejected one.
            pub history_blocks: u32 => atomic,
            /// Number of blocks that the pool must have for a step that was rejected with [`REJECTED_HISTORY`]; 0 before that step ends.
            pub history_needed: u32,
            /// Rejected steps that `end_step` let the next step repeat, since the status was last reset. They were rejected because a body
            /// left its AABB.
            pub repeats: u32,
            /// 1 while the current step is repeated in this way. If it is rejected again, the host repeats it.
            pub repeated: u32,
            /// Number of spheres whose centres have passed a wall, in all completed steps.
            pub total_passages: u32,
            /// The least insertion index of these spheres in the first step with a passage, or [`NO_BODY`].
            pub first_passing: u32,
            /// Value of `steps` after that step; 0 while there is none.
            pub passage_step: u32,
            /// Value of `escape_ratio` in the last step that was repeated in this way, stored in the same form.
            pub repeat_escape: u32,
        }
        after {}
    }
}

impl Default for Status {
    fn default() -> Self {
        Self {
            lengths_due: 1,
            forces_due: 1,
            rebuild: REBUILD_REQUESTED,
            bad_body: NO_BODY,
            first_bad: NO_BODY,
            first_passing: NO_BODY,
            ..Zeroable::zeroed()
        }
    }
}

impl Status {
    /// Returns whether a stage that rebuilds lists has work. It waits for these bits of `rebuild`. A step that was rejected because
    /// a body left its AABB gets new lists, so that the next one can repeat it.
    pub fn builds_lists(&self, bits: u32) -> bool {
        self.rebuild & bits != 0 && (self.rejected == 0 || self.may_repeat())
    }

    /// Returns whether the next step may repeat the current one: it was rejected only because a body left its AABB, and for the
    /// first time. It must get new lists before.
    pub fn may_repeat(&self) -> bool {
        self.has_only_escaped() && self.repeated == 0
    }

    /// Whether the step was rejected only because a body left its AABB.
    pub fn has_only_escaped(&self) -> bool {
        self.rejected != 0 && self.rejected & !(REJECTED_ESCAPED | REJECTED_BEFORE) == 0
    }

    /// Returns the status with which a rejected step is repeated. Counters begin at zero, and the results of finished phases are
    /// kept.
    pub(crate) fn repeating(self) -> Self {
        let is_done = self.collided != 0;
        let counters =
            |counters: Counters| Counters { collisions: if is_done { counters.collisions } else { 0 }, ..Counters::default() };
        Self {
            counters: self.counters.map(counters),
            collides: if is_done { self.collides } else { 0 },
            listed: 0,
            clustered: if is_done { self.clustered } else { 0 },
            rejected: 0,
            escape_ratio: 0,
            bad_count: 0,
            bad_body: NO_BODY,
            collided: self.collided.min(1),
            ..self
        }
    }

    /// Returns the counts of all blocks together.
    pub fn total_counters(&self) -> Counters {
        self.counters.iter().copied().fold(Counters::default(), Counters::and)
    }
}
