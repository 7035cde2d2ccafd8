//! What is kept from frame to frame: impulses of points and colours of blocks (docs/physics section 11.5).

use glam::{Vec2, Vec3A};

use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::contacts::{Block, Contacts, Impulse, LEFT_OVER, Pair};
use crate::rigid::frame::detect::least_radius;
use crate::rigid::frame::refresh::tangents;
use crate::rigid::history::{History, OldPair, OldPoint};

impl History {
    /// Of the contacts after a frame.
    pub(super) fn new(contacts: &Contacts, substep: f32) -> Self {
        let mut history = Self { substep, ..Self::default() };
        let mut order: Vec<&Pair> = contacts.pairs.iter().collect();
        // Each colour is in order, or nearly so. A stable sort merges such runs.
        order.sort_by_key(|pair| pair.colliders);
        for pair in order {
            let (first, count) = (history.points.len() as u32, u32::from(pair.count));
            let struck = if pair.struck.is_finite() { pair.struck } else { 0.0 };
            history.pairs.push(OldPair { colliders: pair.colliders, first, count, struck });
            for k in pair.first as usize..(pair.first + count) as usize {
                let (point, Impulse { normal, tangent }) = (&contacts.points[k], contacts.impulses[k]);
                let tangent = tangent.x * pair.tangents[0] + tangent.y * pair.tangents[1];
                let old = OldPoint { id: point.id, on_a: point.on_a, normal, tangent };
                // What is not finite belongs to a body that has stopped.
                let is_finite = normal.is_finite() && old.tangent.is_finite() && old.on_a.is_finite();
                history.points.push(if is_finite { old } else { OldPoint::default() });
            }
        }
        history.colours = contacts.blocks.iter().map(|block| (block.bodies, block.colour)).collect();
        history.colours.sort_by_key(|(bodies, _)| *bodies);
        history
    }

    /// The colour of a block in the last frame.
    pub(in crate::rigid) fn colour(&self, bodies: [u32; 2]) -> Option<u8> {
        let place = self.colours.binary_search_by_key(&bodies, |(old, _)| *old).ok()?;
        Some(self.colours[place].1).filter(|colour| *colour != LEFT_OVER)
    }

    /// Gives the points of a frame the impulses that they had, for a substep of `h` seconds.
    pub(super) fn recall(&self, contacts: &mut Contacts, bodies: &Bodies, h: f32) {
        let scale = if self.substep > 0.0 && self.substep != h { h / self.substep } else { 1.0 };
        let Contacts { blocks, pairs, points, impulses, .. } = contacts;
        let mut next = 0;
        for block in blocks.iter() {
            let near = 0.1 * least_radius(bodies, block);
            for pair in &mut pairs[block.pair_range()] {
                let Some(old) = self.pair_after(&mut next, pair.colliders) else { continue };
                let range = pair.first as usize..pair.first as usize + usize::from(pair.count);
                let places = points[range.clone()].iter().map(|point| (point.id, point.on_a));
                let turn = bodies.poses[block.sides()[0]].turn;
                pair.normal = turn * pair.inner_normal;
                pair.tangents = tangents(pair.normal);
                for (k, from) in partners(places, old, near).into_iter().enumerate().take(range.len()) {
                    if let Some(from) = from {
                        let OldPoint { normal, tangent, .. } = old[from];
                        let along = pair.tangents.map(|t| scale * tangent.dot(t));
                        impulses[range.start + k] = Impulse { normal: scale * normal, tangent: Vec2::from_array(along) };
                    }
                }
            }
        }
    }

    /// Whether two blocks of a body with mass have one colour, which no frame leaves behind.
    #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
    pub(in crate::rigid) fn clashes(&self, has_mass: impl Fn(u32) -> bool) -> bool {
        let mut taken: Vec<(u32, u8)> = self
            .colours
            .iter()
            .filter(|(_, colour)| *colour < LEFT_OVER)
            .flat_map(|(bodies, colour)| bodies.iter().filter(|body| has_mass(**body)).map(|body| (*body, *colour)))
            .collect();
        taken.sort_unstable();
        taken.windows(2).any(|two| two[0] == two[1])
    }

    /// Number of left-over blocks.
    #[cfg(test)]
    pub(super) fn left_over(&self) -> usize {
        self.colours.iter().filter(|(_, colour)| *colour == LEFT_OVER).count()
    }
}

/// The old partner of each point: the one with its id, else the nearest one that is free and near enough.
fn partners(places: impl Iterator<Item = (u32, Vec3A)> + Clone, old: &[OldPoint], near: f32) -> [Option<usize>; 4] {
    let (mut partners, mut taken) = ([None; 4], [false; 4]);
    for (k, (id, _)) in places.clone().enumerate() {
        partners[k] = old.iter().enumerate().position(|(j, point)| !taken[j] && point.id == id);
        partners[k].into_iter().for_each(|j| taken[j] = true);
    }
    for (k, (_, place)) in places.enumerate().filter(|(k, _)| partners[*k].is_none()).collect::<Vec<_>>() {
        let distance = |j: usize| old[j].on_a.distance_squared(place);
        let free = (0..old.len()).filter(|j| !taken[*j] && distance(*j) <= near * near);
        partners[k] = free.min_by(|i, j| distance(*i).total_cmp(&distance(*j)));
        partners[k].into_iter().for_each(|j| taken[j] = true);
    }
    partners
}

/// The order of blocks in which new colours are given: a number that is spread evenly.
pub(super) fn hash([a, b]: [u32; 2]) -> u32 {
    let mut x = a.wrapping_mul(0x9E37_79B9) ^ b.wrapping_mul(0x85EB_CA6B);
    x = (x ^ (x >> 16)).wrapping_mul(0x85EB_CA6B);
    x = (x ^ (x >> 13)).wrapping_mul(0xC2B2_AE35);
    x ^ (x >> 16)
}

/// The order of a block among those that take a colour.
pub(super) fn rank(block: &Block) -> (bool, u32, [u32; 2]) {
    (block.far, hash(block.bodies), block.bodies)
}
