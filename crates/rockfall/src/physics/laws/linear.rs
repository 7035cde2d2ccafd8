//! The law `linear`: springs of constant stiffness (docs/physics section 4.11).

use super::{Constants, Stiffness};
use crate::scene::TANGENTIAL_RATIO;

/// The stiffness that is given for the pair; or, where the normal constant is negative, that which follows from E*, the opposite
/// of this constant, and the characteristic velocity, which is the tangential constant.
pub(super) fn stiffness(constants: &Constants, effective_radius: f32, reduced_mass: f32) -> Stiffness {
    let [normal, tangential] = if constants.normal >= 0.0 {
        [constants.normal, constants.tangential]
    } else {
        let elastic = 16.0 / 15.0 * effective_radius.sqrt() * -constants.normal;
        let normal = elastic * libm::powf(reduced_mass * constants.tangential.powi(2) / elastic, 0.2);
        [normal, TANGENTIAL_RATIO * normal]
    };
    Stiffness { normal, tangential, share: 1.0, energy_share: 0.5, unloading: 1.0 }
}
