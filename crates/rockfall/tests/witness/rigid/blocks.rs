//! Pairs, blocks, matching and colours (docs/physics sections 11.3 to 11.6).

use std::collections::HashMap;

use rockfall::glam::{DMat3, DVec3};

use super::shapes::{Manifold, Shape, manifold};
use super::solver::{Block, Pair, Point, Solver, State};

/// A manifold in the pose of two bodies, seen from the centre of the first one.
pub(crate) struct Seen {
    pub(crate) n: DVec3,
    /// Places on the surfaces of a and b, and ids.
    pub(crate) places: Vec<([DVec3; 2], u32)>,
}

impl Solver {
    /// The manifold of two colliders whose bodies have these poses.
    pub(crate) fn manifold(&self, colliders: [usize; 2], states: [State; 2], reach: f64) -> Option<Seen> {
        let [a, b] = colliders.map(|k| &self.colliders[k]);
        let [qa, qb] = [states[0].q * a.turn, states[1].q * b.turn];
        let from = states[0].q * a.place;
        let p = states[1].x - states[0].x + states[1].q * b.place - from;
        let r = DMat3::from_quat(qa.inverse() * qb);
        let Manifold { n, places } = manifold(&a.shape, &b.shape, qa.inverse() * p, r, reach)?;
        let world = |y: DVec3| from + qa * y;
        let places = places.into_iter().map(|place| ([world(place.x), world(place.y)], place.id)).collect();
        Some(Seen { n: qa * n, places })
    }

    pub(crate) fn states(&self, bodies: [usize; 2]) -> [State; 2] {
        bodies.map(|k| self.bodies[k].state)
    }

    fn bounds(&self, k: usize, margin: f64) -> [DVec3; 2] {
        let collider = &self.colliders[k];
        let State { x, q, .. } = self.bodies[collider.body].state;
        let [low, high] = collider.shape.bounds(x + q * collider.place, q * collider.turn);
        [low - margin, high + margin]
    }

    fn are_linked(&self, bodies: [usize; 2]) -> bool {
        bodies[0] != 0
            && self.links.iter().any(|link| !link.collides && (link.bodies == bodies || link.bodies == [bodies[1], bodies[0]]))
    }

    /// Finds pairs and blocks, and matches points with those of the last frame.
    pub(crate) fn find_blocks(&mut self, margins: &[f64]) {
        let mut blocks: HashMap<[usize; 2], Vec<Pair>> = HashMap::new();
        let count = self.colliders.len();
        let boxes: Vec<[DVec3; 2]> = (0..count).map(|k| self.bounds(k, margins[self.colliders[k].body])).collect();
        for one in 0..count {
            for other in one + 1..count {
                let colliders =
                    if self.colliders[one].body <= self.colliders[other].body { [one, other] } else { [other, one] };
                let bodies = colliders.map(|k| self.colliders[k].body);
                let overlap = boxes[one][0].cmple(boxes[other][1]).all() && boxes[other][0].cmple(boxes[one][1]).all();
                let free = bodies.iter().any(|&k| self.bodies[k].has_mass);
                if bodies[0] == bodies[1] || !free || !overlap || self.are_linked(bodies) {
                    continue;
                }
                let reach = margins[bodies[0]] + margins[bodies[1]];
                if let Some(seen) = self.manifold(colliders, self.states(bodies), reach) {
                    blocks.entry(bodies).or_default().push(self.pair(colliders, bodies, &seen));
                }
            }
        }
        let old = std::mem::take(&mut self.blocks);
        let mut found: Vec<Block> =
            blocks.into_iter().map(|(bodies, pairs)| Block { bodies, pairs, colour: 0, waits: false, left: self.h }).collect();
        found.sort_by_key(|block| block.bodies);
        for block in &mut found {
            block.pairs.sort_by_key(|pair| pair.colliders);
            self.leave_covered_out(block);
            let rho = self.smaller(block.bodies);
            let before = old.iter().find(|other| other.bodies == block.bodies);
            for pair in &mut block.pairs {
                let before = before.and_then(|old| old.pairs.iter().find(|other| other.colliders == pair.colliders));
                if let Some(before) = before {
                    matched(pair, &before.points, rho);
                }
            }
        }
        self.blocks = found;
    }

    fn pair(&self, colliders: [usize; 2], bodies: [usize; 2], seen: &Seen) -> Pair {
        let is_round = colliders.iter().any(|&k| self.colliders[k].shape.is_ball());
        let [a, b] = self.states(bodies);
        let points: Vec<Point> = seen.places.iter().map(|&(places, id)| Point::new(self.local([a, b], places), id)).collect();
        Pair { colliders, is_round, local: a.q.inverse() * seen.n, n: seen.n, points }
    }

    /// Places that are seen from the centre of a, in coordinates of both bodies.
    pub(crate) fn local(&self, [a, b]: [State; 2], [on_a, on_b]: [DVec3; 2]) -> [DVec3; 2] {
        [a.q.inverse() * on_a, b.q.inverse() * (on_b - (b.x - a.x))]
    }

    /// Leaves out points of pairs that are not round where another shape covers them (section 11.4, "Static surfaces").
    fn leave_covered_out(&self, block: &mut Block) {
        let [a, b] = block.bodies;
        if self.bodies[a].has_mass {
            return;
        }
        let (width, states) = (self.bodies[b].width, self.states([a, b]));
        let t = 1e-3 * width / 2.0;
        let world = |at: DVec3| states[0].x + states[0].q * at;
        let places = |pair: &Pair| -> Vec<DVec3> { pair.points.iter().map(|point| world(point.at[0])).collect() };
        let inside = |pair: &Pair| {
            let gap = |point: &Point| (states[1].x + states[1].q * point.at[1] - world(point.at[0])).dot(pair.n);
            pair.points.iter().any(|point| gap(point) < -width / 2.0)
        };
        let covers: Vec<(usize, bool)> = block.pairs.iter().map(|pair| (pair.colliders[0], inside(pair))).collect();
        let mut kept = Vec::new();
        for pair in &block.pairs {
            let all = places(pair);
            let middle = all.iter().sum::<DVec3>() / all.len() as f64;
            let is_covered = |p: DVec3| {
                let y = (middle - p).clamp_length_max(3.0 * t);
                let at = p + 2.0 * t * pair.n + y;
                let other = covers.iter().filter(|(shape, inside)| *shape != pair.colliders[0] && !inside);
                other.into_iter().any(|&(shape, _)| self.is_near(shape, states[0], at, t))
            };
            kept.push(all.into_iter().map(|p| pair.is_round || !is_covered(p)).collect::<Vec<bool>>());
        }
        if kept.iter().all(|pair| !pair.contains(&true)) {
            let least = |pair: &Pair| {
                let gap = |point: &Point| (states[1].x + states[1].q * point.at[1] - world(point.at[0])).dot(pair.n);
                pair.points.iter().map(gap).fold(f64::INFINITY, f64::min).abs()
            };
            let best = (0..block.pairs.len())
                .reduce(|best, k| if least(&block.pairs[k]) < least(&block.pairs[best]) { k } else { best });
            if let Some(best) = best {
                kept[best].fill(true);
            }
        }
        for (pair, kept) in block.pairs.iter_mut().zip(kept) {
            let mut kept = kept.into_iter();
            pair.points.retain(|_| kept.next().unwrap_or(true));
        }
    }

    /// Whether the ball of the radius t about a point of the world touches a collider of a static body.
    fn is_near(&self, collider: usize, state: State, at: DVec3, t: f64) -> bool {
        let one = &self.colliders[collider];
        let ball = Shape { core: super::shapes::Core::Point, radius: t };
        let turn = state.q * one.turn;
        let p = turn.inverse() * (at - state.x - state.q * one.place);
        manifold(&one.shape, &ball, p, DMat3::IDENTITY, 0.0).is_some()
    }

    /// Whether a block is far (section 11.4).
    fn is_far(&self, block: &Block, dt: f64) -> bool {
        let [a, b] = block.bodies;
        let (one, other) = (&self.bodies[a], &self.bodies[b]);
        let states = self.states(block.bodies);
        let speed = (other.state.v - one.state.v).length() + one.rim() + other.rim();
        let bound = speed * dt + self.g.length() * dt * dt + 0.02 * self.smaller(block.bodies);
        let gap = |pair: &Pair, point: &Point| {
            let [on_a, on_b] = [states[0].q * point.at[0], states[1].x - states[0].x + states[1].q * point.at[1]];
            (on_b - on_a).dot(pair.n)
        };
        block.pairs.iter().all(|pair| pair.points.iter().all(|point| gap(pair, point) > bound))
    }

    /// Colours (section 11.6). The scenes have no left-over blocks.
    pub(crate) fn colour(&mut self, dt: f64) {
        let far: Vec<bool> = self.blocks.iter().map(|block| self.is_far(block, dt)).collect();
        let mut taken: HashMap<usize, Vec<u8>> = HashMap::new();
        let mut colours: Vec<Option<u8>> = vec![None; self.blocks.len()];
        let heavy = |bodies: [usize; 2]| bodies.into_iter().filter(|&k| self.bodies[k].has_mass);
        for (at, block) in self.blocks.iter().enumerate() {
            let Some(&colour) = self.colours.get(&block.bodies).filter(|colour| **colour < 8) else { continue };
            if heavy(block.bodies).all(|k| !taken.entry(k).or_default().contains(&colour)) {
                heavy(block.bodies).for_each(|k| taken.entry(k).or_default().push(colour));
                colours[at] = Some(colour);
            }
        }
        let mut rest: Vec<usize> = (0..self.blocks.len()).filter(|&at| colours[at].is_none()).collect();
        rest.sort_by_key(|&at| (far[at], hash(self.blocks[at].bodies), self.blocks[at].bodies));
        let mut rounds: HashMap<usize, u32> = HashMap::new();
        for at in rest {
            let bodies = self.blocks[at].bodies;
            let round = 1 + heavy(bodies).map(|k| rounds.get(&k).copied().unwrap_or(0)).max().unwrap_or(0);
            heavy(bodies).for_each(|k| _ = rounds.insert(k, round));
            let is_free = |colour: &u8| heavy(bodies).all(|k| taken.get(&k).is_none_or(|all| !all.contains(colour)));
            let colour = (0..16).find(is_free).filter(|_| round <= 255);
            let colour = colour.expect("a scene without left-over blocks");
            heavy(bodies).for_each(|k| taken.entry(k).or_default().push(colour));
            colours[at] = Some(colour);
        }
        for (block, colour) in self.blocks.iter_mut().zip(colours) {
            block.colour = colour.expect("a colour");
        }
        self.blocks.sort_by_key(|block| (block.colour, block.bodies));
        self.colours = self.blocks.iter().map(|block| (block.bodies, block.colour)).collect();
    }
}

fn hash([a, b]: [usize; 2]) -> u32 {
    let mut x = (a as u32).wrapping_mul(0x9E37_79B9) ^ (b as u32).wrapping_mul(0x85EB_CA6B);
    x = (x ^ (x >> 16)).wrapping_mul(0x85EB_CA6B);
    x = (x ^ (x >> 13)).wrapping_mul(0xC2B2_AE35);
    x ^ (x >> 16)
}

/// Takes impulses over from the last frame (section 11.5).
fn matched(pair: &mut Pair, old: &[Point], rho: f64) {
    let mut is_free = vec![true; old.len()];
    let mut partners: Vec<Option<usize>> = vec![None; pair.points.len()];
    for (point, partner) in pair.points.iter().zip(&mut partners) {
        *partner = (0..old.len()).find(|&k| is_free[k] && old[k].id == point.id);
        partner.iter().for_each(|&k| is_free[k] = false);
    }
    for (point, partner) in pair.points.iter().zip(&mut partners).filter(|(_, partner)| partner.is_none()) {
        let far = |k: usize| old[k].at[0].distance(point.at[0]);
        let free = (0..old.len()).filter(|&k| is_free[k] && far(k) <= 0.1 * rho);
        *partner = free.reduce(|best, k| if far(k) < far(best) { k } else { best });
        partner.iter().for_each(|&k| is_free[k] = false);
    }
    for (point, partner) in pair.points.iter_mut().zip(partners) {
        if let Some(k) = partner {
            (point.normal, point.tangent) = (old[k].normal, old[k].tangent);
        }
    }
}
