//! Joints (docs/physics section 11.14).

use std::f64::consts::{PI, TAU};

use rockfall::JointKind;
use rockfall::glam::{DMat3, DQuat, DVec3};

use super::drives::Free;
use super::mistakes::Mistake;
use super::rows::{Sides, Soft, soft};
use super::solver::{Solver, State};

/// Impulses of rows. Blocks and the friction of a ball have theirs along the axes of the joint.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Impulses {
    pub(super) linear: DVec3,
    pub(super) angular: DVec3,
    pub(super) rub: DVec3,
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) cone: f64,
    pub(super) motor: f64,
    pub(super) friction: f64,
    pub(super) locked: f64,
    /// Of the drive: along the free axis, and of a ball about the axes of the joint.
    pub(super) drive: f64,
    pub(super) round: DVec3,
}

#[derive(Clone, Debug)]
pub(crate) struct Link {
    pub(crate) kind: JointKind,
    pub(crate) bodies: [usize; 2],
    /// Anchors and joint frames in coordinates of the bodies.
    pub(crate) ends: [(DVec3, DQuat); 2],
    /// Errors of both in the present poses, along the axes of the world.
    pub(crate) errors: [(DVec3, DQuat); 2],
    pub(crate) limits: Option<[f64; 2]>,
    pub(crate) cone: Option<f64>,
    pub(crate) speed: Option<f64>,
    /// The greatest force of the motor and of the spring.
    pub(crate) most: f64,
    /// Position at which the spring rests.
    pub(crate) rest: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) effort: f64,
    pub(crate) drag: f64,
    pub(crate) armature: f64,
    /// How far the spring is off in this substep.
    pub(crate) off: f64,
    /// Rate of the rotor; of a ball about the axes of the joint, otherwise its first number.
    pub(crate) rotor: DVec3,
    pub(crate) friction: f64,
    pub(crate) locked: bool,
    pub(crate) collides: bool,
    pub(crate) colour: usize,
    /// The angle h w of its softness.
    pub(crate) angle: f64,
    pub(crate) impulses: Impulses,
    /// Mean force and torque of the frame on the second body.
    pub(crate) load: Load,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Load {
    pub(crate) force: DVec3,
    pub(crate) torque: DVec3,
}

impl std::ops::DivAssign<f64> for Load {
    fn div_assign(&mut self, time: f64) {
        self.force /= time;
        self.torque /= time;
    }
}

/// A row along a line through the anchor, or about it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Row {
    Linear(DVec3),
    Angular(DVec3),
}

/// A joint in a pose.
pub(super) struct Pose {
    pub(super) e: [DVec3; 3],
    pub(super) f1: DVec3,
    pub(super) arms: [DVec3; 2],
    /// Deviations of linear and angular rows.
    pub(super) linear: DVec3,
    pub(super) angular: DVec3,
    /// Position along the free axis, and its row.
    pub(super) axis: Option<(f64, Row)>,
}

impl Sides {
    pub(super) fn turning(&self) -> DVec3 {
        self.w[1] - self.w[0]
    }

    pub(super) fn twist(&mut self, m: DVec3) {
        self.w[0] -= self.inverses[0] * m;
        self.w[1] += self.inverses[1] * m;
    }

    pub(super) fn rate(&self, arms: [DVec3; 2], row: Row) -> f64 {
        match row {
            Row::Linear(n) => self.slip(arms).dot(n),
            Row::Angular(n) => self.turning().dot(n),
        }
    }

    pub(super) fn give(&self, arms: [DVec3; 2], row: Row) -> f64 {
        match row {
            Row::Linear(n) => self.k(arms, n, n),
            Row::Angular(n) => n.dot((self.inverses[0] + self.inverses[1]) * n),
        }
    }

    pub(super) fn act(&mut self, arms: [DVec3; 2], row: Row, impulse: f64) {
        match row {
            Row::Linear(n) => self.push(arms, impulse * n),
            Row::Angular(n) => self.twist(impulse * n),
        }
    }
}

/// Solves a system whose rows and columns outside of `0..3` of the list of axes are left out.
pub(super) fn solved(rows: &[usize], k: impl Fn(usize, usize) -> f64, right: DVec3) -> DVec3 {
    let mut matrix = DMat3::IDENTITY;
    let mut wanted = DVec3::ZERO;
    for &i in rows {
        wanted[i] = right[i];
        for &j in rows {
            matrix.col_mut(j)[i] = k(i, j);
        }
    }
    matrix.inverse() * wanted
}

pub(super) fn along(e: [DVec3; 3], v: DVec3) -> DVec3 {
    DVec3::new(e[0].dot(v), e[1].dot(v), e[2].dot(v))
}

pub(super) fn across(e: [DVec3; 3], v: DVec3) -> DVec3 {
    e[0] * v.x + e[1] * v.y + e[2] * v.z
}

impl Link {
    pub(crate) fn begin(&mut self) {
        self.load = Load::default();
    }

    /// The rotor turns with the joint at the start of a frame.
    fn start(&mut self, sides: &Sides, states: [State; 2]) {
        self.turn_rotor(sides, &self.pose(states));
    }

    fn turn_rotor(&mut self, sides: &Sides, pose: &Pose) {
        self.rotor = match pose.axis {
            _ if self.kind == JointKind::Ball => along(pose.e, sides.turning()),
            Some((_, row)) => DVec3::X * sides.rate(pose.arms, row),
            None => DVec3::ZERO,
        };
    }

    fn linear_rows(&self) -> &'static [usize] {
        match self.kind {
            JointKind::Slider => &[1, 2],
            JointKind::Distance => &[],
            _ => &[0, 1, 2],
        }
    }

    fn angular_rows(&self) -> &'static [usize] {
        match self.kind {
            JointKind::Hinge => &[1, 2],
            JointKind::Slider | JointKind::Fixed => &[0, 1, 2],
            _ => &[],
        }
    }

    /// An angle about the middle of the limits.
    fn reduced(&self, p: f64) -> f64 {
        let middle = self.limits.map_or(0.0, |[a, b]| 0.5 * (a + b));
        p - TAU * ((p - middle) / TAU).round()
    }

    fn pose(&self, [a, b]: [State; 2]) -> Pose {
        let d = b.x - a.x;
        let [(off_a, turn_a), (off_b, turn_b)] = self.errors;
        let (on_a, on_b) = (a.q * self.ends[0].0 + off_a, d + b.q * self.ends[1].0 + off_b);
        let (qa, qb) = (turn_a * a.q * self.ends[0].1, turn_b * b.q * self.ends[1].1);
        let e = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| qa * axis);
        let (f1, gap) = (qb * DVec3::X, on_b - on_a);
        let turn = qa.inverse() * qb;
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let v = DVec3::new(turn.x, turn.y, turn.z);
        let angular = if self.kind == JointKind::Hinge { along(e, e[0].cross(f1)) } else { 2.0 * v };
        let cosine = e[0].dot(f1);
        let about = || if cosine < -0.9 { e[0] } else { (e[0] + f1) / (1.0 + cosine) };
        let twist = || (self.reduced(2.0 * v.x.atan2(turn.w)), Row::Angular(about()));
        let axis = match self.kind {
            JointKind::Hinge => Some(twist()),
            JointKind::Ball => (cosine >= -0.9).then(twist),
            JointKind::Slider => Some((e[0].dot(gap), Row::Linear(e[0]))),
            JointKind::Distance => Some((gap.length(), Row::Linear(gap.try_normalize().unwrap_or(e[0])))),
            _ => None,
        };
        Pose { e, f1, arms: [on_b, on_b - d], linear: along(e, gap), angular, axis }
    }

    fn cone_row(&self, pose: &Pose) -> Option<(f64, Row)> {
        let across = pose.e[0].cross(pose.f1).try_normalize()?;
        Some((self.cone? - pose.e[0].dot(pose.f1).clamp(-1.0, 1.0).acos(), Row::Angular(-across)))
    }

    /// Impulses of rows but the blocks, with their rows.
    fn singles(&self, pose: &Pose) -> Vec<(f64, Row)> {
        let Impulses { lower, upper, motor, friction, locked, drive, cone, .. } = self.impulses;
        let free = lower - upper + motor + friction + locked + drive;
        let free = pose.axis.map(|(_, row)| (free, row));
        free.into_iter().chain(self.cone_row(pose).map(|(_, row)| (cone, row))).collect()
    }

    fn warm(&mut self, sides: &mut Sides, states: [State; 2]) {
        let pose = self.pose(states);
        for (impulse, row) in self.singles(&pose) {
            sides.act(pose.arms, row, impulse);
        }
        sides.push(pose.arms, across(pose.e, self.impulses.linear));
        sides.twist(across(pose.e, self.impulses.angular + self.impulses.rub + self.impulses.round));
    }

    /// The impulses of the substep on the second body.
    fn loaded(&mut self, states: [State; 2]) {
        let pose = self.pose(states);
        self.load.force += across(pose.e, self.impulses.linear);
        self.load.torque += across(pose.e, self.impulses.angular + self.impulses.rub + self.impulses.round);
        for (impulse, row) in self.singles(&pose) {
            match row {
                Row::Linear(n) => self.load.force += impulse * n,
                Row::Angular(n) => self.load.torque += impulse * n,
            }
        }
    }

    fn visit(&mut self, sides: &mut Sides, states: [State; 2], visit: Visit) {
        let pose = self.pose(states);
        let soft = soft(2.0, self.angle, visit.h);
        self.about_all(sides, &pose, visit);
        if visit.relax {
            self.rub_all(sides, &pose, visit);
        }
        self.bound_cone(sides, &pose, visit, &soft);
        self.blocks(sides, &pose, visit, &soft);
        if let Some(free) = self.free(sides, &pose, visit) {
            self.along_axis(sides, &pose, visit, &free);
        }
        // Only the last visit counts for the rotor: the rate that it leaves.
        if visit.relax && !visit.is_first && self.kind != JointKind::Ball {
            self.turn_rotor(sides, &pose);
        }
    }

    /// The rows of the free axis.
    fn along_axis(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, free: &Free) {
        self.drive(sides, pose, visit, free);
        if visit.relax {
            self.motor(sides, pose, visit, free);
            self.rub(sides, pose, visit, free);
        }
        let soft = soft(2.0, self.angle, visit.h);
        self.bound(sides, pose, visit, free, &soft);
        if self.locked {
            self.lock(sides, pose, visit, free, &soft);
        }
    }

    /// The row of a locked distance, which no block answers.
    fn lock(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, free: &Free, soft: &Soft) {
        let (rate, k) = (sides.rate(pose.arms, free.row), sides.give(pose.arms, free.row));
        let change = if visit.relax {
            -rate / k
        } else {
            -(soft.mass * rate + visit.bias * soft.rate * (free.p - self.rest)) / k - soft.give * self.impulses.locked
        };
        self.impulses.locked += change;
        sides.act(pose.arms, free.row, change);
    }

    fn blocks(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, soft: &Soft) {
        let (e, arms) = (pose.e, pose.arms);
        let wanted = |rate: DVec3, off: DVec3| {
            if visit.relax { -rate } else { -(soft.mass * rate + visit.bias * soft.rate * off) }
        };
        let give = if visit.relax { 0.0 } else { soft.give };
        let rows = self.angular_rows();
        if !rows.is_empty() {
            let sum = sides.inverses[0] + sides.inverses[1];
            let right = wanted(along(e, sides.turning()), pose.angular);
            let change = solved(rows, |i, j| e[i].dot(sum * e[j]), right) - give * self.impulses.angular;
            self.impulses.angular += change;
            sides.twist(across(e, change));
        }
        let rows = self.linear_rows();
        if !rows.is_empty() {
            let right = wanted(along(e, sides.slip(arms)), pose.linear);
            let change = solved(rows, |i, j| sides.k(arms, e[i], e[j]), right) - give * self.impulses.linear;
            self.impulses.linear += change;
            sides.push(arms, across(e, change));
        }
    }

    fn bound_cone(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, soft: &Soft) {
        let Some((c, row)) = self.cone_row(pose) else { return };
        let (rate, k) = (sides.rate(pose.arms, row), sides.give(pose.arms, row));
        let old = self.impulses.cone;
        self.impulses.cone = visit.bounded(soft, [c, rate, k, old]);
        sides.act(pose.arms, row, self.impulses.cone - old);
    }

    /// Limits. The sums of their impulses are those without the rotor.
    fn bound(&mut self, sides: &mut Sides, pose: &Pose, visit: Visit, free: &Free, soft: &Soft) {
        let Some([a, b]) = self.limits else { return };
        let k = self.with_rotor(free);
        let (rate, old) = (sides.rate(pose.arms, free.row), self.impulses.lower);
        self.impulses.lower = visit.bounded(soft, [free.p - a, rate, k, old]);
        self.act(sides, pose, free, self.impulses.lower - old);
        let (rate, old) = (sides.rate(pose.arms, free.row), self.impulses.upper);
        self.impulses.upper = visit.bounded(soft, [b - free.p, -rate, k, old]);
        self.act(sides, pose, free, old - self.impulses.upper);
    }
}

#[derive(Clone, Copy)]
pub(super) struct Visit {
    pub(super) relax: bool,
    pub(super) is_first: bool,
    pub(super) h: f64,
    /// 1, or 0 for a mistake.
    pub(super) bias: f64,
}

impl Visit {
    /// The impulse of a row that keeps C at 0 or more, from C, its rate, K and the old impulse.
    fn bounded(self, soft: &Soft, [c, rate, k, old]: [f64; 4]) -> f64 {
        let change = match (self.relax, c > 0.0) {
            (true, true) if old <= 0.0 => return old,
            (true, _) => -rate / k,
            (false, true) => -(rate + c / self.h) / k,
            (false, false) => -(soft.mass * rate + soft.rate * c) / k - soft.give * old,
        };
        (old + change).max(0.0)
    }
}

impl Solver {
    /// Colours and softness of joints.
    pub(crate) fn prepare_links(&mut self) {
        for at in 0..self.links.len() {
            let bodies = self.links[at].bodies;
            let heavy: Vec<usize> = bodies.into_iter().filter(|&k| self.bodies[k].has_mass).collect();
            let meets = |other: &Link| other.bodies.iter().any(|k| heavy.contains(k));
            let taken: Vec<usize> = self.links[..at].iter().filter(|other| meets(other)).map(|other| other.colour).collect();
            let colour = (0..).find(|colour| !taken.contains(colour)).expect("a colour");
            let count = |k: &usize| self.links.iter().filter(|other| other.bodies.contains(k)).count();
            let most = heavy.iter().map(count).max().unwrap_or(0);
            let angle = if most > 3 { 1.5 * PI / most as f64 } else { 0.5 * PI };
            (self.links[at].colour, self.links[at].angle) = (colour, angle);
            heavy.into_iter().for_each(|k| self.bodies[k].jointed = true);
        }
    }

    /// Draws the errors of the places and the frames of joints: their deviations are differences of coordinates.
    pub(crate) fn refresh_links(&mut self) {
        for at in 0..self.links.len() {
            let link = &self.links[at];
            let sizes = [0, 1].map(|end| self.bodies[link.bodies[end]].state.x.abs().max_element() + link.ends[end].0.length());
            let size = sizes[0].max(sizes[1]);
            self.links[at].errors = [0, 1].map(|_| {
                let (off, turn) = (self.errors(size), self.errors(1.0));
                (off, DQuat::from_xyzw(turn.x, turn.y, turn.z, 1.0).normalize())
            });
        }
    }

    pub(crate) fn start_links(&mut self) {
        self.each_link(false, |link, sides, states| link.start(sides, states));
    }

    pub(crate) fn warm_links(&mut self) {
        self.each_link(false, |link, sides, states| link.warm(sides, states));
    }

    /// All joints, in the order of their colours or in the opposite one.
    fn each_link(&mut self, back: bool, mut act: impl FnMut(&mut Link, &mut Sides, [State; 2])) {
        let mut order: Vec<usize> = (0..self.links.len()).collect();
        order.sort_by_key(|&at| self.links[at].colour);
        if back {
            order.reverse();
        }
        for at in order {
            let bodies = self.links[at].bodies;
            let (mut sides, states) = (self.sides(bodies), self.states(bodies));
            act(&mut self.links[at], &mut sides, states);
            self.put(bodies, &sides);
        }
    }

    pub(crate) fn solve_links(&mut self, relax: bool) {
        let bias = if self.made(Mistake::LooseJoints) { 0.0 } else { 1.0 };
        let visits = if self.made(Mistake::OneVisit) { 1 } else { 2 };
        for number in 0..visits {
            let visit = Visit { relax, is_first: number == 0, h: self.h, bias };
            self.each_link(relax == (number == 0), |link, sides, states| link.visit(sides, states, visit));
        }
        if relax {
            self.each_link(false, |link, _, states| link.loaded(states));
        }
    }
}
