//! Passes over all blocks, colour by colour, and the warm start (docs/physics sections 11.6 to 11.8).

use glam::Vec3A;
use rayon::prelude::*;

use crate::rigid::frame::bodies::{Bodies, Motion};
use crate::rigid::frame::contacts::{Block, COLOURS, Contacts, Load, View, for_each, is_crowd};
use crate::rigid::frame::rows::{Pass, Sides, solve};

/// Solves the blocks colour by colour, and then the left-over ones.
pub(super) fn pass(contacts: &mut Contacts, bodies: &mut Bodies, pass: &Pass) {
    for colour in 0..=COLOURS {
        let range = contacts.colour(colour);
        if range.is_empty() {
            continue;
        }
        if colour < COLOURS && !is_crowd(range.len()) {
            let mut part = contacts.part(range.clone());
            for k in 0..range.len() {
                let mut view = part.view(k);
                let ends = solved(&mut view, bodies, pass);
                for (i, end) in view.block.sides().into_iter().zip(ends) {
                    put(bodies, i, end);
                }
            }
            continue;
        }
        let mut ends = vec![[Motion::default(); 2]; range.len()];
        let read: &Bodies = bodies;
        for_each(contacts.part(range.clone()), &mut ends, &|mut view| solved(&mut view, read, pass));
        let blocks = &contacts.blocks[range];
        if colour < COLOURS {
            for (block, [a, b]) in blocks.iter().zip(ends) {
                put(bodies, block.sides()[0], a);
                put(bodies, block.sides()[1], b);
            }
        } else {
            mean(bodies, blocks, &ends);
        }
    }
}

/// The motions of the bodies of a block after its rows.
fn solved(view: &mut View<'_>, bodies: &Bodies, pass: &Pass) -> [Motion; 2] {
    let [a, b] = view.block.sides();
    let [share_a, share_b] = view.block.shares;
    let (mut mass_a, mut mass_b) = (&bodies.masses[a], &bodies.masses[b]);
    let split;
    if [share_a, share_b] != [1.0; 2] {
        split = [mass_a.split(share_a), mass_b.split(share_b)];
        [mass_a, mass_b] = [&split[0], &split[1]];
    }
    let mut sides = Sides { a: bodies.motions[a], b: bodies.motions[b], mass_a, mass_b };
    solve(view, &mut sides, pass);
    [sides.a, sides.b]
}

fn put(bodies: &mut Bodies, i: usize, motion: Motion) {
    // Blocks of one colour may share the world.
    if bodies.masses[i].inverse_mass > 0.0 {
        bodies.motions[i] = motion;
    }
}

/// A body of several left-over blocks takes the mean of its copies.
fn mean(bodies: &mut Bodies, blocks: &[Block], ends: &[[Motion; 2]]) {
    let starts: Vec<[Motion; 2]> = blocks.iter().map(|block| block.sides().map(|i| bodies.motions[i])).collect();
    for ((block, start), end) in blocks.iter().zip(starts).zip(ends) {
        for (side, i) in block.sides().into_iter().enumerate() {
            let change = end[side].minus(&start[side]);
            let motion = bodies.motions[i].plus(&change, 1.0 / block.shares[side]);
            put(bodies, i, motion);
        }
    }
}

/// Applies the impulses of the last substep: each body adds those of its blocks in the order of its list.
pub(super) fn warm_start(contacts: &mut Contacts, bodies: &mut Bodies) {
    let count = contacts.blocks.len();
    let mut loads = std::mem::take(&mut contacts.loads);
    loads.resize(count, Load::default());
    for_each(contacts.part(0..count), &mut loads, &|view| load(&view));
    let (read, masses, constants) = (&*contacts, &bodies.masses, &bodies.constants);
    let apply = |(i, motion): (usize, &mut Motion)| {
        if !constants[i].dynamic || read.of_body(i).is_empty() {
            return;
        }
        let (mut impulse, mut moment) = (Vec3A::ZERO, Vec3A::ZERO);
        for (block, second) in read.of_body(i) {
            let load = &loads[*block as usize];
            impulse += if *second { load.impulse } else { -load.impulse };
            moment += load.moments[usize::from(*second)];
        }
        motion.velocity += masses[i].inverse_mass * impulse;
        motion.spin += masses[i].inverse_inertia * moment;
    };
    if !is_crowd(count) {
        bodies.motions.iter_mut().enumerate().for_each(apply);
    } else {
        bodies.motions.par_iter_mut().with_min_len(256).enumerate().for_each(apply);
    }
    contacts.loads = loads;
}

fn load(view: &View<'_>) -> Load {
    let mut load = Load::default();
    for pair in view.pairs.iter() {
        let first = (pair.first - view.block.first_point) as usize;
        for k in first..first + usize::from(pair.count) {
            let (row, impulse) = (&view.rows[k], &view.impulses[k]);
            if impulse.normal == 0.0 {
                continue;
            }
            let along = impulse.tangent.x * pair.tangents[0] + impulse.tangent.y * pair.tangents[1];
            let push = impulse.normal * pair.normal + along;
            load.impulse += push;
            load.moments[0] -= row.arm_a.cross(push);
            load.moments[1] += row.arm_b.cross(push);
        }
    }
    load
}
