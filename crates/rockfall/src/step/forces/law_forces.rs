//! Computes the contact forces of a law with history, and advances the springs of the contacts (docs/physics.md section 4.11).
//!
//! Both sides of a contact evaluate it in the same way, so their forces are equal and opposite. The owner of a contact writes its
//! new spring to the table of `Histories` for the springs after the step. The step is rejected
//! when a row has no room for all contacts of its mover. Like `rod_forces`, the stage counts contacts and clears `lengths_due`.
//!
//! Pass 0 of velocity Verlet computes forces only if `forces_due` is set, and leaves the springs as they are: the evaluation at the
//! end of the step before has advanced them.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, HISTORY_WORDS, NO_KEY};
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::status::REJECTED_HISTORY;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::laws::contact::law_force;
use crate::physics::laws::history::{Histories, key, owner, pack, row_words, table_words};
use crate::physics::laws::neck::contact;
use crate::step::moves::{FORCES, Moves};
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "law_forces",
    wgsl: Wgsl::File(part!("step/forces/law_forces.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::State, access: Access::Read },
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("histories", Buffer::Histories),
        write("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    moves: |_| Moves { rows: 3, ..FORCES },
    cpu: law_forces,
};

/// Loads of a mover: force and torque of a sphere, or of both ends of a rod.
type Loads = [Vec3; 4];

fn law_forces(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    if pass == 0 {
        world.status.lengths_due = 0;
    }
    if !world.needs_forces(pass) {
        return;
    }
    let (step, spheres) = (&world.step, world.step.spheres);
    let view = View::new(step, &world.topology, &world.states[pass as usize])
        .at_evaluation(&world.status, pass)
        .with_laws(&world.user_laws);
    let lists = Lists::new(step, &world.lists);
    let counts = pass == step.counted_pass();
    let words = row_words(step);
    let (first, second) = world.histories.split_at_mut(table_words(step));
    let (before, after) = if world.status.history_table == 0 { (first, second) } else { (second, first) };
    let histories = Histories::new(step, before);
    let mut slots: Vec<u32> = (0..step.movers()).collect();
    (0..spheres).for_each(|slot| slots[view.insertion_index(slot) as usize] = slot);
    let results: Vec<(Loads, Tally, bool)> = after
        .par_chunks_mut(words)
        .with_min_len(GRAIN)
        .zip(&slots)
        .map(|(row, mover)| {
            let mut tally = Tally::default();
            let (loads, fits) = loads_on(&view, &lists, &histories, *mover, counts.then_some(row), &mut tally);
            (loads, tally, fits)
        })
        .collect();
    for (mover, (loads, ..)) in slots.iter().zip(&results) {
        let at = if *mover < spheres { 4 * step.rods + 2 * mover } else { 4 * (mover - spheres) } as usize;
        let count = if *mover < spheres { 2 } else { 4 };
        for (wrench, load) in world.wrenches[at..].iter_mut().zip(loads).take(count) {
            *wrench = Vec4::from((*load, 0.0));
        }
    }
    if !counts {
        return;
    }
    let fits = results.iter().all(|(.., fits)| *fits);
    results.into_iter().map(|(_, tally, _)| tally).fold(Tally::default(), Tally::merge).add_to(&mut world.status);
    if !fits {
        world.status.rejected |= REJECTED_HISTORY;
    }
}

/// Adds up the loads of the contacts of a mover, in the order of its list, and writes the springs that it owns to `row`, if given.
/// Returns the loads, and whether the row has room for all springs.
fn loads_on(
    view: &View,
    lists: &Lists,
    histories: &Histories,
    mover: u32,
    mut row: Option<&mut [u32]>,
    tally: &mut Tally,
) -> (Loads, bool) {
    let mut loads = Loads::default();
    let mut owned = 0;
    if let Some(row) = row.as_deref_mut() {
        row.fill(NO_KEY);
    }
    let records = view.step.history_room as usize;
    for entry in lists.row(mover) {
        let (a, b) = view.ordered(mover, entry.id());
        let Some(touch) = contact(view, histories, a, b, entry.feature()) else { continue };
        let found = law_force(view, [a, b], &touch, histories.spring(view, a, b, entry.feature()));
        if owner(view, a, b) == mover {
            if let Some(row) = row.as_deref_mut().filter(|_| owned < records) {
                let at = owned * HISTORY_WORDS as usize;
                pack(&mut row[at..], key(view, entry.id(), entry.feature()), &found.spring);
            }
            owned += 1;
        }
        let [force, torque, at] = if mover == a {
            tally.count_contact(touch.overlap);
            [found.loads.force, found.loads.torque_a, Vec3::splat(touch.a)]
        } else {
            [-found.loads.force, found.loads.torque_b, Vec3::splat(touch.b)]
        };
        if mover < view.step.spheres {
            loads[0] += force;
            loads[1] += torque;
        } else {
            for (end, share) in [1.0 - at.x, at.x].into_iter().enumerate() {
                loads[2 * end] += share * force;
                loads[2 * end + 1] += share * torque;
            }
        }
    }
    (loads, owned <= records)
}
