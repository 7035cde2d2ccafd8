//! Forces on spheres and rods (docs/physics section 4).
//!
//! The stage `loads` sums the forces of contacts ([`contacts`]) and attachments ([`attached`]). In the integrators, each body force
//! adds its acceleration and torque to the rates of every moving sphere, in the order of the table below. Body forces also move rods and capsules, through the spheres at
//! their ends.
//!
//! A body force consists of a line in the table and two files in `forces/`: `NAME.rs` with `fn add`, and `NAME.wgsl` with
//! `fn add_NAME`. `docs/extending.md` explains step by step how to add one.

pub(crate) mod attached;
pub(crate) mod contacts;
pub(crate) mod rates;

use glam::{Vec3, Vec4};

use crate::model::part::Part;
use crate::model::view::View;
use attached::attached_force;
use contacts::Load;
use rates::Rates;

/// Declares the modules of the body forces, the function that adds all of them on the CPU, and their WGSL files.
macro_rules! body_forces {
    ($($name:ident),+ $(,)?) => {
        $(mod $name;)+

        /// Adds all body forces on a moving sphere.
        #[inline]
        fn add_body_forces(view: &View, sphere: u32, rates: &mut Rates) {
            $($name::add(view, sphere, rates);)+
        }

        /// The WGSL files of the body forces, and the generated `body_forces.wgsl`, which adds all of them.
        pub(crate) const PARTS: &[Part] = &[
            $(Part {
                file: concat!("physics/forces/", stringify!($name), ".wgsl"),
                text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/physics/forces/", stringify!($name), ".wgsl")),
            },)+
            Part {
                file: "physics/forces/body_forces.wgsl",
                text: concat!(
                    "// requires physics/forces/rates.wgsl\n",
                    $("// requires physics/forces/", stringify!($name), ".wgsl\n",)+
                    "\nfn add_body_forces(i: u32, rates: ptr<function, Rates>) {\n",
                    $("    add_", stringify!($name), "(i, rates);\n",)+
                    "}\n",
                ),
            },
        ];
    };
}

body_forces! {
    gravity,
    linear_damping,
    angular_damping,
    user,
}

/// Returns the rates of change of a moving sphere, from its load and body forces. `wrenches` are the results of the stage `loads`.
pub(crate) fn sphere_rates(view: &View, wrenches: &[Vec4], sphere: u32) -> Rates {
    let at = (4 * view.step.layout.rods + 2 * sphere) as usize;
    rates_of(view, sphere, &Load { force: wrenches[at].truncate(), torque: wrenches[at + 1].truncate() })
}

/// Returns the rates of change of a moving sphere from the load of its contacts and attachments, and body forces.
#[inline]
pub(crate) fn rates_of(view: &View, sphere: u32, load: &Load) -> Rates {
    let mut rates = Rates { acceleration: view.inverse_mass(sphere) * load.force, torque: load.torque };
    add_body_forces(view, sphere, &mut rates);
    rates
}

/// Acceleration of a moving sphere by everything but contacts and damping: gravity, springs, tethers, external forces and forces of
/// the program. For a sphere of a rigid body, it is that by the accelerations of the body (docs/physics section 3.1).
pub(crate) fn free_acceleration(view: &View, sphere: u32) -> Vec3 {
    let gravity = Vec3::from_array(view.step.constants.gravity);
    let Some(body) = view.body_of_sphere(sphere) else { return gravity + free_rates(view, sphere).acceleration };
    if view.step.layout.free_at == 0 {
        return gravity;
    }
    let body = view.rigid_body(body);
    let lever = |sphere: u32| view.position(sphere) - body.centre;
    let (mut force, mut torque) = (Vec3::ZERO, Vec3::ZERO);
    for (index, _) in view.members(body) {
        let member = view.slot_of(index);
        let rates = free_rates(view, member);
        let pull = rates.acceleration / view.inverse_mass(member);
        force += pull;
        torque += rates.torque + lever(member).cross(pull);
    }
    gravity + body.inverse_mass * force + body.spin_of(torque).cross(lever(sphere))
}

/// Rates of change of a moving sphere by springs, tethers, external forces and forces of the program.
fn free_rates(view: &View, sphere: u32) -> Rates {
    let mut rates = Rates { acceleration: view.inverse_mass(sphere) * attached_force(view, sphere), torque: Vec3::ZERO };
    user::add(view, sphere, &mut rates);
    rates
}
