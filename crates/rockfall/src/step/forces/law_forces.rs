//! Computes the contact forces of a law with history, and advances the springs of the contacts (docs/physics.md section 4.11).
//!
//! Both sides of a contact evaluate it in the same way, so their forces are equal and opposite. The owner of a contact writes its
//! new spring to the table of `Histories` for the springs after the step. The step is rejected when the pool has too few blocks for
//! movers that own many contacts. Like `rod_forces`, the stage counts contacts and clears `lengths_due`.
//!
//! Pass 0 of velocity Verlet computes forces only if `forces_due` is set, and leaves the springs as they are: the evaluation at the
//! end of the step before has advanced them.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, NO_KEY};
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::status::REJECTED_HISTORY;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::laws::contact::law_force;
use crate::physics::laws::history::{BLOCK_WORDS, Chains, Histories, Record, key, owner, pack};
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
    let table = world.history_words();
    let (step, spheres) = (&world.step, world.step.spheres);
    let view = View::new(step, &world.topology, &world.states[pass as usize])
        .at_evaluation(&world.status, pass)
        .with_laws(&world.user_laws);
    let lists = Lists::new(step, &world.lists);
    let counts = pass == step.counted_pass();
    let (first, second) = world.histories.split_at_mut(table);
    let (before, after) = if world.status.history_table == 0 { (first, second) } else { (second, first) };
    let histories = Histories::new(before);
    let mut slots: Vec<u32> = (0..step.movers()).collect();
    (0..spheres).for_each(|slot| slots[view.insertion_index(slot) as usize] = slot);
    let results: Vec<(Loads, Tally, Vec<Record>)> = after
        .par_chunks_mut(BLOCK_WORDS)
        .with_min_len(GRAIN)
        .zip(&slots)
        .map(|(block, mover)| {
            let mut tally = Tally::default();
            let mut own = Own { block: counts.then_some(block), count: 0, all: Vec::new() };
            let loads = loads_on(&view, &lists, &histories, *mover, &mut own, &mut tally);
            (loads, tally, own.all)
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
    let mut chains = Chains::new(after, step.movers());
    for (mover, (.., records)) in (0..).zip(&results).filter(|(_, (.., records))| !records.is_empty()) {
        chains.put(mover, records);
    }
    world.status.history_blocks = chains.blocks();
    if world.status.history_blocks > step.history_pool {
        world.status.rejected |= REJECTED_HISTORY;
    }
    results.into_iter().map(|(_, tally, _)| tally).fold(Tally::default(), Tally::merge).add_to(&mut world.status);
}

/// The springs that a mover owns after the step.
struct Own<'a> {
    /// The block of the mover; `None` in an evaluation that does not advance springs.
    block: Option<&'a mut [u32]>,
    /// Number of springs.
    count: usize,
    /// All records of a mover that needs further blocks, and none of others.
    all: Vec<Record>,
}

impl Own<'_> {
    fn push(&mut self, record: Record) {
        let Some(block) = &mut self.block else { return };
        let (records, _) = block.as_chunks_mut();
        if let Some(place) = records.get_mut(self.count) {
            *place = record;
        } else {
            if self.all.is_empty() {
                self.all.extend_from_slice(records);
            }
            self.all.push(record);
        }
        self.count += 1;
    }
}

/// Adds up the loads of the contacts of a mover, in the order of its list, and writes the springs that it owns to `own`.
fn loads_on(view: &View, lists: &Lists, histories: &Histories, mover: u32, own: &mut Own, tally: &mut Tally) -> Loads {
    let mut loads = Loads::default();
    if let Some(block) = &mut own.block {
        block.fill(NO_KEY);
    }
    for entry in lists.row(mover) {
        let (a, b) = view.ordered(mover, entry.id());
        let Some(touch) = contact(view, histories, a, b, entry.feature()) else { continue };
        let found = law_force(view, [a, b], &touch, histories.spring(view, a, b, entry.feature()));
        if owner(view, a, b) == mover {
            own.push(pack(key(view, entry.id(), entry.feature()), &found.spring));
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
    loads
}
