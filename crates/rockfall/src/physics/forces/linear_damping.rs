//! Linear damping: v' = -C v (docs/physics section 4.8).

use crate::model::view::View;
use crate::physics::forces::rates::Rates;

pub(super) fn add(view: &View, sphere: u32, rates: &mut Rates) {
    if view.step.constants.linear_damping > 0.0 {
        rates.acceleration -= view.step.constants.linear_damping * view.velocity(sphere);
    }
}
