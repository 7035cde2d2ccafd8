//! Bodies, blocks and a frame (docs/physics sections 11.1, 11.2 and 11.9).

use std::cell::RefCell;
use std::collections::HashMap;

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rockfall::glam::{DMat3, DQuat, DVec3};

use super::joints::Link;
use super::mistakes::Mistake;
use super::shapes::Shape;

/// Half a unit in the last place of an f32, relative.
pub(crate) const ROUNDING: f64 = 6e-8;

/// A pose and the velocities there, in units, units/s and rad/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) x: DVec3,
    pub(crate) q: DQuat,
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
}

#[derive(Clone, Debug)]
pub(crate) struct Body {
    /// Whether it is dynamic.
    pub(crate) has_mass: bool,
    pub(crate) mass: f64,
    /// Principal moments of inertia in mass units², and the turn from their axes to those of the body.
    pub(crate) moments: DVec3,
    pub(crate) axes: DQuat,
    /// The truth between substeps. `state.w` follows from `l`.
    pub(crate) state: State,
    pub(crate) l: DVec3,
    /// External force.
    pub(crate) force: DVec3,
    /// Greatest distance of its surface from the centre.
    pub(crate) rho: f64,
    /// Least edge or diameter of its shapes.
    pub(crate) width: f64,
    /// Scale of its margin.
    pub(crate) scale: f64,
    /// Whether it has an end of a joint.
    pub(crate) jointed: bool,
    pub(crate) clock: f64,
    /// Velocities after the kick.
    pub(crate) kicked: [DVec3; 2],
    /// Path in this frame.
    pub(crate) path: f64,
}

impl Body {
    pub(crate) fn world() -> Self {
        let state = State { x: DVec3::ZERO, q: DQuat::IDENTITY, v: DVec3::ZERO, w: DVec3::ZERO };
        Self {
            has_mass: false,
            mass: f64::INFINITY,
            moments: DVec3::ONE,
            axes: DQuat::IDENTITY,
            state,
            l: DVec3::ZERO,
            force: DVec3::ZERO,
            rho: f64::INFINITY,
            width: f64::INFINITY,
            scale: 1.0,
            jointed: false,
            clock: 0.0,
            kicked: [DVec3::ZERO; 2],
            path: 0.0,
        }
    }

    pub(crate) fn inverse_mass(&self) -> f64 {
        if self.has_mass { 1.0 / self.mass } else { 0.0 }
    }

    fn tensor(&self, q: DQuat, diagonal: DVec3) -> DMat3 {
        let axes = DMat3::from_quat(q * self.axes);
        axes * DMat3::from_diagonal(diagonal) * axes.transpose()
    }

    /// The inverse inertia with the orientation q (section 11.1).
    pub(crate) fn inverse(&self, q: DQuat) -> DMat3 {
        if self.has_mass { self.tensor(q, self.moments.recip()) } else { DMat3::ZERO }
    }

    pub(crate) fn inertia(&self) -> DMat3 {
        self.tensor(self.state.q, self.moments)
    }

    /// The free rotation (section 5.9).
    pub(crate) fn turned(&self, q: DQuat, l: DVec3, time: f64) -> DQuat {
        let mut sorted = self.moments.to_array();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted[1];
        let mut q = DQuat::from_scaled_axis(l * (time / middle)) * q;
        for (k, part) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
            let rate = 1.0 / self.moments[k] - 1.0 / middle;
            let axis = q * (self.axes * DVec3::AXES[k]);
            q = DQuat::from_scaled_axis(axis * (rate * axis.dot(l) * part * time)) * q;
        }
        q.normalize()
    }

    /// The state at a time of the substep (section 11.7, "Clocks").
    pub(crate) fn at(&self, t: f64, g: DVec3) -> State {
        let State { x, q, v, w } = self.state;
        if !self.has_mass {
            return State { x: x + t * v, q: DQuat::from_scaled_axis(t * w) * q, ..self.state };
        }
        let q = self.turned(q, self.l, t);
        State { x: x + t * v + 0.5 * t * t * g, q, v: v + t * g, w: self.inverse(q) * self.l }
    }

    /// Its speed at the surface by the rotation. An infinite radius counts only if the body turns.
    pub(crate) fn rim(&self) -> f64 {
        if self.state.w == DVec3::ZERO { 0.0 } else { self.state.w.length() * self.rho }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Collider {
    pub(crate) body: usize,
    pub(crate) shape: Shape,
    /// From the centre of the body, in its coordinates.
    pub(crate) place: DVec3,
    pub(crate) turn: DQuat,
    /// Velocity of its surface in coordinates of the body.
    pub(crate) belt: DVec3,
}

/// A point of a pair (sections 11.3 and 11.4).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    /// Places on both surfaces in coordinates of the bodies.
    pub(crate) at: [DVec3; 2],
    pub(crate) id: u32,
    /// Impulses along the normal and, as a vector of the world, along the tangents.
    pub(crate) normal: f64,
    pub(crate) tangent: DVec3,
    /// The geometry of its row.
    pub(crate) s: f64,
    pub(crate) arms: [DVec3; 2],
    /// Velocity of the surfaces against each other.
    pub(crate) belt: DVec3,
    pub(crate) spare: f64,
    pub(crate) acts: bool,
}

impl Point {
    pub(crate) fn new(at: [DVec3; 2], id: u32) -> Self {
        let zero = DVec3::ZERO;
        let (normal, s, spare) = (0.0, 0.0, 0.0);
        Self { at, id, normal, tangent: zero, s, arms: [zero; 2], belt: zero, spare, acts: false }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Pair {
    pub(crate) colliders: [usize; 2],
    pub(crate) is_round: bool,
    /// In coordinates of body a.
    pub(crate) local: DVec3,
    /// In the world, for the rows.
    pub(crate) n: DVec3,
    /// A round pair whose place is hidden has none.
    pub(crate) points: Vec<Point>,
}

/// All pairs of two bodies.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) bodies: [usize; 2],
    pub(crate) pairs: Vec<Pair>,
    pub(crate) colour: u8,
    pub(crate) waits: bool,
    /// The time that is left of the substep.
    pub(crate) left: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct Solver {
    pub(crate) bodies: Vec<Body>,
    pub(crate) colliders: Vec<Collider>,
    pub(crate) links: Vec<Link>,
    /// Acceleration of the field, in units/s².
    pub(crate) g: DVec3,
    pub(crate) mu: f64,
    pub(crate) e: f64,
    pub(crate) substeps: u32,
    /// The substep in s.
    pub(crate) h: f64,
    pub(crate) frame: u64,
    pub(crate) blocks: Vec<Block>,
    pub(crate) colours: HashMap<[usize; 2], u8>,
    /// Errors of the size of the rounding of f32, for tolerances.
    pub(crate) noise: Option<RefCell<Pcg64Mcg>>,
    pub(crate) mistake: Option<Mistake>,
    /// Impacts and rejected frames so far.
    pub(crate) impacts: usize,
    pub(crate) rejections: usize,
}

impl Solver {
    pub(crate) fn made(&self, mistake: Mistake) -> bool {
        self.mistake == Some(mistake)
    }

    /// A random error of up to three roundings of a number of this size.
    pub(crate) fn error(&self, size: f64) -> f64 {
        self.noise.as_ref().map_or(0.0, |rng| 3.0 * ROUNDING * size * rng.borrow_mut().random_range(-1.0..1.0))
    }

    /// Errors of a vector of this size.
    pub(crate) fn errors(&self, size: f64) -> DVec3 {
        DVec3::new(self.error(size), self.error(size), self.error(size))
    }

    pub(crate) fn error_of(&self, v: DVec3) -> DVec3 {
        self.errors(v.length())
    }

    /// The radius of the smaller body with mass.
    pub(crate) fn smaller(&self, bodies: [usize; 2]) -> f64 {
        let radii = bodies.map(|k| if self.bodies[k].has_mass { self.bodies[k].rho } else { f64::INFINITY });
        radii[0].min(radii[1])
    }

    pub(crate) fn margin(&self, k: usize, dt: f64) -> f64 {
        let body = &self.bodies[k];
        let speed = body.state.v.length() + body.rim();
        if !body.has_mass {
            return 1.001 * speed * dt;
        }
        body.scale * (0.02 * body.rho).max(speed * dt + self.g.length() * dt * dt)
    }

    /// Advances by a frame of dt seconds (section 11.2).
    pub(crate) fn advance(&mut self, dt: f64) {
        for attempt in 0..=16 {
            let mut tried = self.clone();
            let margins: Vec<f64> = (0..self.bodies.len()).map(|k| self.margin(k, dt)).collect();
            tried.attempt(dt, &margins);
            let paths = tried.bodies.iter().map(|body| body.path).zip(margins).collect::<Vec<_>>();
            let over = |&(path, margin): &(f64, f64)| path > margin;
            if attempt == 16 || !paths.iter().any(over) {
                *self = tried;
                for (body, (path, margin)) in self.bodies.iter_mut().zip(paths).filter(|(body, _)| body.has_mass) {
                    body.scale = 1.0_f64.max(0.99 * body.scale).max(1.25 * body.scale * path / margin);
                }
                self.frame += 1;
                return;
            }
            self.rejections += 1;
            self.noise = tried.noise;
            for (body, both) in self.bodies.iter_mut().zip(&paths).filter(|(_, both)| over(both)) {
                let more = if attempt >= 3 { 2.0 } else { 1.0 };
                body.scale *= more * 1.25 * both.0 / both.1;
            }
        }
    }

    fn attempt(&mut self, dt: f64, margins: &[f64]) {
        self.h = dt / f64::from(self.substeps);
        self.bodies.iter_mut().for_each(|body| body.path = 0.0);
        self.links.iter_mut().for_each(Link::begin);
        self.find_blocks(margins);
        self.colour(dt);
        self.refresh_all();
        self.start_links();
        for _ in 0..self.substeps {
            self.impacts();
            self.kick();
            self.warm_links();
            self.warm_start();
            self.spare_gaps();
            self.solve_links(false);
            self.pass(false);
            self.keep_momenta();
            self.drift();
            self.refresh_all();
            self.solve_links(true);
            self.pass(true);
            self.keep_momenta();
        }
        self.links.iter_mut().for_each(|link| link.load /= dt);
    }

    fn kick(&mut self) {
        let (h, g) = (self.h, self.g);
        for body in self.bodies.iter_mut().filter(|body| body.has_mass) {
            body.state.v += h * (g + body.force / body.mass);
            body.state.w = body.inverse(body.state.q) * body.l;
            body.kicked = [body.state.v, body.state.w];
        }
    }

    fn keep_momenta(&mut self) {
        for k in 0..self.bodies.len() {
            let (ev, ew) = (self.error_of(self.bodies[k].state.v), self.error_of(self.bodies[k].state.w));
            let body = &mut self.bodies[k];
            if body.has_mass {
                body.state.v += ev;
                let own = body.inverse(body.state.q) * body.l;
                if (own - body.state.w).length() > 1e-14 * own.length() {
                    body.l = body.inertia() * (body.state.w + ew);
                }
            }
        }
    }

    fn drift(&mut self) {
        let (h, g) = (self.h, self.g);
        let no_parabola = self.made(Mistake::NoParabola);
        let no_gyroscope = self.made(Mistake::NoGyroscope);
        for k in 0..self.bodies.len() {
            let errors = [self.error(1.0), self.error(1.0), self.error(1.0)];
            let place = self.error_of(self.bodies[k].state.x);
            let body = &mut self.bodies[k];
            let State { v, w, q, .. } = body.state;
            body.clock = 0.0;
            if !body.has_mass {
                body.state.x += h * v;
                body.state.q = (DQuat::from_scaled_axis(h * w) * q).normalize();
                continue;
            }
            body.path += h * (v.length() + body.rim());
            let changed = (v - body.kicked[0]).length() + body.rho * (w - body.kicked[1]).length();
            let held = body.jointed || no_parabola;
            let beta = if held || g == DVec3::ZERO { 0.0 } else { (1.0 - changed / (0.25 * g.length() * h)).max(0.0) };
            body.state.x += h * v - 0.5 * beta * h * h * g + place;
            body.state.q = if no_gyroscope { DQuat::from_scaled_axis(h * w) * q } else { body.turned(q, body.l, h) };
            let [i, j, k] = errors;
            body.state.q = (DQuat::from_xyzw(i, j, k, 1.0) * body.state.q).normalize();
            body.state.w = body.inverse(body.state.q) * body.l;
        }
    }
}
