//! The bodies while a frame is solved, in flat arrays.

use std::collections::BTreeSet;

use glam::{Mat3A, Vec3, Vec3A};

use crate::rigid::common::MOST_MARGIN;
use crate::rigid::frame::turn::{Moments, about};
use crate::rigid::periods::Periods;
use crate::rigid::pose::Pose;
use crate::rigid::world::{Body, Kind, RigidWorld};
use crate::rotate::{product, unit};

/// Velocity and angular velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Motion {
    pub(super) velocity: Vec3A,
    pub(super) spin: Vec3A,
}

impl Motion {
    /// Velocity of the point at an arm from the centre.
    pub(super) fn at(&self, arm: Vec3A) -> Vec3A {
        self.velocity + self.spin.cross(arm)
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        Self { velocity: self.velocity - other.velocity, spin: self.spin - other.spin }
    }

    pub(super) fn plus(&self, other: &Self, share: f32) -> Self {
        Self { velocity: self.velocity + share * other.velocity, spin: self.spin + share * other.spin }
    }
}

/// How a body resists. All 0 without mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Mass {
    pub(super) inverse_mass: f32,
    pub(super) inverse_inertia: Mat3A,
}

impl Mass {
    /// The share of a body that takes part in `count` left-over blocks.
    pub(super) fn split(&self, count: f32) -> Self {
        if count == 1.0 {
            return *self;
        }
        Self { inverse_mass: count * self.inverse_mass, inverse_inertia: self.inverse_inertia * count }
    }
}

/// What does not change in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Constants {
    pub(super) dynamic: bool,
    pub(super) moments: Moments,
    pub(super) radius: f32,
    /// Acceleration: the field, the external force and springs.
    acceleration: Vec3A,
    torque: Vec3A,
    /// Springs or joints end at it.
    pub(super) sprung: bool,
    pub(super) margin: f32,
}

/// All bodies, by number.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies {
    pub(super) poses: Vec<Pose>,
    pub(super) motions: Vec<Motion>,
    pub(super) masses: Vec<Mass>,
    pub(super) momenta: Vec<Vec3A>,
    /// The spin that belongs to the momentum, bit for bit. Where the spin is another one, rows have changed it.
    pub(super) set: Vec<Vec3A>,
    /// The motions after the kick, before all impulses of a substep.
    pub(super) before: Vec<Motion>,
    /// From when on the path of a body in this substep holds, in s.
    pub(super) clocks: Vec<f32>,
    /// Length of the path of the frame, with that of the turning surface.
    pub(super) paths: Vec<f32>,
    pub(super) constants: Vec<Constants>,
    pub(super) periods: Periods,
    /// Bodies whose state stopped being finite in this frame.
    pub(super) stopped: BTreeSet<u32>,
}

/// The acceleration by the field and the external force, and the torque of that force.
fn kick_of(world: &RigidWorld, body: &Body) -> (Vec3A, Vec3A) {
    ((world.gravity + body.inverse_mass * body.force).into(), body.torque.into())
}

impl Bodies {
    /// The bodies at the start of a frame of `dt` seconds, with their margins.
    pub(super) fn load(world: &RigidWorld, dt: f32) -> Self {
        let count = world.bodies.len();
        let field = world.gravity.length();
        let mut all = Self { clocks: vec![0.0; count], paths: vec![0.0; count], periods: world.periods, ..Self::default() };
        for body in &world.bodies {
            let dynamic = body.kind == Kind::Dynamic && body.inverse_mass > 0.0;
            let moments = if dynamic { Moments::new(body.moments.into(), body.axes) } else { Moments::NONE };
            let turn = if body.spin == Vec3::ZERO { 0.0 } else { body.spin.length() * body.radius };
            let reach = (body.velocity.length() + turn) * dt;
            let fall = if dynamic { field * dt * dt } else { 0.0 };
            let margin = match body.kind {
                Kind::World => 0.0,
                Kind::Kinematic => 1.001 * reach,
                Kind::Dynamic => body.margin_scale * (0.02 * body.radius).max(reach + fall),
            };
            let (acceleration, torque) = if dynamic { kick_of(world, body) } else { (Vec3A::ZERO, Vec3A::ZERO) };
            let sprung = false;
            all.constants.push(Constants { dynamic, moments, radius: body.radius, acceleration, torque, sprung, margin });
            all.poses.push(body.pose);
            let inverse_mass = if dynamic { body.inverse_mass } else { 0.0 };
            all.masses.push(Mass { inverse_mass, inverse_inertia: moments.inverse_inertia(body.pose.turn) });
            let still = body.kind == Kind::World;
            let (velocity, spin) = if still { (Vec3A::ZERO, Vec3A::ZERO) } else { (body.velocity.into(), body.spin.into()) };
            all.motions.push(Motion { velocity, spin });
            all.momenta.push(body.momentum.into());
            all.set.push(spin);
        }
        let ends_of_joints = world.joints.list.iter().flat_map(|joint| joint.ends.map(|end| end.body));
        for body in world.springs.list.iter().flat_map(|spring| spring.bodies).chain(ends_of_joints) {
            all.constants[body as usize].sprung = all.constants[body as usize].dynamic;
        }
        if !world.laws.is_empty() {
            all.constants.iter_mut().for_each(|fixed| fixed.sprung = fixed.dynamic);
        }
        all.before.clone_from(&all.motions);
        all
    }

    /// Writes the state of the bodies that move.
    pub(super) fn store(&self, bodies: &mut [Body]) {
        for (i, body) in bodies.iter_mut().enumerate().filter(|(_, body)| body.kind != Kind::World) {
            body.pose = self.poses[i];
            if self.constants[i].dynamic {
                let Motion { velocity, spin } = self.motions[i];
                (body.velocity, body.spin, body.momentum) = (velocity.into(), spin.into(), self.momenta[i].into());
                body.inverse_inertia = self.masses[i].inverse_inertia.into();
                let wanted = 1.25 * body.margin_scale * self.paths[i] / self.constants[i].margin;
                body.margin_scale = (0.99 * body.margin_scale).max(wanted).clamp(1.0, MOST_MARGIN);
            }
        }
    }

    /// Stops the bodies whose motion is not finite at the end of a frame. Of all that stopped in the frame: their number, and the first.
    pub(super) fn stop(&mut self) -> Option<(u32, u32)> {
        for i in 0..self.count() {
            if self.constants[i].dynamic && !self.moves_finitely(i) {
                self.halt(i);
            }
        }
        self.stopped.first().map(|first| (self.stopped.len() as u32, *first))
    }

    pub(super) fn count(&self) -> usize {
        self.poses.len()
    }

    /// Takes the force and the torque of springs for the next kick.
    pub(super) fn pull(&mut self, world: &RigidWorld, i: usize, [force, torque]: [Vec3A; 2]) {
        let (acceleration, constant) = kick_of(world, &world.bodies[i]);
        self.constants[i].acceleration = acceleration + self.masses[i].inverse_mass * force;
        self.constants[i].torque = constant + torque;
    }

    /// The field and the forces of a substep, before its impulses.
    pub(super) fn kick(&mut self, h: f32) {
        for i in 0..self.count() {
            let fixed = &self.constants[i];
            if fixed.dynamic {
                self.motions[i].velocity += h * fixed.acceleration;
                self.momenta[i] += h * fixed.torque;
                self.motions[i].spin = self.masses[i].inverse_inertia * self.momenta[i];
                self.set[i] = self.motions[i].spin;
            }
        }
        self.before.copy_from_slice(&self.motions);
    }

    /// Lets the momentum follow the spin where rows have changed it.
    pub(super) fn follow(&mut self) {
        for i in 0..self.count() {
            let spin = self.motions[i].spin;
            if self.constants[i].dynamic && spin != self.set[i] {
                self.momenta[i] = self.constants[i].moments.momentum(self.poses[i].turn, spin);
                self.set[i] = spin;
            }
        }
    }

    /// Lets the spin follow the momentum and the orientation.
    pub(super) fn respin(&mut self, i: usize) {
        let inverse_inertia = self.constants[i].moments.inverse_inertia(self.poses[i].turn);
        self.masses[i].inverse_inertia = inverse_inertia;
        self.motions[i].spin = inverse_inertia * self.momenta[i];
        self.set[i] = self.motions[i].spin;
    }

    /// Moves all bodies by a substep. Free flight is an exact parabola; the momentum of a free body does not change by a bit.
    pub(super) fn drift(&mut self, h: f32) {
        for i in 0..self.count() {
            let (motion, fixed) = (self.motions[i], &self.constants[i]);
            if !fixed.dynamic {
                self.poses[i].position += Vec3::from(h * motion.velocity);
                if motion.spin != Vec3A::ZERO {
                    self.poses[i].turn = unit(product(about(h * motion.spin), self.poses[i].turn));
                }
                continue;
            }
            self.paths[i] += h * (motion.velocity.length() + motion.spin.length() * fixed.radius);
            let change = motion.minus(&self.before[i]);
            let size = change.velocity.length() + fixed.radius * change.spin.length();
            let limit = 0.25 * fixed.acceleration.length() * h;
            let beta = match size {
                _ if fixed.sprung || limit == 0.0 => 0.0,
                0.0 => 1.0,
                _ => (1.0 - size / limit).max(0.0),
            };
            let way = h * motion.velocity - 0.5 * beta * h * h * fixed.acceleration;
            let position = self.poses[i].position + Vec3::from(way);
            let turn = fixed.moments.turned(self.poses[i].turn, self.momenta[i], h);
            let pose = Pose::new(position, turn);
            if self.fits(i, &pose) {
                self.poses[i] = pose;
            } else {
                self.halt(i);
                continue;
            }
            self.respin(i);
        }
        self.clocks.fill(0.0);
    }

    /// Whether all points of a body are finite in a pose.
    pub(super) fn fits(&self, i: usize, pose: &Pose) -> bool {
        (pose.position.abs() + self.constants[i].radius).is_finite() && pose.turn.is_finite()
    }

    /// Whether the velocities of all points of a body, and the angular momenta of all spheres in it, are finite. Their radii are at
    /// most twice that of the body.
    fn moves_finitely(&self, i: usize) -> bool {
        let Motion { velocity, spin } = self.motions[i];
        let radius = self.constants[i].radius;
        let rim = radius * spin;
        let speed = velocity.abs().max_element() + (rim.abs().x + rim.abs().y + rim.abs().z);
        let inner = 1.6 * radius * rim / self.masses[i].inverse_mass;
        velocity.is_finite() && speed.is_finite() && inner.is_finite() && self.momenta[i].is_finite()
    }

    /// Stops a body where it is: its next pose or its motion is not finite.
    pub(super) fn halt(&mut self, i: usize) {
        self.motions[i].velocity = Vec3A::ZERO;
        self.momenta[i] = Vec3A::ZERO;
        self.stopped.insert(i as u32);
        self.respin(i);
    }

    /// Where a body is at a time of the substep before its kick, and how it moves there.
    pub(super) fn at(&self, i: usize, time: f32, gravity: Vec3A) -> (Pose, Motion) {
        let (pose, motion) = (self.poses[i], self.motions[i]);
        if time == 0.0 {
            return (pose, motion);
        }
        let fixed = &self.constants[i];
        if !fixed.dynamic {
            let turn = if motion.spin == Vec3A::ZERO { pose.turn } else { unit(product(about(time * motion.spin), pose.turn)) };
            return (Pose::new(pose.position + Vec3::from(time * motion.velocity), turn), motion);
        }
        let position = pose.position + Vec3::from(time * motion.velocity + 0.5 * time * time * gravity);
        let turn = fixed.moments.turned(pose.turn, self.momenta[i], time);
        let spin = if motion.spin == Vec3A::ZERO { Vec3A::ZERO } else { fixed.moments.inverse_inertia(turn) * self.momenta[i] };
        (Pose::new(position, turn), Motion { velocity: motion.velocity + time * gravity, spin })
    }

    /// What moves the second body of a block to its image nearest to the first one.
    pub(super) fn image(&self, bodies: [u32; 2]) -> Vec3 {
        let [a, b] = bodies.map(|body| body as usize);
        if !self.periods.any() || !self.constants[a].dynamic || !self.constants[b].dynamic {
            return Vec3::ZERO;
        }
        self.periods.nearest(self.poses[b].position - self.poses[a].position)
    }

    /// The poses of two bodies, the second one at its image nearest to the first one.
    pub(super) fn poses_of(&self, bodies: [u32; 2]) -> [Pose; 2] {
        let [a, mut b] = bodies.map(|body| self.poses[body as usize]);
        b.position += self.image(bodies);
        [a, b]
    }

    /// The path of a body over its margin, if it has left it.
    pub(super) fn beyond(&self, i: usize) -> Option<f32> {
        let fixed = &self.constants[i];
        (fixed.dynamic && self.paths[i] > fixed.margin).then(|| self.paths[i] / fixed.margin)
    }
}
