//! The integrators, and the choice of one.

use std::fmt;
use std::str::FromStr;

use super::{ContactLaw, invalid};
use crate::error::{Error, Result};

/// How positions and velocities are advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Integrator {
    /// Fourth-order Runge-Kutta: four force evaluations per step (thesis section 2.7.5).
    #[default]
    Rk4,
    /// Symplectic (semi-implicit) Euler: one force evaluation per step.
    SymplecticEuler,
    /// Velocity Verlet: one force evaluation per step, of second order where forces do not depend on velocities. Two evaluations
    /// where collisions or friction impulses are switched on.
    VelocityVerlet,
}

impl Integrator {
    /// All integrators.
    pub const ALL: [Self; 3] = [Self::Rk4, Self::SymplecticEuler, Self::VelocityVerlet];
}

impl fmt::Display for Integrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rk4 => "rk4",
            Self::SymplecticEuler => "symplectic-euler",
            Self::VelocityVerlet => "velocity-verlet",
        })
    }
}

impl FromStr for Integrator {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "rk4" => Ok(Self::Rk4),
            "symplectic-euler" => Ok(Self::SymplecticEuler),
            "velocity-verlet" => Ok(Self::VelocityVerlet),
            _ => Err(invalid("integrator", text, "rk4, symplectic-euler or velocity-verlet")),
        }
    }
}

/// The integrator that is asked for: the one that suits the contact law, or a certain one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum IntegratorChoice {
    /// [`Integrator::VelocityVerlet`] with contact laws that keep tangential springs ([`ContactLaw::has_history`]), which do not
    /// allow RK4; otherwise [`Integrator::Rk4`].
    #[default]
    Auto,
    /// This integrator, whatever the contact law.
    Given(Integrator),
}

impl IntegratorChoice {
    /// The integrator that is given, or the one that `Auto` chooses for a contact law.
    pub fn resolve(self, law: ContactLaw) -> Integrator {
        match self {
            Self::Given(integrator) => integrator,
            Self::Auto if law.has_history() => Integrator::VelocityVerlet,
            Self::Auto => Integrator::Rk4,
        }
    }
}

impl From<Integrator> for IntegratorChoice {
    fn from(integrator: Integrator) -> Self {
        Self::Given(integrator)
    }
}

impl fmt::Display for IntegratorChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Given(integrator) => integrator.fmt(f),
        }
    }
}

impl FromStr for IntegratorChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "auto" => Ok(Self::Auto),
            _ => {
                let known = Integrator::from_str(text).map(Self::Given);
                known.map_err(|_| invalid("integrator", text, "auto, rk4, symplectic-euler or velocity-verlet"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_is_the_integrator_that_the_law_allows() {
        for law in ContactLaw::ALL {
            let expected = if law.has_history() { Integrator::VelocityVerlet } else { Integrator::Rk4 };
            assert_eq!(IntegratorChoice::default().resolve(law), expected, "{law}");
            for integrator in Integrator::ALL {
                assert_eq!(IntegratorChoice::from(integrator).resolve(law), integrator, "{law}");
            }
        }
    }

    #[test]
    fn names_read_back() {
        let all = Integrator::ALL.map(IntegratorChoice::Given).into_iter().chain([IntegratorChoice::Auto]);
        for choice in all {
            assert_eq!(choice.to_string().parse::<IntegratorChoice>().unwrap(), choice);
        }
        let error = "Auto".parse::<IntegratorChoice>().unwrap_err().to_string();
        assert!(error.contains("'Auto'") && error.contains("auto, rk4, symplectic-euler or velocity-verlet"), "{error}");
    }
}
