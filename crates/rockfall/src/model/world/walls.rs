//! Writes the poses of moving walls (docs/physics section 2.12).

use glam::Vec2;

use crate::model::layout::{FLAG_SERVOS, POSE_FLOATS, SERVO_ROWS};
use crate::model::muscles::MuscleClock;
use crate::model::servo::ServoRecord;
use crate::model::world::World;
use crate::scene::{Motion, Scene};

/// Number of rows of a table of poses: one for every half step.
pub(crate) const fn pose_rows(steps: u32) -> u32 {
    2 * steps + 1
}

impl World {
    /// Writes the poses for `steps` steps. The first of them begins at the time of the clock, when the counter of steps in the status is
    /// `first`. Does nothing in scenes without moving walls.
    pub(crate) fn set_poses(&mut self, scene: &Scene, clock: &MuscleClock, first: u32, steps: u32) {
        if self.step.layout.bodies == 0 {
            return;
        }
        self.set_pose_rows(first, pose_rows(steps));
        self.poses.clear();
        let servos = ServoRecord::all(scene);
        for row in 0..pose_rows(steps) {
            let time = clock.written_time_after(row.into());
            let mut servos = servos.iter();
            let poses = scene.motions().iter().map(|motion| match motion.servo.and_then(|_| servos.next()) {
                Some(servo) => servo.pose(),
                None => pose(motion, time),
            });
            self.poses.extend(poses.flatten());
        }
    }

    /// Packs the servos, if walls follow motions. Returns the flag of scenes with servos.
    pub(super) fn set_servos(&mut self, scene: &Scene) -> u32 {
        let servos = if self.step.layout.bodies > 0 { ServoRecord::all(scene) } else { Vec::new() };
        self.servos = servos.iter().flat_map(ServoRecord::rows).collect();
        if !self.servo_loads.is_empty() || !self.wrenches.is_empty() {
            self.servo_loads.resize(self.servo_load_count(), Vec2::ZERO);
        }
        if self.servos.is_empty() { 0 } else { FLAG_SERVOS }
    }

    /// Writes the state of the servos back to the scene.
    pub(crate) fn read_servos(&self, scene: &mut Scene) {
        for rows in self.servos.chunks_exact(SERVO_ROWS as usize) {
            let record = ServoRecord::of(rows);
            let motion = scene.motions.objects_mut().get_mut(record.body as usize - 1);
            if let Some(servo) = motion.and_then(|motion| motion.servo.as_mut()) {
                (servo.displacement, servo.velocity) = (record.place(), record.rate.into());
            }
        }
    }
}

/// The record of a body at a time.
fn pose(motion: &Motion, time: f64) -> [f32; POSE_FLOATS as usize] {
    let (pose, point) = (motion.pose(time), motion.reference());
    let [place, velocity, acceleration] = pose.of_point(point);
    let turn = pose.turn_less_one();
    let rows = [0, 1, 2].map(|row| turn.row(row));
    let mut record = [0.0; POSE_FLOATS as usize];
    let vectors = rows.into_iter().chain([point, place - point, velocity, acceleration, pose.spin()]);
    for (place, vector) in record.chunks_exact_mut(4).zip(vectors) {
        place[..3].copy_from_slice(&vector.as_vec3().to_array());
    }
    record
}
