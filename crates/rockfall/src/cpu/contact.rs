//! The contact law: repulsion, damping, friction and torque of one overlapping pair (physics.md section 4).

use glam::Vec3;

use crate::cpu::touch::Touch;
use crate::cpu::view::{Object, TINY, View};
use crate::layout::{FLAG_COLLISIONS, FLAG_PULL};

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

/// What a contact does: `force` on A, its opposite on B, and a torque on each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactForce {
    pub(crate) force: Vec3,
    pub(crate) torque_a: Vec3,
    pub(crate) torque_b: Vec3,
}

/// The contact force of two objects that touch.
pub(crate) fn contact_force(view: &View, object_a: Object, object_b: Object, touch: &Touch) -> ContactForce {
    let step = view.step;
    let (a, b) = (side(view, object_a, touch.a), side(view, object_b, touch.b));
    let (n, overlap) = (touch.normal, touch.overlap);
    let approach = (a.velocity - b.velocity).dot(n);
    let threshold = step.activation_threshold * smaller_radius(&a, &b);
    // Phase 3 has not seen an overlap that began within this step; its impulse will come with the next one.
    let unseen = step.flags & FLAG_COLLISIONS != 0 && approach > threshold && overlap < 2.0 * approach * step.dt;
    // What comes through a polygon from behind must not be shot out of its face.
    let leaving = matches!(object_b, Object::Polygon(_)) && approach < -threshold;
    if unseen || leaving {
        return ContactForce::default();
    }
    let reduced_mass = 1.0 / (a.inverse_mass + b.inverse_mass);
    let mut pressure = step.contact_force * overlap + step.contact_damping * approach;
    if step.flags & FLAG_PULL == 0 {
        pressure = pressure.max(0.0);
    }

    // Arms that end in one common point: the overlap is shared, or all on the mover's side.
    let (arm_a, arm_b) = match (a.radius, b.radius) {
        (Some(a), Some(b)) => (a - 0.5 * overlap, b - 0.5 * overlap),
        (a, _) => (a.unwrap_or(0.0) - overlap, 0.0),
    };
    let surface_a = a.velocity + a.spin.cross(arm_a * n);
    let surface_b = b.velocity - b.spin.cross(arm_b * n);
    let sliding = surface_b - surface_a;
    let cap = (step.coulomb_friction > 0.0).then(|| step.coulomb_friction * reduced_mass * pressure.max(0.0));
    let friction = friction(sliding - n * sliding.dot(n), step.friction * reduced_mass * overlap, cap);
    let couple = n.cross(friction);
    ContactForce { force: friction - pressure * reduced_mass * n, torque_a: arm_a * couple, torque_b: arm_b * couple }
}

/// The thesis's method 3, t / sqrt(|t|), no larger than the cap where there is one.
///
/// With f the strength, mu m* o, the square root gives |F| = f sqrt|t|; Coulomb's law mu_c N, in the direction of t, N the
/// normal force. The lesser of the two is continuous, never does positive work on the sliding, and is Coulomb's law from |t|
/// = (mu_c N / f)² on: without damping (N = Cc m* o) that is (mu_c Cc / mu)², whatever the overlap and the masses.
fn friction(t: Vec3, strength: f32, cap: Option<f32>) -> Vec3 {
    let tt = t.length_squared();
    if tt <= TINY {
        return Vec3::ZERO;
    }
    let per_velocity = strength / tt.sqrt().sqrt();
    t * cap.map_or(per_velocity, |cap| per_velocity.min(cap / tt.sqrt()))
}
