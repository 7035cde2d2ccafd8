//! Shear of periodic boundaries: images that slide along the box (docs/physics section 2.14).

use crate::phase::{phase, turns};

/// Images that slide along the box (Lees, Edwards, J. Phys. C 5, 1921, 1972): the box above has the velocity `rate` times the period
/// along `gradient`, along the axis `flow`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shear {
    /// The axis along which the velocity of the flow changes: 0 for x, 1 for y, 2 for z.
    pub gradient: usize,
    /// The axis of the flow.
    pub flow: usize,
    /// Rate of the shear, in 1/s.
    pub rate: f32,
    /// Displacement of the box above, in units of 2^-64 periods along `flow`.
    pub(crate) phase: u64,
}

impl Shear {
    /// A shear whose images are not displaced yet.
    pub fn new(gradient: usize, flow: usize, rate: f32) -> Self {
        Self { gradient, flow, rate, phase: 0 }
    }

    /// The same with this displacement of the box above, in periods along the flow.
    #[must_use]
    pub fn with_turns(self, turns: f64) -> Self {
        Self { phase: phase(turns), ..self }
    }

    /// Displacement of the box above at present, in periods along the flow, from -1/2 to 1/2.
    pub fn turns(&self) -> f64 {
        turns(self.phase)
    }
}
