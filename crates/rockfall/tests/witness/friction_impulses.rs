//! Friction impulses (docs/physics section 3.9).

use rockfall::glam::DVec3;

use crate::collide::Pressed;
use crate::sides::{Motion, Side, sides};
use crate::world::{Body, World};

/// Unit friction impulse on one side of a contact.
struct SideImpulse {
    side: Side,
    /// Unit impulse on this side. `torque` is its torque at the arm.
    p: DVec3,
    torque: DVec3,
}

impl World {
    /// Applies the friction impulses of all pressed contacts.
    pub(crate) fn apply_friction_impulses(&mut self, pressed: &[Pressed]) {
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
        let side_impulses = sides(pair, &line).into_iter().zip(slip.arms).map(|(side, arm)| SideImpulse {
            side,
            p: -side.sign * t,
            torque: arm * line.n.cross(t),
        });
        let side_impulses: Vec<SideImpulse> = side_impulses.collect();
        let scale: f64 = side_impulses.iter().map(|side_impulse| self.friction_scale(side_impulse, pressed)).sum();
        if scale == 0.0 {
            return;
        }
        let j = limit.min(speed / scale);
        for side_impulse in &side_impulses {
            self.apply_to_side(side_impulse, j, change);
        }
    }

    /// Sum of N_b times the tangential inverse mass over the bodies of one side.
    fn friction_scale(&self, side_impulse: &SideImpulse, pressed: &[Pressed]) -> f64 {
        if let Some((rigid, at)) = self.capsule_of(side_impulse.side) {
            let torque = rigid.torque(at, side_impulse.p) + side_impulse.torque;
            let across = rigid.across(torque);
            let along = torque - across;
            let mass =
                1.0 / rigid.mass + across.length_squared() / rigid.it + along.length_squared() / (rigid.i[0] + rigid.i[1]);
            return mass * self.pressed_count(rigid.ends[0], pressed);
        }
        let through = |(ball, share): (usize, f64)| {
            let state = &self.balls[ball];
            let mass = share * share * (state.w() + side_impulse.torque.length_squared() * state.i());
            mass * self.pressed_count(ball, pressed)
        };
        self.shares(side_impulse.side).into_iter().map(through).sum()
    }

    /// Number of pressed contacts that touch the body of a sphere, or the sphere itself if it belongs to a network.
    fn pressed_count(&self, ball: usize, pressed: &[Pressed]) -> f64 {
        let touches = |side: Side| match self.body[ball] {
            Some(body @ Body::Capsule(_)) => self.bodies_of(side).contains(&body),
            _ => self.shares(side).into_iter().any(|(other, _)| other == ball),
        };
        let all = pressed.iter().flat_map(|contact| sides(&contact.pair, &contact.line));
        all.filter(|&side| touches(side)).count() as f64
    }

    fn apply_to_side(&self, side_impulse: &SideImpulse, j: f64, change: &mut Motion) {
        if let Some((rigid, at)) = self.capsule_of(side_impulse.side) {
            let torque = rigid.torque(at, side_impulse.p) + side_impulse.torque;
            let across = rigid.across(torque);
            rigid.give(j * side_impulse.p, j * across, j * (torque - across), change);
            return;
        }
        for (ball, share) in self.shares(side_impulse.side) {
            change.v[ball] += share * self.balls[ball].w() * j * side_impulse.p;
            change.l[ball] += share * j * side_impulse.torque;
        }
    }
}
