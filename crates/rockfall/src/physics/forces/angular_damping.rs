//! Angular damping: L' = -C L (docs/physics section 4.8).

use crate::model::view::View;
use crate::physics::forces::rates::Rates;

pub(super) fn add(view: &View, sphere: u32, rates: &mut Rates) {
    if view.step.constants.angular_damping > 0.0 {
        rates.torque -= view.step.constants.angular_damping * view.angular_momentum(sphere);
    }
}
