//! Rows of contacts: warm start, passes, spare gaps (docs/physics sections 11.7 and 11.8).

use rockfall::glam::{DMat3, DQuat, DVec3};

use super::geometry::{Spot, least};
use super::mistakes::Mistake;
use super::solver::{Point, Solver, State};

/// Numbers of a softened row.
pub(crate) struct Soft {
    pub(crate) mass: f64,
    pub(crate) give: f64,
    pub(crate) rate: f64,
}

/// Softness with the damping ratio z and the angle hw of a substep h.
pub(crate) fn soft(z: f64, hw: f64, h: f64) -> Soft {
    let a1 = 2.0 * z + hw;
    let a2 = hw * a1;
    let a3 = 1.0 / (1.0 + a2);
    Soft { mass: a2 * a3, give: a3, rate: a2 * a3 * (hw / h) / a1 }
}

/// Masses and velocities of two bodies.
pub(crate) struct Sides {
    pub(crate) masses: [f64; 2],
    pub(crate) inverses: [DMat3; 2],
    pub(crate) v: [DVec3; 2],
    pub(crate) w: [DVec3; 2],
}

impl Sides {
    pub(crate) fn slip(&self, arms: [DVec3; 2]) -> DVec3 {
        self.v[1] + self.w[1].cross(arms[1]) - self.v[0] - self.w[0].cross(arms[0])
    }

    /// The velocity of a point by an impulse along d, along e.
    pub(crate) fn k(&self, arms: [DVec3; 2], d: DVec3, e: DVec3) -> f64 {
        let side = |k: usize| self.masses[k] * d.dot(e) + arms[k].cross(d).dot(self.inverses[k] * arms[k].cross(e));
        side(0) + side(1)
    }

    pub(crate) fn push(&mut self, arms: [DVec3; 2], p: DVec3) {
        for (side, p) in [(0, -p), (1, p)] {
            self.v[side] += self.masses[side] * p;
            self.w[side] += self.inverses[side] * arms[side].cross(p);
        }
    }

    /// Friction with the impulse t and the bound `most`; returns the new impulse (section 11.8).
    pub(crate) fn rub(&mut self, arms: [DVec3; 2], n: DVec3, belt: DVec3, t: DVec3, most: f64) -> DVec3 {
        let one = n.any_orthonormal_vector();
        let other = n.cross(one);
        let y = self.slip(arms) + belt;
        let (y1, y2) = (y.dot(one), y.dot(other));
        let [k11, k12, k22] = [(one, one), (one, other), (other, other)].map(|(d, e)| self.k(arms, d, e));
        let det = k11 * k22 - k12 * k12;
        let step = one * ((k22 * y1 - k12 * y2) / det) + other * ((k11 * y2 - k12 * y1) / det);
        let mut to = t - step;
        if to.length() > most {
            let greatest = 0.5 * (k11 + k22) + (0.25 * (k11 - k22).powi(2) + k12 * k12).sqrt();
            to = (t - (one * y1 + other * y2) / greatest).clamp_length_max(most);
        }
        self.push(arms, to - t);
        to
    }
}

impl Solver {
    pub(crate) fn sides(&self, bodies: [usize; 2]) -> Sides {
        let each = bodies.map(|k| &self.bodies[k]);
        Sides {
            masses: each.map(|body| body.inverse_mass()),
            inverses: each.map(|body| body.inverse(body.state.q)),
            v: each.map(|body| body.state.v),
            w: each.map(|body| body.state.w),
        }
    }

    pub(crate) fn put(&mut self, bodies: [usize; 2], sides: &Sides) {
        for (side, k) in bodies.into_iter().enumerate() {
            let body = &mut self.bodies[k];
            if body.has_mass {
                (body.state.v, body.state.w) = (sides.v[side], sides.w[side]);
            }
        }
    }

    /// The impulses of the last substep act again.
    pub(crate) fn warm_start(&mut self) {
        let cold = self.made(Mistake::ColdStart);
        for k in 0..self.blocks.len() {
            let block = &self.blocks[k];
            let (bodies, mut sides) = (block.bodies, self.sides(block.bodies));
            for pair in block.pairs.iter().filter(|_| !block.waits && !cold) {
                for point in pair.points.iter().filter(|point| point.normal > 0.0) {
                    sides.push(point.arms, point.normal * pair.n + point.tangent);
                }
            }
            self.put(bodies, &sides);
        }
    }

    /// Spare gaps of round points (section 11.7).
    pub(crate) fn spare_gaps(&mut self) {
        for k in 0..self.blocks.len() {
            let block = &self.blocks[k];
            if block.waits {
                continue;
            }
            let (sides, left) = (self.sides(block.bodies), block.left);
            let mut spares = Vec::new();
            for (p, pair) in block.pairs.iter().enumerate().filter(|(_, pair)| pair.is_round) {
                for (i, point) in pair.points.iter().enumerate() {
                    let u = -sides.slip(point.arms).dot(pair.n);
                    if point.s > 0.0 && u * left > point.s {
                        spares.push((p, i, self.spare_gap(k, p, point.s, u)));
                    }
                }
            }
            for (p, i, spare) in spares {
                self.blocks[k].pairs[p].points[i].spare = spare;
            }
        }
    }

    /// A body at a time after its velocity has the kick of the whole substep.
    fn kicked_at(&self, k: usize, t: f64) -> State {
        let body = &self.bodies[k];
        let State { x, q, v, w } = body.state;
        let g = if body.has_mass { self.g } else { DVec3::ZERO };
        let x = x + t * v - 0.5 * t * (2.0 * self.h - t) * g;
        State { x, q: DQuat::from_scaled_axis(t * w) * q, v: v - (self.h - t) * g, w }
    }

    fn spare_gap(&self, k: usize, p: usize, s: f64, u: f64) -> f64 {
        let block = &self.blocks[k];
        let (left, rho) = (block.left, self.smaller(block.bodies));
        let start = self.h - left;
        let (mut t, mut lowest) = (0.0, f64::INFINITY);
        for _ in 0..8 {
            let states = block.bodies.map(|body| self.kicked_at(body, start + t));
            let sight = self.sight(&block.pairs[p], states);
            let Some(spot) = least(&sight) else { return 0.0 };
            let closing = approach(states, &spot, sight.n);
            if spot.s < 1e-4 * rho {
                return 0.0;
            }
            lowest = lowest.min(spot.s);
            if closing <= 0.0 {
                break;
            }
            let late = (0.01 * left).min(1e-4 * rho / closing);
            if t + spot.s / closing > left + late {
                lowest = lowest.min(spot.s - closing * (left - t));
                break;
            }
            t = (t + spot.s / closing).min(left);
        }
        (lowest - s + u * left).max(0.0)
    }

    /// Solves all blocks, colour by colour.
    pub(crate) fn pass(&mut self, relax: bool) {
        for k in 0..self.blocks.len() {
            if !self.blocks[k].waits {
                self.solve(k, relax);
            }
        }
    }

    fn solve(&mut self, k: usize, relax: bool) {
        let bodies = self.blocks[k].bodies;
        let is_fixed = bodies.iter().any(|&body| !self.bodies[body].has_mass);
        let soft = soft(10.0, std::f64::consts::TAU * if is_fixed { 0.36 } else { 0.18 }, self.h);
        let mut sides = self.sides(bodies);
        let mut pairs = std::mem::take(&mut self.blocks[k].pairs);
        for point in pairs.iter_mut().flat_map(|pair| &mut pair.points) {
            point.acts = !relax || point.s <= 0.0 || point.normal > 0.0;
        }
        let left = self.blocks[k].left;
        let mu = if self.made(Mistake::SmoothRows) { 0.0 } else { self.mu };
        for _ in 0..2 {
            let (mut change, mut largest) = (0.0_f64, 0.0_f64);
            for chunk in chunks(pairs.iter().map(|pair| pair.points.len().max(usize::from(pair.is_round)))) {
                for pair in &mut pairs[chunk.clone()] {
                    for point in pair.points.iter_mut().filter(|point| point.acts) {
                        let to = self.normal_row(&sides, point, pair.n, relax, left, &soft);
                        sides.push(point.arms, (to - point.normal) * pair.n);
                        change = change.max((to - point.normal).abs());
                        point.normal = to;
                    }
                    largest = pair.points.iter().map(|point| point.normal).fold(largest, f64::max);
                }
                for pair in pairs[chunk].iter_mut().filter(|_| relax) {
                    for point in pair.points.iter_mut().filter(|point| point.normal > 0.0 || point.tangent != DVec3::ZERO) {
                        let to = sides.rub(point.arms, pair.n, point.belt, point.tangent, mu * point.normal);
                        change = change.max((to - point.tangent).length());
                        point.tangent = to;
                    }
                }
            }
            if change <= 1e-3 * largest {
                break;
            }
        }
        self.blocks[k].pairs = pairs;
        self.put(bodies, &sides);
    }

    /// The new impulse of a normal row.
    fn normal_row(&self, sides: &Sides, point: &Point, n: DVec3, relax: bool, left: f64, soft: &Soft) -> f64 {
        let (rate, k) = (sides.slip(point.arms).dot(n), sides.k(point.arms, n, n));
        let push = if self.made(Mistake::NoPush) { 0.0 } else { (soft.rate * point.s).max(-3.0) };
        let change = if relax {
            -rate / k
        } else if point.s <= 0.0 {
            -(soft.mass * rate + push) / k - soft.give * point.normal
        } else if self.made(Mistake::NoGap) {
            -rate / k
        } else {
            -(rate + (point.s + point.spare) / left) / k
        };
        (point.normal + change).max(0.0)
    }
}

/// The speed at which both bodies approach at a point of a pose.
pub(crate) fn approach(states: [State; 2], spot: &Spot, n: DVec3) -> f64 {
    -slip(states, arms_at(states, spot)).dot(n)
}

/// The levers of a point (section 11.4).
pub(crate) fn arms_at(states: [State; 2], spot: &Spot) -> [DVec3; 2] {
    let c = 0.5 * (spot.on[0] + spot.on[1]);
    [c, c - (states[1].x - states[0].x)]
}

pub(crate) fn slip([a, b]: [State; 2], arms: [DVec3; 2]) -> DVec3 {
    b.v + b.w.cross(arms[1]) - a.v - a.w.cross(arms[0])
}

/// Ranges of pairs that are read together: at most 4 points, a pair as a whole.
pub(crate) fn chunks(rooms: impl Iterator<Item = usize>) -> Vec<std::ops::Range<usize>> {
    let mut found: Vec<std::ops::Range<usize>> = Vec::new();
    let mut full = 0;
    for (at, room) in rooms.enumerate() {
        match found.last_mut() {
            Some(last) if full + room <= 4 => {
                last.end = at + 1;
                full += room;
            }
            _ => {
                found.push(at..at + 1);
                full = room;
            }
        }
    }
    found
}
