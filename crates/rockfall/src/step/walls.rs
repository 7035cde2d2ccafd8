//! Moving walls.

pub(crate) mod drive_servos;
pub(crate) mod move_walls;
pub(crate) mod servo_loads;
