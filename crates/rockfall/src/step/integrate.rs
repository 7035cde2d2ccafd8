//! Integration of the state, and constraints (docs/physics.md section 5).

pub(crate) mod advance;
pub(crate) mod check_drift;
pub(crate) mod commit_and_turn;
pub(crate) mod commit_symplectic_euler;
pub(crate) mod constrain;
pub(crate) mod drift;
pub(crate) mod end_step;
pub(crate) mod finish;
pub(crate) mod finish_and_turn;
pub(crate) mod kick;
pub(crate) mod kick_and_turn;
pub(crate) mod restore_lengths;
pub(crate) mod starting_forces;
pub(crate) mod symplectic_euler;
pub(crate) mod turn;
