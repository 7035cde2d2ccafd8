//! Every pair is tested (thesis section 2.5.1).

pub(crate) mod count_pairs;
pub(crate) mod fill_pairs;
