//! Solves lone collisions at their time of contact (docs/physics section 3.6).
//!
//! The overlap began within the last step. At that moment the bodies were elsewhere, and the contact line between them was
//! a different one. With the present contact line, an oblique pair would change its angular momentum, and a body under
//! gravity would gain energy (E21). So the bodies are moved back by the time tau since the contact began, get the impulse
//! there, and are moved forward again. This displaces single spheres by tau dv.

use glam::Vec3;

use crate::fine::Fine;
use crate::model::impulse::Impulse;
use crate::model::layout::FLAG_CONTINUOUS;
use crate::model::period::Periods;
use crate::model::view::{Object, View, Wall};
use crate::physics::collision::body::{Body, Capsule, Part};
use crate::physics::collision::{Change, Collision};
use crate::physics::first_contact::time_of_beginning;
use crate::physics::forces::attached::{attached_curvature, attached_force};
use crate::physics::pairs::Surface;
use crate::physics::sides::wall_of;
use crate::physics::touch::{Feature, Motions, Touch, is_over_face, line};

/// Number of iterations for the time of contact.
const ITERATIONS: u32 = 4;

/// The effects of a lone collision, on up to four spheres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outcome {
    pub(super) impulse: Impulse,
    changes: [Change; 4],
    len: usize,
}

impl Outcome {
    pub(super) fn changes(&self) -> &[Change] {
        &self.changes[..self.len]
    }

    fn add(&mut self, change: Change) {
        self.changes[self.len] = change;
        self.len += 1;
    }
}

/// A body of the collision, in the present state.
#[derive(Clone, Copy, Debug)]
enum MovingBody {
    Sphere(u32),
    Capsule(Capsule),
}

impl MovingBody {
    /// The body of a part of a collision.
    fn of(view: &View, part: &Part) -> Self {
        match part.body {
            Body::Capsule(rod) => Self::Capsule(Capsule::of(view, view, rod)),
            _ => Self::Sphere(part.shares[0].0),
        }
    }

    /// The acceleration of the body by everything but contacts. For a capsule, that of its centre of mass.
    fn acceleration(&self, view: &View) -> Vec3 {
        let pulled = match self {
            Self::Sphere(sphere) => view.inverse_mass(*sphere) * attached_force(view, *sphere),
            Self::Capsule(capsule) => {
                capsule.ends.map(|end| attached_force(view, end)).into_iter().sum::<Vec3>() / capsule.mass
            }
        };
        Vec3::from_array(view.step.constants.gravity) + pulled
    }
}

/// An earlier state. Fixed spheres are not moved.
struct EarlierState<'a> {
    view: &'a View<'a>,
    /// Spheres with their positions and velocities.
    spheres: [(u32, Fine, Vec3); 4],
    len: usize,
}

impl<'a> EarlierState<'a> {
    /// Moves the bodies back by a time, along parabolas or along straight lines. On straight lines angular momentum is
    /// conserved whatever the time is.
    fn of(view: &'a View<'a>, movers: &[(MovingBody, Vec3)], time: f32, along_parabolas: bool) -> Self {
        let mut before = Self { view, spheres: [(0, Fine::default(), Vec3::ZERO); 4], len: 0 };
        for (mover, acceleration) in movers {
            let fallen = if along_parabolas { 0.5 * time * time * *acceleration } else { Vec3::ZERO };
            match mover {
                MovingBody::Sphere(sphere) => {
                    let velocity = view.velocity(*sphere);
                    before.add(*sphere, fallen - time * velocity, velocity - time * *acceleration);
                }
                MovingBody::Capsule(capsule) => {
                    let moved = fallen - time * capsule.velocity;
                    let velocity = capsule.velocity - time * *acceleration;
                    let (d, q) = turned(capsule.d, capsule.q, -time);
                    for (end, lever) in capsule.ends.into_iter().zip([0.0, 1.0].map(|place| capsule.lever(place))) {
                        before.add(end, moved + lever * (d - capsule.d), velocity + lever * q);
                    }
                }
            }
        }
        before
    }

    fn add(&mut self, sphere: u32, displacement: Vec3, velocity: Vec3) {
        self.spheres[self.len] = (sphere, displaced(self.view, self.view.precise(sphere), displacement), velocity);
        self.len += 1;
    }

    fn find(&self, sphere: u32) -> Option<&(u32, Fine, Vec3)> {
        self.spheres[..self.len].iter().find(|known| known.0 == sphere)
    }
}

impl Motions for EarlierState<'_> {
    fn position(&self, sphere: u32) -> Vec3 {
        self.find(sphere).map_or_else(|| self.view.position(sphere), |known| known.1.high)
    }

    fn velocity(&self, sphere: u32) -> Vec3 {
        self.find(sphere).map_or_else(|| self.view.velocity(sphere), |known| known.2)
    }

    fn fine_position(&self, sphere: u32) -> Option<Fine> {
        let place = || self.find(sphere).map_or_else(|| self.view.fine(sphere), |known| known.1);
        self.view.step.is_double().then(place)
    }

    fn periods(&self) -> Option<Periods> {
        Periods::of(self.view.step)
    }
}

/// A position after a displacement. With single precision it has no low part.
fn displaced(view: &View, place: Fine, by: Vec3) -> Fine {
    if view.step.is_double() { place.moved(by) } else { Fine { high: place.high + by, low: Vec3::ZERO } }
}

/// An earlier state as seen from a moving wall, in coordinates in which the wall is where it is now (docs/physics section 2.12).
struct SeenFromWall<'a> {
    before: &'a EarlierState<'a>,
    wall: Wall,
    /// How much earlier, in s.
    time: f32,
    along_parabolas: bool,
}

impl SeenFromWall<'_> {
    /// How far the wall has taken a point of it since then, which was at `place`.
    fn taken(&self, place: Vec3) -> Vec3 {
        let Self { wall, time, .. } = self;
        let acceleration = if self.along_parabolas { wall.acceleration } else { Vec3::ZERO };
        let around = wall.spin.cross(wall.lever(place) + *time * wall.velocity);
        *time * (wall.velocity + around) + 0.5 * time * time * (wall.spin.cross(around) - acceleration)
    }

    fn seen(&self, place: Fine) -> Fine {
        displaced(self.before.view, place, self.taken(place.high))
    }

    /// The collision in the earlier state. The normal and the velocity of the wall are those of that time.
    fn collision(&self, view: &View, k: &Collision, kept: Kept) -> Option<Collision> {
        let touch = kept.line(view, k, self)?;
        let (_, point) = wall_of(view, self, [k.a, k.b], &touch)?;
        let velocity = self.wall.velocity_at(point) - self.time * self.wall.acceleration_at(point);
        let angle = -self.time * self.wall.spin;
        let around = angle.cross(touch.normal);
        let normal = (touch.normal + around + 0.5 * angle.cross(around)).normalize();
        Some(Collision::of(view, self.before, [k.a, k.b], k.feature, Touch { normal, ..touch }, velocity))
    }
}

impl Motions for SeenFromWall<'_> {
    fn position(&self, sphere: u32) -> Vec3 {
        let place = self.before.position(sphere);
        place + self.taken(place)
    }

    fn velocity(&self, sphere: u32) -> Vec3 {
        self.before.velocity(sphere)
    }

    fn fine_position(&self, sphere: u32) -> Option<Fine> {
        self.before.fine_position(sphere).map(|place| self.seen(place))
    }

    fn periods(&self) -> Option<Periods> {
        self.before.periods()
    }
}

/// Moves the difference d of two ends and its rate of change q along a circle for a time (docs/physics section 3.6,
/// equation 3).
fn turned(d: Vec3, q: Vec3, time: f32) -> (Vec3, Vec3) {
    let rate = q.length() / d.length();
    if rate == 0.0 {
        return (d, q);
    }
    let (sin, cos) = libm::sincosf(time * rate);
    (cos * d + sin / rate * q, cos * q - sin * rate * d)
}

/// Solves a lone collision.
pub(super) fn solve(view: &View, k: &Collision) -> Outcome {
    let movers = movers_of(view, k);
    let movers = &movers[..k.parts().len()];
    let kept = Kept::of(view, k);
    let (tau, hit) = time_of_contact(view, k, kept, movers, start_of(view, k)).unwrap_or((0.0, *k));
    solved(view, &hit, movers, tau)
}

/// Solves a crossing, a contact that began at about the time `tau` and has ended (docs/physics section 3.10). `None` when the
/// objects do not approach each other at the time of contact.
pub(super) fn solve_crossing(view: &View, k: &Collision, tau: f32) -> Option<Outcome> {
    let movers = movers_of(view, k);
    let movers = &movers[..k.parts().len()];
    let (tau, hit) = time_of_contact(view, k, Kept::Feature(None), movers, tau)?;
    Some(solved(view, &hit, movers, tau))
}

/// The time that the iteration begins with: where contacts within a step are handled, the time of the first contact on straight
/// paths, if it is within the step (docs/physics section 3.10).
fn start_of(view: &View, k: &Collision) -> f32 {
    let is_continuous = view.step.constants.flags & FLAG_CONTINUOUS != 0;
    let began = || time_of_beginning(view, k.a, k.b, k.threshold(view));
    is_continuous.then(began).flatten().unwrap_or(0.0)
}

/// The bodies of a collision, and their accelerations.
fn movers_of(view: &View, k: &Collision) -> [(MovingBody, Vec3); 4] {
    let mut movers = [(MovingBody::Sphere(0), Vec3::ZERO); 4];
    for (place, part) in movers.iter_mut().zip(k.parts()) {
        let mover = MovingBody::of(view, part);
        *place = (mover, mover.acceleration(view));
    }
    movers
}

/// The effects of the collision `hit`, as it was at the time `tau` earlier.
fn solved(view: &View, hit: &Collision, movers: &[(MovingBody, Vec3)], tau: f32) -> Outcome {
    let size =
        (1.0 + Surface::of(view, hit.a, hit.b).restitution) * hit.approach / effective_inverse_mass(view, hit, movers, tau);
    let impulse = Impulse { key: hit.key(view), size, direction: hit.touch.normal };
    let mut outcome = Outcome { impulse, ..Outcome::default() };
    for (part, (mover, _)) in hit.parts().iter().zip(movers) {
        let pushed = part.sign * size;
        match mover {
            MovingBody::Sphere(sphere) => {
                let velocity = pushed * part.shares[0].1 * view.inverse_mass(*sphere) * hit.touch.normal;
                outcome.add(Change { sphere: *sphere, position: tau * velocity, velocity, angular_momentum: Vec3::ZERO });
            }
            MovingBody::Capsule(capsule) => {
                let velocity = pushed / capsule.mass * hit.touch.normal;
                let spin = pushed / inertia_before(capsule, tau) * part.torque;
                capsule_changes(capsule, velocity, spin, tau).into_iter().for_each(|change| outcome.add(change));
            }
        }
    }
    outcome
}

/// The denominator of the impulse (docs/physics section 3.6, equation 2.10): the inverse mass plus tau^2 K, but at least
/// half the inverse mass. Half of tau^2 K, times the square of the impulse, is the energy that the displacements tau dv add
/// to the springs. This term takes that energy from the rebound, so that the collision adds no energy (E21).
fn effective_inverse_mass(view: &View, hit: &Collision, movers: &[(MovingBody, Vec3)], tau: f32) -> f32 {
    if view.step.layout.free_at == 0 {
        return hit.inverse_mass();
    }
    let mut displaced = Vec::new();
    let mut add = |sphere: u32, by: Vec3| displaced.push((sphere, by));
    let n = hit.touch.normal;
    for (part, (mover, _)) in hit.parts().iter().zip(movers) {
        match mover {
            MovingBody::Sphere(sphere) => add(*sphere, part.sign * part.shares[0].1 * view.inverse_mass(*sphere) * n),
            MovingBody::Capsule(capsule) => {
                let velocities = capsule
                    .end_velocities(part.sign / capsule.mass * n, part.sign / inertia_before(capsule, tau) * part.torque);
                capsule.ends.into_iter().zip(velocities).for_each(|(end, velocity)| add(end, velocity));
            }
        }
    }
    let of = |sphere: u32| displaced.iter().find(|known| known.0 == sphere).map(|known| known.1);
    let curvature: f32 = displaced.iter().map(|(sphere, by)| attached_curvature(view, *sphere, *by, of)).sum();
    let inverse_mass = hit.inverse_mass();
    (inverse_mass + tau * tau * curvature).max(0.5 * inverse_mass)
}

/// What a lone collision keeps when it is moved back in time (docs/physics section 2.10).
#[derive(Clone, Copy)]
enum Kept {
    /// The part of a static object.
    Feature(Option<Feature>),
    /// The plane of the face that a sphere touches now.
    Face { sphere: u32, present: Touch },
}

impl Kept {
    fn of(view: &View, k: &Collision) -> Self {
        let (a, b) = (view.object(k.a), view.object(k.b));
        match a {
            Object::Sphere(sphere) if is_over_face(view, a, b) => Self::Face { sphere, present: k.touch },
            _ => Self::Feature(Feature::of(view, a, b, k.feature)),
        }
    }

    /// The contact line of a collision at an earlier time.
    fn line(self, view: &View, k: &Collision, before: &impl Motions) -> Option<Touch> {
        match self {
            Self::Feature(feature) => line(view, before, view.object(k.a), view.object(k.b), feature),
            Self::Face { sphere, present } => {
                let now = view.precise(sphere);
                let moved = before.place(sphere).minus(now);
                Some(Touch { overlap: present.overlap + moved.dot(present.normal), ..present })
            }
        }
    }
}

/// The time since the two objects began to overlap, and the collision as it was then. The iteration begins with the time `start`.
/// `None` if the objects had no contact line then, or did not approach each other.
fn time_of_contact(
    view: &View,
    k: &Collision,
    kept: Kept,
    movers: &[(MovingBody, Vec3)],
    start: f32,
) -> Option<(f32, Collision)> {
    let wall = view.wall(view.object(k.b));
    let closing = |tau: f32, along_parabolas: bool| {
        let before = EarlierState::of(view, movers, tau, along_parabolas);
        let collision = match wall {
            Some(wall) => SeenFromWall { before: &before, wall, time: tau, along_parabolas }.collision(view, k, kept)?,
            None => Collision::of(view, &before, [k.a, k.b], k.feature, kept.line(view, k, &before)?, Vec3::ZERO),
        };
        (collision.approach > 0.0).then_some(collision)
    };
    let mut tau = start;
    for _ in 0..ITERATIONS {
        let Some(collision) = closing(tau, true) else { break };
        tau = (tau + collision.touch.overlap / collision.approach).clamp(0.0, view.step.constants.dt);
    }
    closing(tau, false).map(|hit| (tau, hit))
}

/// The moment of inertia It of a capsule at an earlier time. It differs from the present one only if the distance of the
/// ends changes.
fn inertia_before(capsule: &Capsule, time: f32) -> f32 {
    let (d, _) = turned(capsule.d, capsule.q, -time);
    let reduced_mass = capsule.mass * capsule.centre * (1.0 - capsule.centre);
    reduced_mass * d.length_squared() + capsule.inertia[0] + capsule.inertia[1]
}

/// The changes of the ends of a capsule that is moved back by a time, gets these changes of the velocity of its centre of
/// mass and of its angular velocity, and is moved forward again.
fn capsule_changes(capsule: &Capsule, velocity: Vec3, spin: Vec3, time: f32) -> [Change; 2] {
    let (d_before, q_before) = turned(capsule.d, capsule.q, -time);
    let (d, q) = turned(d_before, q_before + spin.cross(d_before), time);
    let change = |end: usize| {
        let lever = capsule.lever(end as f32);
        Change {
            sphere: capsule.ends[end],
            position: time * velocity + lever * (d - capsule.d),
            velocity: velocity + lever * (q - capsule.q),
            angular_momentum: capsule.inertia[end] * spin,
        }
    };
    [change(0), change(1)]
}
