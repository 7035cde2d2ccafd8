//! The law `linear`: springs of constant stiffness (docs/physics.md section 4.11).

use super::{Constants, Stiffness};

pub(super) fn stiffness(constants: &Constants) -> Stiffness {
    Stiffness { normal: constants.normal, tangential: constants.tangential, share: 1.0, energy_share: 0.5, rescales: false }
}
