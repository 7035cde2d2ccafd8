//! The sort-and-skip broad phase: objects are sorted along x in blocks, and blocks that cannot meet are skipped. The thesis
//! proposes it as a faster tiled test (thesis section 2.5.1).

pub(crate) mod bound_blocks;
pub(crate) mod count_near;
pub(crate) mod fill_near;
pub(crate) mod sort_axis;
