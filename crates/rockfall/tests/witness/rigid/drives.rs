//! Motors, friction, springs and damping of joints (docs/physics section 11.14).

use std::f64::consts::TAU;

use rockfall::JointKind;
use rockfall::glam::{DMat3, DVec3};

use super::joints::{Link, Pose, Row, Visit, across, along, solved};
use super::rows::{Sides, soft};

/// The free axis with the block that answers its rows.
pub(super) struct Free {
    pub(super) p: f64,
    pub(super) row: Row,
    /// K with a hard block.
    hard: f64,
    /// K_d, with the block of this pass.
    give: f64,
    /// What the block gets with an impulse of 1, along the axes of the joint.
    answer: DVec3,
}

impl Link {
    pub(super) fn free(&self, sides: &Sides, pose: &Pose, visit: Visit) -> Option<Free> {
        let (p, row) = pose.axis?;
        let (moved, answer) = self.answer(sides, pose, row);
        let (alone, more) = (sides.give(pose.arms, row), moved.dot(answer));
        let m = if visit.relax { 1.0 } else { soft(2.0, self.angle, visit.h).mass };
        Some(Free { p, row, hard: alone + more, give: alone + m * more, answer: m * answer })
    }

    /// What an impulse of 1 adds to the rates of the block that answers the row, and what a hard block answers.
    fn answer(&self, sides: &Sides, pose: &Pose, row: Row) -> (DVec3, DVec3) {
        let (e, arms, [one, two]) = (pose.e, pose.arms, sides.inverses);
        let all = &[0, 1, 2];
        match row {
            Row::Angular(t) => {
                let u = along(e, (two * t).cross(arms[1]) + (one * t).cross(arms[0]));
                (u, solved(all, |i, j| sides.k(arms, e[i], e[j]), -u))
            }
            Row::Linear(n) if self.kind == JointKind::Slider => {
                let w = along(e, two * arms[1].cross(n) + one * arms[0].cross(n));
                (w, solved(all, |i, j| e[i].dot((one + two) * e[j]), -w))
            }
            Row::Linear(_) => (DVec3::ZERO, DVec3::ZERO),
        }
    }

    /// An impulse along the free axis, and what the block answers.
    fn push(&mut self, sides: &mut Sides, pose: &Pose, free: &Free, impulse: f64) {
        let answer = impulse * free.answer;
        sides.act(pose.arms, free.row, impulse);
        match free.row {
            Row::Angular(_) => {
                self.impulses.linear += answer;
                sides.push(pose.arms, across(pose.e, answer));
            }
            Row::Linear(_) => {
                self.impulses.angular += answer;
                sides.twist(across(pose.e, answer));
            }
        }
    }

    /// The inertia of the rotor of the free axis.
    fn inertia(&self) -> f64 {
        if self.kind == JointKind::Ball { 0.0 } else { self.armature }
    }

    /// What the free axis gives way by with its rotor.
    pub(super) fn with_rotor(&self, free: &Free) -> f64 {
        free.give / (1.0 + self.inertia() * free.give)
    }

    /// An impulse of the motor, of friction or of a limit. The rotor takes its part, the bodies and the block the rest.
    pub(super) fn act(&mut self, sides: &mut Sides, pose: &Pose, free: &Free, impulse: f64) {
        let alpha = self.inertia() * self.with_rotor(free);
        self.impulses.drive -= alpha * impulse;
        self.push(sides, pose, free, (1.0 - alpha) * impulse);
    }

    /// A row towards a speed. The sum of its impulses is that without the rotor.
    fn toward(&mut self, sides: &mut Sides, pose: &Pose, free: &Free, [speed, most, old]: [f64; 3]) -> f64 {
        let change = -(sides.rate(pose.arms, free.row) - speed) / self.with_rotor(free);
        let to = (old + change).clamp(-most, most);
        self.act(sides, pose, free, to - old);
        to
    }

    pub(super) fn motor(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, free: &Free) {
        let (p, Some(mut speed)) = (free.p, self.speed) else { return };
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
        self.impulses.motor = self.toward(sides, pose, free, [speed, visit.h * most, self.impulses.motor]);
    }

    /// Friction of the free axis.
    pub(super) fn rub(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, free: &Free) {
        if self.friction > 0.0 && self.kind != JointKind::Ball {
            let most = visit.h * self.friction;
            self.impulses.friction = self.toward(sides, pose, free, [0.0, most, self.impulses.friction]);
        }
    }

    /// Friction of a ball.
    pub(super) fn rub_all(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit) {
        if self.friction <= 0.0 || self.kind != JointKind::Ball {
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
    pub(super) fn drive(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, free: &Free) {
        let (h, k) = (visit.h, self.stiffness);
        let is_ball = self.kind == JointKind::Ball;
        let [c, drag] = if is_ball { [0.0; 2] } else { [self.damping, self.drag] };
        let inertia = self.inertia();
        let acts = k > 0.0 || self.effort != 0.0 || [c, drag, inertia].iter().any(|number| *number > 0.0);
        if !acts {
            return;
        }
        if !visit.relax && visit.is_first {
            self.off = free.p - self.rest;
            if self.kind.turns() {
                self.off -= TAU * (self.off / TAU).round();
            }
        }
        let (hard, give, before) = (free.hard, free.give, sides.rate(pose.arms, free.row));
        let own = (h * h * k - 0.25 / hard).max(0.0).min(6.0 / hard);
        let [bounded, loose] = [h * c + own, h * drag + inertia];
        let [start, kept] = [h * self.effort - (h * k).min(2.0 / (h * hard)) * self.off, inertia * self.rotor.x];
        let old = self.impulses.drive;
        // old + change = start - bounded v + kept - loose v with v = before + give change.
        let all = bounded + loose;
        let mut change = (start + kept - old - all * before) / (1.0 + all * give);
        let most = h * self.most;
        let within = start - bounded * (before + give * change);
        if within.abs() > most {
            change = (most.copysign(within) + kept - old - loose * before) / (1.0 + loose * give);
        }
        self.impulses.drive = old + change;
        self.push(sides, pose, free, change);
    }
}
