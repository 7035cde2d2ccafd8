//! Velocity Verlet in scenes with rods: rejects the step if a sphere is outside its AABB where forces are evaluated next, and
//! requests new lists (`rebuild`) if a sphere may leave its AABB within the next step. In other scenes `drift` makes these tests.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::travel::escape_ratio;
use crate::step::integrate::drift::request_rebuild;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "check_drift",
    wgsl: Wgsl::File(part!("step/integrate/check_drift.wgsl")),
    bindings: &[
        read("state", Buffer::Y4),
        read("topology", Buffer::Topology),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Reads position and velocity.
    moves: |_| Moves { rows: 2, sphere_aabbs: 1, ..NONE },
    cpu: check_drift,
};

fn check_drift(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let view = View::new(&world.step, &world.topology, &world.states[3]);
    let ratios = (0..world.step.spheres).into_par_iter().with_min_len(GRAIN);
    let mut tally = Tally::default();
    tally.escape_ratio = ratios.map(|sphere| escape_ratio(&view, &world.aabbs, sphere)).reduce(|| 0.0, f32::max);
    tally.add_to(&mut world.status);
    request_rebuild(world);
}
