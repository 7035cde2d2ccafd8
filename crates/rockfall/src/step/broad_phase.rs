//! The broad phase, which finds the pairs of objects that may touch.

pub(crate) mod brute_force;
pub(crate) mod grid;
pub(crate) mod meet;
pub(crate) mod scan_pairs;
pub(crate) mod sort_and_skip;
