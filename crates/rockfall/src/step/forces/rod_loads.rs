//! Computes the loads of the contacts of every rod, on both its ends (docs/physics section 4). `loads` adds them to those of the
//! spheres at the ends, in the same pass. Counts and springs are handled as in `loads`.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::forces::loads::evaluate;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "rod_loads",
    wgsl: Wgsl::File(part!("step/forces/rod_loads.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::State, access: Access::Read },
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("histories", Buffer::Histories),
        write("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Rods,
    moves: |_| Moves { rods: 1, wrenches: 1, ..NONE },
    cpu: rod_loads,
};

fn rod_loads(world: &mut World, pass: u32) {
    if world.status.rejected != 0 || !world.needs_forces(pass) {
        return;
    }
    let rods = world.step.layout.spheres..world.step.movers();
    evaluate(world, pass, rods, |contacts, _, mover, rows, owned, tally| {
        let [one, two] = contacts.rod_loads(mover - contacts.view.step.layout.spheres, owned, tally);
        rows.copy_from_slice(&[one.force, one.torque, two.force, two.torque].map(|vector| vector.extend(0.0)));
    });
}
