//! Which pairs are in contact: with JKR cohesion, also some that are apart (docs/physics section 4.13).

use crate::laws::Constants;
use crate::model::view::View;
use crate::physics::chain::touch;
use crate::physics::laws::history::Histories;
use crate::physics::laws::jkr;
use crate::physics::side::side;
use crate::physics::touch::{Touch, touch_apart};

/// The contact of two objects that overlap, or that a neck connects although they are apart (docs/physics section 4.13): the
/// contact has a spring, and its distance is less than that at which it tears. The order of the objects is that of [`touch`].
pub(crate) fn contact(view: &View, histories: &Histories, a: u32, b: u32, feature: u32) -> Option<Touch> {
    touch(view, a, b, feature).or_else(|| neck(view, histories, a, b, feature))
}

fn neck(view: &View, histories: &Histories, a: u32, b: u32, feature: u32) -> Option<Touch> {
    if view.step.layout.neck == 0.0 {
        return None;
    }
    let constants = Constants::of(view, a, b);
    let radius = |id| side(view, view.object(id), 0.0).radius.map_or(0.0, f32::recip);
    let reach = jkr::tearing_distance(&constants, 1.0 / (radius(a) + radius(b)))?;
    let touch = touch_apart(view, a, b, feature).filter(|touch| touch.overlap > -reach)?;
    histories.spring(view, a, b, feature).map(|_| touch)
}
