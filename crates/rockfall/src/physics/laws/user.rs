//! The law that the program defines (docs/physics section 4.15).

use super::{Answer, Constants, Stiffness};
use crate::error::Error;
use crate::model::layout::{FLAG_RESISTANCE, USER_REACH};
use crate::model::view::View;
use crate::physics::laws::contact::{Bodies, of_touch};
use crate::physics::touch::Touch;
use crate::user_laws::{ContactForceLaw, ContactInput};

/// The response of the contact of two objects. `before` is the overlap in the last step, or `None` for a new contact.
pub(super) fn answer(
    view: &View,
    ids: [u32; 2],
    constants: &Constants,
    bodies: &Bodies,
    [overlap, approach]: [f32; 2],
    before: Option<f32>,
) -> Answer {
    with_law(view, ids, constants, bodies, [overlap, approach], |law, contact| {
        let found = law.evaluate(contact);
        let tangential = at_least_zero(found.tangential_stiffness);
        let unloading = before.filter(|before| overlap < *before).map_or(1.0, |before| {
            let old = law.evaluate(&ContactInput { overlap: before, ..*contact }).tangential_stiffness;
            if old > tangential { tangential / old } else { 1.0 }
        });
        let normal = if view.step.constants.flags & FLAG_RESISTANCE == 0 {
            0.0
        } else {
            let elastic = |overlap| at_least_zero(law.evaluate(&ContactInput { overlap, speed: 0.0, ..*contact }).normal_force);
            let reach = USER_REACH * overlap;
            at_least_zero((elastic(overlap + reach) - elastic(overlap - reach)) / (2.0 * reach))
        };
        Answer {
            stiffness: Stiffness { normal, tangential, share: 0.0, energy_share: 0.0, unloading },
            press: at_least_zero(found.normal_force),
            dashpot: at_least_zero(found.tangential_damping),
        }
    })
}

/// Elastic energy of the contact of two objects.
pub(super) fn energy(view: &View, ids: [u32; 2], constants: &Constants, bodies: &Bodies, overlap: f32) -> f64 {
    with_law(view, ids, constants, bodies, [overlap, 0.0], ContactForceLaw::energy)
}

/// The error of a contact of two objects whose response is not finite.
pub(crate) fn not_finite(view: &View, ids: [u32; 2], touch: &Touch, what: &str) -> Option<Error> {
    let (constants, bodies, approach) = of_touch(view, ids, touch);
    with_law(view, ids, &constants, &bodies, [touch.overlap, approach], |law, contact| law.not_finite(contact, what))
}

fn with_law<T: Default>(
    view: &View,
    [a, b]: [u32; 2],
    constants: &Constants,
    bodies: &Bodies,
    [overlap, speed]: [f32; 2],
    apply: impl FnOnce(&ContactForceLaw, &ContactInput<'_>) -> T,
) -> T {
    // A simulation with the setting `user` has a law.
    let Some((law, values)) = view.contact_law(a, b) else { return T::default() };
    let mut contact = ContactInput::default();
    (contact.overlap, contact.speed) = (overlap, speed);
    (contact.radius, contact.mass) = (bodies.radius, bodies.mass);
    (contact.young, contact.shear) = (constants.normal, constants.tangential);
    contact.parameters = &values[..law.parameters().len()];
    apply(law, &contact)
}

/// The larger of a number and 0, and NaN as it is.
fn at_least_zero(number: f32) -> f32 {
    if number < 0.0 { 0.0 } else { number }
}
