//! Moving walls.

pub(crate) mod move_walls;
