//! The contact law: repulsion, damping, friction and torque of overlapping pairs, four at a time (physics.md section 4).

use glam::{BVec4A, Vec3, Vec4};

use crate::cpu::geometry::ROUNDED;
use crate::cpu::lanes::Vec3x4;
use crate::cpu::touch::Touch;
use crate::cpu::view::{Object, TINY, View};
use crate::layout::{FLAG_COLLISIONS, FLAG_PULL, Step};

/// One body of a contact, as seen from the contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// 1/m of a sphere, 1/M(a) of a rod (2.6), 0 of what is static.
    pub(crate) inverse_mass: f32,
    pub(crate) velocity: Vec3,
    pub(crate) spin: Vec3,
    /// `None` for what is static.
    pub(crate) radius: Option<f32>,
}

/// The side of `object`; of a rod, at `parameter`.
pub(crate) fn side(view: &View, object: Object, parameter: f32) -> Side {
    match object {
        Object::Sphere(sphere) => Side {
            inverse_mass: view.inverse_mass(sphere),
            velocity: view.velocity(sphere),
            spin: view.spin(sphere),
            radius: Some(view.radius(sphere)),
        },
        Object::Rod(rod) => {
            let rod = view.rod(rod);
            let [one, two] = rod.ends;
            let (s, t) = (1.0 - parameter, parameter);
            Side {
                inverse_mass: s * s * view.inverse_mass(one) + t * t * view.inverse_mass(two),
                velocity: s * view.velocity(one) + t * view.velocity(two),
                spin: s * view.spin(one) + t * view.spin(two),
                radius: Some(rod.radius),
            }
        }
        Object::Cuboid(_) | Object::Polygon(_) => {
            Side { inverse_mass: 0.0, velocity: Vec3::ZERO, spin: Vec3::ZERO, radius: None }
        }
    }
}

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
    // What comes through a polygon from behind must not be shot out of its face.
    let threshold = view.step.activation_threshold * smaller_radius(&a, &b);
    if matches!(object_b, Object::Polygon(_)) && (a.velocity - b.velocity).dot(touch.normal) < -threshold {
        return ContactForce::default();
    }
    let touches = Touches { normal: Vec3x4::splat(touch.normal), overlap: Vec4::splat(touch.overlap) };
    let of_four = contact_forces(view.step, &Sides::splat(&a), &Sides::splat(&b), &touches);
    let [force, torque_a, torque_b] = [of_four.force, of_four.torque_a, of_four.torque_b].map(|v| v.to_rows()[0]);
    ContactForce { force, torque_a, torque_b }
}

/// The approach velocities of four contacts, positive when closing.
#[inline]
pub(crate) fn approach(a: &Sides, b: &Sides, normal: Vec3x4) -> Vec4 {
    (a.velocity - b.velocity).dot(normal)
}

/// The contact forces of four pairs that touch. The law is the same from either side: what is A here need not have been added
/// first.
#[inline]
pub(crate) fn contact_forces(step: &Step, a: &Sides, b: &Sides, touches: &Touches) -> ContactForce<Vec3x4> {
    let (n, overlap) = (touches.normal, touches.overlap);
    let relative = a.velocity - b.velocity;
    let approach = relative.dot(n);
    let reduced_mass = 1.0 / (a.inverse_mass + b.inverse_mass);
    let mut pressure = step.contact_force * overlap + step.contact_damping * approach;
    if step.flags & FLAG_PULL == 0 {
        pressure = pressure.max(Vec4::ZERO);
    }

    // Arms that end in one common point: the overlap is shared, or all on the mover's side.
    let radius_a = a.radius.unwrap_or(Vec4::ZERO);
    let (arm_a, arm_b) = match b.radius {
        Some(radius_b) => (radius_a - 0.5 * overlap, radius_b - 0.5 * overlap),
        None => (radius_a - overlap, Vec4::ZERO),
    };
    // t = uB - uA without what it has along n, to which spins add nothing.
    let t = n * approach - relative - (a.spin * arm_a + b.spin * arm_b).cross(n);
    // How large velocities are, by their sum, which is cheaper than each; opposite ones close or slip.
    let sum = a.velocity + b.velocity;
    let cap = (step.coulomb_friction > 0.0).then(|| step.coulomb_friction * reduced_mass * pressure.max(Vec4::ZERO));
    let rounded = ROUNDED * ROUNDED * (sum.dot(sum) + approach * approach);
    let friction = friction(t, rounded, step.friction * reduced_mass * overlap, cap);
    let couple = n.cross(friction);
    let force = friction - n * (pressure * reduced_mass);

    // Phase 3 has not seen an overlap that began within this step; its impulse will come with the next one.
    let threshold = step.activation_threshold * b.radius.map_or(radius_a, |radius_b| radius_a.min(radius_b));
    let unseen = if step.flags & FLAG_COLLISIONS != 0 {
        approach.cmpgt(threshold) & overlap.cmplt(2.0 * approach * step.dt)
    } else {
        BVec4A::FALSE
    };
    let acts = Vec4::select(unseen, Vec4::ZERO, Vec4::ONE);
    ContactForce { force: force * acts, torque_a: couple * (arm_a * acts), torque_b: couple * (arm_b * acts) }
}

/// The thesis's method 3, t / sqrt(|t|), no larger than the cap where there is one.
///
/// With f the strength, mu m* o, the square root gives |F| = f sqrt|t|; Coulomb's law mu_c N, in the direction of t, N the
/// normal force. The lesser of the two is continuous, never does positive work on the sliding, and is Coulomb's law from |t|
/// = (mu_c N / f)² on: without damping (N = Cc m* o) that is (mu_c Cc / mu)², whatever the overlap and the masses.
///
/// A slip whose square is no more than `rounded` is but the rounding of what it is the difference of, and is none: the root would
/// make a thousandth of it.
#[inline]
fn friction(t: Vec3x4, rounded: Vec4, strength: Vec4, cap: Option<Vec4>) -> Vec3x4 {
    let tt = t.dot(t);
    let speed = tt.sqrt();
    let per_velocity = strength / speed.sqrt();
    let per_velocity = cap.map_or(per_velocity, |cap| per_velocity.min(cap / speed));
    t * Vec4::select(tt.cmple(rounded.max(Vec4::splat(TINY))), Vec4::ZERO, per_velocity)
}
