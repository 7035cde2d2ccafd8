//! What contact laws with a history have in common (docs/physics section 4.11).
//!
//! The table of the laws and their files are in `crate::laws`. A law gives the stiffness, normal force and damping of a
//! contact. Everything else is here: the tangential spring and Coulomb's limit ([`contact`]), resistance to rolling and
//! twisting ([`resistance`]), cohesion ([`jkr`], [`neck`]), and where the history is kept ([`history`]). The thesis's law,
//! which has no history, is in `physics/contact.*`.

pub(crate) mod before;
pub(crate) mod contact;
pub(crate) mod history;
mod jkr;
pub(crate) mod neck;
mod resistance;
pub(crate) mod shared;

use crate::laws::Constants;
use crate::model::view::View;

impl Constants {
    /// The constants of two objects.
    pub(crate) fn of(view: &View, a: u32, b: u32) -> Self {
        let [_, _, _, _, normal, tangential, damping, friction, rolling, rolling_damping, twisting, cohesion] =
            view.pair(a, b).unwrap_or_default();
        Self { normal, tangential, damping, friction, rolling, rolling_damping, twisting, cohesion }
    }
}
