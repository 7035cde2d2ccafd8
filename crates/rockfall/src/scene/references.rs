//! The numbers by which a scene text refers to spheres.

use super::{Scene, SphereId};

/// References of spheres, by slot. A sphere without a reference may have no entry.
#[derive(Clone, Debug, Default)]
pub(crate) struct References(Vec<Option<(SphereId, u32)>>);

impl References {
    pub(crate) fn set(&mut self, sphere: SphereId, reference: u32) {
        let slot = sphere.slot();
        if self.0.len() <= slot {
            self.0.resize(slot + 1, None);
        }
        self.0[slot] = Some((sphere, reference));
    }

    fn get(&self, sphere: SphereId) -> Option<u32> {
        let (owner, reference) = (*self.0.get(sphere.slot())?)?;
        (owner == sphere).then_some(reference)
    }
}

impl Scene {
    /// The number by which the scene text refers to a sphere. `None` for a sphere that was not read from an `S` line.
    ///
    /// Several spheres may have the same reference. In the text it means the last one before the line that uses it.
    pub fn reference(&self, sphere: SphereId) -> Option<u32> {
        self.references.get(sphere)
    }
}
