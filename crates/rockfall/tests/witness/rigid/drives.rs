//! Motors, friction, springs and damping of joints (docs/physics section 11.14).

use std::f64::consts::TAU;

use rockfall::JointKind;
use rockfall::glam::{DMat3, DVec3};

use super::joints::{Link, Pose, Row, Visit, across, along, solved};
use super::rows::{Sides, Soft, soft};

impl Link {
    /// The inertia of the rotor of the free axis.
    pub(super) fn inertia(&self) -> f64 {
        if self.kind == JointKind::Ball { 0.0 } else { self.armature }
    }

    /// The rotor has taken its part of impulses on the free axis, whose row gives way by this.
    pub(super) fn taken(&mut self, give: f64, sum: f64, visit: Visit) {
        if self.inertia() == 0.0 {
            return;
        }
        let k = give / (1.0 + self.inertia() * give);
        self.impulses.drive -= self.inertia() * k * sum;
        if visit.relax && !visit.is_first {
            self.rotor.x += k * sum;
        }
    }

    /// A row towards a speed. The sum of its impulses is that without the rotor.
    fn toward(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, [speed, most, old]: [f64; 3]) -> f64 {
        let Some((_, row)) = pose.axis else { return old };
        let give = sides.give(pose.arms, row);
        let change = -(sides.rate(pose.arms, row) - speed) * (1.0 + self.inertia() * give) / give;
        let to = (old + change).clamp(-visit.h * most, visit.h * most);
        sides.act(pose.arms, row, (to - old) / (1.0 + self.inertia() * give));
        self.taken(give, to - old, visit);
        to
    }

    pub(super) fn motor(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit) {
        let (Some((p, _)), Some(mut speed)) = (pose.axis, self.speed) else { return };
        let mut most = self.most;
        if let Some([a, b]) = self.limits {
            if (speed > 0.0 && p >= b) || (speed < 0.0 && p <= a) {
                most = 0.0;
            } else if speed > 0.0 {
                speed = speed.min((b - p) / visit.h);
            } else if speed < 0.0 {
                speed = speed.max((a - p) / visit.h);
            }
        }
        self.impulses.motor = self.toward(sides, pose, visit, [speed, most, self.impulses.motor]);
    }

    /// Friction.
    pub(super) fn rub(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit) {
        if self.friction <= 0.0 {
            return;
        }
        if self.kind != JointKind::Ball {
            self.impulses.friction = self.toward(sides, pose, visit, [0.0, self.friction, self.impulses.friction]);
            return;
        }
        let k = sides.inverses[0] + sides.inverses[1];
        let old = across(pose.e, self.impulses.rub);
        let to = (old - k.inverse() * sides.turning()).clamp_length_max(visit.h * self.friction);
        sides.twist(to - old);
        self.impulses.rub = along(pose.e, to);
    }

    /// The drive of a ball.
    pub(super) fn about_all(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit) {
        let r = visit.h * (self.damping + self.drag) + self.armature;
        if self.kind != JointKind::Ball || r == 0.0 {
            return;
        }
        // old + m = J_a s - r (w + K m).
        let k = sides.inverses[0] + sides.inverses[1];
        let old = across(pose.e, self.impulses.round);
        let right = self.armature * across(pose.e, self.rotor) - r * sides.turning() - old;
        let m = (DMat3::IDENTITY + r * k).inverse() * right;
        sides.twist(m);
        self.impulses.round = along(pose.e, old + m);
        if visit.relax && !visit.is_first {
            self.rotor = along(pose.e, sides.turning());
        }
    }

    /// The drive of the free axis.
    pub(super) fn along_axis(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit) {
        let (h, k) = (visit.h, self.stiffness);
        let is_ball = self.kind == JointKind::Ball;
        let [c, drag] = if is_ball { [0.0; 2] } else { [self.damping, self.drag] };
        let inertia = self.inertia();
        let acts = k > 0.0 || self.effort != 0.0 || [c, drag, inertia].iter().any(|number| *number > 0.0);
        let Some((p, row)) = pose.axis.filter(|_| acts) else { return };
        if !visit.relax && visit.is_first {
            self.off = p - self.rest;
            if self.kind.turns() {
                self.off -= TAU * (self.off / TAU).round();
            }
        }
        // An impulse of 1 gives the block `across`, and the block gives the drive as much. It answers, and moves in any case.
        let Answer { across: moved, answer, expected } = self.answer(sides, pose, row, visit);
        let give = sides.give(pose.arms, row) + moved.dot(answer);
        let hard = sides.give(pose.arms, row) + moved.dot(answer) / self.gain(visit);
        let before = sides.rate(pose.arms, row) + moved.dot(expected);
        let own = (h * h * k - 0.25 / hard).max(0.0).min(6.0 / hard);
        let [bounded, free] = [h * c + own, h * drag + inertia];
        let [start, kept] = [h * self.effort - (h * k).min(2.0 / (h * hard)) * self.off, inertia * self.rotor.x];
        let old = self.impulses.drive;
        // old + change = start - bounded v + kept - free v with v = before + give change.
        let all = bounded + free;
        let mut change = (start + kept - old - all * before) / (1.0 + all * give);
        let most = h * self.most;
        let within = start - bounded * (before + give * change);
        if within.abs() > most {
            change = (most.copysign(within) + kept - old - free * before) / (1.0 + free * give);
        }
        sides.act(pose.arms, row, change);
        self.impulses.drive = old + change;
        if visit.relax && !visit.is_first && !is_ball {
            self.rotor.x = before + give * change;
        }
        match row {
            Row::Angular(_) => {
                self.impulses.linear += change * answer;
                sides.push(pose.arms, across(pose.e, change * answer));
            }
            Row::Linear(_) => {
                self.impulses.angular += change * answer;
                sides.twist(across(pose.e, change * answer));
            }
        }
    }

    fn soft(&self, visit: Visit) -> Soft {
        soft(2.0, self.angle, visit.h)
    }

    /// The part of a rate that blocks take away.
    fn gain(&self, visit: Visit) -> f64 {
        if visit.relax { 1.0 } else { self.soft(visit).mass }
    }

    /// What the block answers that a drive of this row moves.
    fn answer(&self, sides: &Sides, pose: &Pose, row: Row, visit: Visit) -> Answer {
        let (e, arms, [one, two]) = (pose.e, pose.arms, sides.inverses);
        let all = &[0, 1, 2];
        let wanted = |rate: DVec3, off: DVec3, old: DVec3| {
            let Soft { mass, rate: pull, give, .. } = self.soft(visit);
            if visit.relax { (-rate, DVec3::ZERO) } else { (-(mass * rate + visit.bias * pull * off), -give * old) }
        };
        let (moved, answer, expected) = match row {
            Row::Angular(t) => {
                let u = along(e, (two * t).cross(arms[1]) + (one * t).cross(arms[0]));
                let (right, more) = wanted(along(e, sides.slip(arms)), pose.linear, self.impulses.linear);
                let k = |i: usize, j: usize| sides.k(arms, e[i], e[j]);
                (u, solved(all, k, -u), solved(all, k, right) + more)
            }
            Row::Linear(n) if self.kind == JointKind::Slider => {
                let w = along(e, two * arms[1].cross(n) + one * arms[0].cross(n));
                let (right, more) = wanted(along(e, sides.turning()), pose.angular, self.impulses.angular);
                let k = |i: usize, j: usize| e[i].dot((one + two) * e[j]);
                (w, solved(all, k, -w), solved(all, k, right) + more)
            }
            Row::Linear(_) => (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO),
        };
        Answer { across: moved, answer: self.gain(visit) * answer, expected }
    }
}

/// How a block answers a drive, along the axes of the joint.
struct Answer {
    across: DVec3,
    answer: DVec3,
    expected: DVec3,
}
