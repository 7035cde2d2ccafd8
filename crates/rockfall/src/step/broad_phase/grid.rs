//! The grid broad phase, whose cells have several levels of size.

pub(crate) mod cells;
pub(crate) mod clear_cells;
pub(crate) mod count_cells;
pub(crate) mod count_long;
pub(crate) mod fill_long;
pub(crate) mod find_neighbours;
pub(crate) mod scan_cells;
pub(crate) mod sort_cells;
