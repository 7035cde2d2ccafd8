//! The loads of rods and spheres: the only stages that evaluate forces of contacts.

pub(crate) mod loads;
pub(crate) mod rod_loads;
