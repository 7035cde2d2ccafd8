//! Lengths of rods, and the orientations and spins of capsules at the end of a step (docs/physics section 5).

use rockfall::Integrator;
use rockfall::glam::{DQuat, DVec3};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;

use crate::advance::Course;
use crate::world::{Mistake, Sweeps, World};

/// Relative error at which an implementation may end its sweeps (docs/physics section 5.4).
const TOLERANCE: f64 = 1e-5;
/// Relative error at which the witness ends its sweeps.
const EXACT: f64 = 1e-13;
/// Largest number of sweeps of an implementation.
const SWEEPS: usize = 400;
/// Largest number of sweeps of the witness.
const MANY: usize = 20_000;

impl World {
    /// Rods of fixed length with at least one end that can move.
    fn held(&self) -> Vec<(usize, [usize; 2], f64)> {
        let movable = |ends: [usize; 2]| ends.into_iter().any(|end| !self.balls[end].fixed);
        let held = self.bars.iter().enumerate().filter_map(|(number, bar)| bar.length.map(|length| (number, bar.ends, length)));
        held.filter(|&(_, ends, _)| movable(ends)).collect()
    }

    /// Repeats sweeps over all rods until the errors are within the tolerance. `correct` corrects one rod and returns
    /// its relative error.
    fn sweep(&mut self, mut correct: impl FnMut(&mut Self, (usize, [usize; 2], f64)) -> f64) {
        let mut rods = self.held();
        let (tolerance, most) = match self.sweeps {
            Sweeps::Exact => (EXACT, MANY),
            Sweeps::WithinTolerance(seed) => {
                rods.shuffle(&mut Pcg64Mcg::seed_from_u64(seed));
                (TOLERANCE, SWEEPS)
            }
        };
        for sweep in 0.. {
            let errors = rods.iter().map(|&rod| correct(self, rod));
            let worst = errors.fold(0.0, f64::max);
            if worst <= tolerance {
                return;
            }
            if sweep == most {
                self.lost |= worst > 100.0 * TOLERANCE;
                return;
            }
        }
    }

    /// Removes length errors, in positions only.
    pub(crate) fn restore_lengths(&mut self) {
        self.sweep(|world, (_, ends, length)| {
            let d = world.balls[ends[1]].x - world.balls[ends[0]].x;
            let axis = d.try_normalize().unwrap_or(DVec3::Y);
            let excess = d.length() - length;
            let w = ends.map(|end| world.balls[end].w());
            let way = excess / (w[0] + w[1]) * axis;
            world.balls[ends[0]].x += w[0] * way;
            world.balls[ends[1]].x -= w[1] * way;
            excess.abs() / length
        });
    }

    /// SHAKE and RATTLE.
    pub(crate) fn constrain(&mut self, old: &[DVec3]) {
        let dt = self.dt;
        self.sweep(|world, (_, ends, length)| {
            let d = world.balls[ends[1]].x - world.balls[ends[0]].x;
            let along = old[ends[1]] - old[ends[0]];
            let w = ends.map(|end| world.balls[end].w());
            // Solves |d - g (w1 + w2) along| = length for the root near 0.
            let (a, b, c) = (along.length_squared(), d.dot(along), d.length_squared() - length * length);
            let root = b * b - a * c;
            if root <= 0.0 || b <= 0.0 {
                world.lost = true;
                return 0.0;
            }
            let g = c / (b + root.sqrt()) / (w[0] + w[1]);
            for (end, w) in [(0, w[0]), (1, -w[1])] {
                world.balls[ends[end]].x += g * w * along;
                world.balls[ends[end]].v += g * w * along / dt;
            }
            (d.length() - length).abs() / length
        });
        if self.made(Mistake::NoRattle) {
            return;
        }
        self.sweep(|world, (_, ends, length)| {
            let axis = (world.balls[ends[1]].x - world.balls[ends[0]].x).normalize_or_zero();
            let w = ends.map(|end| world.balls[end].w());
            let own = |end: usize| if world.balls[end].fixed { DVec3::ZERO } else { world.balls[end].v };
            let opening = (own(ends[1]) - own(ends[0])).dot(axis);
            let change = opening / (w[0] + w[1]) * axis;
            world.balls[ends[0]].v += w[0] * change;
            world.balls[ends[1]].v -= w[1] * change;
            opening.abs() * dt / length
        });
    }

    /// Updates orientations and the spins of capsules. A fixed sphere turns with its surface velocity.
    pub(crate) fn turn(&mut self, course: &Course) {
        for at in 0..self.balls.len() {
            match self.capsule_end(at) {
                None => self.balls[at].q = turn_by(course.spin[at] * self.dt) * self.balls[at].q,
                Some((bar, 0)) => self.turn_capsule(bar, &course.old),
                Some(_) => {}
            }
        }
    }

    /// Turns a capsule as a rigid body (E18, docs/physics section 5.5).
    fn turn_capsule(&mut self, bar: usize, old: &[DVec3]) {
        let [one, two] = self.bars[bar].ends;
        let (first, second) = (self.balls[one].clone(), self.balls[two].clone());
        let (d, q) = (second.x - first.x, second.v - first.v);
        let mu = first.mass * second.mass / (first.mass + second.mass);
        let (i1, i2) = (first.inertia(), second.inertia());
        let own = if self.made(Mistake::CapsuleTurn) { 0.0 } else { i1 + i2 };
        let it = mu * d.length_squared() + own;
        let spins = first.l + second.l;
        let axis = d.normalize();
        let h = spins - axis * axis.dot(spins);
        let h = h - (i1 + i2) * (h + mu * d.cross(q)) / it;
        let start = (old[two] - old[one]).normalize();
        // Momentum that the ends receive from the spins, gradually during the step. With symplectic Euler the part that is
        // due to forces and torques acts for the whole step. It is the excess across the axis at the start of the step.
        let mut moving = h;
        if self.set.integrator == Integrator::SymplecticEuler {
            let all = spins - (i1 + i2) / it * (spins + mu * d.cross(q));
            moving += all - start * start.dot(all);
        }
        let p = moving.cross(d) / d.length_squared();
        let total = mu * d.cross(q) + spins;
        let length = d.length();
        let moved = d + 0.5 * self.dt * p / mu;
        let new = moved.normalize();
        let across = (total - new * new.dot(total)) / it;
        let roll = new * new.dot(total) / (i1 + i2);
        let turned = length * new;
        let m = first.mass + second.mass;
        let (x, v) = ((first.mass * first.x + second.mass * second.x) / m, (first.mass * first.v + second.mass * second.v) / m);
        let rotation = DQuat::from_rotation_arc(start, new) * DQuat::from_scaled_axis(self.dt * roll.dot(new) * start);
        for (end, part, i) in [(one, -second.mass / m, i1), (two, first.mass / m, i2)] {
            let ball = &mut self.balls[end];
            ball.x = x + part * turned;
            ball.v = v + part * across.cross(turned);
            ball.l = i * (across + roll);
            ball.q = (rotation * ball.q).normalize();
        }
    }
}

fn turn_by(angle: DVec3) -> DQuat {
    DQuat::from_scaled_axis(angle)
}
