//! The thesis's proposal for a faster tiled test: blocks of objects sorted along x are skipped (thesis section 2.5.1).

pub(crate) mod bound_blocks;
pub(crate) mod count_near;
pub(crate) mod fill_near;
pub(crate) mod sort_axis;
