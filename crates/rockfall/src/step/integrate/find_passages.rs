//! Counts the spheres whose centre has passed a wall in the step (docs/physics section 2.20).
//!
//! A sphere is tested if its way in the step is longer than a quarter of its radius, or if the deepest overlap at the step before was
//! at least half of its radius. In most steps there is none, and every thread returns after two words of the status. `loads` notes
//! fast spheres. The way follows from the stage states. So spheres that are put somewhere between steps are not counted.

use glam::Vec3;
use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::view::{Object, View};
use crate::model::world::World;
use crate::physics::passage::{is_deep, is_fast, passes};
use crate::settings::Integrator;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "find_passages",
    wgsl: Wgsl::File(part!("step/integrate/find_passages.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("y2", Buffer::Y2),
        read("y3", Buffer::Y3),
        read("y4", Buffer::Y4),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    moves: |_| NONE,
    cpu: find_passages,
};

pub(crate) fn find_passages(world: &mut World, _pass: u32) {
    let deepest = f32::from_bits(world.status.last_max_overlap);
    if world.status.rejected != 0 || (world.status.counters[0].fast == 0 && !is_deep(deepest, world.step.layout.least_radius)) {
        return;
    }
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let lists = Lists::new(&world.step, &world.lists);
    let is_due = |sphere: &u32| {
        let may_pass = is_fast(&view, *sphere) || is_deep(deepest, view.radius(*sphere));
        may_pass && !view.is_fixed(*sphere) && view.is_own(*sphere)
    };
    let spheres = (0..world.step.layout.spheres).into_par_iter().with_min_len(GRAIN);
    let count = |mut tally: Tally, sphere: u32| {
        let way = way_in_step(world, &view, sphere);
        let passes = |id: u32| matches!(view.object(id), Object::Polygon(polygon) if passes(&view, sphere, way, polygon));
        if lists.row(sphere).any(|entry| passes(entry.id())) {
            tally.count_passage(view.insertion_index(sphere));
        }
        tally
    };
    let tally = spheres.filter(is_due).fold(Tally::default, count).reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
}

/// The way of a sphere in the step. Without rods and rigid bodies it follows from the velocities that moved the sphere.
fn way_in_step(world: &World, view: &View, sphere: u32) -> Vec3 {
    let [_, y2, y3, y4] = &world.states;
    let (traits, dt) = (world.step.traits(), world.step.constants.dt);
    let row = |state: &[glam::Vec4], region: u32| state[(region * world.step.layout.spheres + sphere) as usize].truncate();
    let now = view.position(sphere);
    match traits.integrator {
        _ if traits.turns_late() => now - row(y3, 0),
        Integrator::VelocityVerlet => dt * row(y4, 1),
        Integrator::SymplecticEuler => dt * view.velocity(sphere),
        // Stage state 3 is half a step ahead of the start, at the velocity of stage state 2.
        Integrator::Rk4 => (now - row(y3, 0)) + 0.5 * dt * row(y2, 1),
    }
}
