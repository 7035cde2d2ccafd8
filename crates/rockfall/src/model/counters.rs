//! What a stage adds to the status block. Tallies can be merged in any order, so threads may divide the work freely.

use crate::error::BadStage;
use crate::model::status::{BAD_STAGE_SHIFT, Counters, ESCAPE_SHIFT, NO_BODY, REBUILD_DONE, REBUILD_REQUESTED, Status};

/// Counts for one body, or for several bodies together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tally {
    pub(crate) contacts: u32,
    /// Deepest overlap; not negative.
    pub(crate) max_overlap: f32,
    pub(crate) collisions: u32,
    /// Whether some body may leave its AABB before the next opportunity to rebuild lists.
    pub(crate) rebuild: bool,
    /// Largest distance of a body outside its AABB, in units of 0.02 r; 0 when every body is inside.
    escape_ratio: f32,
    /// `REJECTED_ESCAPED` bits.
    escaped: u32,
    bad_count: u32,
    bad_body: u32,
    /// Whether some sphere is so fast that it may pass a wall.
    pub(crate) fast: bool,
    passages: u32,
    /// The complement of the least insertion index.
    passing: u32,
}

impl Default for Tally {
    fn default() -> Self {
        Self {
            contacts: 0,
            max_overlap: 0.0,
            collisions: 0,
            rebuild: false,
            escape_ratio: 0.0,
            escaped: 0,
            bad_count: 0,
            bad_body: NO_BODY,
            fast: false,
            passages: 0,
            passing: 0,
        }
    }
}

impl Tally {
    pub(crate) fn merge(self, other: Self) -> Self {
        Self {
            contacts: self.contacts + other.contacts,
            max_overlap: self.max_overlap.max(other.max_overlap),
            collisions: self.collisions + other.collisions,
            rebuild: self.rebuild | other.rebuild,
            escape_ratio: self.escape_ratio.max(other.escape_ratio),
            escaped: self.escaped | other.escaped,
            bad_count: self.bad_count + other.bad_count,
            bad_body: self.bad_body.min(other.bad_body),
            fast: self.fast | other.fast,
            passages: self.passages + other.passages,
            passing: self.passing.max(other.passing),
        }
    }

    /// Notes how far a body is outside its AABB, in units of 0.02 r, or 0. `dispatch` is the number of the dispatch that found it.
    pub(crate) fn note_escape(&mut self, dispatch: u32, ratio: f32) {
        if ratio > 0.0 {
            self.escaped |= 1 << (ESCAPE_SHIFT + dispatch);
            self.escape_ratio = self.escape_ratio.max(ratio);
        }
    }

    /// Counts a contact of the first force evaluation.
    pub(crate) fn count_contact(&mut self, overlap: f32) {
        self.contacts += 1;
        self.max_overlap = self.max_overlap.max(overlap);
    }

    /// Counts a body whose new state is not finite.
    pub(crate) fn count_bad(&mut self, stage: BadStage, insertion_index: u32) {
        self.bad_count += 1;
        self.bad_body = self.bad_body.min((stage as u32) << BAD_STAGE_SHIFT | insertion_index);
    }

    /// Counts a sphere whose centre has passed a wall.
    pub(crate) fn count_passage(&mut self, insertion_index: u32) {
        self.passages += 1;
        self.passing = self.passing.max(!insertion_index);
    }

    /// Adds the tally to the counters of the current step.
    pub(crate) fn add_to(self, status: &mut Status) {
        let counters = Counters {
            contacts: self.contacts,
            max_overlap: self.max_overlap.to_bits(),
            collisions: self.collisions,
            fast: self.fast.into(),
            passages: self.passages,
            passing: self.passing,
            ..Counters::default()
        };
        status.counters[0] = status.counters[0].and(counters);
        status.collides |= u32::from(self.collisions > 0);
        status.bad_count += self.bad_count;
        status.bad_body = status.bad_body.min(self.bad_body);
        if self.rebuild {
            status.rebuild |= REBUILD_REQUESTED;
        }
        if self.escaped != 0 {
            status.rejected |= self.escaped;
            // New lists, with which the step can be repeated.
            status.rebuild |= REBUILD_REQUESTED;
            status.escape_ratio = status.escape_ratio.max(self.escape_ratio.to_bits());
        }
    }
}

/// Counts the rebuild of the lists, if there was one in this step. A request for a rebuild that was not made stays pending.
pub(crate) fn count_builds(status: &mut Status) {
    if status.rebuild & REBUILD_DONE != 0 {
        status.rebuild &= !REBUILD_DONE;
        status.builds += 1;
    }
}
