//! Friction impulses (docs/physics.md section 3.9).

use rockfall::glam::DVec3;

use crate::collide::Pressed;
use crate::sides::{Motion, Side, sides};
use crate::world::{Body, World};

/// The unit impulse of friction on one side.
struct Grip {
    side: Side,
    /// Unit impulse on this side, and its couple.
    p: DVec3,
    couple: DVec3,
}

impl World {
    /// Friction impulses of all contacts that were pressed.
    pub(crate) fn rub(&mut self, pressed: &[Pressed]) {
        if self.set.coulomb == 0.0 && self.set.collision_friction == 0.0 {
            return;
        }
        let motion = Motion::of(self);
        let mut change = Motion::none(self);
        for contact in pressed {
            self.apply_friction_to_one(contact, pressed, &motion, &mut change);
        }
        for (at, ball) in self.balls.iter_mut().enumerate().filter(|(_, ball)| !ball.fixed) {
            ball.v += change.v[at];
            ball.l += change.l[at];
        }
    }

    fn apply_friction_to_one(&self, contact: &Pressed, pressed: &[Pressed], motion: &Motion, change: &mut Motion) {
        let Some(line) = self.nearer_line(&contact.pair) else { return };
        let pair = &contact.pair;
        let slip = self.slip(pair, &line, motion);
        let speed = slip.t.length();
        if speed == 0.0 {
            return;
        }
        let force = if line.o > 0.0 { self.normal_force(pair, &line, motion, false).map_or(0.0, |found| found.1) } else { 0.0 };
        let limit = self.set.collision_friction * contact.j + self.set.coulomb * self.dt * force;
        let t = slip.t / speed;
        let grips = sides(pair, &line).into_iter().zip(slip.arms).map(|(side, arm)| Grip {
            side,
            p: -side.sign * t,
            couple: arm * line.n.cross(t),
        });
        let grips: Vec<Grip> = grips.collect();
        let scale: f64 = grips.iter().map(|grip| self.grip_scale(grip, pressed)).sum();
        if scale == 0.0 {
            return;
        }
        let j = limit.min(speed / scale);
        for grip in &grips {
            self.give_grip(grip, j, change);
        }
    }

    /// Sum of N times the tangential inverse mass over the bodies of one side.
    fn grip_scale(&self, grip: &Grip, pressed: &[Pressed]) -> f64 {
        if let Some((rigid, at)) = self.capsule_of(grip.side) {
            let torque = rigid.torque(at, grip.p) + grip.couple;
            let across = rigid.across(torque);
            let along = torque - across;
            let mass =
                1.0 / rigid.mass + across.length_squared() / rigid.it + along.length_squared() / (rigid.i[0] + rigid.i[1]);
            return mass * self.pressing(rigid.ends[0], pressed);
        }
        let through = |(ball, share): (usize, f64)| {
            let state = &self.balls[ball];
            let mass = share * share * (state.w() + grip.couple.length_squared() * state.i());
            mass * self.pressing(ball, pressed)
        };
        self.shares(grip.side).into_iter().map(through).sum()
    }

    /// How many pressed contacts touch the body of a sphere; in a network, the sphere itself.
    fn pressing(&self, ball: usize, pressed: &[Pressed]) -> f64 {
        let touches = |side: Side| match self.body[ball] {
            Some(body @ Body::Capsule(_)) => self.bodies_of(side).contains(&body),
            _ => self.shares(side).into_iter().any(|(other, _)| other == ball),
        };
        let all = pressed.iter().flat_map(|contact| sides(&contact.pair, &contact.line));
        all.filter(|&side| touches(side)).count() as f64
    }

    fn give_grip(&self, grip: &Grip, j: f64, change: &mut Motion) {
        if let Some((rigid, at)) = self.capsule_of(grip.side) {
            let torque = rigid.torque(at, grip.p) + grip.couple;
            let across = rigid.across(torque);
            rigid.give(j * grip.p, j * across, j * (torque - across), change);
            return;
        }
        for (ball, share) in self.shares(grip.side) {
            change.v[ball] += share * self.balls[ball].w() * j * grip.p;
            change.l[ball] += share * j * grip.couple;
        }
    }
}
