//! What inlets and outlets have done so far.

use super::Rate;
use super::sum::Sum;
use crate::scene::Scene;

/// What inlets and outlets have done so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FlowState {
    /// The number of steps after which inlets and outlets acted last.
    pub(crate) acted: Option<u64>,
    /// The reference of the next sphere that comes in.
    pub(crate) next_reference: u32,
    pub(crate) inlets: Vec<InletState>,
    pub(crate) outlets: Vec<Passed>,
}

/// What an inlet has done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InletState {
    /// Serial number of the next sphere.
    pub(crate) serial: u64,
    /// What the rate counts, of all spheres before it.
    pub(crate) sum: f64,
    /// Places that were tried for it.
    pub(crate) tries: u64,
    pub(crate) passed: Passed,
}

/// Spheres that came in or left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Passed {
    pub(crate) spheres: u64,
    pub(crate) mass: Sum,
}

impl Passed {
    pub(crate) fn add(&mut self, mass: f32) {
        self.spheres += 1;
        self.mass.add(mass);
    }
}

impl FlowState {
    pub(crate) fn of(scene: &Scene) -> Self {
        let mut state = Self::default();
        state.complete(scene);
        state
    }

    /// Adds the inlets and outlets that were added to the scene.
    pub(crate) fn complete(&mut self, scene: &Scene) {
        if self.inlets.len() < scene.inlets().len() {
            self.next_reference = self.next_reference.max(scene.references.next());
        }
        for (number, inlet) in scene.inlets().iter().enumerate().skip(self.inlets.len()) {
            let sum = match inlet.rate {
                Rate::Number(_) => inlet.after as f64,
                _ => {
                    let sequence = scene.sequence(inlet, number);
                    (0..inlet.after).map(|serial| sequence.share(serial)).sum()
                }
            };
            self.inlets.push(InletState { serial: inlet.after, sum, ..InletState::default() });
        }
        self.outlets.resize(scene.outlets().len(), Passed::default());
    }
}
