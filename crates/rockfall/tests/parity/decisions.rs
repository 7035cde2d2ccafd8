//! Evaluates every decision of a step in f64, from docs/physics and without the library, with its slack: the distance from
//! the value at which the decision changes.
//!
//! A decision is ambiguous when its slack is less than [`LIMIT`], because rounding may then decide either way. A state with an
//! ambiguous decision cannot be used to compare the backends.

use std::collections::BTreeMap;

use glam::DVec3;
use rockfall::model::layout::{ENTRY_BITS, ENTRY_OVERLAPS, LIST_COUNT_MASK, SLICE};
use rockfall::model::world::World;

use crate::bodies::{Bodies, Kind};
use crate::collide::{self, Change, Share};
use crate::covered::without_covered;
use crate::narrow::{EDGES, Touch, rod_polygon_slack, touches};
use crate::surfaces::without_hidden;

/// Least slack of a decision, in units, units/s, or as a pure number.
pub(crate) const LIMIT: f64 = 1e-4;

/// An ambiguous decision.
#[derive(Clone)]
pub(crate) struct Ambiguous {
    pub(crate) what: &'static str,
    /// Id of one of the objects that the decision is about.
    pub(crate) object: usize,
}

/// Ambiguous decisions of a state, and the number of times that each case occurs in it.
#[derive(Clone, Default)]
pub(crate) struct Findings {
    pub(crate) ambiguous: Vec<Ambiguous>,
    pub(crate) seen: BTreeMap<String, usize>,
}

impl Findings {
    /// Records a decision if its slack is so small that it is ambiguous.
    pub(crate) fn decide(&mut self, what: &'static str, object: usize, slack: f64) {
        if slack.is_nan() || slack.abs() < LIMIT {
            self.ambiguous.push(Ambiguous { what, object });
        }
    }

    /// Counts an occurrence of a case.
    pub(crate) fn count(&mut self, what: String) {
        *self.seen.entry(what).or_default() += 1;
    }
}

/// An overlap of the objects `a < b`.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub(crate) a: usize,
    pub(crate) b: usize,
    pub(crate) touch: Touch,
    /// Shares of the spheres in a unit impulse along the normal.
    pub(crate) shares: Vec<Share>,
    /// Inverse mass of the contact along the normal. Spheres of networks count as if they were not connected.
    pub(crate) w: f64,
    /// Approach velocity.
    pub(crate) u: f64,
    pub(crate) collides: bool,
}

/// Returns all overlaps but those that other shapes hide or that their chains cover. Ambiguous decisions on whether objects overlap go to `findings`.
pub(crate) fn contacts(bodies: &Bodies, findings: &mut Findings) -> Vec<Contact> {
    let mut all = Vec::new();
    for a in 0..bodies.movers() {
        for b in a + 1..bodies.groups.len() {
            findings.decide("rod-polygon", a, rod_polygon_slack(bodies, a, b));
            for touch in touches(bodies, a, b) {
                findings.decide(touch.kind, a, touch.holds);
                if touch.holds > 0.0 {
                    findings.decide(touch.kind, a, touch.sure);
                    all.push(contact(bodies, a, b, touch));
                }
            }
        }
    }
    without_hidden(bodies, without_covered(bodies, all, findings), findings)
}

fn contact(bodies: &Bodies, a: usize, b: usize, touch: Touch) -> Contact {
    let (shares, surface) = collide::shares(bodies, a, b, &touch);
    let w = collide::inverse_mass(bodies, &shares);
    let u = collide::approach(bodies, &shares, surface);
    Contact { a, b, touch, w, u, collides: bodies.collisions && w > 0.0 && u > bodies.threshold(a, b), shares }
}

/// Contacts of the collision phase, and the changes of the spheres.
#[derive(Default)]
pub(crate) struct Collisions {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) changes: BTreeMap<usize, Change>,
    /// Objects whose collisions share a body with another collision, so that only sweeps can solve them.
    pub(crate) shared: Vec<usize>,
}

/// Evaluates the collision phase up to `commit_collisions`: its decisions and its outcome.
pub(crate) fn collisions(world: &World, findings: &mut Findings) -> Collisions {
    let bodies = &Bodies::new(world, 0);
    let contacts = contacts(bodies, findings);
    let mut outcome = Collisions::default();
    let mut clustered = Vec::new();
    let pressed: Vec<Contact> = contacts.iter().filter(|contact| contact.w > 0.0).cloned().collect();
    let colliding: Vec<&Contact> = pressed.iter().filter(|contact| contact.collides).collect();
    for k in &contacts {
        findings.count(format!("{} overlapping", k.touch.kind));
        findings.decide("inverse mass", k.a, k.w);
        if bodies.collisions {
            findings.decide("approach", k.a, k.u - bodies.threshold(k.a, k.b));
        }
    }
    for k in &colliding {
        findings.count(format!("{} colliding", k.touch.kind));
        if collide::is_lone(bodies, k, &pressed, findings) {
            findings.count("lone".to_owned());
            collide::hit(bodies, k, &mut outcome.changes, findings);
            continue;
        }
        clustered.push(*k);
        let is_shared = collide::is_shared(k, &colliding);
        findings.count(if is_shared { "clustered" } else { "pressed" }.to_owned());
        outcome.shared.extend(is_shared.then_some(k.a));
    }
    collide::sweep(bodies, &clustered, &colliding, &mut outcome.changes, findings);
    outcome.contacts = contacts;
    outcome
}

/// Returns the velocity of the contact point on an object. A fixed end of a rod is at rest there (docs/physics section 2.2).
fn velocity(bodies: &Bodies, id: usize, parameter: f64) -> DVec3 {
    match bodies.kind(id) {
        Kind::Ball(ball) => bodies.balls[ball].v,
        Kind::Bar(bar) => {
            let [one, two] = bodies.bars[bar].ends.map(|end| match &bodies.balls[end] {
                ball if ball.w > 0.0 => ball.v,
                _ => DVec3::ZERO,
            });
            one.lerp(two, parameter)
        }
        Kind::Block(_) | Kind::Face(_) => DVec3::ZERO,
    }
}

/// Evaluates the decisions of the contact forces in stage state `state`.
pub(crate) fn forces(world: &World, state: usize, findings: &mut Findings) {
    let bodies = &Bodies::new(world, state);
    for Contact { a, b, touch, .. } in contacts(bodies, findings) {
        let what = force(bodies, a, b, &touch, findings);
        findings.count(format!("{} {what}", touch.kind));
    }
}

/// Evaluates the decisions of the force of one contact, and returns the case (docs/physics sections 4.3 and 4.4).
fn force(bodies: &Bodies, a: usize, b: usize, touch: &Touch, findings: &mut Findings) -> &'static str {
    let u = (velocity(bodies, a, touch.a) - velocity(bodies, b, touch.b)).dot(touch.n);
    let threshold = bodies.threshold(a, b);
    let fresh = (u - threshold).min(2.0 * u * bodies.dt - touch.overlap);
    let leaving = -threshold - u;
    if bodies.collisions {
        findings.decide("fresh overlap", a, fresh);
        findings.decide("leaving", a, leaving);
    }
    let pressure = touch.overlap + bodies.damping / bodies.stiffness * u;
    findings.decide("pressure", a, pressure);
    match () {
        () if bodies.collisions && fresh > 0.0 => "fresh",
        () if bodies.collisions && leaving > 0.0 => "leaving",
        () if pressure < 0.0 => "not pulling",
        () => "pressing",
    }
}

/// Evaluates the decisions of `apply_friction_impulses` in the state after the collisions (docs/physics section 3.9).
pub(crate) fn friction_impulses(world: &World, findings: &mut Findings) {
    let bodies = &Bodies::new(world, 0);
    let pressed = entries(world).into_iter().filter(|entry| entry.word & ENTRY_OVERLAPS != 0 && entry.mover < entry.other);
    for Entry { mover: a, other: b, feature, .. } in pressed {
        let all = touches(bodies, a, b);
        if all.is_empty() {
            // A rod and a polygon, which have no reference.
            findings.decide("rod-polygon", a, 0.0);
            continue;
        }
        let mut touch = all[if all.len() > 1 { feature } else { 0 }];
        if let Some(vertex) = all.get(EDGES + feature) {
            // The contact of a rod and a box is at the edge if the edge is hit, and otherwise at the nearer of edge and vertex.
            findings.decide("an edge", a, touch.overlap.min(touch.line));
            if touch.overlap.min(touch.line) < 0.0 {
                let nearer = vertex.overlap - touch.overlap;
                findings.decide("nearer", a, if vertex.line > 0.0 && touch.line > 0.0 { nearer } else { 1.0 });
                if touch.line < 0.0 || (vertex.line > 0.0 && nearer > 0.0) {
                    touch = *vertex;
                }
            }
        }
        findings.decide("a contact line", a, touch.line);
        if touch.line < 0.0 {
            findings.count("friction without a contact line".to_owned());
            continue;
        }
        findings.decide("the geometry of friction", a, touch.sure);
        findings.decide("overlap", a, touch.overlap);
        findings.count(format!("{} friction impulse", touch.kind));
        if bodies.coulomb > 0.0 && touch.overlap > 0.0 {
            force(bodies, a, b, &touch, findings);
        }
    }
}

/// Evaluates, for every moving sphere, whether it lies inside the largest ball in its AABB in stage state `state`.
pub(crate) fn escapes(world: &World, state: usize, findings: &mut Findings) {
    for (ball, id) in Bodies::new(world, state).balls.iter().zip(0..).filter(|(ball, _)| ball.w > 0.0) {
        let aabb = &world.aabbs[id];
        let [min, max] = [aabb.min, aabb.max].map(|corner| DVec3::from_array(corner.map(f64::from)));
        let room = 0.5 * (max - min).min_element() - ball.radius - ball.x.distance(0.5 * (min + max));
        // A sphere outside its AABB rejects the step, so it counts as ambiguous, too.
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

/// Reads the pair lists by their documented layout.
pub(crate) fn entries(world: &World) -> Vec<Entry> {
    let step = &world.step;
    let mut all = Vec::new();
    for mover in 0..world.movers() {
        let slice = world.lists[(step.layout.slices_at + mover / SLICE) as usize];
        for place in 0..world.lists[mover as usize] & LIST_COUNT_MASK {
            let slot = ((slice + place) * SLICE + mover % SLICE) as usize;
            // Lists that did not fit are incomplete.
            let Some(word) = world.lists.get(step.layout.entries_at as usize + slot).copied() else {
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
