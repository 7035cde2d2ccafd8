//! Collisions: which contacts collide, lone collisions, and clusters (docs/physics section 3).

use rockfall::Integrator;
use rockfall::glam::DVec3;

use crate::geometry::{Line, Pair, Thing};
use crate::sides::{Motion, Rigid, Side, sides};
use crate::world::{Body, Mistake, World};

/// A contact is pressed if its overlap exceeds this factor times the smaller radius.
const PRESSED: f64 = 1e-5;
/// Contacts whose normals have at most this scalar product do not influence each other.
const ACROSS: f64 = 0.001;
/// Two contacts are at one place if 1 - G_kl^2 / (G_kk G_ll) is at most this.
const ONE_PLACE: f64 = 1e-3;
/// Sweeps over the contacts of a cluster.
const SWEEPS: [f64; 8] = [1.25098, 1.25098, 2.66852, 2.66852, 1.81611, 1.81611, 1.0, 1.0];
/// If the inverse mass of a network is less than this fraction of that of its spheres without rods, the contact cannot
/// move.
const RIGID: f64 = 1e-6;

/// A contact that is pressed at the start of the phase.
#[derive(Clone, Debug)]
pub(crate) struct Pressed {
    pub(crate) pair: Pair,
    pub(crate) line: Line,
    pub(crate) collides: bool,
    pub(crate) lone: bool,
    /// Normal impulse that the contact received.
    pub(crate) j: f64,
    /// Time since first contact.
    pub(crate) tau: f64,
}

impl World {
    /// The smaller radius of a pair.
    pub(crate) fn least_radius(&self, pair: &Pair) -> f64 {
        let radius = |thing: Thing| self.radius(thing).unwrap_or(f64::INFINITY);
        radius(pair.a).min(radius(pair.b))
    }

    /// The approach velocity above which a pair collides.
    pub(crate) fn threshold(&self, pair: &Pair) -> f64 {
        let now = || self.pulled_accelerations().iter().map(|a| a.length()).collect();
        let sizes: Vec<f64> = self.pulled.clone().unwrap_or_else(now);
        let of = |thing: Thing| match thing {
            Thing::Ball(ball) => sizes[ball],
            Thing::Bar(bar) => self.bars[bar].ends.map(|end| sizes[end]).into_iter().fold(0.0, f64::max),
            Thing::Block(_) | Thing::Face(_) => 0.0,
        };
        let steps = if self.set.integrator == Integrator::SymplecticEuler { 4.0 } else { 2.0 };
        let pulled = of(pair.a).max(of(pair.b)) + self.wall_acceleration(pair);
        (self.set.threshold * self.least_radius(pair)).max(steps * pulled * self.dt)
    }

    /// Finds the pressed contacts, and which of them collide (docs/physics section 3.1) and are lone (section 3.5).
    pub(crate) fn find(&self) -> Vec<Pressed> {
        let mut pressed = Vec::new();
        for (pair, line) in self.touches() {
            let mass: f64 = sides(&pair, &line).into_iter().map(|side| self.unprojected(side, line.n)).sum();
            if line.o > PRESSED * self.least_radius(&pair) && mass > 0.0 {
                let collides = self.closing(&pair, &line) > self.threshold(&pair);
                pressed.push(Pressed { pair, line, collides, lone: false, j: 0.0, tau: 0.0 });
            }
        }
        let lone: Vec<bool> = (0..pressed.len()).map(|k| pressed[k].collides && self.is_lone(&pressed, k)).collect();
        for (contact, lone) in pressed.iter_mut().zip(lone) {
            contact.lone = lone;
        }
        pressed
    }

    fn is_lone(&self, pressed: &[Pressed], k: usize) -> bool {
        let this = &pressed[k];
        self.touched(&this.pair, &this.line).into_iter().all(|body| {
            let influences = |other: &Pressed| {
                let of_sphere = body == Body::Single(if let Thing::Ball(ball) = other.pair.a { ball } else { usize::MAX });
                let of_static = matches!(other.pair.b, Thing::Block(_) | Thing::Face(_));
                let across = this.line.n.dot(other.line.n).abs() <= ACROSS;
                self.touched(&other.pair, &other.line).contains(&body) && !(of_sphere && of_static && across)
            };
            let others = pressed.iter().enumerate().filter(|&(l, _)| l != k);
            !matches!(body, Body::Network(_)) && !others.into_iter().any(|(_, other)| influences(other))
        })
    }

    /// Computes collisions without friction impulses. Returns the pressed contacts.
    pub(crate) fn collide(&mut self) -> Vec<Pressed> {
        let mut pressed = self.find();
        let accelerations = self.free_accelerations();
        let (mut change, mut moved) = (Motion::none(self), vec![DVec3::ZERO; self.balls.len()]);
        for contact in pressed.iter_mut().filter(|contact| contact.lone) {
            self.lone(contact, &accelerations, &mut change, &mut moved);
        }
        self.cluster(&mut pressed, &mut change);
        for (at, ball) in self.balls.iter_mut().enumerate() {
            ball.x += moved[at];
            ball.v += change.v[at];
            ball.l += change.l[at];
        }
        pressed
    }

    /// A lone collision at its time of contact (docs/physics section 3.6).
    fn lone(&self, contact: &mut Pressed, accelerations: &[DVec3], change: &mut Motion, moved: &mut [DVec3]) {
        let pair = contact.pair;
        let bodies = self.touched(&pair, &contact.line);
        let face = self.on_face(&pair);
        let line_of = |world: &Self| match face {
            Some(ball) => {
                let moved = world.balls[ball].x - self.balls[ball].x;
                Some(Line { o: contact.line.o + moved.dot(contact.line.n), ..contact.line })
            }
            None => world.line(&pair),
        };
        let wall = self.wall(pair.b).filter(|_| !self.made(Mistake::WallReturn));
        let closing = |world: &Self, tau: f64, curved: bool| {
            if let Some(wall) = &wall {
                return world.closing_of_wall(&pair, wall, tau, curved, line_of);
            }
            let line = line_of(world)?;
            let u = world.closing(&pair, &line);
            (u > 0.0).then_some((line, u))
        };
        let mut tau = 0.0_f64;
        for _ in 0..4 {
            let Some((line, u)) = closing(&self.back(&bodies, accelerations, tau, true), tau, true) else { break };
            tau = (tau + line.o / u).clamp(0.0, self.dt);
        }
        if self.made(Mistake::NoReturn) {
            tau = 0.0;
        }
        let mut then = self.back(&bodies, accelerations, tau, false);
        let (line, u) = closing(&then, tau, false).unwrap_or_else(|| {
            tau = 0.0;
            then = self.clone();
            (contact.line, self.closing(&pair, &contact.line))
        });
        let (unit, j) = self.lone_impulse(&then, &pair, &line, u, tau);
        contact.j = j;
        contact.tau = tau;
        let mut impulse = Motion::none(self);
        impulse.add(&unit, contact.j);
        for body in bodies {
            match body {
                Body::Single(ball) => {
                    moved[ball] += tau * impulse.v[ball];
                    change.v[ball] += impulse.v[ball];
                    change.l[ball] += impulse.l[ball];
                }
                Body::Capsule(bar) => self.capsule_forth(bar, tau, &impulse, change, moved),
                Body::Network(_) => {}
            }
        }
    }

    /// The changes by a unit impulse at the time of contact, and the impulse of a lone collision with the approach velocity `u`.
    fn lone_impulse(&self, then: &Self, pair: &Pair, line: &Line, u: f64, tau: f64) -> (Motion, f64) {
        let mass: f64 = sides(pair, line).into_iter().map(|side| then.unprojected(side, line.n)).sum();
        let mut unit = Motion::none(self);
        for side in sides(pair, line) {
            then.give(side, side.sign * line.n, &mut unit);
        }
        // The displacements change the energy of springs to second order in tau. Without this term every collision
        // would add energy.
        let work = tau * tau * self.curvature(&self.displacements(then, pair, line));
        let springs = if self.made(Mistake::SpringWork) { 0.0 } else { work };
        (unit, (1.0 + self.elasticity()) * u / (mass + springs).max(0.5 * mass))
    }

    /// Displacement of every sphere per unit of time since the contact, caused by a unit impulse at the time of
    /// contact. The impulse on a capsule acts on its axis at the time of contact, but the resulting rotation is applied
    /// to its present axis.
    fn displacements(&self, then: &Self, pair: &Pair, line: &Line) -> Vec<DVec3> {
        let mut way = Motion::none(self);
        for side in sides(pair, line) {
            let p = side.sign * line.n;
            match (self.capsule_of(side), then.capsule_of(side)) {
                (Some((now, _)), Some((past, at))) => now.give(p, past.torque(at, p), DVec3::ZERO, &mut way),
                _ => then.give(side, p, &mut way),
            }
        }
        way.v
    }

    fn elasticity(&self) -> f64 {
        self.set.restitution * if self.made(Mistake::Restitution) { 1.01 } else { 1.0 }
    }

    /// Moves these bodies back in time. Positions follow a parabola with the accelerations if `curved` is set, and
    /// straight lines otherwise. Velocities change by the accelerations in both cases.
    fn back(&self, bodies: &[Body], accelerations: &[DVec3], tau: f64, curved: bool) -> Self {
        let mut world = self.clone();
        for &body in bodies {
            match body {
                Body::Single(ball) => {
                    let (state, a) = (&mut world.balls[ball], accelerations[ball]);
                    state.x += if curved { 0.5 * tau * tau * a } else { DVec3::ZERO } - tau * state.v;
                    state.v -= tau * a;
                }
                Body::Capsule(bar) => {
                    let a = accelerations[self.bars[bar].ends[0]];
                    let way = |v: DVec3| if curved { 0.5 * tau * tau * a } else { DVec3::ZERO } - tau * v;
                    let (d, q, v) = turned(&Rigid::of(self, bar), &Motion::of(self), -tau);
                    let shift = way(v);
                    world.place(bar, &Rigid::of(self, bar), shift, d, v - tau * a, q);
                }
                Body::Network(_) => {}
            }
        }
        world
    }

    /// Places a capsule, with its centre shifted relative to this world.
    fn place(&mut self, bar: usize, rigid: &Rigid, shift: DVec3, d: DVec3, v: DVec3, q: DVec3) {
        let [one, two] = self.bars[bar].ends;
        let parts = [-rigid.m[1] / rigid.mass, rigid.m[0] / rigid.mass];
        let centre = (rigid.m[0] * self.balls[one].x + rigid.m[1] * self.balls[two].x) / rigid.mass + shift;
        for (end, part) in [one, two].into_iter().zip(parts) {
            self.balls[end].x = centre + part * d;
            self.balls[end].v = v + part * q;
        }
    }

    /// Applies an impulse to a capsule that was moved back along its circle, and moves it forward along its new circle.
    fn capsule_forth(&self, bar: usize, tau: f64, impulse: &Motion, change: &mut Motion, moved: &mut [DVec3]) {
        let rigid = Rigid::of(self, bar);
        let (d, q, v) = turned(&rigid, &Motion::of(self), -tau);
        let [one, two] = rigid.ends;
        let dv = rigid.centre_velocity(impulse);
        let new = Rigid { d, ..Rigid::of(self, bar) };
        let mut motion = Motion::none(self);
        let q = q + impulse.v[two] - impulse.v[one];
        motion.v[one] = v + dv - rigid.m[1] / rigid.mass * q;
        motion.v[two] = v + dv + rigid.m[0] / rigid.mass * q;
        let (d, q, v) = turned(&new, &motion, tau);
        let mut after = self.clone();
        after.place(bar, &rigid, tau * dv, d, v, q);
        for end in [one, two] {
            moved[end] += after.balls[end].x - self.balls[end].x;
            change.v[end] += after.balls[end].v - self.balls[end].v;
            change.l[end] += impulse.l[end];
        }
    }

    /// Solves all other collisions (docs/physics section 3.7).
    fn cluster(&self, pressed: &mut [Pressed], change: &mut Motion) {
        let colliding: Vec<(Pair, Line)> =
            pressed.iter().filter(|contact| contact.collides).map(|contact| (contact.pair, contact.line)).collect();
        let mut members: Vec<&mut Pressed> = pressed.iter_mut().filter(|contact| contact.collides && !contact.lone).collect();
        let units: Vec<Motion> = members.iter().map(|contact| self.unit(&contact.pair, &contact.line)).collect();
        let scales: Vec<f64> = members.iter().map(|contact| self.scale(&contact.pair, &contact.line, &colliding)).collect();
        let speed: Vec<f64> = members.iter().map(|contact| self.closing(&contact.pair, &contact.line)).collect();
        // Change of the approach velocity of one contact by a unit impulse of another.
        let coupling: Vec<Vec<f64>> = members
            .iter()
            .map(|contact| units.iter().map(|unit| -self.approach(&contact.pair, &contact.line, unit)).collect())
            .collect();
        let wanted: Vec<f64> = speed.iter().map(|speed| (1.0 + self.elasticity()) * speed).collect();
        let only: Vec<bool> = members.iter().map(|contact| self.is_only(&contact.pair, &contact.line, &colliding)).collect();
        let sweeps = if self.made(Mistake::OneSweep) { 1 } else { SWEEPS.len() };
        let mut j = vec![0.0_f64; members.len()];
        for size in &SWEEPS[..sweeps] {
            let next = (0..j.len()).map(|k| {
                let slowed: f64 = coupling[k].iter().zip(&j).map(|(by, j)| by * j).sum();
                let size = if only[k] { 1.0 } else { *size };
                if scales[k] > 0.0 { (j[k] + size * (wanted[k] - slowed) / scales[k]).max(0.0) } else { 0.0 }
            });
            j = next.collect();
        }
        let lines: Vec<(Pair, Line)> = members.iter().map(|contact| (contact.pair, contact.line)).collect();
        for [k, l] in self.couples(&lines, &colliding) {
            let ([own, by], [back, their]) = ([coupling[k][k], coupling[k][l]], [coupling[l][k], coupling[l][l]]);
            if own * their - by * back > ONE_PLACE * own * their && !self.made(Mistake::OneSweep) {
                (j[k], j[l]) = pair_impulses([own, by, back, their], [wanted[k], wanted[l]]);
            }
        }
        for ((contact, unit), j) in members.iter_mut().zip(&units).zip(j) {
            contact.j = j;
            change.add(unit, j);
        }
    }

    /// The clusters of two contacts: those that share a body, and have no other colliding contact on their bodies, none of
    /// which is a network.
    fn couples(&self, members: &[(Pair, Line)], colliding: &[(Pair, Line)]) -> Vec<[usize; 2]> {
        let bodies: Vec<Vec<Body>> = members.iter().map(|(pair, line)| self.touched(pair, line)).collect();
        let has_one_other = |own: &Vec<Body>| {
            let others = own.iter().map(|body| {
                let all = colliding.iter().flat_map(|(pair, line)| self.touched(pair, line));
                all.filter(|touched| touched == body).count() - 1
            });
            others.sum::<usize>() == 1 && !own.iter().any(|body| matches!(body, Body::Network(_)))
        };
        let lonely: Vec<usize> = (0..members.len()).filter(|k| has_one_other(&bodies[*k])).collect();
        let pairs = lonely.iter().flat_map(|k| lonely.iter().filter(move |l| k < l).map(move |l| [*k, *l]));
        pairs.filter(|[k, l]| bodies[*k].iter().any(|body| bodies[*l].contains(body))).collect()
    }

    /// Whether this is the only colliding contact on its bodies.
    fn is_only(&self, pair: &Pair, line: &Line, colliding: &[(Pair, Line)]) -> bool {
        let touching = |body: &Body| {
            colliding.iter().flat_map(|(pair, line)| self.touched(pair, line)).filter(|touched| touched == body).count()
        };
        self.touched(pair, line).iter().all(|body| touching(body) == 1)
    }

    /// Scale G~ of a contact, or 0 where the contact cannot move.
    fn scale(&self, pair: &Pair, line: &Line, colliding: &[(Pair, Line)]) -> f64 {
        let (mut scale, mut free) = (0.0, 0.0);
        for side in sides(pair, line) {
            free += self.unprojected(side, line.n);
            for (body, mass) in self.bodies(side, line.n) {
                scale += match body {
                    Body::Network(_) => self.couplings(body, side, line, colliding),
                    _ => mass * self.count(body, line, colliding),
                };
            }
        }
        let gives = -self.approach(pair, line, &self.unit(pair, line));
        if gives < RIGID * free { 0.0 } else { scale }
    }

    /// The sum of the absolute couplings of a side on a network or a rigid body with all sides on it.
    fn couplings(&self, body: Body, side: Side, line: &Line, colliding: &[(Pair, Line)]) -> f64 {
        let change = self.pushed(body, side, line.n);
        let all = colliding.iter().flat_map(|(pair, other)| sides(pair, other).map(|side| (side, other.n)));
        all.map(|(side, n)| self.along(body, side, n, &change).abs()).sum()
    }

    /// N of a contact on one of its bodies.
    fn count(&self, body: Body, line: &Line, colliding: &[(Pair, Line)]) -> f64 {
        let weight = |other: &Line| match body {
            Body::Single(_) => line.n.dot(other.n).abs(),
            _ => 1.0,
        };
        let all = colliding.iter().map(|(pair, other)| {
            let times = self.touched(pair, other).into_iter().filter(|&touched| touched == body).count();
            times as f64 * weight(other)
        });
        all.sum()
    }
}

/// The impulses of two contacts in closed form. The couplings are those of the first with itself and with the second, then
/// those of the second with the first and with itself.
fn pair_impulses([own, by, back, their]: [f64; 4], [one, two]: [f64; 2]) -> (f64, f64) {
    if their * one <= by * two {
        return (0.0, two / their);
    }
    if own * two <= back * one {
        return (one / own, 0.0);
    }
    let margin = own * their - by * back;
    ((their * one - by * two) / margin, (own * two - back * one) / margin)
}

/// Axis, velocity of end 2 relative to end 1, and velocity of the centre of a capsule after it has moved along its
/// circle for a time.
fn turned(rigid: &Rigid, motion: &Motion, time: f64) -> (DVec3, DVec3, DVec3) {
    let (d, q) = (rigid.d, motion.v[rigid.ends[1]] - motion.v[rigid.ends[0]]);
    let v = rigid.centre_velocity(motion);
    let (length, speed) = (d.length(), q.length());
    if speed == 0.0 {
        return (d, q, v);
    }
    let (sin, cos) = (time * speed / length).sin_cos();
    (d * cos + q * (length / speed) * sin, q * cos - d * (speed / length) * sin, v)
}
