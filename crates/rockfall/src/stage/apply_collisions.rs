//! Collisions, 2 of 3: every sphere gathers its shares of the weighted impulses and displacements (physics.md section 3). The
//! overlap is removed too where nothing else presses: where the row sum over all overlapping contacts is 1 within 0.001.
//!
//! The new state of those that collide goes to `Y2`, for the others still read the old one. A body that would stop being finite keeps its
//! position, loses velocity and spin, and is reported.

use glam::Vec3;
use rayon::prelude::*;

use crate::cpu::collision::{Incident, row_sums, takes_part};
use crate::cpu::lists::Lists;
use crate::cpu::state::{Motion, Rows};
use crate::cpu::tally::{Tally, asks_for_lists};
use crate::cpu::view::View;
use crate::layout::{Aabb, BadStage, ENTRY_COLLIDES, ENTRY_OVERLAPS};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "apply_collisions",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/one_state.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/rows.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("wgsl/plain.wgsl"),
        part!("wgsl/weights.wgsl"),
        part!("wgsl/stored_sums.wgsl"),
        part!("wgsl/travel.wgsl"),
        part!("wgsl/margin.wgsl"),
        part!("wgsl/tell.wgsl"),
        part!("wgsl/changes.wgsl"),
        part!("wgsl/teams.wgsl"),
        part!("wgsl/ordered_sums.wgsl"),
        part!("stage/apply_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("aabbs", Buffer::Aabbs),
        read("row_sums", Buffer::RowSums),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    cpu: apply_collisions,
};

fn apply_collisions(world: &mut World, _pass: u32) {
    if world.status.void != 0 || world.status.collided != 0 || world.status.collides == 0 {
        return;
    }
    let [start, y2, ..] = &mut world.states;
    let view = View::new(&world.step, &world.words, start);
    let lists = Lists::new(&world.step, &world.lists);
    let tally = Rows::of(y2, world.step.spheres)
        .map(|mut rows| {
            let mut tally = Tally::default();
            let applied_here = |sphere: &u32| takes_part(&view, &lists, *sphere);
            for sphere in rows.spheres().filter(applied_here) {
                let after = collided(&view, &lists, &world.row_sums, &world.aabbs, sphere, &mut tally);
                rows.set(&view, sphere, after);
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.tell(&mut world.status);
}

/// The sphere after all its shares of impulses and displacements; tells whether it may leave its AABB so. `stored` are the row sums of
/// collisions, where they are.
fn collided(view: &View, lists: &Lists, stored: &[f32], aabbs: &[Aabb], sphere: u32, tally: &mut Tally) -> Motion {
    let after = after_collisions(view, lists, stored, sphere, tally);
    tally.rebuild |= asks_for_lists(view, aabbs, sphere, after.position, after.velocity);
    after
}

fn after_collisions(view: &View, lists: &Lists, stored: &[f32], sphere: u32, tally: &mut Tally) -> Motion {
    let before = Motion::of(view, sphere);
    if view.is_fixed(sphere) {
        return before;
    }
    let (mut dv, mut dx) = (Vec3::ZERO, Vec3::ZERO);
    // What overlaps without colliding is needed for row sums alone.
    let incident = Incident::of(view, lists, sphere, if stored.is_empty() { ENTRY_OVERLAPS } else { ENTRY_COLLIDES });
    incident.each(|collision, row, entry| {
        if entry.word & ENTRY_COLLIDES == 0 {
            return;
        }
        let sum = match stored.get(lists.slot(row, entry)) {
            Some(sum) => *sum,
            None => row_sums(view, lists, collision, Some(&incident)).told(),
        };
        let share = collision.share_of(sphere) * (view.inverse_mass(sphere) / (sum.abs() * collision.inverse_mass));
        dv += share * ((1.0 + view.step.restitution) * collision.approach);
        if sum < 0.0 {
            dx += share * collision.touch.overlap;
        }
    });
    Motion { position: before.position + dx, velocity: before.velocity + dv, ..before }.or_stopped(
        before.position,
        BadStage::Collisions,
        view.user(sphere),
        tally,
    )
}
