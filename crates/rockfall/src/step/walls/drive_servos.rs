//! Moves the servos (docs/physics section 2.18).
//!
//! Pass 0, at the start of a step, writes the poses of the step to the table `poses`, from which `move_walls` puts walls where they are.
//! Pass [`SERVO_END`], at the end of an accepted step, adds up the loads of each servo, moves it on, and finds its rate for the next step.

use glam::Vec2;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{POSE_FLOATS, SERVO_END, SERVO_ROWS, SERVO_SUMS};
use crate::model::part::part;
use crate::model::servo::ServoRecord;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "drive_servos",
    wgsl: Wgsl::File(part!("step/walls/drive_servos.wgsl")),
    bindings: &[
        read("contributions", Buffer::ServoLoads),
        write("servos", Buffer::Servos),
        write("poses", Buffer::Poses),
        read("status", Buffer::Status),
    ],
    threads: Threads::Motions,
    moves: |_| NONE,
    cpu: drive_servos,
};

/// Part of the error of the force that a servo corrects within a step.
const GAIN: f32 = 0.25;

fn drive_servos(world: &mut World, pass: u32) {
    let is_end = pass == SERVO_END;
    if is_end && world.status.rejected != 0 {
        return;
    }
    for number in 0..world.servos.len() / SERVO_ROWS as usize {
        let at = number * SERVO_ROWS as usize;
        let servo = ServoRecord::of(&world.servos[at..]);
        if is_end {
            let load = sum_of(world, number);
            let rate = rate_for(&servo, load, world.step.constants.dt);
            let moved = ServoRecord { rate, ..servo.moved(world.step.constants.dt) };
            world.servos[at..at + SERVO_ROWS as usize].copy_from_slice(&moved.rows());
        } else {
            put_poses(world, &servo);
        }
    }
}

/// Writes the poses at the start, in the middle and at the end of the step.
fn put_poses(world: &mut World, servo: &ServoRecord) {
    let constants = &world.step.constants;
    let (first, dt) = (2 * world.status.steps.wrapping_sub(constants.pose_step), constants.dt);
    let last = constants.pose_rows.saturating_sub(1);
    for (row, time) in (first..).zip([0.0, 0.5 * dt, dt]) {
        if row <= last {
            let at = ((row * world.step.layout.bodies + servo.body - 1) * POSE_FLOATS) as usize;
            world.poses[at..at + POSE_FLOATS as usize].copy_from_slice(&servo.moved(time).pose());
        }
    }
}

/// The sums of the forces and of the stiffnesses of a servo, over the movers in insertion order.
fn sum_of(world: &World, servo: usize) -> Vec2 {
    let movers = world.movers() as usize;
    let loads = &world.servo_loads[servo * movers..][..movers];
    let mut sums = [Vec2::ZERO; SERVO_SUMS as usize];
    for chunk in loads.chunks(sums.len()) {
        sums.iter_mut().zip(chunk).for_each(|(sum, load)| *sum += *load);
    }
    let mut half = sums.len() / 2;
    while half > 0 {
        for place in 0..half {
            sums[place] += sums[place + half];
        }
        half /= 2;
    }
    sums[0]
}

/// The rate of the next step.
fn rate_for(servo: &ServoRecord, Vec2 { x: force, y: stiffness }: Vec2, dt: f32) -> f32 {
    let error = servo.target - force;
    let rate = if stiffness > 0.0 {
        GAIN * error / (stiffness * dt)
    } else if error == 0.0 {
        0.0
    } else {
        servo.most.copysign(error)
    };
    let rate = rate.clamp(-servo.most, servo.most);
    if rate.is_finite() { rate } else { 0.0 }
}
