//! The time within which the contact laws with history react, which bounds the time step (docs/physics section 4.11).

use crate::laws::{Ball, Given, GrainLaw, grain_names};
use crate::scene::{Scene, Sphere};
use crate::settings::ContactLaw;
use crate::stability::{at_most, nearest};

/// The shortest time of the contacts of a scene, and the sphere that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawTime {
    /// The contact law.
    pub law: ContactLaw,
    /// Shortest time of an elastic impact of the sphere with one of equal size and mass, in s; or the Rayleigh time of the sphere.
    pub seconds: f64,
    /// Index of the sphere, in order of addition.
    pub sphere: usize,
    /// Speed of the impact that takes this time, in units/s. `None` for the Rayleigh time, and for a law with which the time does
    /// not depend on the speed.
    pub speed: Option<f64>,
}

impl LawTime {
    /// The longest time step: 20 % of the Rayleigh time, or a 20th of an impact.
    pub fn largest_dt(&self) -> f64 {
        self.seconds / if self.is_rayleigh() { 5.0 } else { 20.0 }
    }

    fn is_rayleigh(&self) -> bool {
        self.speed.is_none() && self.law.grain().is_some_and(GrainLaw::reacts_by_waves)
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
        self.shortest(None, GrainLaw::reaction_time)
    }

    /// All times that bound the time step of a contact law with history: [`Scene::law_time`], and the shortest time of an
    /// impact where it depends on the speed, which is that of the fastest body after a fall through the height of the scene. There
    /// is no impact in a scene without speeds.
    pub fn law_times(&self) -> Vec<LawTime> {
        let speed = self.greatest_speed();
        let impact = (speed > 0.0).then(|| self.shortest(Some(speed), |law, ball| law.impact_time(ball, speed))).flatten();
        self.law_time().into_iter().chain(impact).collect()
    }

    /// The shortest time of the moving spheres.
    fn shortest(&self, speed: Option<f64>, time: impl Fn(&'static dyn GrainLaw, &Ball) -> Option<f64>) -> Option<LawTime> {
        let law = self.contact_law();
        let grain = law.grain()?;
        let numbers = 1..=self.materials().len() as u16;
        let partners: Vec<Vec<Given>> =
            numbers.clone().map(|one| numbers.clone().map(|other| self.given(one, other)).collect()).collect();
        let times = self.moving_surfaces().filter_map(|(index, sphere)| {
            let material = self.material(sphere.material?).ok()?;
            let number = usize::from(self.material_number(sphere.material).ok()?).checked_sub(1)?;
            let [radius, mass] = [sphere.radius, sphere.mass].map(f64::from);
            let elastic = material.young.zip(material.poisson).map(|(young, poisson)| [young, poisson].map(f64::from));
            let seconds = time(grain, &Ball { radius, mass, elastic, partners: &partners[number] })?;
            Some(LawTime { law, seconds, sphere: index, speed })
        });
        times.min_by(|one, other| one.seconds.total_cmp(&other.seconds))
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
            let users = grain_names(|_| true, "and");
            format!("contact law {law}: {} of pairs has no effect; {users} use it", names.join(", "))
        })
    }
}
