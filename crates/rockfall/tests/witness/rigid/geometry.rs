//! The geometry of blocks in a pose, and their refresh (docs/physics section 11.4).

use rockfall::glam::DVec3;

use super::mistakes::Mistake;
use super::solver::{Block, Pair, Point, Solver, State};

/// A point in a pose, seen from the centre of body a.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    /// In coordinates of the bodies.
    pub(crate) at: [DVec3; 2],
    pub(crate) id: u32,
    pub(crate) on: [DVec3; 2],
    pub(crate) s: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct Sight {
    pub(crate) n: DVec3,
    pub(crate) spots: Vec<Spot>,
    /// The place of a ball that hides this one.
    pub(crate) hidden_by: Option<usize>,
}

impl Solver {
    /// A pair in a pose.
    pub(crate) fn sight(&self, pair: &Pair, states: [State; 2]) -> Sight {
        let found = if pair.is_round { self.manifold(pair.colliders, states, f64::INFINITY) } else { None };
        let [a, b] = states;
        let size = self.blunt(pair);
        let spot = |(at, on, id): ([DVec3; 2], [DVec3; 2], u32), n: DVec3| {
            let on = [on[0] + self.errors(size), on[1] + self.errors(size)];
            Spot { at, id, on, s: (on[1] - on[0]).dot(n) }
        };
        let spots = |n: DVec3, all: Vec<([DVec3; 2], [DVec3; 2], u32)>| all.into_iter().map(|one| spot(one, n)).collect();
        if let Some(seen) = found {
            let all = seen.places.iter().map(|&(on, id)| (self.local(states, on), on, id)).collect();
            return Sight { n: seen.n, spots: spots(seen.n, all), hidden_by: None };
        }
        let n = a.q * pair.local;
        let on = |point: &Point| [a.q * point.at[0], b.x - a.x + b.q * point.at[1]];
        Sight { n, spots: spots(n, pair.points.iter().map(|point| (point.at, on(point), point.id)).collect()), hidden_by: None }
    }

    /// All pairs of a block in a pose, with the places of balls that others hide.
    pub(crate) fn sights(&self, block: &Block, states: [State; 2]) -> Vec<Sight> {
        let mut sights: Vec<Sight> = block.pairs.iter().map(|pair| self.sight(pair, states)).collect();
        if self.bodies[block.bodies[0]].has_mass {
            return sights;
        }
        let ball = |k: usize| block.pairs[k].colliders[1];
        // Static balls neither hide nor are hidden (section 11.12).
        let is_ball = |k: usize| self.colliders[k].shape.is_ball();
        let radius = |k: usize| self.colliders[ball(k)].shape.radius;
        let mut places: Vec<(f64, usize)> = (0..sights.len())
            .filter(|&k| is_ball(ball(k)) && !is_ball(block.pairs[k].colliders[0]))
            .filter(|&k| !sights[k].spots.is_empty())
            .map(|k| (sights[k].spots[0].s + radius(k), k))
            .collect();
        places.sort_by(|one, other| one.0.total_cmp(&other.0));
        for later in 0..places.len() {
            let (d, j) = places[later];
            let hides = |&&(least, i): &&(f64, usize)| {
                let product = sights[j].n.dot(sights[i].n);
                let behind = d * product >= least - 1e-5 * radius(j);
                ball(i) == ball(j) && sights[i].hidden_by.is_none() && (behind || product >= 0.99995)
            };
            sights[j].hidden_by = places[..later].iter().find(hides).map(|&(_, i)| i);
        }
        sights
    }

    /// Velocity of the surfaces of a pair against each other.
    pub(crate) fn belt(&self, pair: &Pair, states: [State; 2]) -> DVec3 {
        let [a, b] = [0, 1].map(|side| states[side].q * self.colliders[pair.colliders[side]].belt);
        b - a
    }

    /// Takes the geometry of a block in the present pose.
    pub(crate) fn refresh(&mut self, k: usize) {
        let bodies = self.blocks[k].bodies;
        let states = self.states(bodies);
        self.take(k, states, self.h);
        let two_points = self.made(Mistake::TwoPoints);
        let d = states[1].x - states[0].x;
        for point in self.blocks[k].pairs.iter_mut().flat_map(|pair| &mut pair.points) {
            let [on_a, on_b] = point.arms;
            let c = 0.5 * (on_a + on_b);
            point.arms = if two_points { [on_a, on_b - d] } else { [c, c - d] };
        }
    }

    /// The size of the coordinates by whose differences gaps are found.
    fn blunt(&self, pair: &Pair) -> f64 {
        let sizes = pair.colliders.map(|k| {
            let body = &self.bodies[self.colliders[k].body];
            body.state.x.abs().max_element() + if body.rho.is_finite() { body.rho } else { 0.0 }
        });
        sizes[0].max(sizes[1])
    }

    /// Takes normals, gaps and surface velocities of a block in a pose, and carries impulses over. `arms` become the places on
    /// both surfaces, seen from the centre of a.
    pub(crate) fn take(&mut self, k: usize, states: [State; 2], left: f64) {
        let sights = self.sights(&self.blocks[k], states);
        let mut pairs = std::mem::take(&mut self.blocks[k].pairs);
        let mut given = Vec::new();
        for (pair, sight) in pairs.iter_mut().zip(&sights) {
            let belt = self.belt(pair, states);
            let same = pair.points.len() == 1 && sight.spots.len() == 1;
            let before = |id: u32| pair.points.iter().find(|point| same || point.id == id).copied();
            let mut points: Vec<Point> = sight.spots.iter().map(|spot| fresh(before(spot.id), spot, sight.n, belt)).collect();
            if pair.is_round {
                pair.local = states[0].q.inverse() * sight.n;
            }
            if let Some(by) = sight.hidden_by {
                // As they were: nothing is projected on the tangents of a place without points.
                pair.points.drain(..).for_each(|point| given.push((by, point)));
                points.clear();
            }
            (pair.n, pair.points) = (sight.n, points);
        }
        for (by, given) in given {
            let (n, point) = (pairs[by].n, &mut pairs[by].points[0]);
            point.normal += given.normal;
            point.tangent += given.tangent - n * n.dot(given.tangent);
        }
        self.blocks[k].pairs = pairs;
        self.blocks[k].left = left;
    }

    pub(crate) fn refresh_all(&mut self) {
        (0..self.blocks.len()).for_each(|k| self.refresh(k));
        self.refresh_links();
    }
}

/// A point in a new pose, with the impulses of an old one.
fn fresh(before: Option<Point>, spot: &Spot, n: DVec3, belt: DVec3) -> Point {
    let (normal, tangent) = before.map_or((0.0, DVec3::ZERO), |old| (old.normal, old.tangent));
    Point { normal, tangent: tangent - n * n.dot(tangent), s: spot.s, arms: spot.on, belt, ..Point::new(spot.at, spot.id) }
}

/// The least gap of a sight.
pub(crate) fn least(sight: &Sight) -> Option<Spot> {
    sight.spots.iter().copied().reduce(|best, spot| if spot.s < best.s { spot } else { best })
}
