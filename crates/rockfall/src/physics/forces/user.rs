//! Forces of the laws that the program gave (docs/physics section 4.14).

use crate::model::view::View;
use crate::physics::forces::rates::Rates;
use crate::user_laws::ForceLoad;

pub(super) fn add(view: &View, sphere: u32, rates: &mut Rates) {
    if let Some(laws) = view.force_laws() {
        let ForceLoad { force, torque } = laws.load(&view.force_input(sphere));
        rates.acceleration += view.inverse_mass(sphere) * force;
        rates.torque += torque;
    }
}
