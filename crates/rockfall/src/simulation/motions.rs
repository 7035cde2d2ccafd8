//! Where motions have brought their walls (docs/physics section 2.12).

use glam::{DQuat, DVec3};

use crate::scene::Motion;
use crate::simulation::Simulation;

/// Where a motion has brought the walls that follow it, and how they move. A point of a wall that is written at `x`, with `x0` the
/// point that the motion turns about, or else the origin, is at `position + orientation * (x - x0)`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionState {
    /// Where the point `x0` is, in units.
    pub position: DVec3,
    /// Its velocity, in units/s.
    pub velocity: DVec3,
    /// The turn from where the walls are written, a unit quaternion.
    pub orientation: DQuat,
    /// Angular velocity, in rad/s.
    pub angular_velocity: DVec3,
}

impl Simulation {
    /// The states of all motions at the present time, in order of addition. Servos are where they were when the state was read back last
    /// ([`Simulation::sync`]).
    pub fn motion_states(&self) -> Vec<MotionState> {
        let time = self.muscle_clock.written_time();
        let state = |motion: &Motion| {
            let pose = motion.pose(time);
            let [position, velocity, _] = pose.of_point(motion.reference());
            MotionState { position, velocity, orientation: pose.orientation(), angular_velocity: pose.spin() }
        };
        self.scene.motions().iter().map(state).collect()
    }
}
