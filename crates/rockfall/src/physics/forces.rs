//! Forces on spheres and rods (docs/physics.md section 4).
//!
//! `net_force` sums the forces of contacts and attachments. To their acceleration and torque every body force adds its own: a pair of
//! files of one name in `forces/`, `NAME.rs` with `fn add` and `NAME.wgsl` with `fn add_NAME`, and a line in the table below. Sphere
//! by sphere, in the order of the table; rods and capsules move by the spheres at their ends. docs/extending.md adds one step by step.

pub(crate) mod net_force;
pub(crate) mod rates;

use glam::Vec4;

use crate::model::counters::Tally;
use crate::model::lists::Lists;
use crate::model::part::Part;
use crate::model::view::View;
use net_force::sphere_load;
use rates::Rates;

/// Declares the modules of the body forces, their sum on the CPU, and the WGSL files of the same.
macro_rules! body_forces {
    ($($name:ident),+ $(,)?) => {
        $(mod $name;)+

        /// Adds all body forces on a moving sphere.
        #[inline]
        fn add_body_forces(view: &View, sphere: u32, rates: &mut Rates) {
            $($name::add(view, sphere, rates);)+
        }

        /// The WGSL of the body forces, and `body_forces.wgsl`, which adds all of them.
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
}

/// The rates of change of a moving sphere: contacts and attachments, then the body forces. `wrenches` are those of `rod_forces`.
pub(crate) fn sphere_rates(view: &View, lists: &Lists, wrenches: &[Vec4], sphere: u32, tally: Option<&mut Tally>) -> Rates {
    let load = sphere_load(view, lists, wrenches, sphere, tally);
    let mut rates = Rates { acceleration: view.inverse_mass(sphere) * load.force, torque: load.torque };
    add_body_forces(view, sphere, &mut rates);
    rates
}
