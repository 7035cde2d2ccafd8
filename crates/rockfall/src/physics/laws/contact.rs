//! Force and torques of a contact by a law with history, and its tangential spring (docs/physics section 4.11).

use glam::Vec3;

use crate::error::Error;
use crate::laws::{Answer, Bodies, Constants, Contact, of_file};
use crate::model::layout::{FLAG_COLLISIONS, FLAG_RESISTANCE};
use crate::model::view::View;
use crate::physics::contact::{ContactForce, collision_velocity};
use crate::physics::laws::jkr::{self, Bond};
use crate::physics::laws::resistance::{Kept, Turning};
use crate::physics::rigid::shared_damping;
use crate::physics::side::Side;
use crate::physics::sides::sides;
use crate::physics::touch::Touch;

/// The state of a contact between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spring {
    /// Tangential displacement of A's surface relative to B's, in units. A is the object that was added first.
    pub(crate) shift: Vec3,
    /// Overlap in the last step, in units. With JKR cohesion, a² / R* with the contact radius a, which is positive for a neck
    /// too.
    pub(crate) overlap: f32,
    /// Moment on A of the springs against rolling and twisting.
    pub(crate) moment: Vec3,
}

impl Spring {
    /// The record of a contact with a polygon that a sphere passes from behind. It has no force.
    pub(crate) const PASSAGE: Self = Self { shift: Vec3::ZERO, overlap: -1.0, moment: Vec3::ZERO };

    /// Whether this is the record of a passage.
    pub(crate) fn is_passage(&self) -> bool {
        self.overlap < 0.0
    }

    /// The spring after a turn of the wall, at its old length.
    fn turned(self, angle: Vec3) -> Self {
        let turned = |v: Vec3| {
            let (length, moved) = (v.length(), v + angle.cross(v));
            if length > 0.0 { moved * (length / moved.length()) } else { v }
        };
        if angle == Vec3::ZERO { self } else { Self { shift: turned(self.shift), moment: turned(self.moment), ..self } }
    }

    /// The spring, or that of a new contact if it exceeds the range of f32.
    fn in_range(self) -> Self {
        let Self { shift, overlap, moment } = self;
        if shift.is_finite() && overlap.is_finite() && moment.is_finite() { self } else { Self::default() }
    }
}

/// Result of a law.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LawForce {
    /// `force` acts on A and its opposite on B.
    pub(crate) loads: ContactForce<Vec3>,
    /// The tangential spring after the step.
    pub(crate) spring: Spring,
    /// Whether the tangential force is at Coulomb's limit.
    pub(crate) slips: bool,
}

/// What a contact has of the tangential spring that it shares with contacts of neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Share {
    /// Tangential stiffness per that of a contact alone.
    pub(crate) stiffness: f32,
    /// The tangential stiffness of the group per that in the last step, while the group unloads; otherwise 1.
    pub(crate) unloading: f32,
}

impl Share {
    /// What the law gives for a contact, with its share of the tangential stiffness.
    pub(crate) fn of(self, mut answer: Answer) -> Answer {
        answer.stiffness.tangential *= self.stiffness;
        answer.stiffness.unloading = self.unloading;
        answer.dashpot *= self.stiffness.sqrt();
        answer
    }
}

/// What a contact begins a step with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    /// The spring in the last step, or `None` for a new contact.
    pub(crate) spring: Option<Spring>,
    /// What it has of a spring that it shares with neighbours in a rigid body.
    pub(crate) share: Option<Share>,
}

/// Evaluates the contact of objects a and b, of which a was added first, and advances its spring by `View::spring_time`.
/// The last argument is what it begins with.
pub(crate) fn law_force(
    view: &View,
    [id_a, id_b]: [u32; 2],
    touch: &Touch,
    Start { spring: before, share }: Start,
) -> LawForce {
    let (step, n, overlap) = (view.step, touch.normal, touch.overlap);
    let [a, b] = sides(view, [id_a, id_b], touch);
    let approach = (a.velocity - b.velocity).dot(n);
    if before.as_ref().is_some_and(Spring::is_passage) {
        return LawForce { spring: Spring::PASSAGE, ..LawForce::default() };
    }
    if step.constants.flags & FLAG_COLLISIONS != 0 {
        // As in docs/physics section 4.4.
        let threshold = collision_velocity(step, &a, &b);
        if approach < -threshold || (approach > threshold && overlap < 2.0 * approach * step.constants.dt) {
            return LawForce { spring: Spring { overlap, ..Spring::default() }, ..LawForce::default() };
        }
    }
    let mut constants = Constants::of(view, id_a, id_b);
    constants.damping *= shared_damping(view, [id_a, id_b], touch, [a.inverse_mass, b.inverse_mass]);
    let bodies = Bodies::of(&a, &b);
    let bond = Bond::of(&constants, bodies.radius, overlap);
    let depth = bond.depth;
    let mut contact = contact(view, [id_a, id_b], &constants, &bodies, [depth, approach]);
    contact.before = before.map(|before| before.overlap);
    let answer = of_file(step.layout.law, |law| law.answer(&contact));
    let (stiff, normal, damping) = (answer.stiffness, answer.press, answer.dashpot);
    let elastic = stiff.share * stiff.normal * depth;
    let attraction = constants.cohesion.max(0.0) * bodies.radius + bond.pull * elastic;
    // What limits friction: N, or with JKR the whole force and twice the pull-off force.
    let press = (normal + (bond.grip() - bond.pull) * elastic).max(0.0);

    let [arm_a, arm_b] = match (a.radius, b.radius) {
        (Some(radius_a), Some(radius_b)) => [radius_a - 0.5 * overlap, radius_b - 0.5 * overlap],
        (radius, _) => [radius.unwrap_or(0.0) - overlap, 0.0],
    };
    let surface = a.velocity - b.velocity + (arm_a * a.spin + arm_b * b.spin).cross(n);
    let slip = surface - n * surface.dot(n);
    // The spring of a contact with a wall turns with the wall.
    let before = before.map(|before| if b.radius.is_none() { before.turned(view.spring_time() * b.spin) } else { before });
    let rub = share.map_or(answer, |share| share.of(answer));
    let carried = before.map_or(Vec3::ZERO, |before| carried(before, n, rub.stiffness.unloading));
    let shift = carried + view.spring_time() * slip;
    let tangential = Tangential { shift, slip, stiffness: rub.stiffness.tangential, damping: rub.dashpot };
    let (tangential, shift, slips) = limited(&tangential, constants.friction * press);

    let torque = n.cross(tangential);
    let pushed = normal - attraction;
    let mut loads = ContactForce { force: tangential - pushed * n, torque_a: arm_a * torque, torque_b: arm_b * torque };
    let mut moment = Vec3::ZERO;
    if step.constants.flags & FLAG_RESISTANCE != 0 {
        let turning = Turning {
            sides: [&a, &b],
            normal: n,
            overlap: depth,
            radius: bodies.radius,
            press,
            stiffness: stiff,
            dashpot: damping,
            times: [step.constants.dt, view.spring_time()],
        };
        let kept =
            before.map_or(Kept { moment, overlap: depth }, |before| Kept { moment: before.moment, overlap: before.overlap });
        let found = turning.moments(&constants, kept);
        loads.torque_a += found.torque;
        loads.torque_b -= found.torque;
        moment = found.kept;
    }
    LawForce { loads, spring: Spring { shift, overlap: depth, moment }.in_range(), slips }
}

/// The displacement of the last step in the present tangent plane. It keeps its length, but it shrinks with
/// the tangential stiffness when the contact unloads, so that unloading creates no energy.
fn carried(before: Spring, n: Vec3, unloading: f32) -> Vec3 {
    let flat = before.shift - n * before.shift.dot(n);
    let (length, old_length) = (flat.length(), before.shift.length());
    if length == 0.0 {
        return Vec3::ZERO;
    }
    flat * (old_length / length * unloading)
}

/// The tangential spring and dashpot of a contact.
struct Tangential {
    shift: Vec3,
    slip: Vec3,
    stiffness: f32,
    damping: f32,
}

/// The tangential force on A, which is at most `limit`, the displacement that belongs to it, and whether the limit was exceeded.
fn limited(t: &Tangential, limit: f32) -> (Vec3, Vec3, bool) {
    let force = -t.stiffness * t.shift - t.damping * t.slip;
    let size = force.length();
    if size <= limit {
        return (force, t.shift, false);
    }
    let force = force * (limit / size);
    // Where the dashpot alone exceeds the limit, the spring is released. Otherwise it would push the contact along its slip.
    let elastic = force + t.damping * t.slip;
    let shift = if elastic.dot(force) > 0.0 { -elastic / t.stiffness } else { Vec3::ZERO };
    (force, shift, true)
}

/// Constants, bodies and speed of approach of a contact.
fn of_touch(view: &View, [id_a, id_b]: [u32; 2], touch: &Touch) -> (Constants, Bodies, f32) {
    let [a, b] = sides(view, [id_a, id_b], touch);
    (Constants::of(view, id_a, id_b), Bodies::of(&a, &b), (a.velocity - b.velocity).dot(touch.normal))
}

/// A new contact of two objects with an overlap and a speed of approach.
#[inline]
fn contact<'a>(
    view: &View<'a>,
    [id_a, id_b]: [u32; 2],
    constants: &'a Constants,
    bodies: &'a Bodies,
    [overlap, approach]: [f32; 2],
) -> Contact<'a> {
    let resists = view.step.constants.flags & FLAG_RESISTANCE != 0;
    Contact { constants, bodies, overlap, approach, before: None, resists, program: view.contact_law(id_a, id_b) }
}

/// The error of a contact of two objects to which the law of the program gives a response that is not finite.
pub(crate) fn not_finite(view: &View, ids: [u32; 2], touch: &Touch, what: &str) -> Option<Error> {
    let (constants, bodies, approach) = of_touch(view, ids, touch);
    let contact = contact(view, ids, &constants, &bodies, [touch.overlap, approach]);
    contact.with_law(|law, input| law.not_finite(input, what))
}

/// Stiffness and damping of a contact, along its normal and in its tangent plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pliancy {
    /// Force per displacement, in mass/s².
    pub(crate) stiffness: [f32; 2],
    /// Force per velocity, in mass/s.
    pub(crate) damping: [f32; 2],
}

/// Stiffness and damping of a contact by a law with history (docs/physics section 2.18).
pub(crate) fn pliancy(view: &View, ids: [u32; 2], touch: &Touch) -> Pliancy {
    let (constants, bodies, approach) = of_touch(view, ids, touch);
    let depth = Bond::of(&constants, bodies.radius, touch.overlap).depth;
    let contact = contact(view, ids, &constants, &bodies, [depth, approach]);
    let dt = view.step.constants.dt;
    let (now, [normal, damping]) = of_file(view.step.layout.law, |law| (law.answer(&contact), law.slopes(&contact, dt)));
    Pliancy { stiffness: [normal, now.stiffness.tangential], damping: [damping, now.dashpot] }
}

/// Energy of the normal spring of a contact, and of its attraction.
pub(crate) fn normal_energy(view: &View, id_a: u32, id_b: u32, touch: &Touch) -> f64 {
    let (constants, bodies, _) = of_touch(view, [id_a, id_b], touch);
    if let Some(energy) = jkr::energy(&constants, bodies.radius, touch.overlap) {
        return energy;
    }
    let contact = contact(view, [id_a, id_b], &constants, &bodies, [touch.overlap, 0.0]);
    let elastic = of_file(view.step.layout.law, |law| law.energy(&contact));
    elastic - f64::from(constants.cohesion) * f64::from(bodies.radius) * f64::from(touch.overlap)
}

impl Bodies {
    #[inline]
    fn of(a: &Side, b: &Side) -> Self {
        Self { radius: effective_radius(a, b), mass: 1.0 / (a.inverse_mass + b.inverse_mass) }
    }
}

/// R*, with 1/R* the sum of the curvatures of both sides. Boxes and polygons are flat.
#[inline]
fn effective_radius(a: &Side, b: &Side) -> f32 {
    let curvature = |side: &Side| side.radius.map_or(0.0, f32::recip);
    1.0 / (curvature(a) + curvature(b))
}
