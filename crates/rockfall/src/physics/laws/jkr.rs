//! Cohesion by Johnson, Kendall and Roberts (docs/physics section 4.13).
//!
//! The contact radius is a = a_t u², with the contact radius a_t at which the contact tears. Then the overlap is h (u⁴ - 4 u)
//! with h = a_t² / R*, and the force is the elastic one of Hertz at the contact radius a, times 1 - 6 / u³.
//! `Constants::cohesion` is
//! -k with k³ = pi gamma / (4 E*), so that h = k² R*^(1/3).

use crate::laws::Constants;

/// Newton steps that invert the overlap. The start is at most 23 % too large; three steps leave a relative error of 1e-13,
/// without rounding.
const NEWTON_STEPS: u32 = 3;

/// The attraction in a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bond {
    /// Overlap a² / R* with which Hertz's contact has the same contact radius. Without this model it is the overlap itself.
    pub(super) depth: f32,
    /// Attraction per elastic force, 6 / u³.
    pub(super) pull: f32,
}

impl Bond {
    pub(super) fn of(constants: &Constants, effective_radius: f32, overlap: f32) -> Self {
        let Some(unit) = unit_of(constants, effective_radius) else {
            return Self { depth: overlap, pull: 0.0 };
        };
        let u = 1.0 + excess(overlap / unit);
        let squared = u * u;
        Self { depth: unit * squared * squared, pull: 6.0 / (squared * u) }
    }

    /// Twice the pull-off force per elastic force: 2 x 9 / u⁶.
    pub(super) fn grip(&self) -> f32 {
        0.5 * self.pull * self.pull
    }
}

/// The unit h of the overlap; `None` for a pair without this model.
fn unit_of(constants: &Constants, effective_radius: f32) -> Option<f32> {
    let k = -constants.cohesion;
    (k > 0.0).then(|| k * k * libm::cbrtf(effective_radius))
}

/// The distance up to which a contact persists when its objects are apart, 3 h; `None` for a pair without this model.
pub(super) fn tearing_distance(constants: &Constants, effective_radius: f32) -> Option<f32> {
    unit_of(constants, effective_radius).map(|unit| 3.0 * unit)
}

/// Returns u - 1 for the overlap in units of h, from u⁴ - 4 u.
///
/// With x = u - 1, u⁴ - 4 u + 3 = x² (x² + 4 x + 6). So x sqrt(x² + 4 x + 6) = q with q² = overlap + 3. Its left side is convex
/// and has no double root, so Newton's method converges from above, where it starts. The iteration is written with positive
/// terms only.
fn excess(overlap: f32) -> f32 {
    let q = (overlap + 3.0).max(0.0).sqrt();
    let mut x = q / (1.0 + (1.0 + q).sqrt());
    for _ in 0..NEWTON_STEPS {
        let root = (x * (x + 4.0) + 6.0).sqrt();
        x = (x * x * (x + 2.0) + q * root) / (2.0 * (x * (x + 3.0) + 3.0));
    }
    x
}

/// Energy of the normal force, E* R*^(1/2) h^(5/2) (8/15 u¹⁰ - 16/3 u⁷ + 8 u⁴), which is 0 for separate objects; `None` for a
/// pair without this model.
pub(super) fn energy(constants: &Constants, effective_radius: f32, overlap: f32) -> Option<f64> {
    let unit = unit_of(constants, effective_radius)?;
    let u = 1.0 + f64::from(excess(overlap / unit));
    let (unit, radius) = (f64::from(unit), f64::from(effective_radius));
    let polynomial = u.powi(4) * (8.0 / 15.0 * u.powi(6) - 16.0 / 3.0 * u.powi(3) + 8.0);
    Some(f64::from(constants.normal) * radius.sqrt() * unit * unit * unit.sqrt() * polynomial)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// u⁴ - 4 u by bisection in f64.
    fn by_bisection(overlap: f64) -> f64 {
        let (mut low, mut high) = (1.0, 1e9);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if middle * (middle * middle * middle - 4.0) < overlap { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    #[test]
    fn the_inverse_is_that_of_a_bisection() {
        let near = (0..400).map(|k| -3.0 + 10.0_f64.powf(-7.0 + 0.02 * f64::from(k)));
        let far = (0..400).map(|k| 10.0_f64.powf(-7.0 + 0.07 * f64::from(k)));
        let mut worst = 0.0_f64;
        for overlap in near.chain(far).map(|overlap| overlap as f32) {
            let expected = by_bisection(overlap.into());
            let found = 1.0 + excess(overlap);
            worst = worst.max((f64::from(found) / expected - 1.0).abs());
        }
        // The rounding of `found` alone is up to 6e-8.
        assert!(worst < 3e-7, "{worst}");
        assert_eq!(excess(-3.0), 0.0);
        assert_eq!(excess(-3.1), 0.0, "rounding beyond the end of the contact");
    }

    #[test]
    fn the_force_is_that_of_the_contact_radius() {
        let constants = Constants {
            normal: 1e5,
            tangential: 1e5,
            damping: 0.0,
            friction: 0.0,
            rolling: 0.0,
            rolling_damping: 0.0,
            twisting: 0.0,
            cohesion: -0.02,
        };
        let (young, radius, k) = (1e5_f64, 0.3_f64, f64::from(0.02_f32));
        let gamma = k.powi(3) * 4.0 * young / std::f64::consts::PI;
        let tearing = tearing_distance(&constants, radius as f32).unwrap();
        for share in [-0.999_f32, -0.5, 0.0, 1.0, 30.0, 1e4] {
            let overlap = share * tearing;
            let bond = Bond::of(&constants, radius as f32, overlap);
            let a = (radius * f64::from(bond.depth)).sqrt();
            // The formulas of Johnson, Kendall and Roberts.
            let expected = a * a / radius - 2.0 * (std::f64::consts::PI * gamma * a / young).sqrt();
            assert!((f64::from(overlap) - expected).abs() < 2e-6 * f64::from(bond.depth), "{share}: {overlap}, {expected}");
            let attraction = 2.0 * std::f64::consts::PI * a * a * (4.0 * gamma * young / (std::f64::consts::PI * a)).sqrt();
            let elastic = 4.0 / 3.0 * young * a.powi(3) / radius;
            assert!((elastic * f64::from(bond.pull) / attraction - 1.0).abs() < 1e-5, "{share}");
            let grip = 2.0 * 3.0 * std::f64::consts::PI * gamma * radius;
            assert!((elastic * f64::from(bond.grip()) / grip - 1.0).abs() < 1e-5, "{share}");
        }
        assert_eq!(Bond::of(&Constants { cohesion: 0.5, ..constants }, 0.3, 0.1), Bond { depth: 0.1, pull: 0.0 });
        // The force is the derivative of the energy.
        let energy = |overlap: f32| energy(&constants, radius as f32, overlap).unwrap();
        for share in [-0.9_f32, -0.3, 0.5, 5.0] {
            let (low, high) = ((share - 0.01) * tearing, (share + 0.01) * tearing);
            let bond = Bond::of(&constants, radius as f32, share * tearing);
            let a = (radius * f64::from(bond.depth)).sqrt();
            let force = 4.0 / 3.0 * young * a.powi(3) / radius * (1.0 - f64::from(bond.pull));
            let slope = (energy(high) - energy(low)) / f64::from(high - low);
            assert!((slope / force - 1.0).abs() < 0.01, "{share}: {slope}, {force}");
        }
    }
}
