//! The spatial order of spheres in memory.

pub(crate) mod count_digits;
pub(crate) mod key_spheres;
pub(crate) mod measure_order;
pub(crate) mod permute_spheres;
pub(crate) mod scatter_digits;
pub(crate) mod settle_spheres;
