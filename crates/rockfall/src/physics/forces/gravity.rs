//! Gravity (docs/physics section 4.1).

use glam::Vec3;

use crate::model::view::View;
use crate::physics::forces::rates::Rates;

pub(super) fn add(view: &View, _sphere: u32, rates: &mut Rates) {
    rates.acceleration += Vec3::from_array(view.step.constants.gravity);
}
