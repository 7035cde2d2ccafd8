//! The time within which the contact laws with history react, which bounds the time step (docs/physics.md section 4.11).

use std::f64::consts::PI;
use std::fmt;

use crate::scene::Scene;
use crate::settings::ContactLaw;

/// The shortest time of the contacts of a scene, and the sphere that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawTime {
    /// The contact law.
    pub law: ContactLaw,
    /// `hertz-mindlin`: Rayleigh time of the sphere, in s. `linear`: shortest time of an elastic impact of the sphere with one of
    /// equal mass, in s.
    pub seconds: f64,
    /// Index of the sphere, in order of addition.
    pub sphere: usize,
}

impl LawTime {
    /// The longest time step: 20 % of the Rayleigh time, or a 20th of an impact.
    pub fn largest_dt(&self) -> f64 {
        self.seconds / if self.law == ContactLaw::HertzMindlin { 5.0 } else { 20.0 }
    }

    /// Returns whether a time step of `dt` seconds is too long.
    pub fn is_exceeded_by(&self, dt: f32) -> bool {
        f64::from(dt) > self.largest_dt() * (1.0 + 1e-6)
    }

    /// Describes the time and a time step of `dt` seconds.
    pub fn describe(&self, dt: f32) -> String {
        let percent = 100.0 * f64::from(dt) / self.seconds;
        format!("{self}; the time step is {percent:.3} % of it, at most {:.3e} s is advised", self.largest_dt())
    }
}

impl fmt::Display for LawTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { law, seconds, sphere } = self;
        let what = if *law == ContactLaw::HertzMindlin { "Rayleigh time" } else { "time of an impact" };
        write!(f, "contact law {law}: the shortest {what} is {seconds:.3e} s, that of sphere {sphere}")
    }
}

impl Scene {
    /// The time that bounds the time step of a contact law with history; `None` for the law of the thesis, and where no moving
    /// sphere has the constants of the law.
    pub fn law_time(&self) -> Option<LawTime> {
        let law = self.settings.contact_law;
        let moving = self.spheres().iter().enumerate().filter(|(_, sphere)| !sphere.fixed);
        let times = moving.filter_map(|(index, sphere)| {
            let id = sphere.material?;
            let mass = f64::from(sphere.mass);
            let seconds = match law {
                ContactLaw::Thesis => return None,
                ContactLaw::Linear => {
                    let of = |other| self.pair(Some(id), Some(other)).ok().and_then(|pair| pair.stiffness).map(f64::from);
                    let stiffest = self.material_ids().filter_map(of).fold(0.0, f64::max);
                    (stiffest > 0.0).then(|| PI * (0.5 * mass / stiffest).sqrt())?
                }
                ContactLaw::HertzMindlin => {
                    let material = self.material(id).ok()?;
                    let (young, poisson) = (f64::from(material.young?), f64::from(material.poisson?));
                    let radius = f64::from(sphere.radius);
                    let density = mass / (4.0 / 3.0 * PI * radius.powi(3));
                    let shear = young / (2.0 * (1.0 + poisson));
                    PI * radius * (density / shear).sqrt() / (0.1631 * poisson + 0.8766)
                }
            };
            Some(LawTime { law, seconds, sphere: index })
        });
        times.min_by(|one, other| one.seconds.total_cmp(&other.seconds))
    }
}
