//! Chains of rods in f64: which contacts of spheres and rods other parts of their chains cover (docs/physics section 2.13).

use glam::DVec3;

use crate::bodies::{Bodies, Kind};
use crate::decisions::{Contact, Findings};
use crate::narrow::touches;

/// Part of a rod near its end where another rod must touch it to cover the contact of the end sphere.
const NEAR_END: f64 = 1e-4;
/// Cosine of the angle up to which a chain is straight: 0.01.
const STRAIGHT: f64 = 0.999_950_000_416_665;

/// One side of a contact.
struct Half {
    /// Id of the object, and the parameter on a rod.
    own: (usize, f64),
    other: usize,
    /// The centre of the other object, or the point of its axis.
    y: DVec3,
    /// Unit normal to the other object.
    n: DVec3,
}

/// Removes the contacts that their chains cover.
pub(crate) fn without_covered(bodies: &Bodies, contacts: Vec<Contact>, findings: &mut Findings) -> Vec<Contact> {
    let mut keep = |contact: &Contact| {
        let condition = covered(bodies, contact);
        findings.decide("covered", contact.a, condition);
        if condition > 0.0 {
            findings.count(format!("{} covered", contact.touch.kind));
        }
        condition <= 0.0
    };
    contacts.into_iter().filter(|contact| keep(contact)).collect()
}

/// Whether a chain covers a contact, as a condition: the greatest one of all parts.
fn covered(bodies: &Bodies, contact: &Contact) -> f64 {
    let (a, b, touch) = (contact.a, contact.b, &contact.touch);
    let (Some(x), Some(y)) = (point(bodies, a, touch.a), point(bodies, b, touch.b)) else { return f64::NEG_INFINITY };
    let halves = [Half { own: (a, touch.a), other: b, y, n: touch.n }, Half { own: (b, touch.b), other: a, y: x, n: -touch.n }];
    halves.iter().map(|half| half.covered(bodies)).fold(f64::NEG_INFINITY, f64::max)
}

/// The centre of a sphere, or a point of the axis of a rod. `None` for a box or polygon.
fn point(bodies: &Bodies, id: usize, parameter: f64) -> Option<DVec3> {
    match bodies.kind(id) {
        Kind::Ball(ball) => Some(bodies.balls[ball].x),
        Kind::Bar(bar) => Some(bodies.segment(bar)[0].lerp(bodies.segment(bar)[1], parameter)),
        Kind::Block(_) | Kind::Face(_) => None,
    }
}

fn away(bodies: &Bodies, bar: usize, end: usize) -> DVec3 {
    let [one, two] = bodies.bars[bar].ends;
    bodies.balls[one + two - end].x - bodies.balls[end].x
}

impl Half {
    /// Whether another part of the same chain may touch the other object.
    fn may_meet(&self, bodies: &Bodies, part: usize) -> bool {
        bodies.may_touch(part.min(self.other), part.max(self.other))
    }

    fn covered(&self, bodies: &Bodies) -> f64 {
        let (id, parameter) = self.own;
        let conditions: Vec<f64> = match bodies.kind(id) {
            Kind::Ball(ball) => bodies.bars_of[ball].iter().map(|bar| self.by_rod(bodies, ball, *bar)).collect(),
            Kind::Bar(bar) => {
                let parts = [parameter, 1.0 - parameter].into_iter().zip(bodies.bars[bar].ends);
                parts.flat_map(|(part, end)| self.at_end(bodies, bar, part, end)).collect()
            }
            Kind::Block(_) | Kind::Face(_) => Vec::new(),
        };
        conditions.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The contact point of the sphere is inside the rod.
    fn by_rod(&self, bodies: &Bodies, ball: usize, bar: usize) -> f64 {
        let (axis, rod) = (away(bodies, bar, ball), bodies.balls.len() + bar);
        if !self.may_meet(bodies, rod) {
            return f64::NEG_INFINITY;
        }
        let alpha = (self.y - bodies.balls[ball].x).dot(axis) / axis.length_squared();
        let (own, radius) = (bodies.balls[ball].radius, bodies.bars[bar].radius);
        let sine = 1.0 - self.n.dot(axis.normalize()).powi(2);
        let within = if own <= radius { f64::INFINITY } else { radius.powi(2) - own.powi(2) * sine };
        let meets = match bodies.kind(self.other) {
            Kind::Bar(_) => {
                let meeting = touches(bodies, rod.min(self.other), rod.max(self.other));
                let holds = meeting.iter().map(|touch| touch.holds).fold(f64::NEG_INFINITY, f64::max);
                holds.max(alpha - NEAR_END)
            }
            _ => f64::INFINITY,
        };
        alpha.min(within).min(meets)
    }

    /// The contact point of the rod is inside the sphere at an end, or beyond a straight joint there.
    fn at_end(&self, bodies: &Bodies, bar: usize, part: f64, end: usize) -> Vec<f64> {
        let axis = away(bodies, bar, end);
        let radii = bodies.balls[end].radius.powi(2) - bodies.bars[bar].radius.powi(2);
        let inside = if self.may_meet(bodies, end) { radii - (part * axis.length()).powi(2) } else { f64::NEG_INFINITY };
        let mut conditions = vec![inside];
        for next in bodies.bars_of[end].iter().filter(|next| **next != bar) {
            let (own, their) = (axis.normalize(), away(bodies, *next, end).normalize());
            if self.may_meet(bodies, bodies.balls.len() + next) {
                conditions.push((-own.dot(their) - STRAIGHT).min(-(self.y - bodies.balls[end].x).dot(own - their)));
            }
        }
        conditions
    }
}
