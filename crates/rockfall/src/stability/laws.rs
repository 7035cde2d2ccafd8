//! The time within which the contact laws with history react, which bounds the time step (docs/physics section 4.11).

use std::f64::consts::PI;

use crate::scene::{Scene, Sphere};
use crate::settings::ContactLaw;
use crate::stability::{at_most, nearest};

/// The shortest time of the contacts of a scene, and the sphere that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawTime {
    /// The contact law.
    pub law: ContactLaw,
    /// Shortest time of an elastic impact of the sphere with one of equal size and mass, in s; or, for `hertz-mindlin` without a
    /// speed, the Rayleigh time of the sphere.
    pub seconds: f64,
    /// Index of the sphere, in order of addition.
    pub sphere: usize,
    /// `hertz-mindlin`: speed of the impact that takes this time, in units/s. `None` for the Rayleigh time, and for `linear`, with
    /// which the time does not depend on the speed.
    pub speed: Option<f64>,
}

impl LawTime {
    /// The longest time step: 20 % of the Rayleigh time, or a 20th of an impact.
    pub fn largest_dt(&self) -> f64 {
        self.seconds / if self.is_rayleigh() { 5.0 } else { 20.0 }
    }

    fn is_rayleigh(&self) -> bool {
        self.law == ContactLaw::HertzMindlin && self.speed.is_none()
    }

    /// Returns whether a time step of `dt` seconds is too long.
    pub fn is_exceeded_by(&self, dt: f32) -> bool {
        f64::from(dt) > self.largest_dt() * (1.0 + 1e-6)
    }

    /// Describes the time and a time step of `dt` seconds.
    pub fn describe(&self, scene: &Scene, dt: f32) -> String {
        let Self { law, seconds, sphere, speed } = *self;
        let what = match speed {
            Some(speed) => format!("time of an impact at {} units/s", nearest(speed)),
            None if self.is_rayleigh() => "Rayleigh time".to_owned(),
            None => "time of an impact".to_owned(),
        };
        let part = f64::from(dt) / seconds;
        let step = match nearest(if part < 1.0 { 100.0 * part } else { part }) {
            percent if part < 1.0 => format!("{percent} % of it"),
            times => format!("{times} times as long"),
        };
        let has_steps = !self.is_rayleigh() && part < 1.0;
        let steps = if has_steps { format!(" ({} steps per impact)", nearest(1.0 / part)) } else { String::new() };
        format!(
            "contact law {law}: the shortest {what} is {} s, that of {}; the time step is {step}{steps}, at most {} s is advised",
            nearest(seconds),
            scene.name_of_sphere(sphere),
            at_most(self.largest_dt())
        )
    }
}

impl Scene {
    /// The moving spheres, with their numbers.
    pub(super) fn moving_surfaces(&self) -> impl Iterator<Item = (usize, &Sphere)> {
        self.spheres().iter().enumerate().filter(|(_, sphere)| !sphere.fixed)
    }

    /// The time that bounds the time step of a contact law with history; `None` for the law of the thesis, and where no moving
    /// sphere has the constants of the law.
    pub fn law_time(&self) -> Option<LawTime> {
        let law = self.contact_law();
        let times = self.moving_surfaces().filter_map(|(index, sphere)| {
            let id = sphere.material?;
            let mass = f64::from(sphere.mass);
            let seconds = match law {
                ContactLaw::Thesis | ContactLaw::User | ContactLaw::Rigid | ContactLaw::Auto => return None,
                ContactLaw::Linear => {
                    let (number, radius) = (self.material_number(Some(id)).ok()?, 0.5 * f64::from(sphere.radius));
                    let of = |other| self.normal_stiffness(number, other, radius, 0.5 * mass);
                    let stiffest = (1..=self.materials().len() as u16).filter_map(of).fold(0.0, f64::max);
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
            Some(LawTime { law, seconds, sphere: index, speed: None })
        });
        times.min_by(|one, other| one.seconds.total_cmp(&other.seconds))
    }

    /// All times that bound the time step of a contact law with history: [`Scene::law_time`], and for `hertz-mindlin` the shortest
    /// time of an impact, 2.87 (m*² / (R* E*² u))^(1/5). u is the speed of the fastest body after a fall through the height of the
    /// scene. There is no impact in a scene without speeds.
    pub fn law_times(&self) -> Vec<LawTime> {
        self.law_time().into_iter().chain(self.hertz_time()).collect()
    }

    /// Names the properties of pairs that are given although the law of the thesis does not use them.
    pub(super) fn unused_properties(&self) -> Option<String> {
        let is_given = |property: Option<f32>| property.is_some_and(|value| value > 0.0);
        let given = [
            ("rolling_friction", self.pairs.values().any(|pair| is_given(pair.rolling_friction))),
            ("twisting_friction", self.pairs.values().any(|pair| is_given(pair.twisting_friction))),
            ("surface_energy", self.pairs.values().any(|pair| is_given(pair.surface_energy))),
        ];
        let names: Vec<&str> = given.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect();
        let law = self.contact_law();
        (!names.is_empty() && !law.has_history()).then(|| {
            format!("contact law {law}: {} of pairs has no effect; linear, hertz-mindlin and user use it", names.join(", "))
        })
    }

    fn hertz_time(&self) -> Option<LawTime> {
        let (law, speed) = (self.contact_law(), self.greatest_speed());
        if law != ContactLaw::HertzMindlin || speed <= 0.0 {
            return None;
        }
        // The stiffest partner of each material.
        let moduli: Vec<f64> = (1..=self.materials().len() as u16)
            .map(|one| {
                let with = |other| self.moduli(one, other).map_or(0.0, |[normal, _]| f64::from(normal));
                (1..=self.materials().len() as u16).map(with).fold(0.0, f64::max)
            })
            .collect();
        let times = self.moving_surfaces().filter_map(|(index, sphere)| {
            let number = usize::from(self.material_number(sphere.material).ok()?).checked_sub(1)?;
            let (mass, radius) = (0.5 * f64::from(sphere.mass), 0.5 * f64::from(sphere.radius));
            let seconds = 2.87 * (mass * mass / (radius * moduli[number].powi(2) * speed)).powf(0.2);
            (moduli[number] > 0.0).then_some(LawTime { law, seconds, sphere: index, speed: Some(speed) })
        });
        times.min_by(|one, other| one.seconds.total_cmp(&other.seconds))
    }
}
