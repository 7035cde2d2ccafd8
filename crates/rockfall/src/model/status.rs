//! The block `status`: what kernels tell the host, and each other.

use bytemuck::{Pod, Zeroable};

/// Bit of [`Status::rejected`]: the pair lists did not fit; [`Status::pair_rows_needed`] rows are needed.
pub const REJECTED_PAIRS: u32 = 1;
/// Bit of [`Status::rejected`]: a body left its AABB before or within the step, so its list may lack a pair.
pub const REJECTED_ESCAPED: u32 = 2;
/// Bit of [`Status::rejected`]: a body's state stopped being finite in the step before; later steps do nothing.
pub const REJECTED_NON_FINITE: u32 = 4;

/// Bit of [`Status::rejected`]: the pair lists need more rows than can be numbered.
pub const REJECTED_COUNT: u32 = 8;

/// Bit of [`Status::rejected`]: collisions share bodies and the step was begun without sweeps, or there is no room for them.
pub const REJECTED_COLLISIONS: u32 = 16;
/// Bit of [`Status::rejected`], beside [`REJECTED_COLLISIONS`]: one workgroup cannot make all sweeps.
pub const REJECTED_MANY: u32 = 32;

/// Bit of [`Status::rebuild`]: some body asks for new lists.
pub const REBUILD_REQUESTED: u32 = 1;
/// Bit of [`Status::rebuild`]: they were made in this step.
pub const REBUILD_DONE: u32 = 2;

/// [`Status::bad_body`] when every body is finite.
pub const NO_BODY: u32 = u32::MAX;
/// The place in a step where a body stopped being finite, the high bits of [`Status::bad_body`].
pub const BAD_STAGE_SHIFT: u32 = 29;

/// How many [`Counters`] there are.
pub const COUNTER_BLOCKS: u32 = 64;

/// What some workgroups have counted in the step under way. A device adds to one word for one workgroup after the other, some
/// nanoseconds each, so they share out [`COUNTER_BLOCKS`] of these, a sector of the cache each; `end_step` adds them up.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Counters {
    /// Contacts of the step's first force evaluation.
    pub contacts: u32,
    /// Bits of the deepest overlap of the step's first force evaluation.
    pub max_overlap: u32,
    /// Collisions handled.
    pub collisions: u32,
    /// Padding to 32 bytes.
    pub pad: [u32; 5],
}

impl Counters {
    /// Both together.
    pub fn and(self, other: Self) -> Self {
        Self {
            contacts: self.contacts + other.contacts,
            max_overlap: self.max_overlap.max(other.max_overlap),
            collisions: self.collisions + other.collisions,
            pad: self.pad,
        }
    }
}

/// What the kernels tell the host, and each other. Counters are of the step under way unless they say `last` or `total`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Status {
    /// What is counted; on the CPU the first holds all of it.
    pub counters: [Counters; COUNTER_BLOCKS as usize],
    /// `VOID_*` bits; not 0: later stages leave the bodies alone, until the host has seen to it.
    pub rejected: u32,
    /// Rows that the entries of the pair lists need.
    pub pair_rows_needed: u32,
    /// Bits of the largest distance, in 0.02 r, by which a body left its AABB; positive floats order like their bits.
    pub escape_ratio: u32,
    /// Steps done since the status was last reset.
    pub steps: u32,
    /// 2 once the collisions of the step under way are done, 1 when they were done before the step was begun again, so that it
    /// does not repeat them.
    pub collided: u32,
    /// 1 when rod lengths may be off before the integration (first step, a step with collisions).
    pub lengths_due: u32,
    /// 1 where there are collisions in the step under way.
    pub collides: u32,
    /// Contacts of the last step done.
    pub last_contacts: u32,
    /// Bits of the deepest overlap of the last step done.
    pub last_max_overlap: u32,
    /// Collisions of the last step done.
    pub last_collisions: u32,
    /// Collisions of all steps done, low word.
    pub total_collisions_low: u32,
    /// Collisions of all steps done, high word.
    pub total_collisions_high: u32,
    /// Least `stage << BAD_STAGE_SHIFT | sphere` (see [`BadStage`]; the sphere's index in order of addition) over the bodies that
    /// stopped being finite, or [`NO_BODY`].
    pub bad_body: u32,
    /// Value of `steps` when the first body stopped being finite (that step counted); 0 while there is none.
    pub bad_step: u32,
    /// Bodies stopped for not being finite.
    pub bad_count: u32,
    /// The same of all steps done.
    pub total_bad: u32,
    /// Value of `bad_body` in the step `bad_step`: the first body that stopped being finite, or [`NO_BODY`].
    pub first_bad: u32,
    /// `LISTS_*` bits; while it is 0, AABBs and lists of an earlier step still hold every pair.
    pub rebuild: u32,
    /// Steps in which AABBs and lists were made anew, since the status was last reset.
    pub builds: u32,
    /// List entries that `measure_order` looked at.
    pub order_entries: u32,
    /// Sum of the binary digits of the distances in memory between their two spheres.
    pub order_digits: u32,
    /// Collisions that were listed in the step under way; more than there is room for void it.
    pub listed: u32,
    /// 1 where collisions share bodies in the step under way.
    pub clustered: u32,
    /// Steps in which collisions shared bodies, since the status was last reset.
    pub clustered_steps: u32,
    /// Those of them with more collisions than [`FEW_COLLISIONS`](crate::model::layout::FEW_COLLISIONS).
    pub many_steps: u32,
}

impl Default for Status {
    fn default() -> Self {
        Self { lengths_due: 1, rebuild: REBUILD_REQUESTED, bad_body: NO_BODY, first_bad: NO_BODY, ..Zeroable::zeroed() }
    }
}

impl Status {
    /// All that was told in the step under way.
    pub fn total_counters(&self) -> Counters {
        self.counters.iter().copied().fold(Counters::default(), Counters::and)
    }
}
