//! Velocity Verlet: evaluates the forces at the start of the step, if those of the last step do not belong to the present state
//! (docs/physics.md section 5.7).
//!
//! Runs when `forces_due` is set: in the first step, after edits, and after the collision phase. The stage counts no contacts,
//! because `kick` counts them.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::step::integrate::kick::put_rates;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "starting_forces",
    wgsl: Wgsl::File(part!("step/integrate/starting_forces.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("wrenches", Buffer::Wrenches),
        write("kept_rates", Buffer::Rates),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    // Most steps need nothing of it.
    moves: |_| NONE,
    cpu: starting_forces,
};

fn starting_forces(world: &mut World, pass: u32) {
    if world.status.rejected != 0 || !world.needs_forces(pass) {
        return;
    }
    let view = View::new(&world.step, &world.topology, &world.states[0])
        .at_evaluation(&world.status, pass)
        .with_laws(&world.user_laws);
    let lists = Lists::new(&world.step, &world.lists);
    let spheres = (0..world.step.spheres).into_par_iter().with_min_len(GRAIN);
    let of = |sphere: u32| (!view.is_fixed(sphere)).then(|| sphere_rates(&view, &lists, &world.wrenches, sphere, None));
    let rates: Vec<Option<Rates>> = spheres.map(of).collect();
    put_rates(world, &rates);
}
