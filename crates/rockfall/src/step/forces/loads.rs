//! Computes the load of every sphere: force and torque of its contacts, then of what is attached to it (docs/physics section 4).
//! The integrators read it from `Wrenches`.
//!
//! Pass p evaluates the state that pass p of the integrator reads. The stage rejects the step if a moving sphere is outside its AABB
//! in that state, because its list may then lack contacts. The last evaluation of RK4 and of velocity Verlet also requests new lists
//! (`rebuild`) if a sphere may leave its AABB within the next step: the state is close to that at the end of the step. The first pass
//! counts rebuilds of the lists and clears `lengths_due`.
//!
//! The pass that counts contacts, [`counted_pass`](crate::model::step::Step::counted_pass), also advances their springs. The owner of
//! a contact writes its new spring to the table of `Histories` for the springs after the step. The step is rejected when the pool has
//! too few blocks for movers that own many contacts. Pass 0 of velocity Verlet computes loads only if `forces_due` is set: in the
//! first step, after edits, and after the collision phase.

use std::ops::Range;

use glam::Vec4;
use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::{Tally, count_builds};
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, LAW_THESIS};
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::status::{ESCAPED_IN_LOADS, REJECTED_HISTORY};
use crate::model::step::Aabb;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::attached::add_attached;
use crate::physics::forces::contacts::{Contacts, Load};
use crate::physics::laws::history::{BLOCK_WORDS, Chains, Histories, Owned, Record};
use crate::physics::passage::is_fast;
use crate::physics::travel::{escape_ratio, needs_rebuild};
use crate::step::moves::{FORCES, Moves};
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;
use crate::user_laws::ForceLoad;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "loads",
    wgsl: Wgsl::File(part!("step/forces/loads.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::State, access: Access::Read },
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("histories", Buffer::Histories),
        write("wrenches", Buffer::Wrenches),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    // Reads 3 rows, writes the load.
    moves: |_| Moves { rows: 5, sphere_aabbs: 1, ..FORCES },
    cpu: loads,
};

fn loads(world: &mut World, pass: u32) {
    // How many blocks of springs are needed is counted to the end.
    if world.status.rejected & !REJECTED_HISTORY != 0 {
        return;
    }
    if pass == 0 {
        count_builds(&mut world.status);
        world.status.lengths_due = 0;
    }
    if world.needs_forces(pass) {
        evaluate(world, pass, 0..world.step.layout.spheres, |contacts, rod_loads, sphere, rows, owned, tally| {
            let is_fixed = contacts.view.is_fixed(sphere);
            if is_fixed && contacts.view.step.layout.law == LAW_THESIS {
                tally.into_iter().for_each(|tally| contacts.count(sphere, tally));
                return;
            }
            let mut load = contacts.sphere_load(sphere, owned, tally);
            if !is_fixed {
                add_attached(contacts.view, rod_loads, sphere, &mut load);
                add_laws_of_member(contacts.view, sphere, &mut load);
                rows.copy_from_slice(&[load.force, load.torque].map(|vector| vector.extend(0.0)));
            }
        });
    }
    check_places(world, pass);
}

/// Adds the load of the laws of the program on a sphere of a rigid body. Integrators add that on other spheres.
fn add_laws_of_member(view: &View, sphere: u32, load: &mut Load) {
    let laws = view.force_laws().filter(|_| view.body_of_sphere(sphere).is_some());
    if let Some(ForceLoad { force, torque }) = laws.map(|laws| laws.load(&view.force_input(sphere))) {
        load.force += force;
        load.torque += torque;
    }
}

/// Evaluates the loads of all spheres or of all rods, by their ids. `load` gets the contacts, the loads of the rods, the mover, the rows
/// of its load, its springs, and the counts of the pass that counts contacts.
pub(super) fn evaluate(
    world: &mut World,
    pass: u32,
    movers: Range<u32>,
    load: impl Fn(&Contacts, &[Vec4], u32, &mut [Vec4], &mut Owned, Option<&mut Tally>) + Sync,
) {
    let table = world.history_words();
    let World { step, topology, states, user_laws, lists, histories, wrenches, status, .. } = world;
    let counts = pass == step.counted_pass();
    let (first, second) = histories.split_at_mut(table);
    let (before, after) = if status.history_table == 0 { (first, second) } else { (second, first) };
    let view = View::new(step, topology, &states[pass as usize]).at_evaluation(status, pass).with_laws(user_laws);
    let lists = Lists::new(step, lists);
    let contacts = Contacts { view: &view, lists: &lists, histories: Histories::new(before) };
    let mut blocks = blocks_of(&view, movers.clone(), if counts { &mut *after } else { &mut [] });
    let (rods, spheres) = wrenches.split_at_mut(4 * step.layout.rods as usize);
    let (rod_loads, rows, width) = if movers.start == 0 { (&*rods, spheres, 2) } else { (&[][..], rods, 4) };
    let (tally, long) = rows
        .par_chunks_mut(width)
        .zip(&mut blocks)
        .zip(movers)
        .with_min_len(GRAIN)
        .fold(Evaluated::default, |(mut tally, mut long), ((rows, block), mover)| {
            let mut owned = Owned::new(std::mem::take(block));
            load(&contacts, rod_loads, mover, rows, &mut owned, counts.then_some(&mut tally));
            let records = owned.into_long();
            if !records.is_empty() {
                long.push((view.insertion_index(mover), records));
            }
            (tally, long)
        })
        .reduce(Evaluated::default, |(tally, mut long), (other, mut others)| {
            long.append(&mut others);
            (tally.merge(other), long)
        });
    let mut chains = Chains::new(after, step.movers(), status.history_blocks);
    long.iter().for_each(|(mover, records)| chains.put(*mover, records));
    status.history_blocks = chains.blocks();
    if status.history_blocks > step.layout.history_pool {
        status.rejected |= REJECTED_HISTORY;
    }
    tally.add_to(status);
}

/// Counts, and the springs of movers that need several blocks, by insertion index.
type Evaluated = (Tally, Vec<(u32, Vec<Record>)>);

/// The blocks of movers in a table of springs, in the order of memory. They are empty for the law of the thesis, which has no table.
fn blocks_of<'a>(view: &View, movers: Range<u32>, table: &'a mut [u32]) -> Vec<&'a mut [u32]> {
    let mut by_index: Vec<&mut [u32]> = table.chunks_mut(BLOCK_WORDS).skip(movers.start as usize).take(movers.len()).collect();
    let mut take = |mover: u32| by_index.get_mut((view.insertion_index(mover) - movers.start) as usize).map(std::mem::take);
    movers.clone().map(|mover| take(mover).unwrap_or_default()).collect()
}

fn check_places(world: &mut World, pass: u32) {
    let view = View::new(&world.step, &world.topology, &world.states[pass as usize]);
    let spheres = (0..world.step.layout.spheres).into_par_iter().with_min_len(GRAIN);
    let of = |mut tally: Tally, sphere: u32| {
        note_place(&view, &world.aabbs, pass, sphere, &mut tally);
        tally
    };
    spheres.fold(Tally::default, of).reduce(Tally::default, Tally::merge).add_to(&mut world.status);
}

/// Notes whether a sphere is outside its AABB, and in the last pass of several whether it may soon leave it.
pub(crate) fn note_place(view: &View, aabbs: &[Aabb], pass: u32, sphere: u32, tally: &mut Tally) {
    tally.note_escape(ESCAPED_IN_LOADS + pass, escape_ratio(view, aabbs, sphere));
    tally.rebuild |= pass == 3 && needs_rebuild(view, aabbs, sphere, view.position(sphere), view.velocity(sphere));
    let has_walls = view.step.layout.polygons > 0;
    tally.fast |= has_walls && is_fast(view, sphere) && view.step.traits().counts_passages();
}
