//! The collision phase (docs/physics section 3).

pub(crate) mod apply_collisions;
pub(crate) mod apply_friction_impulses;
pub(crate) mod commit_collisions;
pub(crate) mod commit_friction_impulses;
pub(crate) mod find_collisions;
pub(crate) mod find_crossings;
pub(crate) mod gather_impulses;
pub(crate) mod project_networks;
pub(crate) mod sweep_at_once;
pub(crate) mod sweep_collisions;
pub(crate) mod synchronise;
pub(crate) mod weigh_collisions;
pub(crate) mod weigh_networks;
