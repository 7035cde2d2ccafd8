//! Smoothing functions.

use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use rockfall::{Error, Result};

/// Distance at which the Gaussian ends, in widths.
const CUT: f64 = 3.0;

/// The shape of a smoothing function. Both integrate to 1 over all space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Kernel {
    /// Proportional to exp(-d²/(2 w²)) up to the distance d = 3 w, with the width w.
    #[default]
    Gaussian,
    /// The same everywhere up to the distance w.
    Heaviside,
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gaussian => "gaussian",
            Self::Heaviside => "heaviside",
        })
    }
}

impl FromStr for Kernel {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "gaussian" => Ok(Self::Gaussian),
            "heaviside" => Ok(Self::Heaviside),
            _ => Err(Error::Invalid { field: "kernel", value: format!("`{text}`"), expected: "gaussian or heaviside" }),
        }
    }
}

/// A smoothing function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothing {
    kernel: Kernel,
    width: f64,
    /// Factor with which the function integrates to 1, in 1/units³.
    factor: f64,
}

impl Smoothing {
    /// A smoothing function of a width in units.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a width that is not positive and finite.
    pub fn new(kernel: Kernel, width: f64) -> Result<Self> {
        if !(width > 0.0 && width.is_finite()) {
            return Err(Error::Invalid {
                field: "width",
                value: width.to_string(),
                expected: "a finite number greater than 0",
            });
        }
        let volume = match kernel {
            // 4 pi times the integral of d² exp(-d²/2) from 0 to the cut.
            Kernel::Gaussian => {
                4.0 * PI * ((PI / 2.0).sqrt() * libm::erf(CUT * FRAC_1_SQRT_2) - CUT * (-0.5 * CUT * CUT).exp())
            }
            Kernel::Heaviside => 4.0 / 3.0 * PI,
        };
        Ok(Self { kernel, width, factor: 1.0 / (volume * width.powi(3)) })
    }

    /// The width, in units.
    pub fn width(self) -> f64 {
        self.width
    }

    /// The distance at which the function ends, in units.
    pub fn reach(self) -> f64 {
        self.width * if self.kernel == Kernel::Gaussian { CUT } else { 1.0 }
    }

    /// The value at a distance, in 1/units³.
    pub fn at(self, distance: DVec3) -> f64 {
        let squared = distance.length_squared();
        if squared >= self.reach().powi(2) {
            return 0.0;
        }
        match self.kernel {
            Kernel::Gaussian => self.factor * (-0.5 * squared / (self.width * self.width)).exp(),
            Kernel::Heaviside => self.factor,
        }
    }

    /// The mean of the function over a line between two distances, in 1/units³.
    pub fn mean(self, from: DVec3, to: DVec3) -> f64 {
        let length = (to - from).length();
        if length == 0.0 {
            return self.at(from);
        }
        // Positions along the line, from the point that is nearest to the centre.
        let start = from.dot(to - from) / length;
        let offset = (from.length_squared() - start * start).max(0.0);
        let half = (self.reach().powi(2) - offset).max(0.0).sqrt();
        let [low, high] = [start.max(-half), (start + length).min(half)];
        if low >= high {
            return 0.0;
        }
        let integral = match self.kernel {
            Kernel::Gaussian => {
                let error_function = |at: f64| libm::erf(at * FRAC_1_SQRT_2 / self.width);
                let across = (-0.5 * offset / (self.width * self.width)).exp();
                across * self.width * (PI / 2.0).sqrt() * (error_function(high) - error_function(low))
            }
            Kernel::Heaviside => high - low,
        };
        self.factor * integral / length
    }
}
