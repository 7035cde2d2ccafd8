//! The contact law: repulsion, damping, friction and torque of overlapping pairs, four at a time (docs/physics sections 4.3
//! to 4.6).

use glam::{Vec3, Vec4};

use crate::model::lanes::Vec3x4;
use crate::model::layout::{FLAG_COLLISIONS, FLAG_CONTINUOUS, FLAG_PULL};
use crate::model::lists::Lists;
use crate::model::step::Step;
use crate::model::view::{TINY, View};
use crate::physics::first_contact::time_of_visible_beginning;
use crate::physics::geometry::ROUNDED;
use crate::physics::pairs::{Surface, Surfaces};
use crate::physics::side::Side;
use crate::physics::sides::sides;
use crate::physics::touch::Touch;

/// Approach velocity, in units/s, above which the contact of two sides collides (erratum E19). The acceleration by everything but
/// contacts gives a body at rest a velocity of up to `|a| dt` within a step.
pub(crate) fn collision_velocity(step: &Step, a: &Side, b: &Side) -> f32 {
    let free = a.free_acceleration.max(b.free_acceleration);
    (step.constants.activation_threshold * smaller_radius(a, b)).max(step.free_time() * free)
}

/// Returns the smaller radius of a contact, which the activation threshold refers to.
pub(crate) fn smaller_radius(a: &Side, b: &Side) -> f32 {
    match (a.radius, b.radius) {
        (Some(a), Some(b)) => a.min(b),
        (Some(radius), None) | (None, Some(radius)) => radius,
        (None, None) => 0.0,
    }
}

/// The objects on one side of four contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sides {
    pub(crate) inverse_mass: Vec4,
    /// 1/I, 0 for objects that cannot turn.
    pub(crate) inverse_inertia: Vec4,
    pub(crate) velocity: Vec3x4,
    pub(crate) spin: Vec3x4,
    /// `None` for boxes and polygons, in all four contacts.
    pub(crate) radius: Option<Vec4>,
    /// Sizes of the accelerations by everything but contacts, in units/s².
    pub(crate) free_acceleration: Vec4,
}

impl Sides {
    /// Repeats one side four times.
    pub(crate) fn splat(side: &Side) -> Self {
        Self {
            inverse_mass: Vec4::splat(side.inverse_mass),
            inverse_inertia: Vec4::splat(side.inverse_inertia),
            velocity: Vec3x4::splat(side.velocity),
            spin: Vec3x4::splat(side.spin),
            radius: side.radius.map(Vec4::splat),
            free_acceleration: Vec4::splat(side.free_acceleration),
        }
    }
}

/// Geometry of four contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touches {
    /// Unit normals from A to B.
    pub(crate) normal: Vec3x4,
    /// Depths of the overlaps; negative where the objects are apart.
    pub(crate) overlap: Vec4,
}

/// The force and torques of a contact: `force` acts on A and its opposite on B. `V` is one vector or four.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactForce<V> {
    pub(crate) force: V,
    pub(crate) torque_a: V,
    pub(crate) torque_b: V,
}

/// Returns the contact force of two objects that overlap.
pub(crate) fn contact_force(view: &View, lists: &Lists, [id_a, id_b]: [u32; 2], touch: &Touch) -> ContactForce<Vec3> {
    let sides = sides(view, [id_a, id_b], touch);
    if view.step.constants.flags & FLAG_CONTINUOUS != 0 {
        let threshold = collision_velocity(view.step, &sides[0], &sides[1]);
        // A contact that began within the step exerts no force (docs/physics section 3.10).
        if time_of_visible_beginning(view, lists, [id_a, id_b], threshold).is_some() {
            return ContactForce::default();
        }
    }
    let [a, b] = sides.each_ref().map(Sides::splat);
    let surfaces = Surfaces::splat(&Surface::of(view, id_a, id_b));
    let of_four = contact_forces(view.step, &a, &b, &Touches::splat(touch), &surfaces);
    let [force, torque_a, torque_b] = [of_four.force, of_four.torque_a, of_four.torque_b].map(|v| v.to_rows()[0]);
    ContactForce { force, torque_a, torque_b }
}

impl Touches {
    /// Repeats one contact four times.
    pub(crate) fn splat(touch: &Touch) -> Self {
        Self { normal: Vec3x4::splat(touch.normal), overlap: Vec4::splat(touch.overlap) }
    }
}

/// Approach velocities of four contacts, and the thresholds that they are compared with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approach {
    /// Approach velocities, positive when the objects approach each other.
    pub(crate) velocity: Vec4,
    /// A contact collides when its approach velocity exceeds this.
    pub(crate) threshold: Vec4,
}

impl Approach {
    #[inline]
    pub(crate) fn of(step: &Step, a: &Sides, b: &Sides, normal: Vec3x4) -> Self {
        let radius_a = a.radius.unwrap_or(Vec4::ZERO);
        let smaller = b.radius.map_or(radius_a, |radius_b| radius_a.min(radius_b));
        let free = a.free_acceleration.max(b.free_acceleration);
        let threshold = (step.constants.activation_threshold * smaller).max(step.free_time() * free);
        Self { velocity: (a.velocity - b.velocity).dot(normal), threshold }
    }
}

/// Returns the normal forces of four contacts, (Cc o + Cd u) m*. Positive forces push the objects apart. Forces are not
/// negative, unless the settings allow contact damping to pull.
///
/// While collisions are switched on, the force is 0 in two cases (docs/physics section 4.4):
/// - The pair separates fast. An impulse has already made it rebound, and a force would add energy (E22).
/// - The overlap began within this step. The collision phase has not seen it yet. The impulse follows in the next step.
#[inline]
pub(crate) fn normal_forces(step: &Step, a: &Sides, b: &Sides, overlap: Vec4, approach: &Approach) -> Vec4 {
    pressures(step, overlap, approach.velocity) * acting_masses(step, a, b, overlap, approach)
}

/// Normal forces divided by the reduced masses.
#[inline]
fn pressures(step: &Step, overlap: Vec4, approach: Vec4) -> Vec4 {
    let pressure = step.constants.contact_force * overlap + step.constants.contact_damping * approach;
    if step.constants.flags & FLAG_PULL == 0 { pressure.max(Vec4::ZERO) } else { pressure }
}

/// Reduced masses m*, 0 where the contact exerts no force.
#[inline]
fn acting_masses(step: &Step, a: &Sides, b: &Sides, overlap: Vec4, approach: &Approach) -> Vec4 {
    let Approach { velocity, threshold } = *approach;
    let reduced_mass = 1.0 / (a.inverse_mass + b.inverse_mass);
    if step.constants.flags & FLAG_COLLISIONS == 0 {
        return reduced_mass;
    }
    let unseen = velocity.cmpgt(threshold) & overlap.cmplt(2.0 * velocity * step.constants.dt);
    Vec4::select(unseen | velocity.cmplt(-threshold), Vec4::ZERO, reduced_mass)
}

/// Returns the arms of four contacts: the distances from the centres or axes of A and B to their common contact point. Against
/// a sphere or rod, each arm is shorter by half of the overlap. Against a box or polygon, the arm of A is shorter by all of it.
#[inline]
pub(crate) fn arms(a: &Sides, b: &Sides, overlap: Vec4) -> [Vec4; 2] {
    let radius_a = a.radius.unwrap_or(Vec4::ZERO);
    match b.radius {
        Some(radius_b) => [radius_a - 0.5 * overlap, radius_b - 0.5 * overlap],
        None => [radius_a - overlap, Vec4::ZERO],
    }
}

/// Slip of four contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slip {
    /// t, the velocity of B's surface relative to A's surface.
    pub(crate) velocity: Vec3x4,
    /// A slip with a square up to this is only a rounding error of the velocities that are subtracted.
    pub(crate) rounded: Vec4,
}

impl Slip {
    /// Computes t = uB - uA without its component along n. Spins do not contribute to that component.
    #[inline]
    pub(crate) fn of(a: &Sides, b: &Sides, normal: Vec3x4, [arm_a, arm_b]: [Vec4; 2], approach: Vec4) -> Self {
        let relative = a.velocity - b.velocity;
        let velocity = normal * approach - relative - (a.spin * arm_a + b.spin * arm_b).cross(normal);
        // The sum of both velocities measures their size. It is cheaper than the size of each. Where opposite velocities cancel
        // in the sum, they contribute to the approach velocity or to the slip.
        let sum = a.velocity + b.velocity;
        let rounded = ROUNDED * ROUNDED * (sum.dot(sum) + approach * approach);
        Self { velocity, rounded: rounded.max(Vec4::splat(TINY)) }
    }
}

/// Returns the contact forces of four pairs that overlap. The contact law is symmetric, so A need not be the object that was
/// added first.
#[inline]
pub(crate) fn contact_forces(
    step: &Step,
    a: &Sides,
    b: &Sides,
    touches: &Touches,
    surfaces: &Surfaces,
) -> ContactForce<Vec3x4> {
    let (n, overlap) = (touches.normal, touches.overlap);
    let approach = Approach::of(step, a, b, n);
    let mass = acting_masses(step, a, b, overlap, &approach);
    let normal = n * (pressures(step, overlap, approach.velocity) * mass);
    let [arm_a, arm_b] = arms(a, b, overlap);
    // Friction impulses replace the friction force.
    let has_impulses = surfaces.coulomb_friction.cmpgt(Vec4::ZERO);
    if has_impulses.all() {
        return ContactForce { force: Vec3x4::default() - normal, ..ContactForce::default() };
    }
    let strength = Vec4::select(has_impulses, Vec4::ZERO, surfaces.friction);
    let slip = Slip::of(a, b, n, [arm_a, arm_b], approach.velocity);
    let slip_inverse_mass =
        a.inverse_mass + b.inverse_mass + arm_a * arm_a * a.inverse_inertia + arm_b * arm_b * b.inverse_inertia;
    let friction = friction(&slip, strength * overlap * mass, slip_inverse_mass * (2.0 * step.constants.dt));
    let torque = n.cross(friction);
    ContactForce { force: friction - normal, torque_a: torque * arm_a, torque_b: torque * arm_b }
}

/// Returns the friction force of the thesis's third method, strength t / sqrt(|t|), but at most t / divisor.
///
/// The bound keeps the integration stable (E25, docs/physics section 4.6). With divisor = 2 w_t dt, where w_t is the inverse
/// mass of the slip, a force at the bound removes half of the slip within a step. Near rest, the square-root law alone would
/// change the slip by many times its value. The smaller of the two quotients is strength t / max(sqrt(|t|), strength divisor).
#[inline]
fn friction(slip: &Slip, strength: Vec4, divisor: Vec4) -> Vec3x4 {
    let t = slip.velocity;
    let tt = t.dot(t);
    let per_velocity = strength / tt.sqrt().sqrt().max(strength * divisor);
    t * Vec4::select(tt.cmple(slip.rounded), Vec4::ZERO, per_velocity)
}
