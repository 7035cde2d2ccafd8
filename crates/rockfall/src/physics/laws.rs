//! Contact laws with a history (docs/physics section 4.11).
//!
//! A law consists of a line in the table below and two files in `laws/`: `NAME.rs` with `fn stiffness`, and `NAME.wgsl` with
//! `fn NAME_stiffness`. Everything else is common to all laws: damping, the tangential spring, Coulomb's limit ([`contact`]),
//! resistance to rolling and twisting ([`resistance`]), cohesion ([`jkr`], [`neck`]), and where the history is kept
//! ([`history`]). The law that a program defines ([`user`]) gives its damping itself. The thesis's law, which has no history,
//! is in `physics/contact.*`.

pub(crate) mod before;
pub(crate) mod contact;
mod hertz_mindlin;
pub(crate) mod history;
mod jkr;
mod linear;
pub(crate) mod neck;
mod resistance;
pub(crate) mod shared;
pub(crate) mod user;

use crate::model::view::View;
use crate::physics::laws::contact::Bodies;
use crate::settings::ContactLaw;

/// Constants of a pair of materials for a law with history, from the table of pairs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constants {
    /// `linear`: k_n in mass/s², or -E* if it follows from E*. `hertz-mindlin` and `user`: E* in mass/(units s²).
    pub(crate) normal: f32,
    /// `linear`: k_t in mass/s², or the characteristic velocity in units/s. `hertz-mindlin` and `user`: G* in mass/(units s²).
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
    /// DMT: pull-off force per R*, in mass/s². JKR: -(pi gamma / (4 E*))^(1/3), in units^(1/3).
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stiffness {
    /// Derivative of the elastic normal force by the overlap, in mass/s².
    pub(crate) normal: f32,
    /// Tangential force per tangential displacement, in mass/s².
    pub(crate) tangential: f32,
    /// Elastic normal force, as a fraction of `normal` times the overlap.
    pub(crate) share: f32,
    /// Energy of the normal spring, as a fraction of `normal` times the square of the overlap.
    pub(crate) energy_share: f32,
    /// While the contact unloads: the tangential stiffness per that in the last step. The tangential displacement shrinks with it.
    /// Otherwise 1.
    pub(crate) unloading: f32,
}

/// What a law gives for a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Answer {
    pub(crate) stiffness: Stiffness,
    /// Normal force N without cohesion, at least 0.
    pub(crate) press: f32,
    /// Tangential force per tangential velocity, in mass/s.
    pub(crate) dashpot: f32,
}

/// The law of the scene for the contact of two objects, at its overlap and speed of approach. With JKR cohesion, the overlap is
/// that of a contact without attraction and with the same contact radius. `before` is the overlap in the last
/// step, or `None` for a new contact.
pub(crate) fn answer(
    view: &View,
    ids: [u32; 2],
    constants: &Constants,
    bodies: &Bodies,
    [overlap, approach]: [f32; 2],
    before: Option<f32>,
) -> Answer {
    let law = ContactLaw::from_number(view.step.layout.law);
    if law == ContactLaw::User {
        return user::answer(view, ids, constants, bodies, [overlap, approach], before);
    }
    let stiffness = stiffness(law, constants, bodies, overlap, before);
    let dashpot = |stiffness: f32| constants.damping * (stiffness * bodies.mass).sqrt();
    let press = (stiffness.share * stiffness.normal * overlap + dashpot(stiffness.normal) * approach).max(0.0);
    Answer { press, dashpot: dashpot(stiffness.tangential), stiffness }
}

/// Elastic energy of the normal force of the contact of two objects at an overlap.
pub(crate) fn energy(view: &View, ids: [u32; 2], constants: &Constants, bodies: &Bodies, overlap: f32) -> f64 {
    let law = ContactLaw::from_number(view.step.layout.law);
    if law == ContactLaw::User {
        return user::energy(view, ids, constants, bodies, overlap);
    }
    let stiffness = stiffness(law, constants, bodies, overlap, None);
    f64::from(stiffness.energy_share) * f64::from(stiffness.normal) * f64::from(overlap).powi(2)
}

/// The stiffness of a contact, from the constants of the pair, R*, m* and the overlap.
fn stiffness(law: ContactLaw, constants: &Constants, bodies: &Bodies, overlap: f32, before: Option<f32>) -> Stiffness {
    match law {
        ContactLaw::HertzMindlin => hertz_mindlin::stiffness(constants, bodies.radius, overlap, before),
        // The other laws do not use this function.
        _ => linear::stiffness(constants, bodies.radius, bodies.mass),
    }
}
