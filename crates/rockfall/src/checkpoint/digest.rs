//! Hashes of a checkpoint, with which two runs are compared.

use std::hash::{DefaultHasher, Hasher as _};

use crate::checkpoint::Checkpoint;

/// Hashes of what determines how a simulation continues, and of how its steps were taken. Two runs of the same scene on the same device
/// have equal hashes. Another version of rockfall or of Rust may hash differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest {
    /// Hash of the scene, the state of all objects, and the options.
    pub state: u64,
    /// Hash of the numbers of repeated steps and of rebuilt lists, and of the margin, length and room of the lists.
    pub schedule: u64,
}

impl Checkpoint {
    /// The hashes of the checkpoint, without its note.
    pub fn digest(&self) -> Digest {
        let mut state = self.clone();
        state.note.clear();
        let report = &mut state.report;
        let counts = [std::mem::take(&mut report.replays), std::mem::take(&mut report.list_builds)];
        let lists = [&mut state.history.margin_scale, &mut state.history.lookahead].map(|part| std::mem::take(part).to_bits());
        let room = state.options.pair_capacity.take();
        Digest { state: hash(&state.to_bytes()), schedule: hash(&(counts, lists, room)) }
    }
}

fn hash(what: &impl std::hash::Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    what.hash(&mut hasher);
    hasher.finish()
}
