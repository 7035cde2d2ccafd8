//! Resistance to rolling and twisting of a contact (docs/physics section 4.12).

use glam::Vec3;

use crate::laws::{Constants, Stiffness};
use crate::physics::side::Side;

/// Properties of a contact that its resistances depend on.
pub(super) struct Turning<'a> {
    pub(super) sides: [&'a Side; 2],
    pub(super) normal: Vec3,
    pub(super) overlap: f32,
    /// Reduced radius R*, in units.
    pub(super) radius: f32,
    /// Normal force N.
    pub(super) press: f32,
    pub(super) stiffness: Stiffness,
    /// Tangential force per tangential velocity.
    pub(super) dashpot: f32,
    /// The time step, and the time by which the springs advance, in s.
    pub(super) times: [f32; 2],
}

/// The moment that a contact keeps from one step to the next, and the overlap that belongs to it.
#[derive(Clone, Copy)]
pub(super) struct Kept {
    pub(super) moment: Vec3,
    pub(super) overlap: f32,
}

/// The torque on A, and the moment to keep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moments {
    pub(super) torque: Vec3,
    pub(super) kept: Vec3,
}

impl Turning<'_> {
    /// Returns the torque of rolling and twisting resistance, and the moment to keep.
    pub(super) fn moments(&self, constants: &Constants, before: Kept) -> Moments {
        let [a, b] = self.sides;
        let spin = a.spin - b.spin;
        let twist = spin.dot(self.normal);
        let roll = spin - twist * self.normal;
        let old_twist = before.moment.dot(self.normal);
        let old_roll = before.moment - old_twist * self.normal;
        let (roll_factor, twist_factor) = self.unloading(before.overlap);
        let mut sum = Moments::default();
        if constants.rolling > 0.0 {
            let limit = constants.rolling * self.radius * self.press;
            let found = match constants.rolling_damping {
                ratio if ratio < 0.0 => Moments { torque: self.constant_torque(roll, limit), kept: Vec3::ZERO },
                ratio => self.spring_dashpot(roll, roll_factor * old_roll, limit, [constants.rolling, ratio]),
            };
            sum = found;
        }
        if constants.twisting > 0.0 {
            let [torque, kept] = self.twisting(constants, twist, twist_factor * old_twist);
            sum.torque += torque * self.normal;
            sum.kept += kept * self.normal;
        }
        sum
    }

    /// Ratios of the rolling and the twisting stiffness to those of the step before, where the contact unloads.
    fn unloading(&self, old_overlap: f32) -> (f32, f32) {
        if self.overlap >= old_overlap {
            return (1.0, 1.0);
        }
        let roll = self.stiffness.unloading;
        (roll, roll * (self.overlap / old_overlap))
    }

    /// Returns torque and moment to keep of rolling model `c`. The coefficients are mu_r and the damping ratio.
    fn spring_dashpot(&self, roll: Vec3, old: Vec3, limit: f32, [coefficient, ratio]: [f32; 2]) -> Moments {
        let stiffness = 2.25 * self.stiffness.normal * (coefficient * self.radius).powi(2);
        let kept = old - stiffness * self.times[1] * roll;
        let size = kept.length();
        if size > limit {
            let kept = kept * (limit / size);
            return Moments { torque: kept, kept };
        }
        let inverse: f32 = self.sides.map(inverse_inertia_about_contact).iter().sum();
        let dashpot = 2.0 * ratio * (stiffness / inverse).sqrt();
        Moments { torque: kept - dashpot * roll, kept }
    }

    /// Returns the torque of rolling model `a`, which keeps no moment.
    fn constant_torque(&self, roll: Vec3, limit: f32) -> Vec3 {
        let rate = roll.length();
        if rate == 0.0 {
            return Vec3::ZERO;
        }
        let inverse: f32 = self.sides.map(|side| side.inverse_inertia).iter().sum();
        let size = limit.min(0.5 * rate / (self.times[0] * inverse));
        roll * (-size / rate)
    }

    /// Returns the torque of twisting and the moment to keep, along the normal.
    fn twisting(&self, constants: &Constants, twist: f32, old: f32) -> [f32; 2] {
        let area = self.radius * self.overlap;
        let limit = 2.0 / 3.0 * area.sqrt() * constants.twisting * self.press;
        let kept = old - 0.5 * self.stiffness.tangential * area * self.times[1] * twist;
        if kept.abs() > limit {
            return [limit.copysign(kept); 2];
        }
        let dashpot = 0.5 * self.dashpot * area;
        [kept - dashpot * twist, kept]
    }
}

/// Returns 1 / (I + m r²) of a side: 0 for a fixed body, a box or a polygon.
fn inverse_inertia_about_contact(side: &Side) -> f32 {
    match side.radius {
        Some(radius) if side.inverse_mass > 0.0 => {
            side.inverse_inertia * side.inverse_mass / (side.inverse_mass + side.inverse_inertia * radius * radius)
        }
        _ => 0.0,
    }
}
