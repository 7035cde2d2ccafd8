//! What is kept from frame to frame, as rows for the device (`rigid/frame/past.wgsl`) and back.

use glam::Vec3A;

use crate::rigid::collide::MOST_POINTS;
use crate::rigid::common::LEFT_OVER;
use crate::rigid::history::{History, OldPair, OldPoint};
use crate::rigid::world::RigidWorld;

/// Rows of [`History`], in the order (owner, partner, colliders).
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Past {
    /// First pair of each body, and the end.
    pub(super) starts: Vec<u32>,
    /// Colliders, bodies; points, colour, normal impulse of impacts, 0.
    pub(super) pairs: Vec<[u32; 8]>,
    /// Place, id; tangential impulse, normal impulse. Four for each pair.
    pub(super) points: Vec<[u32; 8]>,
}

impl Past {
    /// The rows of what a world remembers. Colours of which two clash on a body are not kept.
    pub(super) fn of(world: &RigidWorld) -> Self {
        let history = &world.history;
        let has_mass = |body: u32| world.bodies[body as usize].inverse_mass > 0.0;
        let body = |collider: u32| world.colliders[collider as usize].body;
        let known = |old: &&OldPair| old.colliders.iter().all(|collider| (*collider as usize) < world.colliders.len());
        let mut order: Vec<(u32, u32, &OldPair)> = Vec::with_capacity(history.pairs.len());
        for old in history.pairs.iter().filter(known) {
            let [a, b] = old.colliders.map(body);
            let owner = if has_mass(b) { b } else { a };
            order.push((owner, a + b - owner, old));
        }
        order.sort_by_key(|(owner, partner, old)| (*owner, *partner, old.colliders));
        let clash = history.clashes(has_mass);
        let mut past = Self { starts: vec![0; world.bodies.len() + 1], ..Self::default() };
        for (owner, _, old) in order {
            past.starts[owner as usize + 1] += 1;
            let bodies = old.colliders.map(body);
            let colour = history.colour(bodies).filter(|_| !clash).unwrap_or(LEFT_OVER);
            let [a, b] = old.colliders;
            past.pairs.push([a, b, bodies[0], bodies[1], old.count, colour.into(), old.struck.to_bits(), 0]);
            let points = &history.points[old.first as usize..(old.first + old.count) as usize];
            past.points.extend((0..MOST_POINTS).map(|k| points.get(k).map_or([0; 8], row)));
        }
        for body in 0..world.bodies.len() {
            past.starts[body + 1] += past.starts[body];
        }
        past
    }

    /// Back from the rows.
    pub(super) fn history(&self, substep: f32) -> History {
        let mut history = History { substep, ..History::default() };
        let mut order: Vec<(usize, &[u32; 8])> = self.pairs.iter().enumerate().collect();
        order.sort_unstable_by_key(|(_, pair)| [pair[0], pair[1]]);
        for (p, pair) in order {
            let (first, count) = (history.points.len() as u32, pair[4].min(MOST_POINTS as u32));
            let struck = f32::from_bits(pair[6]);
            history.pairs.push(OldPair { colliders: [pair[0], pair[1]], first, count, struck });
            history.points.extend(self.points[MOST_POINTS * p..][..count as usize].iter().map(point));
        }
        history.colours = self.pairs.iter().map(|pair| ([pair[2], pair[3]], pair[5] as u8)).collect();
        // The first pair of a block knows its colour.
        history.colours.dedup_by_key(|(bodies, _)| *bodies);
        history.colours.sort_unstable_by_key(|(bodies, _)| *bodies);
        history
    }
}

fn row(point: &OldPoint) -> [u32; 8] {
    let ([x, y, z], [u, v, w]) = (point.on_a.to_array(), point.tangent.to_array());
    let bits = f32::to_bits;
    [bits(x), bits(y), bits(z), point.id, bits(u), bits(v), bits(w), bits(point.normal)]
}

fn point(row: &[u32; 8]) -> OldPoint {
    let vector = |at: usize| Vec3A::from_array([0, 1, 2].map(|axis| f32::from_bits(row[at + axis])));
    OldPoint { id: row[3], on_a: vector(0), normal: f32::from_bits(row[7]), tangent: vector(4) }
}
