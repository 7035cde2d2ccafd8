//! Integrates rigid bodies and places their spheres (docs/physics sections 1.5, 4.16 and 5.9).
//!
//! The thread of its first sphere sums the loads of its member spheres, moves the body as the integrator moves a sphere, and writes the member spheres to
//! the state that the integrator has just written. The integrator leaves them out. The passes are
//! [`AFTER_DRIFT`] and [`AFTER_KICK`] with velocity Verlet, and [`AFTER_EULER`]: no contact law that has rigid bodies allows
//! RK4. Every pass also writes the record of the body in the
//! topology, with the centre and the inertia in that state, which contacts read. Pass [`BEFORE_STEP`] moves no body: a rejected
//! step may have left another record, and in a world that was just packed the spheres have not been placed by the device.
//!
//! A body whose new state is not finite keeps its place and stops, and its first sphere is reported.

use glam::{Quat, Vec3, Vec4};
use rayon::prelude::*;

use crate::error::BadStage;
use crate::fine::Fine;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{
    AFTER_DRIFT, AFTER_EULER, AFTER_KICK, BEFORE_STEP, DRIFTED_ROW, GRAIN, RATE_WORDS, RESIDUE_ROW, RIGID_ROWS, STAGE_ROW,
};
use crate::model::part::part;
use crate::model::residue::{Increased, increased};
use crate::model::rigid::{Moments, Pose};
use crate::model::step::{Constants, Step};
use crate::model::view::{RigidRecord, View};
use crate::model::world::World;
use crate::physics::forces::contacts::Load;
use crate::physics::forces::rates::Rates;
use crate::physics::travel::needs_rebuild;
use crate::rotate::rotated;
use crate::step::moves::NONE;
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "move_bodies",
    wgsl: Wgsl::File(part!("step/bodies/move_bodies.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::Placed, access: Access::Write },
        write("bodies", Buffer::RigidBodies),
        write("topology", Buffer::Topology),
        read("wrenches", Buffer::Wrenches),
        write("kept_rates", Buffer::Rates),
        write("orientations", Buffer::Orientations),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    moves: |_| NONE,
    cpu: move_bodies,
};

/// What a pass makes of a body.
struct Moved {
    /// The vectors of the body.
    rows: [Vec4; RIGID_ROWS as usize],
    /// Where its spheres are placed.
    pose: Pose,
    /// The rates that velocity Verlet keeps.
    kept: Option<Rates>,
    is_bad: bool,
}

fn row(rows: &[Vec4], place: usize) -> Vec3 {
    rows[place].truncate()
}

/// Writes the stage state that forces are evaluated in.
fn set_stage(rows: &mut [Vec4], pose: &Pose) {
    let Pose { position: Fine { high, low }, velocity, momentum, orientation } = *pose;
    let vectors = [velocity.extend(0.0), momentum.extend(0.0), orientation.into(), high.extend(0.0), low.extend(0.0)];
    rows[STAGE_ROW as usize..][..vectors.len()].copy_from_slice(&vectors);
}

/// A body during a pass.
struct Passing<'a> {
    view: &'a View<'a>,
    wrenches: &'a [Vec4],
    body: &'a RigidRecord,
    moments: Moments,
    pass: u32,
}

impl Passing<'_> {
    /// The rates of change in a state with this orientation, from the loads of the members (docs/physics section 4.16).
    fn rates(&self, pose: &Pose) -> Rates {
        let Step { constants, layout, .. } = self.view.step;
        let mut sum = Load::default();
        for (index, place) in self.view.members(*self.body) {
            let at = (4 * layout.rods + 2 * self.view.slot_of(index)) as usize;
            let [force, torque] = [at, at + 1].map(|at| self.wrenches[at].truncate());
            sum.force += force;
            sum.torque += torque + rotated(pose.orientation, place).cross(force);
        }
        let Constants { gravity, linear_damping, angular_damping, .. } = *constants;
        let acceleration = self.body.inverse_mass * sum.force + Vec3::from_array(gravity) - linear_damping * pose.velocity;
        Rates { acceleration, torque: sum.torque - angular_damping * pose.momentum }
    }

    /// The pose with a velocity and an angular momentum after these increments. Row `from` has the residues before, `to` gets those after.
    fn increased(&self, rows: &mut [Vec4], [from, to]: [u32; 2], pose: Pose, by: [Vec3; 2]) -> Pose {
        let before = self.view.step.has_residues().then_some(rows[from as usize]);
        let Increased { velocity, angular_momentum, residues } = increased([pose.velocity, pose.momentum], before, by);
        if before.is_some() {
            rows[to as usize] = residues;
        }
        Pose { velocity, momentum: angular_momentum, ..pose }
    }

    /// The state after a kick for a time and a drift for the whole step. Row `residues` gets the residues after it.
    fn kicked_and_moved(&self, rows: &mut [Vec4], rates: &Rates, kick: f32, residues: u32) -> Pose {
        let dt = self.view.step.constants.dt;
        let by = [kick * rates.acceleration, kick * rates.torque];
        let kicked = self.increased(rows, [RESIDUE_ROW, residues], Pose::of(rows), by);
        let orientation = self.moments.turned(kicked.orientation, kicked.momentum, dt);
        Pose { orientation, ..kicked.moved(dt * kicked.velocity) }
    }

    /// Velocity Verlet: the state after the drift, from the kept rates or those at the start of the step.
    fn drift(&self, rows: &mut [Vec4], kept: Option<Rates>) -> Pose {
        let start = Pose::of(rows);
        let rates = kept.unwrap_or_else(|| self.rates(&start));
        let next = self.kicked_and_moved(rows, &rates, 0.5 * self.view.step.constants.dt, DRIFTED_ROW);
        set_stage(rows, &next);
        next
    }

    /// Velocity Verlet: the state after the second half of the kick, and the rates that it keeps.
    fn kick(&self, rows: &mut [Vec4]) -> (Pose, Rates) {
        let half = 0.5 * self.view.step.constants.dt;
        let rows_of_stage = &rows[STAGE_ROW as usize..];
        let stage = Pose {
            position: Fine { high: row(rows_of_stage, 3), low: row(rows_of_stage, 4) },
            velocity: row(rows_of_stage, 0),
            momentum: row(rows_of_stage, 1),
            orientation: Quat::from_vec4(rows_of_stage[2]),
        };
        let rates = self.rates(&stage);
        let by = [half * rates.acceleration, half * rates.torque];
        (self.increased(rows, [DRIFTED_ROW, RESIDUE_ROW], stage, by), rates)
    }

    /// Moves the body. `kept` are the rates from the last step of velocity Verlet, where they hold.
    fn moved(&self, rows: &[Vec4], kept: Option<Rates>) -> Moved {
        let mut rows: [Vec4; RIGID_ROWS as usize] = std::array::from_fn(|place| rows[place]);
        let start = Pose::of(&rows);
        let mut keeps = None;
        let mut pose = match self.pass {
            BEFORE_STEP => start,
            AFTER_EULER => self.kicked_and_moved(&mut rows, &self.rates(&start), self.view.step.constants.dt, RESIDUE_ROW),
            AFTER_DRIFT => self.drift(&mut rows, kept),
            _ => {
                let (pose, rates) = self.kick(&mut rows);
                keeps = Some(rates);
                pose
            }
        };
        let is_bad = !pose.is_finite();
        if is_bad {
            pose = Pose { velocity: Vec3::ZERO, momentum: Vec3::ZERO, ..start };
            if !ends_step(self.pass) {
                set_stage(&mut rows, &pose);
            }
            keeps = keeps.map(|_| Rates { acceleration: Vec3::ZERO, torque: Vec3::ZERO });
        }
        if ends_step(self.pass) {
            rows[..Pose::ROWS].copy_from_slice(&pose.rows());
        }
        Moved { rows, pose, kept: keeps, is_bad }
    }
}

/// Whether a pass writes the state after the step.
fn ends_step(pass: u32) -> bool {
    matches!(pass, AFTER_KICK | AFTER_EULER)
}

fn stage_of(pass: u32) -> BadStage {
    if pass == AFTER_KICK { BadStage::Forces2 } else { BadStage::Forces1 }
}

fn move_bodies(world: &mut World, pass: u32) {
    if world.step.layout.rigid_bodies == 0 || (pass != BEFORE_STEP && world.status.rejected != 0) {
        return;
    }
    let moved = move_all(world, pass);
    for (body, moved) in moved.iter().enumerate() {
        world.rigid_bodies[body * RIGID_ROWS as usize..][..RIGID_ROWS as usize].copy_from_slice(&moved.rows);
        if let Some(Rates { acceleration, torque }) = moved.kept {
            let at = (world.step.layout.spheres as usize + body) * RATE_WORDS as usize;
            acceleration.write_to_slice(&mut world.rates[at..]);
            torque.write_to_slice(&mut world.rates[at + 3..]);
        }
    }
    place_members(world, pass, &moved);
    for (body, Moved { pose, .. }) in (0..).zip(&moved) {
        world.put_record(body, pose);
    }
}

fn move_all(world: &mut World, pass: u32) -> Vec<Moved> {
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let keeps_rates = world.status.forces_due == 0 && pass == AFTER_DRIFT;
    let bodies = (0..world.step.layout.rigid_bodies).into_par_iter().with_min_len(GRAIN / 4);
    let moved: Vec<Moved> = bodies
        .map(|number| {
            let body = view.rigid_body(number);
            let kept = keeps_rates.then(|| {
                let at = ((world.step.layout.spheres + number) * RATE_WORDS) as usize;
                let [acceleration, torque] = [at, at + 3].map(|at| Vec3::from_slice(&world.rates[at..]));
                Rates { acceleration, torque }
            });
            let passing = Passing { view: &view, wrenches: &world.wrenches, moments: view.moments(&body), body: &body, pass };
            passing.moved(&world.rigid_bodies[(number * RIGID_ROWS) as usize..], kept)
        })
        .collect();
    let mut tally = Tally::default();
    for (number, moved) in (0..).zip(&moved) {
        let first = view.members(view.rigid_body(number)).next();
        if let Some((index, _)) = first.filter(|_| moved.is_bad) {
            tally.count_bad(stage_of(pass), index);
        }
    }
    tally.add_to(&mut world.status);
    moved
}

/// Writes the member spheres to the state that the pass places them in, and their orientations at the end of the step.
fn place_members(world: &mut World, pass: u32, moved: &[Moved]) {
    let to = if pass == AFTER_DRIFT { 3 } else { 0 };
    let is_new = to == 0;
    let mut state = std::mem::take(&mut world.states[to]);
    let view = View::new(&world.step, &world.topology, if is_new { &state } else { &world.states[0] });
    let placed: Vec<(u32, [Vec4; 4], Quat)> = (0..world.step.layout.rigid_bodies)
        .into_par_iter()
        .with_min_len(GRAIN / 4)
        .flat_map_iter(|body| {
            let pose = moved[body as usize].pose;
            view.placed(body, pose).map(move |(slot, rows)| (slot, rows, pose.orientation))
        })
        .collect();
    let mut tally = Tally::default();
    if pass == AFTER_EULER {
        for (sphere, rows, _) in &placed {
            tally.rebuild |= needs_rebuild(&view, &world.aabbs, *sphere, row(rows, 0), row(rows, 1));
        }
    }
    // A stage state has low parts of positions only where geometry uses them.
    let n = world.step.layout.spheres as usize;
    let regions = state.len() / n;
    for (sphere, rows, orientation) in &placed {
        let slot = *sphere as usize;
        for (region, row) in rows.iter().enumerate().take(regions) {
            state[region * n + slot] = *row;
        }
        if is_new {
            world.orientations[slot] = (*orientation).into();
        }
    }
    world.states[to] = state;
    tally.add_to(&mut world.status);
}
