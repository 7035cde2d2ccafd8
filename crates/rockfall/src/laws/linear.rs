//! The law `linear`: springs of constant stiffness (docs/physics section 4.11).

use std::f64::consts::PI;

use super::{Answer, Ball, Contact, Given, GrainLaw, Needs, Reduced, Stiffness};

/// Ratio of the tangential to the normal stiffness.
const TANGENTIAL_RATIO: f32 = 2.0 / 7.0;

pub(super) struct Linear;

impl GrainLaw for Linear {
    fn needs(&self) -> Needs {
        Needs::OfPairs(
            "a pair with stiffness, or its materials with a stiffness with themselves; or characteristic_velocity, and \
             materials with young and poisson",
        )
    }

    /// k_n and k_t; or -E* and the characteristic velocity, from which they follow.
    fn constants(&self, given: &Given) -> Option<[f32; 2]> {
        match given.stiffness {
            Some(stiffness) => Some([stiffness, TANGENTIAL_RATIO * stiffness]),
            None => given.characteristic_velocity.zip(given.moduli).map(|(speed, [young, _])| [-young, speed]),
        }
    }

    fn unit_impact(&self) -> Option<fn(f64) -> (f64, f64)> {
        Some(|overlap| (overlap, 1.0))
    }

    fn has_necks(&self) -> bool {
        false
    }

    fn has_potential(&self) -> bool {
        true
    }

    fn overlap_under(&self, given: &Given, bodies: Reduced, force: f64) -> Option<(f64, f64)> {
        Some((force / estimate(given, bodies)?, 1.0))
    }

    /// u sqrt(m / k).
    fn depth_at(&self, given: &Given, bodies: Reduced, speed: f64) -> Option<(f64, f64)> {
        let stiffness = estimate(given, bodies)?;
        Some((speed * (bodies.mass / stiffness).sqrt(), if given.stiffness.is_some() { 2.0 } else { 2.5 }))
    }

    /// pi sqrt(m* / k_n) with the stiffest partner.
    fn reaction_time(&self, ball: &Ball) -> Option<f64> {
        let stiffest = ball.partners.iter().filter_map(|given| estimate(given, ball.reduced())).fold(0.0, f64::max);
        (stiffest > 0.0).then(|| PI * (0.5 * ball.mass / stiffest).sqrt())
    }

    fn reacts_by_waves(&self) -> bool {
        false
    }

    fn impact_time(&self, _: &Ball, _: f64) -> Option<f64> {
        None
    }

    #[inline]
    fn answer(&self, contact: &Contact) -> Answer {
        stiffness(contact).answer(contact)
    }

    #[inline]
    fn slopes(&self, contact: &Contact, _: f32) -> [f32; 2] {
        stiffness(contact).slopes(contact)
    }

    #[inline]
    fn energy(&self, contact: &Contact) -> f64 {
        stiffness(contact).energy(contact)
    }

    #[inline]
    fn relative_force(&self, overlap: f32) -> f32 {
        overlap.max(0.0)
    }

    #[inline]
    fn stiffness_by_force(&self, _: f32) -> f32 {
        1.0
    }

    #[inline]
    fn stiffness_by_overlap(&self, _: f32) -> f32 {
        1.0
    }
}

/// The normal stiffness of two bodies.
fn estimate(given: &Given, bodies: Reduced) -> Option<f64> {
    if let Some(stiffness) = given.stiffness {
        return Some(stiffness.into());
    }
    let (speed, young) = given.characteristic_velocity.zip(given.young())?;
    let elastic = 16.0 / 15.0 * bodies.radius.sqrt() * young;
    Some(elastic * libm::pow(bodies.mass * f64::from(speed).powi(2) / elastic, 0.2))
}

/// The stiffness that is given for the pair; or, where the normal constant is negative, that which follows from E*, the
/// opposite of this constant, and the characteristic velocity, which is the tangential constant.
#[inline]
fn stiffness(contact: &Contact) -> Stiffness {
    let (constants, bodies) = (contact.constants, contact.bodies);
    let [normal, tangential] = if constants.normal >= 0.0 {
        [constants.normal, constants.tangential]
    } else {
        let elastic = 16.0 / 15.0 * bodies.radius.sqrt() * -constants.normal;
        let normal = elastic * libm::powf(bodies.mass * constants.tangential.powi(2) / elastic, 0.2);
        [normal, TANGENTIAL_RATIO * normal]
    };
    Stiffness { normal, tangential, share: 1.0, energy_share: 0.5, unloading: 1.0 }
}
