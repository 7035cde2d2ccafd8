//! Walls that follow motions under the law `rigid`: each motion is a kinematic body (docs/physics section 11.1).

use glam::{DQuat, DVec3};

use super::Frames;
use crate::rigid::periods::Periods;
use crate::rigid::pose::Pose;
use crate::rigid::world::Body;
use crate::scene::{Motion, MotionId, Polygon, Scene, Surface};

/// From this turn in a frame on, in rad, the shorter way around may be the wrong one.
const LONG_TURN: f64 = 3.0;

/// Where a motion puts the body of its walls, whose origin is at `origin` before any motion.
fn pose(motion: &Motion, origin: DVec3, time: f64) -> (DVec3, DQuat) {
    let pose = motion.pose(time);
    (pose.of_point(origin)[0], pose.orientation())
}

/// The angular velocity that turns one orientation into another in `dt` seconds.
fn spin_between(from: DQuat, to: DQuat, dt: f64) -> DVec3 {
    let turn = to * from.inverse();
    let (axis, cos) = if turn.w < 0.0 { (-turn.xyz(), -turn.w) } else { (turn.xyz(), turn.w) };
    let sin = axis.length();
    if sin == 0.0 { DVec3::ZERO } else { 2.0 * libm::atan2(sin, cos) / (sin * dt) * axis }
}

/// Puts a kinematic body where its motion is, with the velocities that take it to where the motion will be after `dt` seconds. `base` is
/// where the coordinates of the world begin. In a periodic scene the displacement is that of the nearest image.
fn drive(body: &mut Body, motion: &Motion, [base, origin]: [DVec3; 2], periods: &Periods, time: f64, dt: f64) {
    let ((from, turn), (to, next)) = (pose(motion, origin, time), pose(motion, origin, time + dt));
    let middle = motion.pose(time + 0.5 * dt).spin();
    let spin = if middle.length() * dt < LONG_TURN { spin_between(turn, next, dt) } else { middle };
    let image = periods.nearest_finely(from - origin);
    body.pose = Pose::new((from + image - base).as_vec3(), turn.as_quat());
    (body.velocity, body.spin) = (((to - from) / dt).as_vec3(), spin.as_vec3());
}

impl Frames {
    /// Puts the walls that follow motions where they are at a time in s, with the velocities of a frame of `dt` seconds from there.
    pub(super) fn place_motions(&mut self, scene: &Scene, time: f64, dt: f32) {
        let (bodies, periods) = (&mut self.world.bodies[1..], &self.world.periods);
        for ((body, motion), origin) in bodies.iter_mut().zip(scene.motions()).zip(&self.origins) {
            drive(body, motion, [self.base, *origin], periods, time, dt.into());
        }
    }

    /// The same, also on the device.
    pub(super) fn drive(&mut self, scene: &Scene, time: f64, dt: f32) {
        self.place_motions(scene, time, dt);
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(device) = self.device.as_ref().filter(|_| !self.origins.is_empty()) {
            device.drive(&self.world.bodies[1..=self.origins.len()]);
        }
    }
}

/// The middle of walls at rest: the origin of the body that they make.
pub(super) fn middle(places: impl Iterator<Item = DVec3>) -> DVec3 {
    let [mut low, mut high] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for place in places {
        (low, high) = (low.min(place), high.max(place));
    }
    if low.is_finite() { 0.5 * (low + high) } else { DVec3::ZERO }
}

/// The place of a polygon among the walls of its motion.
pub(super) fn middle_of(polygon: &Polygon) -> DVec3 {
    polygon.corner.as_dvec3() + polygon.cone_axis().map_or(DVec3::ZERO, |axis| 0.5 * axis.along)
}

/// Whether some plane would turn: no margin holds for its far parts.
pub(super) fn turns_planes(scene: &Scene) -> bool {
    let turns = |motion: &Motion| motion.terms.iter().any(|term| term.spin != 0.0);
    let of = |motion: Option<MotionId>| scene.body_number(motion).ok().and_then(|number| number.checked_sub(1));
    let is_turned = |motion| of(motion).is_some_and(|number| turns(&scene.motions()[number as usize]));
    let is_plane = |polygon: &Polygon| polygon.surface == Surface::Plane;
    scene.polygons().iter().any(|polygon| is_plane(polygon) && is_turned(polygon.motion))
}
