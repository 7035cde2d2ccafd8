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

    /// The number after all that were ever given to spheres, from 1.
    pub(crate) fn next(&self) -> u32 {
        self.0.iter().flatten().map(|(_, reference)| reference.saturating_add(1)).max().unwrap_or(1).max(1)
    }

    /// Whether no sphere ever had a reference.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// A different number for each of `spheres`: their references if no two are equal, otherwise their indices. Spheres without
    /// a reference get numbers above all others.
    pub(super) fn distinct(&self, spheres: impl Iterator<Item = SphereId> + Clone) -> Vec<u32> {
        let mut known: Vec<u32> = spheres.clone().filter_map(|sphere| self.get(sphere)).collect();
        let count = spheres.clone().count() as u32;
        known.sort_unstable();
        let first = known.last().map_or(0, |last| last.saturating_add(1));
        if known.windows(2).any(|pair| pair[0] == pair[1]) || first.checked_add(count).is_none() {
            return (0..count).collect();
        }
        let mut free = first..;
        spheres.map(|sphere| self.get(sphere).or_else(|| free.next()).unwrap_or_default()).collect()
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
