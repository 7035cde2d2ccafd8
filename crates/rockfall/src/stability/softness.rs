//! Estimates how deep bodies at rest overlap with the contact laws that keep springs.

use std::fmt;

use crate::laws::Reduced;
use crate::scene::{Scene, Sphere};
use crate::settings::ContactLaw;
use crate::stability::depth::{DEEP, SAFETY};
use crate::stability::{Crowd, nearest, rounded_up};

/// A warning that gravity presses resting bodies too deeply into each other, because their material is too soft for the load.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoftMaterial {
    /// The contact law.
    pub law: ContactLaw,
    /// Estimate of the deepest overlap at rest, in units.
    pub overlap: f64,
    /// Radius of the body that overlaps most, in units.
    pub radius: f64,
    /// The mass that this body carries, divided by its own mass; 1 for a body alone.
    pub load: f64,
    /// Number by which Young's modulus (`linear` with a given stiffness: the stiffness) must be multiplied at least, so that the
    /// overlap is at most 5 % of the radius.
    pub factor: f64,
}

impl fmt::Display for SoftMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { law, overlap, radius, load, factor } = *self;
        let [percent, overlap, radius] = [100.0 * overlap / radius, overlap, radius].map(nearest);
        write!(f, "contact law {law}: ")?;
        if load > 1.0 {
            let load = nearest(load);
            write!(f, "bodies below others carry about {load} times their weight and overlap by up to {overlap} units, ")?;
        } else {
            write!(f, "bodies at rest overlap by about {overlap} units, ")?;
        }
        write!(f, "{percent} % of their radius {radius}: make the material {} times as stiff", nearest(rounded_up(factor)))
    }
}

impl Scene {
    /// Returns a warning if bodies at rest overlap by more than 5 % of their radius with a contact law that keeps springs; `None`
    /// for the law of the thesis, for which [`Scene::sinking`] warns.
    ///
    /// The overlap is that of two equal spheres of the same material that are pressed by the force F = 3 l m g. The load l is
    /// estimated as in [`Scene::resolved_settings`], and 3 because contacts do not carry equal shares. A body alone has l = 1,
    /// without the 3.
    pub fn soft_material(&self) -> Option<SoftMaterial> {
        let law = self.contact_law();
        let crowd = self.crowd();
        if !law.has_history() || crowd == Crowd::None || self.settings.gravity == 0.0 {
            return None;
        }
        let sets = self.sets_at_rest();
        let loose: Vec<&Sphere> =
            self.spheres().iter().enumerate().filter(|(index, _)| !sets.is_held(*index)).map(|(_, sphere)| sphere).collect();
        let carried = self.pile_load(&loose, true);
        let found = loose.iter().filter_map(|sphere| {
            let [mass, radius] = [sphere.mass, sphere.radius].map(f64::from);
            let load = carried.as_ref().map_or(1.0, |carried| carried(mass, radius) / mass);
            let share = if carried.is_some() { SAFETY } else { 1.0 };
            let force = share * load * mass * f64::from(self.settings.gravity.abs());
            let (overlap, power) = self.overlap_under(sphere, force)?;
            let factor = (overlap / (DEEP * radius)).powf(power);
            Some(SoftMaterial { law, overlap, radius, load, factor })
        });
        let worst = found.max_by(|one, other| (one.overlap / one.radius).total_cmp(&(other.overlap / other.radius)))?;
        (worst.overlap > DEEP * (1.0 + 1e-6) * worst.radius).then_some(worst)
    }

    /// Overlap of two spheres like this one that are pressed together by a force, and the power of the overlap to which the force
    /// is proportional.
    pub(super) fn overlap_under(&self, sphere: &Sphere, force: f64) -> Option<(f64, f64)> {
        let number = self.material_number(Some(sphere.material?)).ok()?;
        let [mass, radius] = [sphere.mass, sphere.radius].map(f64::from);
        let bodies = Reduced { radius: 0.5 * radius, mass: 0.5 * mass };
        self.contact_law().grain()?.overlap_under(&self.given(number, number), bodies, force)
    }
}
