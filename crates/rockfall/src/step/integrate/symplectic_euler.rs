//! Symplectic Euler: v += dt a(x, v), L += dt T, x += dt v (docs/physics section 5.2), and without rods and rigid bodies the new orientations, by
//! the new spin (exponential map, docs/physics section 5.3).
//!
//! In scenes with rods or rigid bodies the stage leaves the old position in region 0 of `Y3` and the new spin in region 2. It requests new lists
//! (`rebuild`) if a sphere may leave its AABB within the next step, and reports spheres whose state is not finite.

use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, SLICE};
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::physics::travel::needs_rebuild;
use crate::step::integrate::turn::turn_for;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "symplectic_euler",
    wgsl: Wgsl::File(part!("step/integrate/symplectic_euler.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        write("y3", Buffer::Y3),
        read("topology", Buffer::Topology),
        read("wrenches", Buffer::Wrenches),
        read("aabbs", Buffer::Aabbs),
        write("orientations", Buffer::Orientations),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Reads 3 rows and the load; writes 3 rows; reads and writes the orientation.
    moves: |_| Moves { rows: 10, sphere_aabbs: 1, residues: 2, ..NONE },
    cpu: symplectic_euler,
};

fn symplectic_euler(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let [start, _, y3, _] = &mut world.states;
    let view = View::new(&world.step, &world.topology, start).at_evaluation(&world.status, 0).with_laws(&world.user_laws);
    let (dt, turns_late) = (world.step.constants.dt, world.step.traits().turns_late());
    let next = |sphere: u32, y: Motion, tally: &mut Tally| {
        if !view.is_integrated(sphere) {
            return y;
        }
        let Rates { acceleration, torque } = sphere_rates(&view, &world.wrenches, sphere);
        let kicked = y.increased(view.step, [dt * acceleration, dt * torque]);
        let (position, low) = kicked.moved(dt * kicked.velocity);
        let next = Motion { position, low, ..kicked };
        let next = next.or_stopped(&y, BadStage::Forces1, view.insertion_index(sphere), tally);
        tally.rebuild |= needs_rebuild(&view, &world.aabbs, sphere, next.position, next.velocity);
        next
    };
    let spheres = (0..world.step.layout.spheres).into_par_iter().with_min_len(GRAIN);
    let mut all: Vec<Motion> = spheres.map(|sphere| Motion::of(&view, sphere)).collect();
    let tally = all
        .par_chunks_mut(SLICE as usize)
        .zip(Rows::of(y3, world.step.layout.spheres))
        .map(|(all, mut memory)| {
            let mut tally = Tally::default();
            for (sphere, motion) in memory.spheres().zip(all) {
                *motion = next(sphere, *motion, &mut tally);
                if turns_late {
                    memory.remember(sphere, view.position(sphere), motion.angular_momentum * view.inverse_inertia(sphere));
                }
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
    Rows::of(start, world.step.layout.spheres).for_each(|mut rows| {
        rows.spheres().for_each(|sphere| rows.replace(sphere, all[sphere as usize]));
    });
    if !turns_late {
        let view = View::new(&world.step, &world.topology, start);
        let turning = world.orientations.par_iter_mut().enumerate().with_min_len(GRAIN);
        turning.for_each(|(sphere, orientation)| turn_for(orientation, view.spin(sphere as u32), dt));
    }
}
