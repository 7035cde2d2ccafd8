//! Writes the poses of moving walls (docs/physics.md section 2.12).

use crate::model::layout::POSE_FLOATS;
use crate::model::muscles::MuscleClock;
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
        for row in 0..pose_rows(steps) {
            let time = clock.written_time_after(row.into());
            self.poses.extend(scene.motions().iter().flat_map(|motion| pose(motion, time)));
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
