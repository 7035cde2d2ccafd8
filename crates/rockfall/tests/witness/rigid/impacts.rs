//! Impacts (docs/physics section 11.7).

use rockfall::glam::DVec3;

use super::geometry::{Sight, Spot, least};
use super::mistakes::Mistake;
use super::rows::{Sides, approach, arms_at};
use super::solver::{Solver, State};

/// A hit of a block: the time of its impact in the substep, its depth, and whether all hit points were near at the start.
struct Hit {
    time: f64,
    depth: f64,
    is_near: bool,
}

/// A point of a block at the time from which hits are sought.
struct Sought {
    pair: usize,
    spot: Spot,
    /// Approach speed, and the acceleration with which it grows.
    u: f64,
    a: f64,
    /// By how much a hit may be late.
    late: f64,
}

impl Solver {
    pub(crate) fn impacts(&mut self) {
        let mut any = false;
        self.blocks.iter_mut().for_each(|block| block.waits = false);
        for _ in 0..2 {
            for k in 0..self.blocks.len() {
                if let Some(hit) = self.hit(k) {
                    any |= self.reflect(k, &hit);
                }
            }
        }
        for k in 0..self.blocks.len() {
            if any && self.hit(k).is_some_and(|hit| hit.is_near) {
                self.blocks[k].waits = true;
                for point in self.blocks[k].pairs.iter_mut().flat_map(|pair| &mut pair.points) {
                    (point.normal, point.tangent) = (0.0, DVec3::ZERO);
                }
            }
        }
        for k in 0..self.blocks.len() {
            self.clocked_rows(k);
        }
    }

    fn field(&self, k: usize) -> DVec3 {
        if self.bodies[k].has_mass { self.g } else { DVec3::ZERO }
    }

    fn at(&self, bodies: [usize; 2], t: f64) -> [State; 2] {
        bodies.map(|k| {
            let state = self.bodies[k].at(t, self.g);
            State { v: state.v + self.error_of(state.v), w: state.w + self.error_of(state.w), ..state }
        })
    }

    fn hit(&self, k: usize) -> Option<Hit> {
        let block = &self.blocks[k];
        let [a, b] = block.bodies.map(|k| &self.bodies[k]);
        let (h, rho, field) = (self.h, self.smaller(block.bodies), self.g.length());
        let least_speed = if self.e > 0.0 { 0.0 } else { 0.1 * rho / h };
        let is_fixed = !a.has_mass || !b.has_mass;
        let bound = 1.5 * ((b.state.v - a.state.v).length() + a.rim() + b.rim()) + if is_fixed { field * h } else { 0.0 };
        if bound <= least_speed.max(field * h) {
            return None;
        }
        let start = a.clock.max(b.clock);
        let left = h - start;
        let states = self.at(block.bodies, start);
        let acceleration = self.field(block.bodies[1]) - self.field(block.bodies[0]);
        let (mut first, mut depth, mut is_near) = (f64::INFINITY, 0.0_f64, true);
        for (pair, sight) in block.pairs.iter().map(|pair| self.sight(pair, states)).enumerate() {
            for &spot in &sight.spots {
                let (u, a) = (approach(states, &spot, sight.n), -acceleration.dot(sight.n));
                if u <= least_speed || u + a.max(0.0) * left <= field * h {
                    continue;
                }
                let sought = Sought { pair, spot, u, a, late: (0.01 * left).min(1e-4 * rho / u) };
                let found = if block.pairs[pair].is_round {
                    self.search(k, &sought, start)
                } else {
                    self.root(&sought, left).map(|t| (t, u))
                };
                if let Some((t, touching)) = found {
                    first = first.min(t.min(left));
                    depth = depth.max((touching + 0.5 * a.abs() * h) * h);
                    is_near &= spot.s > -2.0 * u * h;
                }
            }
        }
        (first < f64::INFINITY).then(|| Hit { time: (start + first).min((1.0 - 1e-6) * h), depth, is_near })
    }

    /// The time of the hit of a point that is not round.
    fn root(&self, sought: &Sought, left: f64) -> Option<f64> {
        let (u, a, s) = (sought.u, sought.a, sought.spot.s);
        let least = self.g.length() * self.h;
        if s <= 0.0 {
            return (u > least).then_some(0.0);
        }
        let square = u * u + 2.0 * a * s;
        let t = 2.0 * s / (u + square.max(0.0).sqrt());
        (square >= 0.0 && t >= 0.0 && t <= left + sought.late && u + a * t > least).then_some(t)
    }

    /// The time of the hit of a round point, and its speed there.
    fn search(&self, k: usize, sought: &Sought, start: f64) -> Option<(f64, f64)> {
        let block = &self.blocks[k];
        let (rho, left, late) = (self.smaller(block.bodies), self.h - start, sought.late);
        let least_speed = self.g.length() * self.h;
        let (u, s, grows) = (sought.u, sought.spot.s, sought.a.max(0.0));
        if s - u * (left + late) - 0.5 * grows * left * left > 0.0 {
            return None;
        }
        let is_hidden = |states: [State; 2]| {
            let sights = self.sights(block, states);
            sights[sought.pair].hidden_by.is_some()
        };
        if s <= 0.0 {
            return (u > least_speed && !is_hidden(self.at(block.bodies, start))).then_some((0.0, u));
        }
        let mut t = 0.0;
        for _ in 0..8 {
            let states = self.at(block.bodies, start + t);
            let sight = self.sight(&block.pairs[sought.pair], states);
            let spot = least(&sight)?;
            let u = approach(states, &spot, sight.n);
            if spot.s < 1e-4 * rho {
                return (u > least_speed && !is_hidden(states)).then_some((t, u));
            }
            if u <= 0.0 || t + spot.s / u > left + late {
                return None;
            }
            t = (t + spot.s / u).min(left);
        }
        None
    }

    /// Reflects a block.
    fn reflect(&mut self, k: usize, hit: &Hit) -> bool {
        let block = &self.blocks[k];
        let (bodies, g, time) = (block.bodies, self.g, hit.time);
        let states = self.at(bodies, time);
        let sights = self.sights(block, states);
        let mut sides = Sides {
            masses: bodies.map(|k| self.bodies[k].inverse_mass()),
            inverses: [0, 1].map(|side| self.bodies[bodies[side]].inverse(states[side].q)),
            v: states.map(|state| state.v),
            w: states.map(|state| state.w),
        };
        let mut points: Vec<(DVec3, [DVec3; 2], DVec3)> = Vec::new();
        for (pair, Sight { n, spots, .. }) in block.pairs.iter().zip(&sights).filter(|(_, sight)| sight.hidden_by.is_none()) {
            let belt = self.belt(pair, states);
            points.extend(spots.iter().filter(|spot| spot.s <= hit.depth).map(|spot| (*n, arms_at(states, spot), belt)));
        }
        let Some(impulses) = self.bounced(&mut sides, &points) else { return false };
        self.impacts += 1;
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let State { x, q, .. } = states[side];
            let body = &mut self.bodies[bodies[side]];
            if !body.has_mass {
                continue;
            }
            let moments: DVec3 = points.iter().zip(&impulses).map(|((_, arms, _), p)| arms[side].cross(sign * *p)).sum();
            body.l += moments;
            let v = sides.v[side];
            if self.mistake != Some(Mistake::KeptPlace) {
                body.state.x = x - (time * v - 0.5 * time * time * g);
                body.state.q = body.turned(q, body.l, -time);
            }
            body.state.v = v - time * g;
            body.state.w = body.inverse(body.state.q) * body.l;
            body.clock = time;
        }
        true
    }

    /// The impulses of points with normals, levers and surface velocities.
    fn bounced(&self, sides: &mut Sides, points: &[(DVec3, [DVec3; 2], DVec3)]) -> Option<Vec<DVec3>> {
        let speeds = |sides: &Sides| -> Vec<f64> { points.iter().map(|(n, arms, _)| -sides.slip(*arms).dot(*n)).collect() };
        let before = speeds(sides);
        let (v, w) = (sides.v, sides.w);
        let mut lambda = vec![0.0; points.len()];
        for _ in 0..16 {
            for (k, (n, arms, _)) in points.iter().enumerate() {
                let u = -sides.slip(*arms).dot(*n);
                let to = (lambda[k] + u / sides.k(*arms, *n, *n)).max(0.0);
                sides.push(*arms, (to - lambda[k]) * *n);
                lambda[k] = to;
            }
        }
        let after = speeds(sides);
        let d: f64 = (0..points.len()).map(|k| lambda[k] * (before[k] - after[k])).sum();
        let whole: f64 = lambda.iter().zip(&before).map(|(one, u)| one * u).sum();
        if d <= 0.0 || d.is_nan() {
            return None;
        }
        let e = if self.made(Mistake::HalfRestitution) { 0.5 * self.e } else { self.e };
        let mu = if self.made(Mistake::SmoothImpacts) { 0.0 } else { self.mu };
        (sides.v, sides.w) = (v, w);
        let normals: Vec<f64> = lambda.iter().map(|one| (1.0 + e) * whole / d * one).collect();
        for ((n, arms, _), normal) in points.iter().zip(&normals) {
            sides.push(*arms, *normal * *n);
        }
        let mut tangents = vec![DVec3::ZERO; points.len()];
        for _ in 0..4 {
            for (k, (n, arms, belt)) in points.iter().enumerate().filter(|(k, _)| normals[*k] > 0.0) {
                tangents[k] = sides.rub(*arms, *n, *belt, tangents[k], mu * normals[k]);
            }
        }
        Some((0..points.len()).map(|k| normals[k] * points[k].0 + tangents[k]).collect())
    }

    /// Rows of a block of which a body has a clock.
    fn clocked_rows(&mut self, k: usize) {
        let bodies = self.blocks[k].bodies;
        let start = self.bodies[bodies[0]].clock.max(self.bodies[bodies[1]].clock);
        if start <= 0.0 {
            return;
        }
        let (now, then) = (self.states(bodies), self.at(bodies, start));
        let (d0, d) = (now[1].x - now[0].x, then[1].x - then[0].x);
        self.take(k, then, self.h - start);
        let has_mass = bodies.map(|k| self.bodies[k].has_mass);
        for point in self.blocks[k].pairs.iter_mut().flat_map(|pair| &mut pair.points) {
            let (on_a, on_b) = (point.arms[0], d0 + (point.arms[1] - d));
            let c = match has_mass {
                [false, _] => on_b,
                [_, false] => on_a,
                _ => 0.5 * (on_a + on_b),
            };
            point.arms = [c, c - d0];
        }
    }
}
