//! Chains of rods as one surface: which contacts their parts cover (docs/physics section 2.13).

use rockfall::glam::DVec3;

use crate::geometry::{Feature, Line, Pair, Thing};
use crate::world::{Mistake, World};

/// A parameter beyond an end of a rod by at most this much belongs to the rod.
const AT_END: f64 = 1e-6;
/// A sphere as thick as its rod is inside of it.
const AS_THICK: f64 = 1e-6;
/// Part of a rod near its end where another rod must touch it.
const NEAR_END: f64 = 1e-4;
/// Bends of at most this angle are straight.
const STRAIGHT: f64 = 0.01;

impl World {
    /// Whether a part of a chain covers a contact of two balls or bars.
    pub(crate) fn is_covered(&self, pair: &Pair, line: &Line) -> bool {
        !self.made(Mistake::Covered)
            && (self.covers(pair.a, line.at[0], pair.b, line.at[1], line.n)
                || self.covers(pair.b, line.at[1], pair.a, line.at[0], -line.n))
    }

    fn covers(&self, own: Thing, at: f64, other: Thing, other_at: f64, n: DVec3) -> bool {
        let y = match other {
            Thing::Ball(ball) => self.balls[ball].x,
            Thing::Bar(bar) => self.on_bar(bar, other_at),
            Thing::Block(_) | Thing::Face(_) => return false,
        };
        match own {
            Thing::Ball(ball) => self.bars_at(ball).any(|bar| self.bar_covers_ball(ball, bar, other, y, n)),
            Thing::Bar(bar) => self.bars[bar].ends.into_iter().any(|end| {
                self.ball_covers_bar(bar, at, end, other)
                    || self.bars_at(end).any(|next| next != bar && self.next_covers_bar(bar, next, end, other, y))
            }),
            Thing::Block(_) | Thing::Face(_) => false,
        }
    }

    fn on_bar(&self, bar: usize, at: f64) -> DVec3 {
        let [one, two] = self.ends(bar);
        one.lerp(two, at)
    }

    fn bars_at(&self, ball: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.bars.len()).filter(move |&bar| self.bars[bar].ends.contains(&ball))
    }

    /// The vector from an end of a bar to its other end.
    fn away_from(&self, bar: usize, end: usize) -> DVec3 {
        let [one, two] = self.bars[bar].ends;
        self.balls[if one == end { two } else { one }].x - self.balls[end].x
    }

    fn bar_covers_ball(&self, ball: usize, bar: usize, other: Thing, y: DVec3, n: DVec3) -> bool {
        let (axis, radius) = (self.away_from(bar, ball), self.balls[ball].radius);
        let squared = axis.length_squared();
        if squared == 0.0 || !self.meet(Thing::Bar(bar), other) {
            return false;
        }
        let alpha = (y - self.balls[ball].x).dot(axis) / squared;
        let across = radius.powi(2) * (1.0 - n.dot(axis).powi(2) / squared);
        if alpha < -AT_END || across > (1.0 + AS_THICK) * self.bars[bar].radius.powi(2) {
            return false;
        }
        let Thing::Bar(second) = other else { return true };
        let pair = Pair { a: Thing::Bar(bar.min(second)), b: Thing::Bar(bar.max(second)), feature: Feature::None };
        alpha > NEAR_END || self.line(&pair).is_some_and(|line| line.o > 0.0)
    }

    fn ball_covers_bar(&self, bar: usize, at: f64, end: usize, other: Thing) -> bool {
        let t = self.on_bar(bar, at).distance(self.balls[end].x);
        self.balls[end].radius.powi(2) > t.powi(2) + self.bars[bar].radius.powi(2) && self.meet(Thing::Ball(end), other)
    }

    fn next_covers_bar(&self, bar: usize, next: usize, end: usize, other: Thing, y: DVec3) -> bool {
        let [own, their] = [bar, next].map(|bar| self.away_from(bar, end).normalize());
        let side = (y - self.balls[end].x).dot(own - their);
        -own.dot(their) >= STRAIGHT.cos() && (side < 0.0 || (side == 0.0 && next < bar)) && self.meet(Thing::Bar(next), other)
    }

    /// Whether two balls or bars may touch, in any order.
    fn meet(&self, one: Thing, two: Thing) -> bool {
        self.may_touch(one, two) && self.may_touch(two, one)
    }
}
