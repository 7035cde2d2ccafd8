//! The law `hertz-mindlin`: the stiffness of elastic bodies with curved surfaces (docs/physics section 4.11).

use super::{Constants, Stiffness};

/// S_n = 2 E* sqrt(R* d), S_t = 8 G* sqrt(R* d). The elastic force 4/3 E* sqrt(R*) d^(3/2) is 2/3 S_n d.
pub(super) fn stiffness(constants: &Constants, effective_radius: f32, overlap: f32, before: Option<f32>) -> Stiffness {
    let contact_radius = (effective_radius * overlap).sqrt();
    Stiffness {
        normal: 2.0 * constants.normal * contact_radius,
        tangential: 8.0 * constants.tangential * contact_radius,
        share: 2.0 / 3.0,
        energy_share: 4.0 / 15.0,
        unloading: before.filter(|before| overlap < *before).map_or(1.0, |before| (overlap / before).sqrt()),
    }
}
