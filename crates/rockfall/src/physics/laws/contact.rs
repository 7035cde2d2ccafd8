//! Force and torques of a contact by a law with history, and its tangential spring (docs/physics.md section 4.11).

use glam::Vec3;

use crate::model::layout::{FLAG_COLLISIONS, FLAG_RESISTANCE};
use crate::model::view::View;
use crate::physics::contact::{ContactForce, collision_velocity, smaller_radius};
use crate::physics::laws::resistance::{Kept, Turning};
use crate::physics::laws::{Constants, stiffness};
use crate::physics::side::{Side, side};
use crate::physics::touch::Touch;
use crate::settings::ContactLaw;

/// The state of a contact between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spring {
    /// Tangential displacement of A's surface relative to B's, in units. A is the object that was added first.
    pub(crate) shift: Vec3,
    /// Overlap in the last step, in units.
    pub(crate) overlap: f32,
    /// Moment on A of the springs against rolling and twisting.
    pub(crate) moment: Vec3,
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

/// Evaluates the contact of objects a and b, of which a was added first, and advances its spring by a time step.
/// `before` is its spring in the last step, or `None` for a new contact.
pub(crate) fn law_force(view: &View, [id_a, id_b]: [u32; 2], touch: &Touch, before: Option<Spring>) -> LawForce {
    let (step, n, overlap) = (view.step, touch.normal, touch.overlap);
    let [a, b] = [side(view, view.object(id_a), touch.a), side(view, view.object(id_b), touch.b)];
    let approach = (a.velocity - b.velocity).dot(n);
    let spring = Spring { shift: Vec3::ZERO, overlap, moment: Vec3::ZERO };
    if step.flags & FLAG_COLLISIONS != 0 {
        // As in docs/physics.md section 4.4.
        let threshold = collision_velocity(step, smaller_radius(&a, &b));
        if approach < -threshold || (approach > threshold && overlap < 2.0 * approach * step.dt) {
            return LawForce { spring, ..LawForce::default() };
        }
    }
    let reduced_mass = 1.0 / (a.inverse_mass + b.inverse_mass);
    let constants = Constants::of(view, id_a, id_b);
    let radius = effective_radius(&a, &b);
    let stiff = stiffness(ContactLaw::from_number(step.law), &constants, radius, reduced_mass, overlap);

    let damping = constants.damping * (stiff.normal * reduced_mass).sqrt();
    let normal = (stiff.share * stiff.normal * overlap + damping * approach).max(0.0);

    let [arm_a, arm_b] = match (a.radius, b.radius) {
        (Some(radius_a), Some(radius_b)) => [radius_a - 0.5 * overlap, radius_b - 0.5 * overlap],
        (radius, _) => [radius.unwrap_or(0.0) - overlap, 0.0],
    };
    let surface = a.velocity - b.velocity + (arm_a * a.spin + arm_b * b.spin).cross(n);
    let slip = surface - n * surface.dot(n);
    let carried = before.map_or(Vec3::ZERO, |before| carried(before, n, overlap, stiff.rescales));
    let shift = carried + step.dt * slip;
    let damping = constants.damping * (stiff.tangential * reduced_mass).sqrt();
    let (tangential, shift, slips) =
        limited(&Tangential { shift, slip, stiffness: stiff.tangential, damping }, constants.friction * normal);

    let torque = n.cross(tangential);
    let pushed = normal - constants.cohesion * radius;
    let mut loads = ContactForce { force: tangential - pushed * n, torque_a: arm_a * torque, torque_b: arm_b * torque };
    let mut moment = Vec3::ZERO;
    if step.flags & FLAG_RESISTANCE != 0 {
        let turning = Turning { sides: [&a, &b], normal: n, overlap, radius, press: normal, stiffness: stiff, dt: step.dt };
        let kept = before.map_or(Kept { moment, overlap }, |before| Kept { moment: before.moment, overlap: before.overlap });
        let found = turning.moments(&constants, kept);
        loads.torque_a += found.torque;
        loads.torque_b -= found.torque;
        moment = found.kept;
    }
    LawForce { loads, spring: Spring { shift, overlap, moment }, slips }
}

/// The displacement of the last step in the present tangent plane. It keeps its length, but for a law that rescales it shrinks
/// with the square root of the overlap, so that unloading creates no energy.
fn carried(before: Spring, n: Vec3, overlap: f32, rescales: bool) -> Vec3 {
    let flat = before.shift - n * before.shift.dot(n);
    let (length, old_length) = (flat.length(), before.shift.length());
    if length == 0.0 {
        return Vec3::ZERO;
    }
    let unloading = if rescales && overlap < before.overlap { (overlap / before.overlap).sqrt() } else { 1.0 };
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

/// Energy of the normal spring of a contact, and of its attraction.
pub(crate) fn normal_energy(view: &View, id_a: u32, id_b: u32, touch: &Touch) -> f64 {
    let [a, b] = [side(view, view.object(id_a), touch.a), side(view, view.object(id_b), touch.b)];
    let (constants, radius) = (Constants::of(view, id_a, id_b), effective_radius(&a, &b));
    let reduced_mass = 1.0 / (a.inverse_mass + b.inverse_mass);
    let stiff = stiffness(ContactLaw::from_number(view.step.law), &constants, radius, reduced_mass, touch.overlap);
    let elastic = f64::from(stiff.energy_share) * f64::from(stiff.normal) * f64::from(touch.overlap).powi(2);
    elastic - f64::from(constants.cohesion) * f64::from(radius) * f64::from(touch.overlap)
}

/// R*, with 1/R* the sum of the curvatures of both sides. Boxes and polygons are flat.
fn effective_radius(a: &Side, b: &Side) -> f32 {
    let curvature = |side: &Side| side.radius.map_or(0.0, f32::recip);
    1.0 / (curvature(a) + curvature(b))
}
