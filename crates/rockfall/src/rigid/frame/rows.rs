//! Rows of a block: normal impulses and the friction cone (docs/physics section 11.8).

use glam::{Vec2, Vec3A};

use crate::rigid::frame::bodies::{Mass, Motion};
use crate::rigid::frame::contacts::{Along, Block, Impulse, Lever, Pair, Row, View};

/// Greatest speed at which an overlap is pushed out, in units/s.
const PUSH_OUT: f32 = 3.0;
/// Inner sweeps over the points of a block.
const SWEEPS: usize = 2;
/// A sweep that changes impulses by less than this share of the largest one is the last.
const CALM: f32 = 1e-3;

/// How soft rows are in the biased pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Softness {
    /// Speed per overlap, times the share of the mass.
    pub(super) rate: f32,
    /// Share of the mass.
    pub(super) mass: f32,
    /// Share of the impulse that is given back.
    pub(super) impulse: f32,
}

impl Softness {
    /// Of a frequency times the substep, with the damping ratio of contacts.
    pub(super) fn new(frequency_h: f32, h: f32) -> Self {
        Self::of(frequency_h, 10.0, h)
    }

    /// Of a frequency times the substep and a damping ratio.
    pub(super) fn of(frequency_h: f32, damping: f32, h: f32) -> Self {
        let turn = std::f32::consts::TAU * frequency_h;
        let first = 2.0 * damping + turn;
        let second = turn * first;
        let third = 1.0 / (1.0 + second);
        let mass = second * third;
        Self { rate: mass * (turn / h) / first, mass, impulse: third }
    }
}

/// A pass over the rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// With softness and speculation; the other pass relaxes.
    pub(super) biased: bool,
    /// Between bodies with mass, and with a side without mass.
    pub(super) softness: [Softness; 2],
}

/// The two bodies of a block while it is solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides<'a> {
    pub(super) a: Motion,
    pub(super) b: Motion,
    pub(super) mass_a: &'a Mass,
    pub(super) mass_b: &'a Mass,
}

impl Sides<'_> {
    /// Velocity of b relative to a at a row.
    #[inline(always)]
    pub(super) fn closing(&self, row: &Row) -> Vec3A {
        self.b.at(row.arm_b) - self.a.at(row.arm_a)
    }

    /// Forms the lever of a row, unless that is done.
    #[inline(always)]
    fn form_once(&self, pair: &Pair, row: &mut Row, lever: &mut Lever) {
        if !row.formed {
            row.formed = true;
            self.form(pair, row, lever);
        }
    }

    /// Forms K of a row and what its impulses do.
    #[inline(never)]
    pub(super) fn form(&self, pair: &Pair, row: &Row, lever: &mut Lever) {
        let directions = [pair.normal, pair.tangents[0], pair.tangents[1]];
        lever.along = directions.map(|along| {
            let [turn_a, turn_b] = [row.arm_a.cross(along), row.arm_b.cross(along)];
            Along {
                turn_a,
                turn_b,
                response_a: self.mass_a.inverse_inertia * turn_a,
                response_b: self.mass_b.inverse_inertia * turn_b,
            }
        });
        let linear = self.mass_a.inverse_mass + self.mass_b.inverse_mass;
        let turning = |i: usize, j: usize| {
            let (one, other) = (&lever.along[i], &lever.along[j]);
            one.turn_a.dot(other.response_a) + one.turn_b.dot(other.response_b)
        };
        let (xx, xy, yy) = (linear + turning(1, 1), turning(1, 2), linear + turning(2, 2));
        let scale = 1.0 / (xx * yy - xy * xy);
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        lever.inverse_normal = 1.0 / (linear + turning(0, 0));
        lever.inverse_tangent = [yy * scale, -xy * scale, xx * scale];
        lever.inverse_slip = 1.0 / (mean + (half * half + xy * xy).sqrt());
    }

    /// Velocity of b relative to a along a direction of a formed row.
    #[inline(always)]
    fn speed(&self, along: Vec3A, turn: &Along) -> f32 {
        // One sum in lanes instead of three.
        let lanes = along * (self.b.velocity - self.a.velocity) + (turn.turn_b * self.b.spin - turn.turn_a * self.a.spin);
        lanes.element_sum()
    }

    /// An impulse along a direction of a formed row: on b, and its opposite on a.
    #[inline(always)]
    fn push_along(&mut self, along: Vec3A, turn: &Along, impulse: f32) {
        self.a.velocity -= (impulse * self.mass_a.inverse_mass) * along;
        self.a.spin -= impulse * turn.response_a;
        self.b.velocity += (impulse * self.mass_b.inverse_mass) * along;
        self.b.spin += impulse * turn.response_b;
    }

    /// An impulse along the normal of a formed row.
    pub(super) fn push(&mut self, pair: &Pair, lever: &Lever, impulse: f32) {
        self.push_along(pair.normal, &lever.along[0], impulse);
    }

    /// Speed along the normal of a formed row.
    pub(super) fn normal_speed(&self, pair: &Pair, lever: &Lever) -> f32 {
        self.speed(pair.normal, &lever.along[0])
    }
}

/// Solves the rows of a block.
pub(super) fn solve(view: &mut View<'_>, sides: &mut Sides<'_>, pass: &Pass) {
    if view.block.waits || !wake(view, pass) {
        return;
    }
    for _ in 0..SWEEPS {
        let (change, largest) = sweep(view, sides, pass);
        if change <= CALM * largest {
            break;
        }
    }
}

/// Marks the rows of the relax pass. False if the block has none to solve.
fn wake(view: &mut View<'_>, pass: &Pass) -> bool {
    if pass.biased {
        return true;
    }
    let mut any = false;
    for (row, impulse) in view.rows.iter_mut().zip(view.impulses.iter()) {
        row.live = row.gap <= 0.0 || impulse.normal > 0.0;
        any |= row.live || impulse.tangent != Vec2::ZERO;
    }
    any
}

/// One sweep over all chunks: the largest change of an impulse, and the largest normal impulse.
#[inline(always)]
fn sweep(view: &mut View<'_>, sides: &mut Sides<'_>, pass: &Pass) -> (f32, f32) {
    let (mut change, mut largest) = (0.0_f32, 0.0_f32);
    let mut start = 0;
    while start < view.pairs.len() {
        let more = view.pairs[start + 1..].iter().take_while(|pair| !pair.opens).count();
        let chunk = &view.pairs[start..=start + more];
        let base = view.block.first_point;
        for pair in chunk {
            let first = (pair.first - base) as usize;
            for k in first..first + usize::from(pair.count) {
                let (row, lever, impulse) = (&mut view.rows[k], &mut view.levers[k], &mut view.impulses[k]);
                change = change.max(normal_row(pair, row, lever, impulse, sides, pass, view.block));
                largest = largest.max(impulse.normal);
            }
        }
        // The speeds of the biased pass are not those of the bodies: friction against them would move the bodies.
        for pair in chunk.iter().filter(|_| !pass.biased) {
            let first = (pair.first - base) as usize;
            for k in first..first + usize::from(pair.count) {
                let (row, lever, impulse) = (&mut view.rows[k], &mut view.levers[k], &mut view.impulses[k]);
                if impulse.normal > 0.0 || impulse.tangent != Vec2::ZERO {
                    sides.form_once(pair, row, lever);
                    let bound = pair.friction * impulse.normal;
                    change = change.max(friction_row(pair, lever, &mut impulse.tangent, sides, bound));
                }
            }
        }
        start += 1 + more;
    }
    (change, largest)
}

#[inline(always)]
fn normal_row(
    pair: &Pair,
    row: &mut Row,
    lever: &mut Lever,
    impulse: &mut Impulse,
    sides: &mut Sides<'_>,
    pass: &Pass,
    block: &Block,
) -> f32 {
    let before = impulse.normal;
    if !pass.biased && !row.live {
        return 0.0;
    }
    let step = if pass.biased && row.gap > 0.0 {
        let apart = (row.gap + row.spare) / block.time;
        if before == 0.0 && !row.formed && sides.closing(row).dot(pair.normal) + apart >= 0.0 {
            return 0.0;
        }
        sides.form_once(pair, row, lever);
        -(sides.normal_speed(pair, lever) + apart) * lever.inverse_normal
    } else {
        sides.form_once(pair, row, lever);
        let speed = sides.normal_speed(pair, lever);
        if pass.biased {
            let soft = &pass.softness[usize::from(block.fixed)];
            let speed = soft.mass * speed + (soft.rate * row.gap).max(-PUSH_OUT);
            -speed * lever.inverse_normal - soft.impulse * before
        } else {
            -speed * lever.inverse_normal
        }
    };
    impulse.normal = (before + step).max(0.0);
    let done = impulse.normal - before;
    if done != 0.0 {
        sides.push(pair, lever, done);
    }
    done.abs()
}

/// The friction of a point within a bound: sticks if it can, else takes a step against the slip. The change of the impulse.
#[inline(always)]
pub(super) fn friction_row(pair: &Pair, lever: &Lever, tangent: &mut Vec2, sides: &mut Sides<'_>, bound: f32) -> f32 {
    let [t1, t2] = pair.tangents;
    let [_, one, other] = &lever.along;
    let slip = Vec2::new(sides.speed(t1, one), sides.speed(t2, other)) + pair.belt;
    let [xx, xy, yy] = lever.inverse_tangent;
    let before = *tangent;
    let mut trial = before - Vec2::new(xx * slip.x + xy * slip.y, xy * slip.x + yy * slip.y);
    if trial.length_squared() > bound * bound {
        trial = before - lever.inverse_slip * slip;
        let size = trial.length();
        if size > bound {
            trial *= bound / size;
        }
    }
    let done = trial - before;
    if done != Vec2::ZERO {
        sides.push_along(t1, one, done.x);
        sides.push_along(t2, other, done.y);
    }
    *tangent = trial;
    done.length()
}
