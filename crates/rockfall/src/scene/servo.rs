//! Servos: motions that seek a force or a torque (docs/physics section 2.18).

use glam::DVec3;

use crate::error::{Error, Result};
use crate::scene::pose::Pose;

/// What moves a wall until it exerts a force or a torque on the bodies that touch it. A [`Motion`](crate::Motion) with a servo has no
/// terms.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Servo {
    /// What it seeks.
    pub seeks: Sought,
    /// Greatest speed, in units/s, or in rad/s for a torque. Without contacts, the wall moves at this speed.
    pub speed: f64,
    /// Present displacement along the force, in units, or present angle about the axis, in rad. At 0 the walls are where they are written.
    pub displacement: f64,
    /// Present rate of the displacement, in units/s or rad/s.
    pub velocity: f64,
}

/// What a [`Servo`] seeks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Sought {
    /// The force that the walls exert on the bodies, in mass units/s². The walls move along it.
    Force(DVec3),
    /// The torque that the walls exert on the bodies.
    Torque {
        /// Torque about the axis, in mass units²/s². It is positive where it turns bodies as a right-handed screw.
        torque: f64,
        /// Direction of the axis. Its length does not matter, but it is not 0.
        axis: DVec3,
        /// A point of the axis, in units.
        through: DVec3,
    },
}

impl Servo {
    /// A servo that seeks a force on the bodies, in mass units/s², and moves along it at most at a speed in units/s.
    pub fn force(force: impl Into<DVec3>, speed: f64) -> Self {
        Self::new(Sought::Force(force.into()), speed)
    }

    /// A servo that seeks a torque on the bodies, in mass units²/s², about an axis through a point, and turns at most at a speed in rad/s.
    pub fn torque(torque: f64, axis: impl Into<DVec3>, through: impl Into<DVec3>, speed: f64) -> Self {
        Self::new(Sought::Torque { torque, axis: axis.into(), through: through.into() }, speed)
    }

    fn new(seeks: Sought, speed: f64) -> Self {
        Self { seeks, speed, displacement: 0.0, velocity: 0.0 }
    }

    /// The force or the torque that it seeks, along its direction.
    pub fn target(&self) -> f64 {
        match self.seeks {
            Sought::Force(force) => force.length(),
            Sought::Torque { torque, .. } => torque,
        }
    }

    /// The unit vector along which it moves or about which it turns.
    pub fn direction(&self) -> DVec3 {
        let (Sought::Force(vector) | Sought::Torque { axis: vector, .. }) = self.seeks;
        vector.normalize_or(DVec3::Z)
    }

    pub(crate) fn validate(&self) -> Result<()> {
        let wrong = |field, value: String, expected| Err(Error::Invalid { field, value, expected });
        let show = |vector: DVec3| format!("{:?}", vector.to_array());
        // Kernels read all of it as f32.
        let is_number = |x: f64| (x as f32).is_finite();
        match self.seeks {
            Sought::Force(force) if !(force.try_normalize().is_some() && is_number(force.length())) => {
                return wrong("servo.force", show(force), "three finite numbers that are not all 0");
            }
            Sought::Torque { torque, .. } if !is_number(torque) => {
                return wrong("servo.torque", torque.to_string(), "a finite number");
            }
            Sought::Torque { axis, .. } if axis.try_normalize().is_none() => {
                return wrong("servo.axis", show(axis), "a direction, not 0");
            }
            Sought::Torque { through, .. } if !through.to_array().into_iter().all(is_number) => {
                return wrong("servo.through", show(through), "three finite numbers");
            }
            _ => {}
        }
        if !(is_number(self.speed) && self.speed as f32 > 0.0) {
            return wrong("servo.speed", self.speed.to_string(), "a finite number above 0");
        }
        if !is_number(self.displacement) {
            return wrong("servo.displacement", self.displacement.to_string(), "a finite number");
        }
        // In f32, because a run limits the rate to the speed in f32, which may be above the speed in f64.
        if self.velocity.is_nan() || (self.velocity as f32).abs() > self.speed as f32 {
            return wrong("servo.velocity", self.velocity.to_string(), "a number from -speed to speed");
        }
        Ok(())
    }

    /// A point of the axis; the origin for a force.
    pub(crate) fn through(&self) -> DVec3 {
        match self.seeks {
            Sought::Force(_) => DVec3::ZERO,
            Sought::Torque { through, .. } => through,
        }
    }

    /// Whether it turns.
    pub(crate) fn turns(&self) -> bool {
        matches!(self.seeks, Sought::Torque { .. })
    }

    /// The present pose.
    pub(crate) fn pose(&self) -> Pose {
        let (way, rate, direction) = (self.displacement, self.velocity, self.direction());
        if self.turns() {
            return Pose::about(direction, [way, rate], self.through());
        }
        Pose { shift: [way * direction, rate * direction, DVec3::ZERO], ..Pose::REST }
    }

    /// The words of the line `@servo` after the name.
    pub(crate) fn words(&self) -> String {
        let vector = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
        let seeks = match self.seeks {
            Sought::Force(force) => format!(" force={}", vector(force)),
            Sought::Torque { torque, axis, through } => {
                format!(" torque={torque} axis={} through={}", vector(axis), vector(through))
            }
        };
        let unless_zero = |key: &str, value: f64| if value == 0.0 { String::new() } else { format!(" {key}={value}") };
        let state = unless_zero("displacement", self.displacement) + &unless_zero("velocity", self.velocity);
        format!("{seeks} speed={}{state}", self.speed)
    }
}
