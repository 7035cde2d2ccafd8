//! AABBs of all objects.

pub(crate) mod update_aabbs;
