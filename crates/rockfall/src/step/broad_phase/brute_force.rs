//! The brute-force broad phase, which tests every pair (thesis section 2.5.1).

pub(crate) mod count_pairs;
pub(crate) mod fill_pairs;
