//! Forces: gravity, springs, contacts (docs/physics section 4).

use rockfall::glam::DVec3;

use crate::geometry::{Line, Pair};
use crate::sides::{Motion, Side, sides};
use crate::world::{Anchor, Ball, Body, Mistake, Pull, World};

/// A slip of at most this fraction of its operands is a rounding error.
const ROUNDED: f64 = 5e-7;

/// Rates of change of velocity and angular momentum.
pub(crate) type Rates = Motion;

/// Relative motion of the surfaces of a contact.
pub(crate) struct Slip {
    /// Velocity of B's surface relative to A's, perpendicular to the normal.
    pub(crate) t: DVec3,
    /// Arms of A and B; 0 for a static object.
    pub(crate) arms: [f64; 2],
}

impl World {
    /// Inverse mass of a side along the normal. Capsules and networks count as free spheres.
    fn free_mass(&self, side: Side) -> f64 {
        self.shares(side).into_iter().map(|(ball, share)| share * share * self.balls[ball].w()).sum()
    }

    fn free_inertia(&self, side: Side) -> f64 {
        self.shares(side).into_iter().map(|(ball, share)| share * share * self.balls[ball].i()).sum()
    }

    /// Inverse mass of a contact against slip, for the bound of friction.
    fn slip_mass(&self, pair: &Pair, line: &Line, arms: [f64; 2]) -> f64 {
        let of = |(side, arm): (Side, f64)| self.free_mass(side) + arm * arm * self.free_inertia(side);
        sides(pair, line).into_iter().zip(arms).map(of).sum()
    }

    pub(crate) fn slip(&self, pair: &Pair, line: &Line, motion: &Motion) -> Slip {
        let radii = [pair.a, pair.b].map(|thing| self.radius(thing));
        let back = match (self.made(Mistake::Arms), radii[1]) {
            (true, _) => 0.0,
            (false, Some(_)) => 0.5 * line.o,
            (false, None) => line.o,
        };
        let arms = radii.map(|radius| radius.map_or(0.0, |radius| radius - back));
        let [a, b] = sides(pair, line);
        let [va, on_wall] = self.surface_velocities(pair, line, motion);
        let vb = on_wall + self.belt(pair, line);
        let turn_a = self.spin(a, motion).cross(arms[0] * line.n);
        let turn_b = self.spin(b, motion).cross(arms[1] * line.n);
        let slip = (vb - turn_b) - (va + turn_a);
        let t = slip - line.n * slip.dot(line.n);
        let operands = [va, vb, turn_a, turn_b].into_iter().map(DVec3::length_squared).sum::<f64>().sqrt();
        Slip { t: if t.length() <= ROUNDED * operands { DVec3::ZERO } else { t }, arms }
    }

    /// Reduced mass and normal force of a contact (docs/physics section 4.3); `None` where there is no force.
    pub(crate) fn normal_force(&self, pair: &Pair, line: &Line, motion: &Motion, pull: bool) -> Option<(f64, f64)> {
        let [a, b] = sides(pair, line);
        let [va, vb] = self.surface_velocities(pair, line, motion);
        let u = (va - vb).dot(line.n);
        let c = self.threshold(pair);
        let separating_fast = u < -c && !self.made(Mistake::Separating);
        let new_overlap = u > c && line.o < 2.0 * u * self.dt;
        let mass = self.free_mass(a) + self.free_mass(b);
        if mass == 0.0 || self.set.collisions && (separating_fast || new_overlap) {
            return None;
        }
        let strength = self.set.stiffness * line.o + self.set.damping * u;
        Some((1.0 / mass, if pull { strength } else { strength.max(0.0) } / mass))
    }

    /// Adds the force and the torques of a contact.
    fn contact(&self, pair: &Pair, line: &Line, motion: &Motion, loads: &mut Motion) {
        let Some((mass, normal)) = self.normal_force(pair, line, motion, self.set.pull) else { return };
        let slip = self.slip(pair, line, motion);
        let both = sides(pair, line);
        let speed = slip.t.length();
        let mut friction = DVec3::ZERO;
        if speed > 0.0 {
            let law = self.set.friction * mass * line.o * speed.sqrt();
            let bound = speed / (2.0 * self.slip_mass(pair, line, slip.arms) * self.dt);
            let size = match self.set.coulomb {
                0.0 if self.made(Mistake::FrictionBound) => law,
                0.0 => law.min(bound),
                _ => 0.0,
            };
            friction = size * slip.t / speed;
        }
        for (side, arm) in both.into_iter().zip(slip.arms) {
            let force = side.sign * (normal * line.n - friction);
            let torque = arm * line.n.cross(friction);
            for (ball, share) in self.shares(side) {
                loads.v[ball] += share * force;
                loads.l[ball] += share * torque;
            }
        }
    }

    /// External forces, springs and tethers on every sphere.
    pub(crate) fn pull_forces(&self) -> Vec<DVec3> {
        let mut forces: Vec<DVec3> = self.balls.iter().map(|ball| ball.force).collect();
        for pull in &self.pulls {
            let near = &self.balls[pull.ball];
            let (far, far_v) = match pull.anchor {
                Anchor::Ball(ball) => (self.balls[ball].x, self.balls[ball].v),
                Anchor::Point(point) => (point, DVec3::ZERO),
            };
            let d = far - near.x;
            let Some(n) = d.try_normalize() else { continue };
            let force = (pull.stiffness * (d.length() - pull.length) + pull.damping * (far_v - near.v).dot(n)) * n;
            forces[pull.ball] += force;
            if let Anchor::Ball(ball) = pull.anchor {
                forces[ball] -= force;
            }
        }
        forces
    }

    /// Second derivative of the energy of springs and tethers for displacements of all spheres (docs/physics section
    /// 3.6).
    pub(crate) fn curvature(&self, displacements: &[DVec3]) -> f64 {
        let of_pull = |pull: &Pull| {
            let (far, moved) = match pull.anchor {
                Anchor::Ball(ball) => (self.balls[ball].x, displacements[ball]),
                Anchor::Point(point) => (point, DVec3::ZERO),
            };
            let (d, s) = (far - self.balls[pull.ball].x, moved - displacements[pull.ball]);
            if d == DVec3::ZERO {
                return 0.0;
            }
            // The stiffness acts along the spring, the present tension across it.
            let tight = pull.length / d.length();
            pull.stiffness * ((1.0 - tight) * s.length_squared() + tight * s.dot(d).powi(2) / d.length_squared())
        };
        self.pulls.iter().map(of_pull).sum()
    }

    /// Acceleration of every sphere by everything except contacts and damping.
    pub(crate) fn pulled_accelerations(&self) -> Vec<DVec3> {
        let forces = self.pull_forces();
        let of = |(ball, force): (&Ball, DVec3)| if ball.fixed { DVec3::ZERO } else { self.set.gravity + force / ball.mass };
        self.balls.iter().zip(forces).map(of).collect()
    }

    /// Accelerations by everything except contacts. Both ends of a capsule have that of its centre (docs/physics
    /// section 3.6).
    pub(crate) fn free_accelerations(&self) -> Vec<DVec3> {
        let forces = self.pull_forces();
        (0..self.balls.len())
            .map(|ball| match self.body[ball] {
                None => DVec3::ZERO,
                Some(Body::Capsule(bar)) => {
                    let [one, two] = self.bars[bar].ends;
                    let mass = self.balls[one].mass + self.balls[two].mass;
                    self.set.gravity + (forces[one] + forces[two]) / mass
                }
                Some(_) => self.set.gravity + forces[ball] / self.balls[ball].mass,
            })
            .collect()
    }

    /// Rates of change of velocity and angular momentum in the present state.
    pub(crate) fn rates(&self) -> Rates {
        let motion = Motion::of(self);
        let mut loads = Motion { v: self.pull_forces(), ..Motion::none(self) };
        for (pair, line) in self.touches() {
            self.contact(&pair, &line, &motion, &mut loads);
        }
        for (ball, state) in self.balls.iter().enumerate() {
            if state.fixed {
                (loads.v[ball], loads.l[ball]) = (DVec3::ZERO, DVec3::ZERO);
            } else {
                loads.v[ball] = loads.v[ball] / state.mass + self.set.gravity - self.set.linear_damping * motion.v[ball];
                loads.l[ball] -= self.set.angular_damping * motion.l[ball];
            }
        }
        loads
    }
}
