//! The law that the program defines (docs/physics section 4.15).

use super::{Answer, Ball, Contact, Given, GrainLaw, Needs, Reduced, Stiffness};
use crate::user_laws::{ContactForceLaw, ContactInput};

/// Distance over which the normal stiffness is found, per overlap.
const REACH: f32 = 0.01;

pub(super) struct User;

impl GrainLaw for User {
    fn needs(&self) -> Needs {
        Needs::Nothing
    }

    /// E* and G*.
    fn constants(&self, given: &Given) -> Option<[f32; 2]> {
        Some(given.moduli.unwrap_or_default())
    }

    fn unit_impact(&self) -> Option<fn(f64) -> (f64, f64)> {
        None
    }

    fn has_necks(&self) -> bool {
        false
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn overlap_under(&self, _: &Given, _: Reduced, _: f64) -> Option<(f64, f64)> {
        None
    }

    fn depth_at(&self, _: &Given, _: Reduced, _: f64) -> Option<(f64, f64)> {
        None
    }

    fn reaction_time(&self, _: &Ball) -> Option<f64> {
        None
    }

    fn reacts_by_waves(&self) -> bool {
        false
    }

    fn impact_time(&self, _: &Ball, _: f64) -> Option<f64> {
        None
    }

    #[inline]
    fn answer(&self, contact: &Contact) -> Answer {
        let Contact { overlap, before, .. } = *contact;
        contact.with_law(|law, input| {
            let found = law.evaluate(input);
            let tangential = at_least_zero(found.tangential_stiffness);
            let unloading = before.filter(|before| overlap < *before).map_or(1.0, |before| {
                let old = law.evaluate(&ContactInput { overlap: before, ..*input }).tangential_stiffness;
                if old > tangential { tangential / old } else { 1.0 }
            });
            let normal = if contact.resists {
                let elastic =
                    |overlap| at_least_zero(law.evaluate(&ContactInput { overlap, speed: 0.0, ..*input }).normal_force);
                let reach = REACH * overlap;
                at_least_zero((elastic(overlap + reach) - elastic(overlap - reach)) / (2.0 * reach))
            } else {
                0.0
            };
            Answer {
                stiffness: Stiffness { normal, tangential, share: 0.0, energy_share: 0.0, unloading },
                press: at_least_zero(found.normal_force),
                dashpot: at_least_zero(found.tangential_damping),
            }
        })
    }

    /// The program gives a force alone. Its slopes are found from differences.
    #[inline]
    fn slopes(&self, contact: &Contact, dt: f32) -> [f32; 2] {
        let Contact { overlap, approach, .. } = *contact;
        let press = |overlap: f32, approach: f32| self.answer(&Contact { overlap, approach, ..*contact }).press;
        let (reach, speed) = (0.01 * overlap, 0.01 * overlap / dt);
        let by_overlap = press(overlap + reach, approach) - press(overlap - reach, approach);
        let by_speed = press(overlap, approach + speed) - press(overlap, approach - speed);
        [by_overlap / (2.0 * reach), by_speed / (2.0 * speed)].map(|slope| slope.max(0.0))
    }

    #[inline]
    fn energy(&self, contact: &Contact) -> f64 {
        Contact { approach: 0.0, ..*contact }.with_law(ContactForceLaw::energy)
    }

    #[inline]
    fn relative_force(&self, _: f32) -> f32 {
        0.0
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

impl Contact<'_> {
    /// Applies something to the law of the program and what it knows of the contact.
    pub(crate) fn with_law<T: Default>(&self, apply: impl FnOnce(&ContactForceLaw, &ContactInput<'_>) -> T) -> T {
        // A simulation with the setting `user` has a law.
        let Some((law, values)) = self.program else { return T::default() };
        let mut input = ContactInput::default();
        (input.overlap, input.speed) = (self.overlap, self.approach);
        (input.radius, input.mass) = (self.bodies.radius, self.bodies.mass);
        (input.young, input.shear) = (self.constants.normal, self.constants.tangential);
        input.parameters = &values[..law.parameters().len()];
        apply(law, &input)
    }
}

/// The larger of a number and 0, and NaN as it is.
fn at_least_zero(number: f32) -> f32 {
    if number < 0.0 { 0.0 } else { number }
}
