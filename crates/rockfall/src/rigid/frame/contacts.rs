//! Contacts while a frame is solved: blocks, pairs and points in flat arrays, in the order of blocks.

use std::ops::Range;

use glam::{Vec2, Vec3A};

use crate::rigid::collide::{MOST_POINTS, Manifold};
pub(super) use crate::rigid::common::{COLOURS, LEFT_OVER};

/// A pair of colliders that are within reach, a on the body with the smaller number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) bodies: [u32; 2],
    pub(super) colliders: [u32; 2],
    pub(super) manifold: Manifold,
}

/// Where the points of a pair are: from the centre of body a, along the axes of the world.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    pub(super) normal: Vec3A,
    pub(super) count: usize,
    pub(super) on_a: [Vec3A; MOST_POINTS],
    pub(super) on_b: [Vec3A; MOST_POINTS],
    pub(super) ids: [u32; MOST_POINTS],
}

impl Place {
    pub(super) fn gap(&self, k: usize) -> f32 {
        (self.on_b[k] - self.on_a[k]).dot(self.normal)
    }
}

/// A contact point in coordinates of its bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Point {
    pub(super) on_a: Vec3A,
    pub(super) on_b: Vec3A,
    pub(super) id: u32,
}

/// What the passes need of all points. Formed by the refresh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Row {
    /// The common point from the centre of either body.
    pub(super) arm_a: Vec3A,
    pub(super) arm_b: Vec3A,
    /// Separation; negative for an overlap.
    pub(super) gap: f32,
    /// kappa: what the gap of a round contact keeps beyond the tangent line.
    pub(super) spare: f32,
    /// Its lever is that of this geometry.
    pub(super) formed: bool,
    /// Takes part in the relax pass.
    pub(super) live: bool,
}

/// What impulses at a point do. Apart from the rows, and formed when it is needed: most points of a frame never touch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lever {
    /// 1 / K along the normal.
    pub(super) inverse_normal: f32,
    /// Inverse of K_t: xx, xy, yy.
    pub(super) inverse_tangent: [f32; 3],
    /// 1 / the greater eigenvalue of K_t.
    pub(super) inverse_slip: f32,
    /// For the normal and the two tangents.
    pub(super) along: [Along; 3],
}

/// How an impulse of 1 along a direction turns both bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Along {
    /// Its moments, arm x direction.
    pub(super) turn_a: Vec3A,
    pub(super) turn_b: Vec3A,
    /// The changes of the spins: inverse inertia times moment.
    pub(super) response_a: Vec3A,
    pub(super) response_b: Vec3A,
}

impl Row {
    pub(super) fn new(arm_a: Vec3A, arm_b: Vec3A, gap: f32) -> Self {
        Self { arm_a, arm_b, gap, ..Self::default() }
    }
}

/// The impulse of a point in a substep: along the normal and along the two tangents.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Impulse {
    pub(super) normal: f32,
    pub(super) tangent: Vec2,
}

/// A pair of colliders: one manifold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pair {
    pub(super) colliders: [u32; 2],
    /// Its first point, and how many points there is room for.
    pub(super) first: u32,
    pub(super) room: u8,
    /// Points at present.
    pub(super) count: u8,
    /// Its first point opens a chunk.
    pub(super) opens: bool,
    /// Its points are found anew at every refresh.
    pub(super) round: bool,
    pub(super) friction: f32,
    pub(super) restitution: f32,
    /// Unit vector from a to b in coordinates of body a.
    pub(super) inner_normal: Vec3A,
    /// The normal and the tangents of the last refresh.
    pub(super) normal: Vec3A,
    pub(super) tangents: [Vec3A; 2],
    /// Velocity of the surface of b less that of a, along the tangents.
    pub(super) belt: Vec2,
    /// The normal impulse of its impacts in the frame.
    pub(super) struck: f32,
}

/// All contacts of two bodies. One thread owns it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Block {
    pub(super) bodies: [u32; 2],
    /// Its colour, [`LEFT_OVER`] for none.
    pub(super) colour: u8,
    /// Round in which it took its colour; 0 for a kept one.
    pub(super) round: u8,
    /// It matters only after a hit.
    pub(super) far: bool,
    /// One side has no mass.
    pub(super) fixed: bool,
    /// It has no rows in this substep: its impact is not yet over.
    pub(super) waits: bool,
    /// Impacts are possible: a pair has e > 0.
    pub(super) elastic: bool,
    /// Balls may touch several static shapes, of which some hide others.
    pub(super) seams: bool,
    pub(super) first_pair: u32,
    pub(super) pairs: u32,
    pub(super) first_point: u32,
    /// Room for points.
    pub(super) points: u32,
    /// The left-over blocks in which its bodies take part, 1 for a block with a colour.
    pub(super) shares: [f32; 2],
    /// What is left of the substep after its clocks, in s.
    pub(super) time: f32,
}

impl Block {
    pub(super) fn pair_range(&self) -> Range<usize> {
        self.first_pair as usize..(self.first_pair + self.pairs) as usize
    }

    pub(super) fn sides(&self) -> [usize; 2] {
        self.bodies.map(|body| body as usize)
    }
}

/// The impulses of a block: on b, and the moments of those on a and b about their centres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Load {
    pub(super) impulse: Vec3A,
    pub(super) moments: [Vec3A; 2],
}

/// All contacts of a frame, and which blocks a colour and a body have.
#[derive(Clone, Debug, Default)]
pub(super) struct Contacts {
    /// In the order (colour, a, b).
    pub(super) blocks: Vec<Block>,
    pub(super) pairs: Vec<Pair>,
    pub(super) points: Vec<Point>,
    pub(super) rows: Vec<Row>,
    pub(super) levers: Vec<Lever>,
    pub(super) impulses: Vec<Impulse>,
    /// First block of a colour; the left-over blocks are those of the last one.
    pub(super) colours: [u32; COLOURS + 2],
    /// First entry of a body in `list`.
    pub(super) lists: Vec<u32>,
    /// Blocks of the bodies, with the side on which the body is, in the order (a, b).
    pub(super) list: Vec<(u32, bool)>,
    /// Room for the loads of the blocks.
    pub(super) loads: Vec<Load>,
}

impl Contacts {
    pub(super) fn colour(&self, colour: usize) -> Range<usize> {
        self.colours[colour] as usize..self.colours[colour + 1] as usize
    }

    pub(super) fn of_body(&self, body: usize) -> &[(u32, bool)] {
        &self.list[self.lists[body] as usize..self.lists[body + 1] as usize]
    }

    /// The contacts of a range of blocks.
    pub(super) fn part(&mut self, range: Range<usize>) -> Part<'_> {
        let (first_pair, first_point) = self.starts(range.start);
        let (end_pair, end_point) = self.starts(range.end);
        Part {
            first_pair,
            first_point,
            blocks: &mut self.blocks[range],
            pairs: &mut self.pairs[first_pair..end_pair],
            points: &mut self.points[first_point..end_point],
            rows: &mut self.rows[first_point..end_point],
            levers: &mut self.levers[first_point..end_point],
            impulses: &mut self.impulses[first_point..end_point],
        }
    }

    /// Where the pairs and the points of a block begin.
    fn starts(&self, block: usize) -> (usize, usize) {
        let start = |block: &Block| (block.first_pair as usize, block.first_point as usize);
        self.blocks.get(block).map_or((self.pairs.len(), self.points.len()), start)
    }

    /// Lists the blocks of each body in the order (a, b), in which `order` has all blocks.
    pub(super) fn list_by_body(&mut self, bodies: usize, order: &[u32]) {
        self.lists = vec![0; bodies + 1];
        for body in self.blocks.iter().flat_map(|block| block.sides()) {
            self.lists[body + 1] += 1;
        }
        for body in 0..bodies {
            self.lists[body + 1] += self.lists[body];
        }
        let mut next = self.lists.clone();
        self.list = vec![(0, false); 2 * self.blocks.len()];
        for k in order {
            for (side, body) in self.blocks[*k as usize].sides().into_iter().enumerate() {
                self.list[next[body] as usize] = (*k, side == 1);
                next[body] += 1;
            }
        }
    }
}

/// Some blocks in a row with all that is theirs.
pub(super) struct Part<'a> {
    first_pair: usize,
    first_point: usize,
    pub(super) blocks: &'a mut [Block],
    pub(super) pairs: &'a mut [Pair],
    pub(super) points: &'a mut [Point],
    pub(super) rows: &'a mut [Row],
    pub(super) levers: &'a mut [Lever],
    pub(super) impulses: &'a mut [Impulse],
}

/// One block with all that is its own. The `first` of its pairs counts from `first_point`.
pub(super) struct View<'a> {
    pub(super) block: &'a mut Block,
    pub(super) pairs: &'a mut [Pair],
    pub(super) points: &'a mut [Point],
    pub(super) rows: &'a mut [Row],
    pub(super) levers: &'a mut [Lever],
    pub(super) impulses: &'a mut [Impulse],
}

impl Part<'_> {
    /// A block by its place in the part.
    pub(super) fn view(&mut self, k: usize) -> View<'_> {
        let block = &mut self.blocks[k];
        let pair = block.first_pair as usize - self.first_pair;
        let (point, count) = (block.first_point as usize - self.first_point, block.points as usize);
        View {
            pairs: &mut self.pairs[pair..pair + block.pairs as usize],
            points: &mut self.points[point..point + count],
            rows: &mut self.rows[point..point + count],
            levers: &mut self.levers[point..point + count],
            impulses: &mut self.impulses[point..point + count],
            block,
        }
    }

    /// The first `middle` blocks, and the others.
    fn split(self, middle: usize) -> (Self, Self) {
        let start = &self.blocks[middle];
        let (pair, point) = (start.first_pair as usize, start.first_point as usize);
        let (blocks, later_blocks) = self.blocks.split_at_mut(middle);
        let (pairs, later_pairs) = self.pairs.split_at_mut(pair - self.first_pair);
        let (points, later_points) = self.points.split_at_mut(point - self.first_point);
        let (rows, later_rows) = self.rows.split_at_mut(point - self.first_point);
        let (levers, later_levers) = self.levers.split_at_mut(point - self.first_point);
        let (impulses, later_impulses) = self.impulses.split_at_mut(point - self.first_point);
        let first = Self { blocks, pairs, points, rows, levers, impulses, ..self };
        let later = Self {
            first_pair: pair,
            first_point: point,
            blocks: later_blocks,
            pairs: later_pairs,
            points: later_points,
            rows: later_rows,
            levers: later_levers,
            impulses: later_impulses,
        };
        (first, later)
    }
}

/// Blocks that are worth a task of their own.
const TASK: usize = 128;
/// Fewer blocks are done by the thread that asks.
const CROWD: usize = 1024;

/// Whether so many blocks are worth other threads. A pool of one thread is never worth the way to it.
pub(super) fn is_crowd(count: usize) -> bool {
    count >= CROWD && rayon::current_num_threads() > 1
}

/// Does something with each block and keeps what comes of it: in parallel where the blocks are many, with the same result.
pub(super) fn for_each<T: Send>(mut part: Part<'_>, out: &mut [T], work: &(impl Fn(View<'_>) -> T + Sync)) {
    if !is_crowd(part.blocks.len()) {
        for (k, slot) in out.iter_mut().enumerate() {
            *slot = work(part.view(k));
        }
    } else {
        divide(part, out, work);
    }
}

fn divide<T: Send>(mut part: Part<'_>, out: &mut [T], work: &(impl Fn(View<'_>) -> T + Sync)) {
    let count = part.blocks.len();
    if count <= TASK {
        for (k, slot) in out.iter_mut().enumerate() {
            *slot = work(part.view(k));
        }
        return;
    }
    let (first, later) = part.split(count / 2);
    let (out, later_out) = out.split_at_mut(count / 2);
    rayon::join(|| divide(first, out, work), || divide(later, later_out, work));
}
