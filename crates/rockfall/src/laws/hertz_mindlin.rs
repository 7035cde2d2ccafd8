//! The law `hertz-mindlin`: the stiffness of elastic bodies with curved surfaces (docs/physics section 4.11).

use std::f64::consts::PI;

use super::{Answer, Ball, Contact, Given, GrainLaw, Needs, Reduced, Stiffness};

pub(super) struct HertzMindlin;

impl GrainLaw for HertzMindlin {
    fn needs(&self) -> Needs {
        Needs::OfMaterials("a material with young and poisson")
    }

    /// E* and G*.
    fn constants(&self, given: &Given) -> Option<[f32; 2]> {
        given.moduli
    }

    fn unit_impact(&self) -> Option<fn(f64) -> (f64, f64)> {
        Some(|overlap| (2.0 / 3.0 * overlap * overlap.max(0.0).sqrt(), overlap.max(0.0).sqrt()))
    }

    fn has_necks(&self) -> bool {
        true
    }

    fn has_potential(&self) -> bool {
        true
    }

    /// 4/3 E* sqrt(R*) overlap^1.5 = F.
    fn overlap_under(&self, given: &Given, bodies: Reduced, force: f64) -> Option<(f64, f64)> {
        let stiffness = 4.0 / 3.0 * given.young()? * bodies.radius.sqrt();
        Some((libm::pow(force / stiffness, 2.0 / 3.0), 1.5))
    }

    /// (15 m u² / (16 E* sqrt(R*)))^(2/5).
    fn depth_at(&self, given: &Given, bodies: Reduced, speed: f64) -> Option<(f64, f64)> {
        let stiffness = 16.0 * given.young()? * bodies.radius.sqrt();
        Some((libm::pow(15.0 * bodies.mass * speed * speed / stiffness, 0.4), 2.5))
    }

    /// The Rayleigh time.
    fn reaction_time(&self, ball: &Ball) -> Option<f64> {
        let [young, poisson] = ball.elastic?;
        let density = ball.mass / (4.0 / 3.0 * PI * ball.radius.powi(3));
        let shear = young / (2.0 * (1.0 + poisson));
        Some(PI * ball.radius * (density / shear).sqrt() / (0.1631 * poisson + 0.8766))
    }

    fn reacts_by_waves(&self) -> bool {
        true
    }

    /// 2.87 (m*² / (R* E*² u))^(1/5) with the stiffest partner.
    fn impact_time(&self, ball: &Ball, speed: f64) -> Option<f64> {
        let stiffest = ball.partners.iter().filter_map(Given::young).fold(0.0, f64::max);
        let Reduced { radius, mass } = ball.reduced();
        (stiffest > 0.0).then(|| 2.87 * libm::pow(mass * mass / (radius * stiffest.powi(2) * speed), 0.2))
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
        overlap * overlap.max(0.0).sqrt()
    }

    #[inline]
    fn stiffness_by_force(&self, ratio: f32) -> f32 {
        libm::cbrtf(ratio)
    }

    #[inline]
    fn stiffness_by_overlap(&self, ratio: f32) -> f32 {
        ratio.sqrt()
    }
}

/// S_n = 2 E* sqrt(R* d), S_t = 8 G* sqrt(R* d). The elastic force 4/3 E* sqrt(R*) d^(3/2) is 2/3 S_n d.
#[inline]
fn stiffness(contact: &Contact) -> Stiffness {
    let Contact { constants, bodies, overlap, before, .. } = *contact;
    let contact_radius = (bodies.radius * overlap).sqrt();
    Stiffness {
        normal: 2.0 * constants.normal * contact_radius,
        tangential: 8.0 * constants.tangential * contact_radius,
        share: 2.0 / 3.0,
        energy_share: 4.0 / 15.0,
        unloading: before.filter(|before| overlap < *before).map_or(1.0, |before| (overlap / before).sqrt()),
    }
}
