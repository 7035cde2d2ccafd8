//! Contact laws with a history (docs/physics.md section 4.11).
//!
//! A law consists of a line in the table below and two files in `laws/`: `NAME.rs` with `fn stiffness`, and `NAME.wgsl` with
//! `fn NAME_stiffness`. Everything else is common to all laws: damping, the tangential spring, Coulomb's limit ([`contact`]),
//! resistance to rolling and twisting ([`resistance`]), and where the history is kept ([`history`]). The thesis's law, which
//! has no history, is in `physics/contact.*`.

pub(crate) mod contact;
mod hertz_mindlin;
pub(crate) mod history;
mod linear;
mod resistance;

use crate::model::view::View;
use crate::settings::ContactLaw;

/// Constants of a pair of materials for a law with history, from the table of pairs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constants {
    /// `linear`: k_n in mass/s², or -E* if it follows from E*. `hertz-mindlin`: E* in mass/(units s²).
    pub(crate) normal: f32,
    /// `linear`: k_t in mass/s², or the characteristic velocity in units/s. `hertz-mindlin`: G* in mass/(units s²).
    pub(crate) tangential: f32,
    /// Damping force per velocity and sqrt(stiffness reduced mass).
    pub(crate) damping: f32,
    /// Coefficient of friction.
    pub(crate) friction: f32,
    /// Coefficient of rolling friction.
    pub(crate) rolling: f32,
    /// Ratio of rolling damping; negative for the model of constant torque.
    pub(crate) rolling_damping: f32,
    /// Coefficient of twisting friction.
    pub(crate) twisting: f32,
    /// Pull-off force per R*, in mass/s².
    pub(crate) cohesion: f32,
}

impl Constants {
    /// The constants of two objects.
    pub(crate) fn of(view: &View, a: u32, b: u32) -> Self {
        let [_, _, _, _, normal, tangential, damping, friction, rolling, rolling_damping, twisting, cohesion] =
            view.pair(a, b).unwrap_or_default();
        Self { normal, tangential, damping, friction, rolling, rolling_damping, twisting, cohesion }
    }
}

/// Stiffness of a contact at its present overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stiffness {
    /// Derivative of the elastic normal force by the overlap, in mass/s².
    pub(crate) normal: f32,
    /// Tangential force per tangential displacement, in mass/s².
    pub(crate) tangential: f32,
    /// Elastic normal force, as a fraction of `normal` times the overlap.
    pub(crate) share: f32,
    /// Energy of the normal spring, as a fraction of `normal` times the square of the overlap.
    pub(crate) energy_share: f32,
    /// Whether the tangential displacement shrinks with the square root of the overlap when the contact unloads.
    pub(crate) rescales: bool,
}

/// The stiffness of a contact by the law of its scene, from the constants of the pair, R*, m* and the overlap.
pub(crate) fn stiffness(
    law: ContactLaw,
    constants: &Constants,
    effective_radius: f32,
    reduced_mass: f32,
    overlap: f32,
) -> Stiffness {
    match law {
        ContactLaw::HertzMindlin => hertz_mindlin::stiffness(constants, effective_radius, overlap),
        // The thesis's law does not use this function.
        ContactLaw::Linear | ContactLaw::Thesis => linear::stiffness(constants, effective_radius, reduced_mass),
    }
}
