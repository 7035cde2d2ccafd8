//! The two sides of a contact: their motion, and the effect of an impulse on them (docs/physics section 3).

use rockfall::glam::DVec3;

use crate::geometry::{Line, Pair, Thing};
use crate::world::{Body, Mistake, World};

/// Velocities and angular momenta of all spheres, or changes of them.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub(crate) v: Vec<DVec3>,
    pub(crate) l: Vec<DVec3>,
}

impl Motion {
    pub(crate) fn none(world: &World) -> Self {
        let zeros = vec![DVec3::ZERO; world.balls.len()];
        Self { v: zeros.clone(), l: zeros }
    }

    pub(crate) fn of(world: &World) -> Self {
        let balls = world.balls.iter();
        Self { v: balls.clone().map(|ball| ball.v).collect(), l: balls.map(|ball| ball.l).collect() }
    }

    pub(crate) fn add(&mut self, other: &Self, times: f64) {
        for (own, other) in [(&mut self.v, &other.v), (&mut self.l, &other.l)] {
            own.iter_mut().zip(other).for_each(|(one, other)| *one += times * *other);
        }
    }
}

/// A rigid capsule at the present positions of its ends (docs/physics section 3.3).
pub(crate) struct Rigid {
    pub(crate) ends: [usize; 2],
    pub(crate) d: DVec3,
    pub(crate) m: [f64; 2],
    pub(crate) i: [f64; 2],
    pub(crate) mass: f64,
    pub(crate) mu: f64,
    /// Moment of inertia perpendicular to the axis.
    pub(crate) it: f64,
}

impl Rigid {
    pub(crate) fn of(world: &World, bar: usize) -> Self {
        let ends = world.bars[bar].ends;
        let (m, i) = (ends.map(|end| world.balls[end].mass), ends.map(|end| world.balls[end].inertia()));
        let d = world.balls[ends[1]].x - world.balls[ends[0]].x;
        let mass = m[0] + m[1];
        let mu = m[0] * m[1] / mass;
        Self { ends, d, m, i, mass, mu, it: mu * d.length_squared() + i[0] + i[1] }
    }

    pub(crate) fn across(&self, y: DVec3) -> DVec3 {
        y - self.d * (self.d.dot(y) / self.d.length_squared())
    }

    pub(crate) fn centre_velocity(&self, motion: &Motion) -> DVec3 {
        (self.m[0] * motion.v[self.ends[0]] + self.m[1] * motion.v[self.ends[1]]) / self.mass
    }

    /// Angular velocity perpendicular to the axis.
    pub(crate) fn turning(&self, motion: &Motion) -> DVec3 {
        let q = motion.v[self.ends[1]] - motion.v[self.ends[0]];
        let spins = motion.l[self.ends[0]] + motion.l[self.ends[1]];
        self.across(self.mu * self.d.cross(q) + spins) / self.it
    }

    /// Torque of an impulse `p` at a parameter of the axis.
    pub(crate) fn torque(&self, at: f64, p: DVec3) -> DVec3 {
        (at - self.m[1] / self.mass) * self.d.cross(p)
    }

    /// Changes by an impulse `p`, a torque perpendicular to the axis, and a torque `roll` along it.
    pub(crate) fn give(&self, p: DVec3, torque: DVec3, roll: DVec3, change: &mut Motion) {
        let (dv, turning) = (p / self.mass, torque / self.it);
        let [one, two] = self.ends;
        change.v[one] += dv - self.m[1] / self.mass * turning.cross(self.d);
        change.v[two] += dv + self.m[0] / self.mass * turning.cross(self.d);
        for (end, i) in self.ends.into_iter().zip(self.i) {
            change.l[end] += i * (turning + roll / (self.i[0] + self.i[1]));
        }
    }
}

/// One side of a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    pub(crate) thing: Thing,
    /// Parameter of the contact on a rod.
    pub(crate) at: f64,
    /// -1 on A, 1 on B: the impulse on this side is along `sign` n.
    pub(crate) sign: f64,
}

pub(crate) fn sides(pair: &Pair, line: &Line) -> [Side; 2] {
    let side = |k: usize, thing, sign| Side { thing, at: line.at[k], sign };
    [side(0, pair.a, -1.0), side(1, pair.b, 1.0)]
}

impl World {
    /// The spheres of a side and their shares.
    pub(crate) fn shares(&self, side: Side) -> Vec<(usize, f64)> {
        match side.thing {
            Thing::Ball(ball) => vec![(ball, 1.0)],
            Thing::Bar(bar) => {
                let [one, two] = self.bars[bar].ends;
                let at = if self.made(Mistake::RodShares) { 1.0 - side.at } else { side.at };
                vec![(one, 1.0 - at), (two, at)]
            }
            Thing::Block(_) | Thing::Face(_) => Vec::new(),
        }
    }

    /// The capsule that a side belongs to, and the parameter of the contact on its axis.
    pub(crate) fn capsule_of(&self, side: Side) -> Option<(Rigid, f64)> {
        match side.thing {
            Thing::Ball(ball) => self.capsule_end(ball).map(|(bar, end)| (Rigid::of(self, bar), end as f64)),
            Thing::Bar(bar) if self.is_capsule(bar) => Some((Rigid::of(self, bar), side.at)),
            _ => None,
        }
    }

    /// Whether the motion of a sphere counts. That of a fixed sphere counts as the surface of the sphere itself, but
    /// not as the end of a rod (docs/physics section 2.2).
    fn counts(&self, side: Side, ball: usize) -> bool {
        !self.balls[ball].fixed || matches!(side.thing, Thing::Ball(_)) || self.made(Mistake::FixedEnds)
    }

    /// Velocity of the contact point of a side, from the velocities of its spheres (2.7).
    pub(crate) fn velocity(&self, side: Side, motion: &Motion) -> DVec3 {
        let counting = self.shares(side).into_iter().filter(|&(ball, _)| self.counts(side, ball));
        counting.map(|(ball, share)| share * motion.v[ball]).sum()
    }

    /// Spin of a side, from the spins of its spheres (2.7).
    pub(crate) fn spin(&self, side: Side, motion: &Motion) -> DVec3 {
        let counting = self.shares(side).into_iter().filter(|&(ball, _)| self.counts(side, ball));
        counting.map(|(ball, share)| share * motion.l[ball] / self.balls[ball].inertia()).sum()
    }

    /// Approach velocity as in docs/physics section 3.2: capsules move as rigid bodies.
    pub(crate) fn approach(&self, pair: &Pair, line: &Line, motion: &Motion) -> f64 {
        let along = |side: Side| match self.capsule_of(side) {
            Some((rigid, at)) if !self.made(Mistake::CapsuleTorque) => {
                rigid.centre_velocity(motion).dot(line.n) + rigid.torque(at, line.n).dot(rigid.turning(motion))
            }
            _ => self.velocity(side, motion).dot(line.n),
        };
        let [a, b] = sides(pair, line);
        along(a) - along(b)
    }

    /// Changes by an impulse `p` on a side, before the projection of networks.
    pub(crate) fn give(&self, side: Side, p: DVec3, change: &mut Motion) {
        match self.capsule_of(side) {
            Some((rigid, at)) => {
                let turns = if self.made(Mistake::CapsuleTorque) { 0.0 } else { 1.0 };
                rigid.give(p, turns * rigid.torque(at, p), DVec3::ZERO, change);
            }
            None => {
                for (ball, share) in self.shares(side) {
                    change.v[ball] += share * self.balls[ball].w() * p;
                }
            }
        }
    }

    /// Changes by a unit impulse of a contact, with networks projected.
    pub(crate) fn unit(&self, pair: &Pair, line: &Line) -> Motion {
        let mut change = Motion::none(self);
        for side in sides(pair, line) {
            self.give(side, side.sign * line.n, &mut change);
        }
        self.project(&mut change);
        change
    }

    /// Inverse mass of a side along a unit vector, before the projection of networks.
    pub(crate) fn unprojected(&self, side: Side, n: DVec3) -> f64 {
        match self.capsule_of(side) {
            Some((rigid, at)) => 1.0 / rigid.mass + rigid.torque(at, n).length_squared() / rigid.it,
            None => self.shares(side).into_iter().map(|(ball, share)| share * share * self.balls[ball].w()).sum(),
        }
    }

    /// The bodies of a side, each once, with their inverse masses for a unit impulse along n.
    pub(crate) fn bodies(&self, side: Side, n: DVec3) -> Vec<(Body, f64)> {
        if let Some((rigid, _)) = self.capsule_of(side) {
            return self.body[rigid.ends[0]].map(|body| (body, self.unprojected(side, n))).into_iter().collect();
        }
        let shares = self.shares(side);
        let mut bodies: Vec<Body> = shares.iter().filter_map(|&(ball, _)| self.body[ball]).collect();
        bodies.dedup();
        let through = |body: Body| self.along(body, side, n, &self.pushed(body, side, n));
        bodies.into_iter().map(|body| (body, through(body))).collect()
    }

    /// Changes of a body that is not a capsule by a unit impulse along n on a side.
    pub(crate) fn pushed(&self, body: Body, side: Side, n: DVec3) -> Motion {
        let mut change = Motion::none(self);
        for (ball, share) in self.shares(side).into_iter().filter(|&(ball, _)| self.body[ball] == Some(body)) {
            change.v[ball] += share * self.balls[ball].w() * n;
        }
        self.project(&mut change);
        change
    }

    /// The velocity along n that a side gets through a body that is not a capsule.
    pub(crate) fn along(&self, body: Body, side: Side, n: DVec3, change: &Motion) -> f64 {
        let own = self.shares(side).into_iter().filter(|&(ball, _)| self.body[ball] == Some(body));
        own.map(|(ball, share)| share * change.v[ball].dot(n)).sum()
    }

    /// The bodies of both sides. A body on both sides appears twice.
    pub(crate) fn touched(&self, pair: &Pair, line: &Line) -> Vec<Body> {
        sides(pair, line).into_iter().flat_map(|side| self.bodies_of(side)).collect()
    }

    /// The bodies of a side, each once.
    pub(crate) fn bodies_of(&self, side: Side) -> Vec<Body> {
        let mut found: Vec<Body> = self.shares(side).iter().filter_map(|&(ball, _)| self.body[ball]).collect();
        found.dedup();
        found
    }

    /// Projects the velocity changes of all networks (docs/physics section 3.4).
    pub(crate) fn project(&self, change: &mut Motion) {
        if self.made(Mistake::NoProjection) {
            return;
        }
        for rods in &self.networks {
            self.project_network(rods, &mut change.v);
        }
    }

    fn project_network(&self, rods: &[usize], v: &mut [DVec3]) {
        let moving = |bar: usize, end: usize| !self.balls[self.bars[bar].ends[end]].fixed;
        if !rods.iter().any(|&bar| self.bars[bar].ends.iter().any(|&end| v[end] != DVec3::ZERO)) {
            return;
        }
        let axes: Vec<DVec3> = rods
            .iter()
            .map(|&bar| {
                let [one, two] = self.ends(bar);
                (two - one).normalize_or_zero()
            })
            .collect();
        // Signed directions at the moving ends of a rod.
        let rows: Vec<Vec<(usize, DVec3)>> = rods
            .iter()
            .zip(&axes)
            .map(|(&bar, &axis)| {
                let ends = [0, 1].into_iter().filter(|&end| moving(bar, end));
                ends.map(|end| (self.bars[bar].ends[end], if end == 0 { -axis } else { axis })).collect()
            })
            .collect();
        let opening: Vec<f64> = rows.iter().map(|row| row.iter().map(|&(ball, along)| along.dot(v[ball])).sum()).collect();
        let matrix: Vec<Vec<f64>> = rows
            .iter()
            .map(|row| {
                let with = |other: &Vec<(usize, DVec3)>| {
                    let pairs = row.iter().flat_map(|one| other.iter().map(move |two| (one, two)));
                    pairs.filter(|(one, two)| one.0 == two.0).map(|(one, two)| self.balls[one.0].w() * one.1.dot(two.1)).sum()
                };
                rows.iter().map(with).collect()
            })
            .collect();
        for (row, tension) in rows.iter().zip(solve(matrix, opening)) {
            for &(ball, along) in row {
                v[ball] -= self.balls[ball].w() * tension * along;
            }
        }
    }
}

/// Solves a symmetric, positive semidefinite system that has a solution. The largest pivot comes first. When all
/// remaining pivots are rounding errors, their rods are redundant.
fn solve(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let count = right.len();
    let largest = (0..count).map(|k| matrix[k][k]).fold(0.0, f64::max);
    let mut order: Vec<usize> = Vec::new();
    let mut left: Vec<usize> = (0..count).collect();
    while let Some(place) = (0..left.len()).max_by(|&p, &q| matrix[left[p]][left[p]].total_cmp(&matrix[left[q]][left[q]])) {
        let pivot = left[place];
        if matrix[pivot][pivot] <= 1e-11 * largest {
            break;
        }
        left.remove(place);
        for &row in &left {
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            for &column in &left {
                let taken = factor * matrix[pivot][column];
                matrix[row][column] -= taken;
            }
            right[row] -= factor * right[pivot];
        }
        order.push(pivot);
    }
    // Rows of earlier pivots are not updated any more, so `matrix[pivot][later]` has its value from when the pivot was
    // chosen.
    let mut solution = vec![0.0; count];
    for (place, &pivot) in order.iter().enumerate().rev() {
        let known: f64 = order[place + 1..].iter().map(|&later| matrix[pivot][later] * solution[later]).sum();
        solution[pivot] = (right[pivot] - known) / matrix[pivot][pivot];
    }
    solution
}
