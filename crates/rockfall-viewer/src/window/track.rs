//! Position and velocity of the picked body over time.

use std::collections::VecDeque;
use std::fmt::Write as _;

use rockfall::glam::Vec3;

use crate::plot::Quantity;

/// Number of points that are kept.
const KEPT: usize = 20_000;
/// Greatest fraction of the wall time that reading the body back may take.
const SHARE: f64 = 0.1;

/// The body at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Simulated time, in s.
    pub time: f64,
    /// Position of the centre, in units.
    pub position: Vec3,
    /// Velocity of the centre, in units/s.
    pub velocity: Vec3,
}

/// The motion of the picked body since it was picked, and in the recorded states before.
#[derive(Clone, Debug, Default)]
pub struct Track {
    points: VecDeque<Point>,
    /// Wall time before which no further point is added, in s.
    next_at: f64,
}

impl Track {
    /// Returns the points in the order of their times.
    pub fn points(&self) -> &VecDeque<Point> {
        &self.points
    }

    /// Whether a point may be added at the wall time `now`.
    pub(super) fn is_due(&self, now: f64) -> bool {
        now >= self.next_at
    }

    /// Adds a point that took `seconds` of wall time to read back. Points at and after its time are removed.
    pub(super) fn add(&mut self, point: Point, now: f64, seconds: f64) {
        while self.points.back().is_some_and(|last| last.time >= point.time) {
            self.points.pop_back();
        }
        self.points.push_back(point);
        if self.points.len() > KEPT {
            self.points.pop_front();
        }
        self.next_at = now + seconds / SHARE;
    }

    /// Removes the points after a time.
    pub(super) fn rewind(&mut self, time: f64) {
        self.points.retain(|point| point.time <= time);
        self.next_at = 0.0;
    }

    /// Returns the points as CSV: time in s, position and height in units, velocity and speed in units/s. The height is the
    /// coordinate along the unit vector `up`.
    pub fn csv(&self, up: Vec3) -> String {
        let mut text = "time,x,y,z,vx,vy,vz,height,speed\n".to_owned();
        for Point { time, position: p, velocity: v } in &self.points {
            // Writing to memory cannot fail.
            let [height, speed] = [Quantity::Height, Quantity::Speed].map(|quantity| quantity.of_body((*p, *v), up));
            let _ = writeln!(text, "{time:.9},{},{},{},{},{},{},{height},{speed}", p.x, p.y, p.z, v.x, v.y, v.z);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(time: f64) -> Point {
        Point { time, position: Vec3::new(1.0, time as f32, 0.0), velocity: Vec3::new(3.0, 0.0, 4.0) }
    }

    #[test]
    fn points_stay_in_the_order_of_their_times() {
        let mut track = Track::default();
        [0.0, 0.5, 1.0, 1.5].into_iter().for_each(|time| track.add(point(time), 0.0, 0.0));
        track.rewind(1.2);
        track.add(point(1.0), 0.0, 0.0);
        let times: Vec<f64> = track.points().iter().map(|point| point.time).collect();
        assert_eq!(times, [0.0, 0.5, 1.0]);
    }

    #[test]
    fn a_track_becomes_csv_with_a_header() {
        let mut track = Track::default();
        track.add(point(0.5), 0.0, 0.0);
        assert_eq!(track.csv(Vec3::Y), "time,x,y,z,vx,vy,vz,height,speed\n0.500000000,1,0.5,0,3,0,4,0.5,5\n");
    }
}
