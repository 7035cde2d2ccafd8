//! One step: collisions, integration, and the corrections after it (docs/physics sections 2 and 5).

use rockfall::Integrator;
use rockfall::glam::DVec3;

use crate::collide::Pressed;
use crate::sides::Motion;
use crate::world::{Ball, World};

/// Data of the start of phase 4 that the end of the step needs.
pub(crate) struct Course {
    /// Positions before the integration, with restored rod lengths.
    pub(crate) old: Vec<DVec3>,
    /// Mean spins over the step.
    pub(crate) spin: Vec<DVec3>,
}

impl World {
    /// Computes a whole step. `lengths_due` requests the restoration of lengths.
    pub(crate) fn step(&mut self, lengths_due: bool) -> Vec<Pressed> {
        let pressed = self.handle_collisions(self.set.collisions);
        self.update_positions(lengths_due);
        pressed
    }

    /// Phase 3: impulses of collisions, if `impulses` is set, and friction impulses.
    pub(crate) fn handle_collisions(&mut self, impulses: bool) -> Vec<Pressed> {
        let accelerations = self.note_pulled();
        // With symplectic Euler, velocities are half a step behind positions (docs/physics section 5.2).
        let late = if self.set.integrator == Integrator::SymplecticEuler { 0.5 * self.dt } else { 0.0 };
        let kick =
            |world: &mut Self, time: f64| world.balls.iter_mut().zip(&accelerations).for_each(|(ball, a)| ball.v += time * *a);
        kick(self, late);
        let pressed = self.change_velocities(impulses);
        kick(self, -late);
        self.apply_friction_impulses(&pressed);
        pressed
    }

    /// Notes the sizes of the accelerations by everything but contacts and damping, which thresholds use until the next phase 3.
    pub(crate) fn note_pulled(&mut self) -> Vec<DVec3> {
        let accelerations = self.pulled_accelerations();
        self.pulled = Some(accelerations.iter().map(|a| a.length()).collect());
        accelerations
    }

    fn change_velocities(&mut self, impulses: bool) -> Vec<Pressed> {
        let mut pressed = if impulses { self.collide() } else { self.find() };
        if !impulses {
            for contact in &mut pressed {
                (contact.collides, contact.lone) = (false, false);
            }
        }
        pressed
    }

    /// Phase 4.
    pub(crate) fn update_positions(&mut self, lengths_due: bool) {
        if lengths_due {
            self.restore_lengths();
        }
        let course = match self.set.integrator {
            Integrator::Rk4 => self.rk4(),
            Integrator::VelocityVerlet => self.velocity_verlet(),
            _ => self.symplectic_euler(),
        };
        self.constrain(&course.old);
        self.turn(&course);
    }

    fn positions(&self) -> Vec<DVec3> {
        self.balls.iter().map(|ball| ball.x).collect()
    }

    fn spins(&self) -> Vec<DVec3> {
        self.balls.iter().map(Ball::spin).collect()
    }

    fn symplectic_euler(&mut self) -> Course {
        let old = self.positions();
        let rates = self.rates();
        let dt = self.dt;
        self.advance(&Motion::none(self), &rates, dt);
        self.advance(&Motion::of(self), &Motion::none(self), dt);
        Course { old, spin: self.spins() }
    }

    /// From forces that are evaluated at the start of the step, as after every edit.
    fn velocity_verlet(&mut self) -> Course {
        let old = self.positions();
        let half = 0.5 * self.dt;
        let rates = self.rates();
        self.advance(&Motion::none(self), &rates, half);
        let spin = self.spins();
        self.advance(&Motion::of(self), &Motion::none(self), self.dt);
        self.place_walls(self.time + self.dt);
        self.constrain(&old);
        let rates = self.rates();
        self.advance(&Motion::none(self), &rates, half);
        Course { old, spin }
    }

    fn rk4(&mut self) -> Course {
        let start = self.clone();
        let (mut mean, mut sum) = (Motion::none(self), Motion::none(self));
        let mut spin = vec![DVec3::ZERO; self.balls.len()];
        let mut stage = start.clone();
        for (weight, next) in [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)] {
            let rates = stage.rates();
            let motion = Motion::of(&stage);
            let part = weight / 6.0;
            stage.spins().into_iter().zip(&mut spin).for_each(|(turn, spin)| *spin += part * turn);
            mean.add(&motion, part);
            sum.add(&rates, part);
            stage = start.clone();
            stage.advance(&motion, &rates, next * self.dt);
            stage.place_walls(start.time + next * self.dt);
        }
        self.advance(&mean, &sum, self.dt);
        Course { old: start.positions(), spin }
    }

    /// Moves everything with the velocities of `motion`, which change at the given rates.
    fn advance(&mut self, motion: &Motion, rates: &Motion, time: f64) {
        for (at, ball) in self.balls.iter_mut().enumerate().filter(|(_, ball)| !ball.fixed) {
            ball.x += time * motion.v[at];
            ball.v += time * rates.v[at];
            ball.l += time * rates.l[at];
        }
    }
}
