//! Rigid bodies of spheres and rods (docs/physics.md sections 1.5, 4.16 and 5.9).

use rockfall::glam::{DQuat, DVec3};
use rockfall::{RigidBody, Scene, Sphere, SphereId, SphereState};

use crate::boxes::places;
use crate::geometry::{Line, Pair, Thing};
use crate::sides::{Motion, Side, sides};
use crate::world::{Ball, Body, Mistake, World};

/// A coefficient of restitution counts as at least this.
const LEAST_RESTITUTION: f64 = 0.01;

/// A rigid body.
#[derive(Clone, Debug)]
pub(crate) struct Clump {
    /// Centre of mass, and its velocity.
    pub(crate) x: DVec3,
    pub(crate) v: DVec3,
    /// Angular momentum about the centre of mass.
    pub(crate) l: DVec3,
    pub(crate) q: DQuat,
    pub(crate) mass: f64,
    /// Principal moments of inertia.
    pub(crate) moments: DVec3,
    /// Turns coordinates along the principal axes into those of the body.
    pub(crate) axes: DQuat,
    /// Spheres, and their centres from the centre of mass in coordinates of the body.
    pub(crate) members: Vec<(usize, DVec3)>,
    /// Whether it is a frame of rods, which the scene does not list as a body.
    pub(crate) implied: bool,
}

/// A point of a body at which a contact acts.
struct Spot {
    clump: usize,
    /// From the centre of mass to the centre of a sphere, the point of the axis of a rod, or the point of the core of a box.
    lever: DVec3,
    /// Radius of the sphere or rod.
    radius: f64,
}

impl Clump {
    /// The bodies of a scene. `number` is that of a sphere in the scene.
    pub(crate) fn all(scene: &Scene, number: impl Fn(SphereId) -> usize) -> Vec<Self> {
        let of = |body: &RigidBody| {
            let shape = scene.shape(body.shape).expect("the shape of a body");
            let properties = shape.mass_properties_of().expect("a valid shape");
            let (moments, axes) = properties.principal();
            let centre = DVec3::from_array(properties.centre);
            let arms = places(scene, body, shape, centre).into_iter().map(|place| place - centre);
            let members = body.spheres().iter().map(|&id| number(id)).zip(arms).collect();
            let (x, v, l, q) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DQuat::IDENTITY);
            let mut clump = Self { x, v, l, q, mass: properties.mass, moments, axes, members, implied: false };
            clump.set(body);
            clump
        };
        scene.bodies().iter().map(of).collect()
    }

    pub(crate) fn set(&mut self, body: &RigidBody) {
        self.x = DVec3::from_array(body.centre());
        self.v = body.velocity.as_dvec3();
        self.l = body.angular_momentum.as_dvec3();
        self.q = body.orientation.as_dquat().normalize();
    }

    /// A principal axis in coordinates of the scene.
    fn axis(&self, k: usize) -> DVec3 {
        self.q * (self.axes * DVec3::AXES[k])
    }

    /// Product of the inverse inertia with a vector.
    pub(crate) fn inverse(&self, y: DVec3) -> DVec3 {
        (0..3).map(|k| self.axis(k) * (self.axis(k).dot(y) / self.moments[k])).sum()
    }

    pub(crate) fn spin(&self) -> DVec3 {
        self.inverse(self.l)
    }

    pub(crate) fn inverse_mass(&self, lever: DVec3, n: DVec3) -> f64 {
        let arm = lever.cross(n);
        1.0 / self.mass + arm.dot(self.inverse(arm))
    }

    /// The orientation after a free rotation for a time with the angular momentum `l`.
    fn turned(&self, l: DVec3, time: f64) -> DQuat {
        let mut sorted = self.moments.to_array();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted[1];
        let mut body = self.clone();
        body.q = DQuat::from_scaled_axis(time / middle * l) * body.q;
        for (k, part) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
            let rate = 1.0 / self.moments[k] - 1.0 / middle;
            if rate != 0.0 {
                let axis = body.axis(k);
                body.q = DQuat::from_axis_angle(axis.normalize(), part * time * rate * axis.dot(l)) * body.q;
            }
        }
        body.q.normalize()
    }

    /// A ball with the state of the body, for comparisons.
    fn as_ball(&self, balls: &[Ball]) -> Ball {
        let reach = |&(ball, arm): &(usize, DVec3)| arm.length() + balls[ball].radius;
        let radius = self.members.iter().map(reach).fold(0.0, f64::max);
        let (x, v, l, q, mass) = (self.x, self.v, self.l, self.q, self.mass);
        Ball { x, v, l, q, mass, radius, fixed: false, force: DVec3::ZERO, group: 0 }
    }
}

/// The state of a body in the form of that of a sphere.
pub(crate) fn state_of(body: &RigidBody) -> SphereState {
    let sphere = Sphere::new(body.position, 1.0).velocity(body.velocity).angular_momentum(body.angular_momentum);
    let mut state = SphereState::from(&sphere);
    state.orientation = body.orientation;
    state
}

/// The damping of an impact of two bodies, in units of the square root of stiffness and mass, for which it rebounds with
/// `restitution`. The force is clipped at 0.
fn damping_of(restitution: f64) -> f64 {
    let wanted = restitution.clamp(LEAST_RESTITUTION, 1.0);
    // The force of the damped oscillator is 0 again after the angle 2 acos(half).
    let rebound = |half: f64| match half {
        half if half < 1.0 => (-2.0 * half * half.acos() / (1.0 - half * half).sqrt()).exp(),
        half if half > 1.0 => (-2.0 * half * half.acosh() / (half * half - 1.0).sqrt()).exp(),
        _ => (-2.0_f64).exp(),
    };
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if rebound(middle) > wanted { &mut low } else { &mut high }) = middle;
    }
    2.0 * low
}

impl World {
    /// The rigid body that a sphere is a member of.
    pub(crate) fn clump_at(&self, ball: usize) -> Option<usize> {
        match self.body[ball] {
            Some(Body::Clump(clump)) => Some(clump),
            _ => None,
        }
    }

    /// The rigid body of an object.
    pub(crate) fn clump_of(&self, thing: Thing) -> Option<usize> {
        match thing {
            Thing::Ball(ball) => self.clump_at(ball),
            Thing::Bar(bar) => {
                let [one, two] = self.bars[bar].ends.map(|end| self.clump_at(end));
                one.filter(|_| one == two)
            }
            Thing::Block(_) | Thing::Face(_) => None,
        }
    }

    /// Whether a contact exerts forces and gets no impulses: that of a rod that ends in a rigid body without being a part of
    /// it.
    pub(crate) fn has_forces_alone(&self, pair: &Pair) -> bool {
        [pair.a, pair.b].into_iter().any(|thing| match thing {
            Thing::Bar(bar) => {
                self.clump_of(thing).is_none() && self.bars[bar].ends.iter().any(|&end| self.clump_at(end).is_some())
            }
            _ => false,
        })
    }

    /// Changes of a rigid body and its spheres by an impulse `p` on a side.
    pub(crate) fn push_clump(&self, side: Side, p: DVec3, change: &mut Motion) -> bool {
        self.push_and_turn_clump(side, p, DVec3::ZERO, change)
    }

    /// The same with a torque in addition.
    pub(crate) fn push_and_turn_clump(&self, side: Side, p: DVec3, torque: DVec3, change: &mut Motion) -> bool {
        let Some(Spot { clump, lever, .. }) = self.spot(side) else { return false };
        let lever = if self.made(Mistake::BodyLever) { DVec3::ZERO } else { lever };
        let body = &self.clumps[clump];
        let (v, l) = (p / body.mass, lever.cross(p) + torque);
        change.clump_v[clump] += v;
        change.clump_l[clump] += l;
        let turning = body.inverse(l);
        for &(ball, arm) in &body.members {
            change.v[ball] += v + turning.cross(body.q * arm);
            change.l[ball] += turning * self.balls[ball].inertia();
        }
        true
    }

    /// Displacements of the spheres of a rigid body per unit of time by an impulse at the time of contact, which turns their present levers.
    pub(crate) fn displace_clump(&self, then: &Self, side: Side, p: DVec3, way: &mut Motion) {
        let mut change = Motion::none(self);
        then.push_clump(side, p, &mut change);
        let Some(number) = self.clump_of(side.thing) else { return };
        let turning = then.clumps[number].inverse(change.clump_l[number]);
        for &(ball, arm) in &self.clumps[number].members {
            way.v[ball] += change.clump_v[number] + turning.cross(self.clumps[number].q * arm);
        }
    }

    /// A rigid body that is touched on a side, moved back in time with the acceleration `a` of its centre, and its spheres.
    pub(crate) fn clump_back(&mut self, side: Side, a: DVec3, tau: f64, curved: bool) {
        let Some(Spot { clump, lever, .. }) = self.spot(side) else { return };
        let spin = self.clumps[clump].spin();
        let v = self.velocity(side, &Motion::of(self)) - spin.cross(lever);
        let body = &mut self.clumps[clump];
        body.x += if curved { 0.5 * tau * tau * a } else { DVec3::ZERO } - tau * v;
        body.v = v - tau * a;
        body.q = body.turned(body.l, -tau);
        self.place_clump(clump);
    }

    /// Moves a rigid body forward in time from `then`, when the impulse acted on it.
    pub(crate) fn clump_forth(&mut self, then: &Self, number: usize, tau: f64, impulse: &Motion) {
        let (body, before) = (&mut self.clumps[number], &then.clumps[number]);
        body.x += tau * impulse.clump_v[number];
        body.q = before.turned(before.l + impulse.clump_l[number], tau);
    }

    /// Acceleration of the centre of a rigid body by forces on its spheres, gravity included.
    pub(crate) fn clump_acceleration(&self, clump: usize) -> DVec3 {
        let forces = self.pull_forces();
        let clump = &self.clumps[clump];
        self.set.gravity + clump.members.iter().map(|&(ball, _)| forces[ball]).sum::<DVec3>() / clump.mass
    }

    /// Acceleration of the spheres of rigid bodies by forces on all of them, `forces` without gravity.
    pub(crate) fn pull_clumps(&self, forces: &[DVec3], accelerations: &mut [DVec3]) {
        for clump in &self.clumps {
            let force: DVec3 = clump.members.iter().map(|&(ball, _)| forces[ball]).sum();
            let torque: DVec3 = clump.members.iter().map(|&(ball, _)| (self.balls[ball].x - clump.x).cross(forces[ball])).sum();
            for &(ball, _) in &clump.members {
                let lever = self.balls[ball].x - clump.x;
                accelerations[ball] = self.set.gravity + force / clump.mass + clump.inverse(torque).cross(lever);
            }
        }
    }

    /// Whether a rigid body is on a side of a contact.
    pub(crate) fn has_clump(&self, pair: &Pair) -> bool {
        [pair.a, pair.b].into_iter().any(|thing| self.clump_of(thing).is_some())
    }

    /// Marks the spheres of rigid bodies.
    pub(crate) fn find_members(&mut self) {
        for (number, clump) in self.clumps.iter().enumerate() {
            for &(ball, _) in &clump.members {
                self.body[ball] = Some(Body::Clump(number));
            }
        }
    }

    /// Places the spheres of rigid bodies.
    pub(crate) fn place_members(&mut self) {
        (0..self.clumps.len()).for_each(|number| self.place_clump(number));
    }

    fn place_clump(&mut self, number: usize) {
        let clump = &self.clumps[number];
        let spin = clump.spin();
        for &(ball, arm) in &clump.members {
            let (ball, arm) = (&mut self.balls[ball], clump.q * arm);
            (ball.x, ball.v, ball.q) = (clump.x + arm, clump.v + spin.cross(arm), clump.q);
            ball.l = spin * ball.inertia();
        }
    }

    /// The rigid bodies that the scene lists. They come before frames.
    pub(crate) fn listed(&self) -> usize {
        self.clumps.iter().filter(|clump| !clump.implied).count()
    }

    /// All rigid bodies as balls.
    pub(crate) fn clumps_as_balls(&self) -> impl Iterator<Item = Ball> + '_ {
        self.clumps.iter().map(|clump| clump.as_ball(&self.balls))
    }

    /// All spheres, and then the rigid bodies that the scene lists, as balls.
    pub(crate) fn compared(&self) -> Vec<Ball> {
        let bodies = self.clumps_as_balls().take(self.listed());
        self.balls.iter().cloned().chain(bodies).collect()
    }

    fn spot(&self, side: Side) -> Option<Spot> {
        let clump = self.clump_of(side.thing)?;
        let radius = self.radius(side.thing)?;
        let place: DVec3 = self.shares(side).into_iter().map(|(ball, share)| share * self.balls[ball].x).sum();
        Some(Spot { clump, lever: place + side.core - self.clumps[clump].x, radius })
    }

    /// The rigid body of a side, and its inverse mass for a unit impulse with a torque.
    pub(crate) fn clump_tangential_mass(&self, side: Side, p: DVec3, torque: DVec3) -> Option<(usize, f64)> {
        let Spot { clump, lever, .. } = self.spot(side)?;
        let lever = if self.made(Mistake::BodyFriction) { DVec3::ZERO } else { lever };
        let (body, turning) = (&self.clumps[clump], lever.cross(p) + torque);
        Some((clump, 1.0 / body.mass + turning.dot(body.inverse(turning))))
    }

    /// Inverse mass of a side on a rigid body.
    pub(crate) fn clump_mass(&self, side: Side, n: DVec3) -> Option<f64> {
        let Spot { clump, lever, .. } = self.spot(side)?;
        let lever = if self.made(Mistake::BodyLever) { DVec3::ZERO } else { lever };
        Some(self.clumps[clump].inverse_mass(lever, n))
    }

    /// The inverse inertia of a side on a rigid body that bounds friction.
    pub(crate) fn clump_inertia(&self, side: Side) -> Option<f64> {
        let Spot { clump, lever, radius } = self.spot(side)?;
        let lever = if self.made(Mistake::BodyBound) { 0.0 } else { lever.length() };
        Some((1.0 + lever / radius).powi(2) / self.clumps[clump].moments.min_element())
    }

    /// Force per approach velocity and reduced mass of a contact of a rigid body, or of one with forces alone.
    pub(crate) fn clump_damping(&self, pair: &Pair, line: &Line) -> f64 {
        let impact = self.set.collisions && (self.has_forces_alone(pair) || self.made(Mistake::BodyDamping));
        let one = if impact { damping_of(self.set.restitution) * self.set.stiffness.sqrt() } else { self.set.damping };
        one * self.wall_factor(pair, line) * self.pair_factor(pair, line)
    }

    /// Turns the loads of the spheres of rigid bodies into rates of change of the bodies.
    pub(crate) fn load_clumps(&self, motion: &Motion, loads: &mut Motion) {
        for (number, clump) in self.clumps.iter().enumerate() {
            let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
            for &(ball, _) in &clump.members {
                force += loads.v[ball];
                torque += loads.l[ball] + (self.balls[ball].x - clump.x).cross(loads.v[ball]);
            }
            loads.clump_v[number] = force / clump.mass + self.set.gravity - self.set.linear_damping * motion.clump_v[number];
            loads.clump_l[number] = torque - self.set.angular_damping * motion.clump_l[number];
        }
    }

    /// Moves rigid bodies with the velocities and angular momenta of `motion`, which change at the given rates.
    pub(crate) fn advance_clumps(&mut self, motion: &Motion, rates: &Motion, time: f64) {
        let wrong = self.made(Mistake::BodyTurn);
        for (number, clump) in self.clumps.iter_mut().enumerate() {
            let l = motion.clump_l[number];
            clump.q = if wrong { DQuat::from_scaled_axis(time * clump.inverse(l)) * clump.q } else { clump.turned(l, time) };
            clump.x += time * motion.clump_v[number];
            clump.v += time * rates.clump_v[number];
            clump.l += time * rates.clump_l[number];
        }
        self.place_members();
    }

    /// The part of friction that the law of Coulomb gives as a force, at a contact with forces alone.
    pub(crate) fn clump_friction(&self, normal: f64, bound: f64) -> f64 {
        (self.set.coulomb * normal.max(0.0)).min(bound)
    }

    /// Inverse mass of a contact against slip, for the bound of friction.
    pub(crate) fn slip_mass(&self, pair: &Pair, line: &Line, arms: [f64; 2]) -> f64 {
        let of = |(side, arm): (Side, f64)| self.free_mass(side, line.n) + arm * arm * self.free_inertia(side);
        sides(pair, line).into_iter().zip(arms).map(of).sum()
    }
}
