//! Integration of the state, and constraints (docs/physics section 5).

pub(crate) mod advance;
pub(crate) mod constrain;
pub(crate) mod drift;
pub(crate) mod end_step;
pub(crate) mod find_passages;
pub(crate) mod finish;
pub(crate) mod kick;
pub(crate) mod symplectic_euler;
pub(crate) mod turn;
