//! The contact law: repulsion, damping, friction and torque of overlapping pairs, four at a time (docs/physics.md sections 4.3 to 4.6).

use glam::{Vec3, Vec4};

use crate::model::lanes::Vec3x4;
use crate::model::layout::{FLAG_COLLISIONS, FLAG_PULL};
use crate::model::step::Step;
use crate::model::view::{Object, TINY, View};
use crate::physics::geometry::ROUNDED;
use crate::physics::side::{Side, side};
use crate::physics::touch::Touch;

/// The radius that the activation threshold refers to.
pub(crate) fn smaller_radius(a: &Side, b: &Side) -> f32 {
    match (a.radius, b.radius) {
        (Some(a), Some(b)) => a.min(b),
        (Some(radius), None) | (None, Some(radius)) => radius,
        (None, None) => 0.0,
    }
}

/// The bodies on one side of four contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sides {
    pub(crate) inverse_mass: Vec4,
    /// 1/I of what can turn, else 0.
    pub(crate) inverse_inertia: Vec4,
    pub(crate) velocity: Vec3x4,
    pub(crate) spin: Vec3x4,
    /// `None` for what is static, in all four.
    pub(crate) radius: Option<Vec4>,
}

impl Sides {
    /// The same body four times.
    pub(crate) fn splat(side: &Side) -> Self {
        Self {
            inverse_mass: Vec4::splat(side.inverse_mass),
            inverse_inertia: Vec4::splat(side.inverse_inertia),
            velocity: Vec3x4::splat(side.velocity),
            spin: Vec3x4::splat(side.spin),
            radius: side.radius.map(Vec4::splat),
        }
    }
}

/// Where four pairs overlap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touches {
    /// Unit normals from A to B.
    pub(crate) normal: Vec3x4,
    /// Depths of the overlaps.
    pub(crate) overlap: Vec4,
}

/// What a contact does: `force` on A, its opposite on B, and a torque on each. `V` is a vector, or four.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactForce<V> {
    pub(crate) force: V,
    pub(crate) torque_a: V,
    pub(crate) torque_b: V,
}

/// The contact force of two objects that touch.
pub(crate) fn contact_force(view: &View, object_a: Object, object_b: Object, touch: &Touch) -> ContactForce<Vec3> {
    let (a, b) = (side(view, object_a, touch.a), side(view, object_b, touch.b));
    let of_four = contact_forces(view.step, &Sides::splat(&a), &Sides::splat(&b), &Touches::splat(touch));
    let [force, torque_a, torque_b] = [of_four.force, of_four.torque_a, of_four.torque_b].map(|v| v.to_rows()[0]);
    ContactForce { force, torque_a, torque_b }
}

impl Touches {
    /// The same touch four times.
    pub(crate) fn splat(touch: &Touch) -> Self {
        Self { normal: Vec3x4::splat(touch.normal), overlap: Vec4::splat(touch.overlap) }
    }
}

/// The velocities of four pairs that decide which rules apply.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approach {
    /// Positive when closing.
    pub(crate) velocity: Vec4,
    /// Above this contacts collide.
    pub(crate) threshold: Vec4,
}

impl Approach {
    #[inline]
    pub(crate) fn of(step: &Step, a: &Sides, b: &Sides, normal: Vec3x4) -> Self {
        let radius_a = a.radius.unwrap_or(Vec4::ZERO);
        let smaller = b.radius.map_or(radius_a, |radius_b| radius_a.min(radius_b));
        let least = Vec4::splat(step.collision_velocity(0.0));
        Self { velocity: (a.velocity - b.velocity).dot(normal), threshold: (step.activation_threshold * smaller).max(least) }
    }
}

/// The normal force of four pairs, positive when pushing: (Cc o + Cd u) m*, and never a pull unless the settings ask for it. While
/// collisions are on there is none in two cases. A pair that separates fast has been given its rebound by an impulse, to which a force
/// would add (E22). An overlap that began within this step is one that the collision phase has not seen: its impulse comes in the next.
#[inline]
pub(crate) fn normal_forces(step: &Step, a: &Sides, b: &Sides, overlap: Vec4, approach: &Approach) -> Vec4 {
    pressures(step, overlap, approach.velocity) * acting_masses(step, a, b, overlap, approach)
}

/// The normal force by the reduced mass.
#[inline]
fn pressures(step: &Step, overlap: Vec4, approach: Vec4) -> Vec4 {
    let pressure = step.contact_force * overlap + step.contact_damping * approach;
    if step.flags & FLAG_PULL == 0 { pressure.max(Vec4::ZERO) } else { pressure }
}

/// m*, 0 where there is no force.
#[inline]
fn acting_masses(step: &Step, a: &Sides, b: &Sides, overlap: Vec4, approach: &Approach) -> Vec4 {
    let Approach { velocity, threshold } = *approach;
    let reduced_mass = 1.0 / (a.inverse_mass + b.inverse_mass);
    if step.flags & FLAG_COLLISIONS == 0 {
        return reduced_mass;
    }
    let unseen = velocity.cmpgt(threshold) & overlap.cmplt(2.0 * velocity * step.dt);
    Vec4::select(unseen | velocity.cmplt(-threshold), Vec4::ZERO, reduced_mass)
}

/// Arms from the middles of four pairs to points that both share: the overlap is halved, or all on the mover's side.
#[inline]
pub(crate) fn arms(a: &Sides, b: &Sides, overlap: Vec4) -> [Vec4; 2] {
    let radius_a = a.radius.unwrap_or(Vec4::ZERO);
    match b.radius {
        Some(radius_b) => [radius_a - 0.5 * overlap, radius_b - 0.5 * overlap],
        None => [radius_a - overlap, Vec4::ZERO],
    }
}

/// How four pairs slide.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slip {
    /// t, by which B's surface moves past A's.
    pub(crate) velocity: Vec3x4,
    /// A slip whose square is no more than this is but the rounding of what it is the difference of.
    pub(crate) rounded: Vec4,
}

impl Slip {
    /// t = uB - uA without what it has along n, to which spins add nothing.
    #[inline]
    pub(crate) fn of(a: &Sides, b: &Sides, normal: Vec3x4, [arm_a, arm_b]: [Vec4; 2], approach: Vec4) -> Self {
        let relative = a.velocity - b.velocity;
        let velocity = normal * approach - relative - (a.spin * arm_a + b.spin * arm_b).cross(normal);
        // How large velocities are, by their sum, which is cheaper than each; opposite ones close or slip.
        let sum = a.velocity + b.velocity;
        let rounded = ROUNDED * ROUNDED * (sum.dot(sum) + approach * approach);
        Self { velocity, rounded: rounded.max(Vec4::splat(TINY)) }
    }
}

/// The contact forces of four pairs that touch. The law is the same from either side: what is A here need not have been added
/// first.
#[inline]
pub(crate) fn contact_forces(step: &Step, a: &Sides, b: &Sides, touches: &Touches) -> ContactForce<Vec3x4> {
    let (n, overlap) = (touches.normal, touches.overlap);
    let approach = Approach::of(step, a, b, n);
    let mass = acting_masses(step, a, b, overlap, &approach);
    let normal = n * (pressures(step, overlap, approach.velocity) * mass);
    let [arm_a, arm_b] = arms(a, b, overlap);
    if step.coulomb_friction > 0.0 {
        // Friction impulses take the place of this force.
        return ContactForce { force: Vec3x4::default() - normal, ..ContactForce::default() };
    }
    let slip = Slip::of(a, b, n, [arm_a, arm_b], approach.velocity);
    let slipping = a.inverse_mass + b.inverse_mass + arm_a * arm_a * a.inverse_inertia + arm_b * arm_b * b.inverse_inertia;
    let friction = friction(&slip, step.friction * overlap * mass, slipping * (2.0 * step.dt));
    let couple = n.cross(friction);
    ContactForce { force: friction - normal, torque_a: couple * arm_a, torque_b: couple * arm_b }
}

/// The thesis's method 3, strength t / sqrt(|t|), and no more than t / least.
///
/// The bound makes it stable (E25). With least = 2 w_t dt, w_t the inverse mass of the slip, the force takes half of the slip away within a
/// step; near rest the square root alone would ask for any multiple of it. Of both quotients the lesser one is the strength over the greater
/// of sqrt(|t|) and strength times least.
#[inline]
fn friction(slip: &Slip, strength: Vec4, least: Vec4) -> Vec3x4 {
    let t = slip.velocity;
    let tt = t.dot(t);
    let per_velocity = strength / tt.sqrt().sqrt().max(strength * least);
    t * Vec4::select(tt.cmple(slip.rounded), Vec4::ZERO, per_velocity)
}
