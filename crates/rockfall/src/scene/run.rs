//! How a scene is meant to be run.

use super::Scene;
use crate::error::{Error, Result};
use crate::rigid::common;
use crate::settings::{ContactLaw, DEFAULT_FRAME, DEFAULT_TIME_STEP, Integrator, IntegratorChoice, Settings};

/// How a scene is meant to be run: the line `@run` of its text. Programs use these values where they are not told otherwise; options
/// of the command line override each of them.
///
/// [`Simulation`](crate::Simulation) and [`Worlds`](crate::Worlds) take the integrator from here unless their options name one. The
/// other values are for the program that calls them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RunDefaults {
    /// Time step, in s. `None`: 0.02 s, and 1/60 s with the contact law `rigid`.
    pub dt: Option<f32>,
    /// The integrator. `None` and [`IntegratorChoice::Auto`]: what the contact law needs.
    pub integrator: Option<IntegratorChoice>,
    /// Number of steps. `None`: the program decides; `rockfall run` does 1000.
    pub steps: Option<u64>,
    /// Number of steps between two frames of a trajectory. `None`: only the final state is written.
    pub every: Option<u64>,
    /// Number of equal parts that every step is divided into. `None`: 1. With the contact law `rigid`, the number of substeps of
    /// the solver in a frame; `None`: what suits gravity and the least width of the bodies, at least 4.
    pub substeps: Option<u32>,
    /// Simulated seconds per second of film, less than 1 for slow motion. `None`: 1.
    pub speed: Option<f64>,
}

impl RunDefaults {
    /// Greatest number of parts of a step, so that a part stays well above the rounding error of the whole step.
    pub const MAX_SUBSTEPS: u32 = common::MAX_SUBSTEPS;

    /// Checks that every value is allowed.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a time step and a speed that are not finite and positive, and for numbers of 0.
    pub fn validate(&self) -> Result<()> {
        let invalid = |field, value: String, expected| Err(Error::Invalid { field, value, expected });
        match *self {
            Self { dt: Some(dt), .. } if !(dt.is_finite() && dt > 0.0) => invalid("run.dt", dt.to_string(), TIME_STEP),
            Self { steps: Some(0), .. } => invalid("run.steps", "0".to_owned(), FROM_ONE),
            Self { every: Some(0), .. } => invalid("run.every", "0".to_owned(), FROM_ONE),
            Self { substeps: Some(parts), .. } if !(1..=Self::MAX_SUBSTEPS).contains(&parts) => {
                invalid("run.substeps", parts.to_string(), PARTS)
            }
            Self { speed: Some(speed), .. } if !(speed.is_finite() && speed > 0.0) => {
                invalid("run.speed", speed.to_string(), SPEED)
            }
            _ => Ok(()),
        }
    }

    /// The time step of a simulation, in s: a step divided by its number of parts. `None` if neither is given.
    pub fn time_step(&self) -> Option<f32> {
        let dt = self.dt.or(self.substeps.map(|_| DEFAULT_TIME_STEP))?;
        Some(dt / self.substeps.unwrap_or(1).max(1) as f32)
    }
}

pub(super) const TIME_STEP: &str = "a finite number of seconds greater than 0";
pub(super) const FROM_ONE: &str = "a whole number of at least 1";
pub(super) const SPEED: &str = "a finite number greater than 0";
pub(super) const PARTS: &str = "a whole number from 1 to 1000000";

impl Scene {
    /// The time step that suits a simulation of this scene, in s: with the contact law `rigid` its frame, which is 1/60 s unless
    /// [`Scene::run`] has another one, otherwise [`RunDefaults::time_step`].
    pub fn time_step(&self) -> Option<f32> {
        if self.is_rigid() { Some(self.run.dt.unwrap_or(DEFAULT_FRAME)) } else { self.run.time_step() }
    }

    /// The time step of a simulation before its first step.
    pub(crate) fn first_time_step(&self) -> f32 {
        self.time_step().unwrap_or(DEFAULT_TIME_STEP)
    }

    /// The contact law of a simulation of this scene: that of its settings. For `auto`, it is `rigid` if the scene has a placed body,
    /// an inlet with a shape, or a joint, and otherwise `thesis`.
    pub fn contact_law(&self) -> ContactLaw {
        match self.settings.contact_law {
            ContactLaw::Auto if self.needs_rigid() => ContactLaw::Rigid,
            ContactLaw::Auto => ContactLaw::Thesis,
            given => given,
        }
    }

    /// Whether the scene has objects that only the contact law `rigid` moves in every form.
    fn needs_rigid(&self) -> bool {
        !self.bodies().is_empty()
            || !self.joints().is_empty()
            || self.inlets().iter().any(|inlet| inlet.shapes().next().is_some())
    }

    /// The settings with the contact law that a simulation takes. Where `auto` means `rigid`, a restitution and a coefficient of
    /// friction that have the defaults of [`Settings`] become those of `rigid`.
    pub(crate) fn chosen_settings(&self) -> Settings {
        let mut settings = self.settings;
        settings.contact_law = self.contact_law();
        if self.settings.contact_law == ContactLaw::Auto && settings.contact_law == ContactLaw::Rigid {
            let (plain, hard) = (Settings::default(), Settings::RIGID);
            let or = |given: f32, plain: f32, hard: f32| if given == plain { hard } else { given };
            settings.restitution = or(settings.restitution, plain.restitution, hard[0]);
            settings.coulomb_friction = or(settings.coulomb_friction, plain.coulomb_friction, hard[1]);
        }
        settings
    }

    /// Whether the contact law is `rigid`.
    pub(crate) fn is_rigid(&self) -> bool {
        self.contact_law() == ContactLaw::Rigid
    }

    /// The integrator of a simulation of this scene, for a choice in its [`Options`](crate::Options): the one that is given, or else
    /// that of [`Scene::run`], or else what the contact law needs.
    pub fn integrator(&self, choice: IntegratorChoice) -> Integrator {
        let own = self.run.integrator.unwrap_or_default();
        let choice = if choice == IntegratorChoice::Auto { own } else { choice };
        choice.resolve(self.contact_law())
    }
}
