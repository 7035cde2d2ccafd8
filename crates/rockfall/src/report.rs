//! The report of a simulation, its energies, and the state of its spheres.

use glam::{DVec3, Mat3, Quat, Vec3};

use crate::fine::Fine;
use crate::scene::{Scene, Sphere};

/// Counts and times of all steps so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// Number of steps done.
    pub steps: u64,
    /// Time simulated, in s: the sum of the time steps as decimal numbers, see [`decimal_time`].
    pub time: f64,
    /// Number of contacts (overlapping pairs) at the first force evaluation of the last step.
    pub contacts: u32,
    /// Deepest overlap at the first force evaluation of the last step, in units.
    pub max_overlap: f32,
    /// Number of collisions handled in the last step.
    pub collisions: u32,
    /// Number of collisions handled in all steps.
    pub total_collisions: u64,
    /// Number of times that a step was repeated, because a body left its AABB, or there was no room for lists, collisions or springs
    /// of contacts.
    pub replays: u64,
    /// Number of times that AABBs and pair lists were rebuilt: in most scenes at most once in a step, and once more where it is repeated.
    /// In the other steps those of an earlier step still held every pair.
    pub list_builds: u64,
    /// Number of times that a body was stopped because its state was no longer finite.
    pub non_finite: u64,
    /// Number of times that the centre of a sphere passed a polygon, a triangle or a plane within a step (docs/physics section
    /// 2.20): an impact deeper than the radius, or a way longer than that. Not counted with `continuous_collisions`, with the contact
    /// law `rigid`, for bodies with boxes, for worlds in one dispatch, and in scenes that several processes share.
    pub passages: u64,
    /// The first of them.
    pub first_passage: Option<Passage>,
}

/// A sphere whose centre passed a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passage {
    /// Index of the sphere.
    pub sphere: usize,
    /// The step, counted from 1.
    pub step: u64,
}

/// Time in s after `steps` steps of `dt` seconds that began at `start`, for output that people read.
///
/// The time step counts as the decimal number that it is written as, and the result is the f64 nearest to the decimal sum: 3 steps
/// of 0.1 s end at 0.3 s, not at 0.30000000447034836 s.
pub fn decimal_time(start: f64, steps: u64, dt: f32) -> f64 {
    let written = dt.to_string();
    let decimals = |text: &str| text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let digits = decimals(&written).max(decimals(&start.to_string()));
    let time = start + steps as f64 * written.parse::<f64>().unwrap_or(f64::from(dt));
    format!("{time:.digits$}").parse().unwrap_or(time)
}

/// Where counting steps of the present length began.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Clock {
    start: (u64, f64),
    dt: f32,
    /// Steps and time of the report after the last addition.
    last: (u64, f64),
}

impl Clock {
    /// Adds steps of `dt` seconds to a report. The time does not depend on how many steps are added at once.
    pub(crate) fn add(&mut self, steps: u64, dt: f32, report: &mut Report) {
        // The report is also set by checkpoints.
        let now = (report.steps, report.time);
        if self.dt != dt || self.last != now {
            (self.start, self.dt) = (now, dt);
        }
        let (first, time) = self.start;
        report.steps += steps;
        report.time = decimal_time(time, report.steps - first, dt);
        self.last = (report.steps, report.time);
    }
}

/// Energies in mass units²/s² and momenta of the current state. All sums leave out fixed spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Energy {
    /// Kinetic energy, including rotation.
    pub kinetic: f64,
    /// Potential energy in gravity: -sum of m G g.x.
    pub potential: f64,
    /// Elastic energy of springs and tethers: sum of k (d - l)² / 2, and of springs of joints: sum of k (p - target)² / 2.
    pub spring: f64,
    /// Elastic energy of contacts: sum of Cc m* o² / 2.
    pub contact: f64,
    /// Momentum, in mass units/s.
    pub momentum: DVec3,
    /// Angular momentum about the origin, including spin, in mass units²/s.
    pub angular_momentum: DVec3,
}

impl Energy {
    /// Sum of all energies.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential + self.spring + self.contact
    }
}

/// The current state of a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SphereState {
    /// Centre, in units.
    pub position: Vec3,
    /// What is left of the centre beyond the digits of `position`, in units; 0 with [`Precision::Single`](crate::settings::Precision).
    pub position_low: Vec3,
    /// Velocity, in units/s.
    pub velocity: Vec3,
    /// Orientation, a unit quaternion.
    pub orientation: Quat,
    /// Angular momentum, in mass units²/s.
    pub angular_momentum: Vec3,
    /// Radius, in units.
    pub radius: f32,
    /// Mass.
    pub mass: f32,
    /// Whether the sphere is fixed.
    pub fixed: bool,
}

impl SphereState {
    /// The centre with all its digits, in units: the sum of `position` and `position_low`.
    pub fn centre(&self) -> [f64; 3] {
        (self.position.as_dvec3() + self.position_low.as_dvec3()).to_array()
    }

    /// Displaces the sphere by whole periods, so that its centre is in the box of a periodic scene. In a sheared scene it gets the
    /// velocity of that image.
    pub fn bring_into_box(&mut self, scene: &Scene) {
        let centre = DVec3::from_array(self.centre());
        let (way, velocity) = scene.image_in_box(centre);
        let Fine { high, low } = Fine::at((centre + way).to_array());
        (self.position, self.position_low) = (high, low);
        self.velocity += velocity;
    }

    /// Orientation as a rotation matrix. Its columns are the axes of the sphere's own frame.
    pub fn rotation(&self) -> Mat3 {
        Mat3::from_quat(self.orientation)
    }

    /// Angular velocity L / I, in rad/s.
    pub fn spin(&self) -> Vec3 {
        self.angular_momentum / (0.4 * self.mass * self.radius * self.radius)
    }
}

impl From<&Sphere> for SphereState {
    fn from(sphere: &Sphere) -> Self {
        Self {
            position: sphere.position,
            position_low: sphere.position_low,
            velocity: sphere.velocity,
            orientation: sphere.orientation,
            angular_momentum: sphere.angular_momentum,
            radius: sphere.radius,
            mass: sphere.mass,
            fixed: sphere.fixed,
        }
    }
}

/// A number for a message, with at most `digits` significant digits and with a power of ten where it would be long: 0.02, 12300,
/// 6.92e-10.
pub fn short_number(number: f64, digits: usize) -> String {
    // The text of a number in scientific notation is a number.
    let rounded = format!("{number:.*e}", digits.saturating_sub(1)).parse().unwrap_or(number);
    if rounded == 0.0 {
        // Also for -0, the value of an empty sum.
        return "0".to_owned();
    }
    if (1e-4..1e6).contains(&rounded.abs()) || !rounded.is_finite() {
        return rounded.to_string();
    }
    format!("{rounded:e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_decimal_sums() {
        let cases = [
            (0.0, 3, 0.1, 0.3),
            (0.0, 1, 0.02, 0.02),
            (0.0, 100_001, 0.02, 2000.02),
            (0.7, 65, 0.02, 2.0),
            (0.005, 1, 0.02, 0.025),
            (0.0, 7, 1.0 / 3.0, 2.33333338),
            (0.0, 2, 1e-38, 2e-38),
            (1.5, 0, 1e30, 1.5),
            (0.0, 2, 3e38, 6e38),
        ];
        for (start, steps, dt, expected) in cases {
            assert_eq!(decimal_time(start, steps, dt), expected, "{start} + {steps} * {dt}");
        }
    }

    #[test]
    fn the_time_does_not_depend_on_the_portions() {
        let (mut one, mut many) = (Report::default(), Report::default());
        Clock::default().add(900, 0.1, &mut one);
        let mut clock = Clock::default();
        (0..9).for_each(|_| clock.add(30, 0.1, &mut many));
        // As after a checkpoint.
        clock = Clock::default();
        (0..63).for_each(|_| clock.add(10, 0.1, &mut many));
        assert_eq!((one.time, many.time), (90.0, 90.0));
        // Back to an earlier state, after a change of the time step.
        clock.add(10, 0.05, &mut many);
        many = Report { steps: 3, time: 0.3, ..Report::default() };
        clock.add(2, 0.05, &mut many);
        assert_eq!((many.steps, many.time), (5, 0.4));
    }

    #[test]
    fn numbers_in_messages_are_short() {
        let cases = [
            (6.92123e-10, "6.92e-10"),
            (15_099_999_999_999_998_000_000_000.0, "1.51e25"),
            (0.02, "0.02"),
            (0.000_123_4, "0.000123"),
            (12_345.0, "12300"),
            (-0.5, "-0.5"),
            (999_999.0, "1e6"),
            (0.0, "0"),
            (-0.0, "0"),
            (f64::INFINITY, "inf"),
        ];
        for (number, expected) in cases {
            assert_eq!(short_number(number, 3), expected);
        }
        assert_eq!(short_number(445.84, 4), "445.8");
    }
}
