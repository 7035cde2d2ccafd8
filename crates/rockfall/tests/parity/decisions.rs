//! Every decision of a step, evaluated in f64 from physics.md and not by the library: how far it is from its switch.
//!
//! A state in which one lies within [`LIMIT`] of its switch tells nothing: rounding may take it either way.

use std::collections::BTreeMap;

use glam::DVec3;
use rockfall::layout::{ENTRY_BITS, LIST_COUNT_MASK, SLICE};
use rockfall::world::World;

use crate::bodies::{Bodies, Kind};
use crate::narrow::{Touch, touches};

/// Least distance from a switch, in units, units/s, or as a pure number.
pub(crate) const LIMIT: f64 = 1e-4;
/// Row sums of at most this count as 1: nothing else presses (physics.md section 3).
const ALONE: f64 = 1.001;

/// A decision that is too close to call.
#[derive(Clone)]
pub(crate) struct Near {
    pub(crate) what: &'static str,
    /// One of the objects that it is about.
    pub(crate) object: usize,
}

/// What a state holds, and what in it is too close to call.
#[derive(Clone, Default)]
pub(crate) struct Findings {
    pub(crate) near: Vec<Near>,
    pub(crate) seen: BTreeMap<String, usize>,
}

impl Findings {
    pub(crate) fn decide(&mut self, what: &'static str, object: usize, slack: f64) {
        if slack.is_nan() || slack.abs() < LIMIT {
            self.near.push(Near { what, object });
        }
    }

    fn see(&mut self, what: String) {
        *self.seen.entry(what).or_default() += 1;
    }
}

/// An overlap of the objects `a < b`.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub(crate) a: usize,
    pub(crate) b: usize,
    pub(crate) touch: Touch,
    /// What each sphere receives of a unit impulse along the normal.
    pub(crate) shares: BTreeMap<usize, DVec3>,
    /// G_kk.
    pub(crate) w: f64,
    /// Approach velocity, conjugate to the impulse.
    pub(crate) u: f64,
    pub(crate) collides: bool,
}

/// All overlaps; decisions about which there are go to `findings`.
pub(crate) fn contacts(bodies: &Bodies, findings: &mut Findings) -> Vec<Contact> {
    let mut all = Vec::new();
    for a in 0..bodies.movers() {
        for b in a + 1..bodies.groups.len() {
            for touch in touches(bodies, a, b) {
                findings.decide(touch.kind, a, touch.holds);
                if touch.holds > 0.0 {
                    findings.decide(touch.kind, a, touch.sure);
                    all.push(contact(bodies, a, b, touch));
                }
            }
        }
    }
    all
}

fn contact(bodies: &Bodies, a: usize, b: usize, touch: Touch) -> Contact {
    let mut shares = BTreeMap::new();
    let mut give = |id: usize, parameter: f64, n: DVec3| match bodies.kind(id) {
        Kind::Ball(ball) => {
            for (sphere, g) in sphere_shares(bodies, ball, n) {
                *shares.entry(sphere).or_insert(DVec3::ZERO) += g;
            }
        }
        Kind::Bar(bar) => {
            let [one, two] = bodies.bars[bar].ends;
            *shares.entry(one).or_insert(DVec3::ZERO) += (1.0 - parameter) * n;
            *shares.entry(two).or_insert(DVec3::ZERO) += parameter * n;
        }
        Kind::Block(_) | Kind::Face(_) => {}
    };
    give(a, touch.a, -touch.n);
    give(b, touch.b, touch.n);
    let over = |value: fn(&Bodies, usize, DVec3) -> f64| shares.iter().map(|(ball, g)| value(bodies, *ball, *g)).sum();
    let w: f64 = over(|bodies, ball, g| bodies.balls[ball].w * g.length_squared());
    let u: f64 = -over(|bodies, ball, g| bodies.balls[ball].v.dot(g));
    Contact { a, b, touch, w, u, collides: w > 0.0 && u > threshold(bodies, a, b), shares }
}

/// The end of a capsule passes the axial part on, by mass.
fn sphere_shares(bodies: &Bodies, ball: usize, n: DVec3) -> Vec<(usize, DVec3)> {
    let Some(partner) = bodies.capsule_partner(ball) else {
        return vec![(ball, n)];
    };
    let axis = (bodies.balls[partner].x - bodies.balls[ball].x).normalize();
    let axial = n.project_onto(axis);
    let (own, other) = (bodies.balls[ball].w, bodies.balls[partner].w);
    let kept = if own == 0.0 { 1.0 } else { other / (own + other) };
    vec![(ball, n - axial + kept * axial), (partner, (1.0 - kept) * axial)]
}

fn threshold(bodies: &Bodies, a: usize, b: usize) -> f64 {
    let radius = |id| match bodies.kind(id) {
        Kind::Ball(ball) => bodies.balls[ball].radius,
        Kind::Bar(bar) => bodies.bars[bar].radius,
        Kind::Block(_) | Kind::Face(_) => f64::INFINITY,
    };
    bodies.threshold * radius(a).min(radius(b))
}

/// |G_kl| / sqrt(G_kk G_ll).
fn coupling(bodies: &Bodies, k: &Contact, l: &Contact) -> f64 {
    let shared = k.shares.iter().filter_map(|(ball, g)| Some((ball, g.dot(*l.shares.get(ball)?))));
    let g: f64 = shared.map(|(ball, product)| bodies.balls[*ball].w * product).sum();
    g.abs() / (k.w * l.w).sqrt()
}

/// A contact with what the collision phase makes of it.
pub(crate) struct Weighed {
    pub(crate) contact: Contact,
    /// s_k.
    pub(crate) weight: f64,
    /// Whether its overlap is removed.
    pub(crate) removed: bool,
}

/// The decisions of `find_collisions` and `apply_collisions`, and their outcome.
pub(crate) fn collisions(world: &World, findings: &mut Findings) -> Vec<Weighed> {
    let bodies = &Bodies::new(world, 0);
    let contacts = contacts(bodies, findings);
    let mut all = Vec::new();
    for k in &contacts {
        findings.see(format!("{} overlapping", k.touch.kind));
        findings.decide("approach", k.a, k.u - threshold(bodies, k.a, k.b));
        findings.decide("inverse mass", k.a, k.w);
        let (mut colliding, mut overlapping) = (1.0, 1.0);
        for l in contacts.iter().filter(|l| !std::ptr::eq(*l, k) && l.w > 0.0) {
            let coupling = coupling(bodies, k, l);
            overlapping += coupling;
            colliding += if l.collides { coupling } else { 0.0 };
        }
        if k.collides {
            findings.see(format!("{} colliding", k.touch.kind));
            findings.decide("row sum", k.a, overlapping - ALONE);
            findings.see(if overlapping <= ALONE { "alone" } else { "pressed" }.to_owned());
        }
        all.push(Weighed { contact: k.clone(), weight: 1.0 / colliding, removed: overlapping <= ALONE });
    }
    all
}

/// Velocity of the point of a contact on an object.
fn velocity(bodies: &Bodies, id: usize, parameter: f64) -> DVec3 {
    match bodies.kind(id) {
        Kind::Ball(ball) => bodies.balls[ball].v,
        Kind::Bar(bar) => {
            let [one, two] = bodies.bars[bar].ends.map(|end| bodies.balls[end].v);
            one.lerp(two, parameter)
        }
        Kind::Block(_) | Kind::Face(_) => DVec3::ZERO,
    }
}

/// The decisions of the contact law in stage state `state`.
pub(crate) fn forces(world: &World, state: usize, findings: &mut Findings) {
    let bodies = &Bodies::new(world, state);
    for Contact { a, b, touch, .. } in contacts(bodies, findings) {
        let u = (velocity(bodies, a, touch.a) - velocity(bodies, b, touch.b)).dot(touch.n);
        let threshold = threshold(bodies, a, b);
        let fresh = (u - threshold).min(2.0 * u * bodies.dt - touch.overlap);
        let leaving = -threshold - u;
        let polygon = matches!(bodies.kind(b), Kind::Face(_));
        if bodies.collisions {
            findings.decide("fresh overlap", a, fresh);
        }
        if polygon {
            findings.decide("leaving a polygon", a, leaving);
        }
        let pressure = touch.overlap + bodies.damping / bodies.stiffness * u;
        findings.decide("pressure", a, pressure);
        let what = match () {
            () if bodies.collisions && fresh > 0.0 => "unseen",
            () if polygon && leaving > 0.0 => "leaving",
            () if pressure < 0.0 => "not pulling",
            () => "pressing",
        };
        findings.see(format!("{} {what}", touch.kind));
    }
}

/// Whether every moving sphere is within the ball that its AABB encloses in stage state `state`.
pub(crate) fn escapes(world: &World, state: usize, findings: &mut Findings) {
    for (ball, id) in Bodies::new(world, state).balls.iter().zip(0..).filter(|(ball, _)| ball.w > 0.0) {
        let aabb = &world.aabbs[id];
        let [min, max] = [aabb.min, aabb.max].map(|corner| DVec3::from_array(corner.map(f64::from)));
        let room = 0.5 * (max - min).min_element() - ball.radius - ball.x.distance(0.5 * (min + max));
        // Outside is no better than near: it would void the step.
        findings.decide("within its AABB", id, room.max(0.0));
    }
}

/// An entry of the pair lists.
pub(crate) struct Entry {
    pub(crate) mover: usize,
    pub(crate) other: usize,
    pub(crate) feature: usize,
    pub(crate) word: u32,
}

/// The pair lists, by their documented layout.
pub(crate) fn entries(world: &World) -> Vec<Entry> {
    let step = &world.step;
    let mut all = Vec::new();
    for mover in 0..world.movers() {
        let slice = world.lists[(step.slices_at + mover / SLICE) as usize];
        for place in 0..world.lists[mover as usize] & LIST_COUNT_MASK {
            let slot = ((slice + place) * SLICE + mover % SLICE) as usize;
            // Lists that did not fit are not to be read.
            let Some(word) = world.lists.get(step.entries_at as usize + slot).copied() else {
                return all;
            };
            all.push(Entry {
                mover: mover as usize,
                other: (word & step.entry_id_mask()) as usize,
                feature: ((word & ((1 << ENTRY_BITS) - 1)) >> step.entry_id_bits()) as usize,
                word,
            });
        }
    }
    all
}
