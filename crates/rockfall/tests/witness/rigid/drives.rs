//! Motors, friction, springs and damping of joints (docs/physics section 11.14).

use std::f64::consts::TAU;

use rockfall::JointKind;
use rockfall::glam::{DMat3, DVec3};

use super::joints::{Link, Pose, Row, Visit, across, along, solved};
use super::rows::Sides;

impl Link {
    /// The motor and the friction.
    pub(super) fn drive(&mut self, sides: &mut Sides, pose: &Pose, h: f64) {
        let mut one = |row: Row, speed: f64, most: f64, impulse: &mut f64| {
            let change = -(sides.rate(pose.arms, row) - speed) / sides.give(pose.arms, row);
            let to = (*impulse + change).clamp(-h * most, h * most);
            sides.act(pose.arms, row, to - *impulse);
            *impulse = to;
        };
        if let (Some((p, row)), Some(mut speed)) = (pose.axis, self.speed) {
            let mut most = self.most;
            if let Some([a, b]) = self.limits {
                if (speed > 0.0 && p >= b) || (speed < 0.0 && p <= a) {
                    most = 0.0;
                } else if speed > 0.0 {
                    speed = speed.min((b - p) / h);
                } else if speed < 0.0 {
                    speed = speed.max((a - p) / h);
                }
            }
            one(row, speed, most, &mut self.impulses.motor);
        }
        if self.friction <= 0.0 {
            return;
        }
        if self.kind == JointKind::Ball {
            let k = sides.inverses[0] + sides.inverses[1];
            let old = across(pose.e, self.impulses.rub);
            let to = (old - k.inverse() * sides.turning()).clamp_length_max(h * self.friction);
            sides.twist(to - old);
            self.impulses.rub = along(pose.e, to);
        } else if let Some((_, row)) = pose.axis {
            one(row, 0.0, self.friction, &mut self.impulses.friction);
        }
    }

    /// The damping of a ball.
    pub(super) fn damp(&mut self, sides: &mut Sides, visit: Visit) {
        if self.kind == JointKind::Ball && self.damping > 0.0 && visit.is_first {
            let resistance = DMat3::from_diagonal(DVec3::splat(1.0 / (visit.h * self.damping)));
            let m = -((sides.inverses[0] + sides.inverses[1] + resistance).inverse() * sides.turning());
            sides.twist(m);
            self.load.torque += m;
        }
    }

    /// The spring and the damping.
    pub(super) fn spring(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit) {
        let (h, k) = (visit.h, self.stiffness);
        let is_ball = self.kind == JointKind::Ball;
        let c = if is_ball { 0.0 } else { self.damping };
        let acts = (k > 0.0 && visit.is_first) || (k == 0.0 && c > 0.0);
        let Some((p, row)) = pose.axis.filter(|_| acts) else { return };
        let (push, twist) = self.answer(sides, pose, row);
        let slip = |sides: &Sides| push.dot(sides.slip(pose.arms)) + twist.dot(sides.turning());
        let act = |sides: &mut Sides, impulse: f64| {
            sides.push(pose.arms, impulse * push);
            sides.twist(impulse * twist);
        };
        let before = slip(sides);
        act(sides, 1.0);
        let give = slip(sides) - before;
        act(sides, -1.0);
        let mut off = p - self.rest;
        if self.kind.turns() {
            off -= TAU * (off / TAU).round();
        }
        let theta = if k > 0.0 { (1.0 - 1.0 / (k * h * h * give)).max(0.0) } else { 0.0 };
        let part = h * c + theta * h * h * k;
        let old = self.impulses.spring;
        let change = -(h * k * off + part * before + old) / (1.0 + part * give);
        let to = (old + change).clamp(-h * self.most, h * self.most);
        act(sides, to - old);
        self.impulses.spring = to;
        let beside = match row {
            Row::Linear(n) => (push - n, twist),
            Row::Angular(n) => (push, twist - n),
        };
        self.load.force += (to - old) * beside.0;
        self.load.torque += (to - old) * beside.1;
    }

    /// The push and the twist of an impulse of 1 of the spring, with what the joint answers at once.
    fn answer(&self, sides: &Sides, pose: &Pose, row: Row) -> (DVec3, DVec3) {
        let (e, arms) = (pose.e, pose.arms);
        match row {
            Row::Angular(t) => {
                let u = (sides.inverses[1] * t).cross(arms[1]) + (sides.inverses[0] * t).cross(arms[0]);
                (-across(e, solved(&[0, 1, 2], |i, j| sides.k(arms, e[i], e[j]), along(e, u))), t)
            }
            Row::Linear(n) if self.kind == JointKind::Slider => {
                let w = sides.inverses[1] * arms[1].cross(n) + sides.inverses[0] * arms[0].cross(n);
                let sum = sides.inverses[0] + sides.inverses[1];
                (n, -across(e, solved(&[0, 1, 2], |i, j| e[i].dot(sum * e[j]), along(e, w))))
            }
            Row::Linear(n) => (n, DVec3::ZERO),
        }
    }
}
