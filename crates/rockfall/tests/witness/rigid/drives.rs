//! Motors, friction, springs and damping of joints (docs/physics section 11.14).

use std::f64::consts::TAU;

use rockfall::JointKind;
use rockfall::glam::{DMat3, DVec3};

use super::joints::{Link, Pose, Row, Visit, across, along, solved};
use super::rows::Sides;

impl Link {
    /// The inertia of the rotor of the free axis.
    pub(super) fn inertia(&self) -> f64 {
        if self.kind == JointKind::Ball { 0.0 } else { self.armature }
    }

    /// The rotor has taken its part of impulses on the free axis, whose row gives way by this.
    pub(super) fn taken(&mut self, give: f64, sum: f64, visit: Visit) {
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
        let theta = if k > 0.0 { (1.0 - (1.0 / give + inertia) / (k * h * h)).max(0.0) } else { 0.0 };
        let [bounded, free] = [h * c + theta * h * h * k, h * drag + inertia];
        let [start, kept] = [h * (self.effort - k * self.off), inertia * self.rotor.x];
        let old = self.impulses.drive;
        // old + change = start - bounded v + kept - free v with v = before + give change.
        let all = bounded + free;
        let mut change = (start + kept - old - all * before) / (1.0 + all * give);
        let most = h * self.most;
        let within = start - bounded * (before + give * change);
        if within.abs() > most {
            change = (most.copysign(within) + kept - old - free * before) / (1.0 + free * give);
        }
        act(sides, change);
        self.impulses.drive = old + change;
        if visit.relax && !visit.is_first && !is_ball {
            self.rotor.x = before + give * change;
        }
        let beside = match row {
            Row::Linear(n) => (push - n, twist),
            Row::Angular(n) => (push, twist - n),
        };
        self.impulses.linear += along(pose.e, change * beside.0);
        self.impulses.angular += along(pose.e, change * beside.1);
    }

    /// The push and the twist of an impulse of 1 of the drive, with what the joint answers at once.
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
