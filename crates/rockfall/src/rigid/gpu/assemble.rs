//! From the manifolds that the search has found to the blocks, pairs, points and lists of a frame.

use crate::rigid::gpu::arrays::Arrays;
use crate::rigid::gpu::kernels::{
    ARRANGE, BLOCKS, BODIES, BUCKET, COLLIDERS, CONSTANTS, CONTACTS, COUNT_COLOURS, COUNTS, ENLIST, EXPOSE, FOUND, GATHER,
    HULLS, KEEP, LAY, LISTS, MARKS, ORDER, OWNED, PAIRS, POINTS, RANK, RANKS, RAW, RECALL, RELIST, SCALES, SORTED, STATES,
    TABLE, TAKE, TALLIES,
};
use crate::rigid::gpu::rows::{BlockRow, ContactRow, PairRow, PointRow};
use crate::rigid::gpu::scan::Scan;
use crate::rigid::gpu::search::Search;
use crate::rigid::gpu::{COLOURS, call, round_call};
use crate::rigid::world::RigidWorld;

/// Rounds in which blocks take colours, as often as it takes.
pub(super) const ROUNDS: u32 = 16;
/// Blocks that a workgroup arranges.
const TILE: u32 = 256;
/// Points of a pair.
const POINTS_OF_PAIR: u64 = 4;

/// What the assembly has to know of a world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Content {
    bodies: u32,
    /// A body without mass has several colliders, of which some may cover points on others.
    covers: bool,
}

impl Content {
    pub(super) fn of(world: &RigidWorld) -> Self {
        let mut counts = vec![0_u32; world.bodies.len()];
        world.colliders.iter().for_each(|collider| counts[collider.body as usize] += 1);
        let mut all = world.bodies.iter().zip(&counts);
        let covers = all.any(|(body, count)| body.inverse_mass == 0.0 && *count > 1);
        Self { bodies: counts.len() as u32, covers }
    }
}

/// The stages between the search and the solver, and how many pairs there is room for.
#[derive(Debug)]
pub(super) struct Assembly {
    pub(super) content: Content,
    pub(super) room: u32,
    /// The arrays with the blocks by owner.
    by_owner: Arrays,
    of_owners: Scan,
    of_blocks: Scan,
    of_colours: Scan,
}

impl Assembly {
    /// Makes the arrays whose length is that of the bodies or of the room for pairs, which is that of the manifolds of the search. What
    /// is kept of the last frame is not copied.
    pub(super) fn new(arrays: &mut Arrays, search: &Search, content: Content) -> Self {
        let ([_, room], bodies) = (search.rooms(), content.bodies);
        let pairs = u64::from(room);
        let bytes = |size: usize| pairs * size as u64;
        arrays.put(FOUND, search.found.clone());
        arrays.put(COUNTS, search.counts.clone());
        arrays.put(OWNED, search.owned.clone());
        arrays.put(SCALES, search.scales.clone());
        arrays.make(ORDER, 4 * pairs);
        arrays.make(SORTED, 4 * pairs);
        arrays.make(TALLIES, 8 * u64::from(bodies + 1));
        arrays.make(MARKS, 8 * u64::from(bodies));
        arrays.make(STATES, 4 * pairs);
        arrays.make(RANKS, 4 * pairs);
        let tiles = room.div_ceil(TILE);
        let table = (COLOURS + 1) * tiles + 1;
        arrays.make(TABLE, 4 * u64::from(table));
        arrays.make(RAW, bytes(size_of::<BlockRow>()));
        arrays.make(BLOCKS, bytes(size_of::<BlockRow>()));
        arrays.make(PAIRS, bytes(size_of::<PairRow>()));
        arrays.make(POINTS, POINTS_OF_PAIR * bytes(size_of::<PointRow>()));
        arrays.make(CONTACTS, POINTS_OF_PAIR * bytes(size_of::<ContactRow>()));
        // The starts, then twice the two entries of each block.
        arrays.make(LISTS, 4 * (u64::from(bodies + 1) + 4 * pairs));
        let kernels = arrays.gpu.scans();
        let scan = |binding: u32, length: u32| Scan::new(&arrays.gpu.device, kernels, arrays.get(binding), length);
        let mut by_owner = arrays.beside();
        for binding in [0, 1, BODIES, CONSTANTS, PAIRS, POINTS, COLLIDERS, HULLS] {
            by_owner.put(binding, arrays.get(binding).clone());
        }
        by_owner.put(BLOCKS, arrays.get(RAW).clone());
        Self {
            content,
            room,
            by_owner,
            of_owners: scan(OWNED, bodies + 1),
            of_blocks: scan(TALLIES, 2 * (bodies + 1)),
            of_colours: scan(TABLE, table),
        }
    }

    /// Clears what is counted, and the blocks.
    pub(super) fn clear(&self, arrays: &Arrays, encoder: &mut wgpu::CommandEncoder) {
        for binding in [TALLIES, MARKS, RAW] {
            encoder.clear_buffer(arrays.get(binding), 0, None);
        }
    }

    /// Orders the manifolds and gathers the blocks, which keep their colours or wait.
    pub(super) fn encode_blocks(&self, arrays: &Arrays, pass: &mut wgpu::ComputePass<'_>) {
        self.of_owners.encode(pass);
        arrays.dispatch(pass, BUCKET, self.room, 0);
        arrays.dispatch(pass, RANK, self.room, 0);
        self.of_blocks.encode(pass);
        arrays.dispatch(pass, LAY, self.room, 0);
        arrays.dispatch(pass, GATHER, self.room, 0);
        arrays.dispatch(pass, ENLIST, self.room.max(self.content.bodies + 1), 0);
        if self.content.covers {
            self.by_owner.dispatch(pass, EXPOSE, self.room, 0);
        }
        arrays.dispatch(pass, RECALL, self.room, 0);
        arrays.dispatch(pass, KEEP, self.room, 0);
    }

    /// Rounds in which blocks take colours.
    pub(super) fn encode_rounds(&self, arrays: &Arrays, pass: &mut wgpu::ComputePass<'_>, rounds: std::ops::Range<u32>) {
        for round in rounds {
            arrays.dispatch(pass, TAKE, self.room, round_call(round));
        }
    }

    /// Arranges the blocks by colour, if none waits or this is the last round.
    pub(super) fn encode_order(&self, arrays: &Arrays, pass: &mut wgpu::ComputePass<'_>, is_last: bool) {
        let call = call(0, is_last);
        arrays.dispatch_groups(pass, COUNT_COLOURS, self.room.div_ceil(TILE), 0);
        self.of_colours.encode(pass);
        arrays.dispatch_groups(pass, ARRANGE, self.room.div_ceil(TILE), call);
        arrays.dispatch(pass, RELIST, self.content.bodies, call);
    }
}
