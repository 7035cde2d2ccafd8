//! Residues: what rounding to f32 leaves of velocities and angular momenta (docs/physics section 5.10).

use glam::{IVec3, UVec3, Vec3, Vec4};

use crate::fine::{Fine, two_sum};

/// Steps below this are so short that rounding would change accelerations, in s.
const SHORT_STEP: f32 = 5e-4;
/// A residue is a multiple of 2^-41 times the greatest power of 2 that its number reaches: 2^-18 of the unit in the last place.
const DIGITS: f32 = 4.547_473_5e-13;
/// Greatest size of the multiple, which has 19 bits.
const MOST: f32 = 262_143.0;
/// Added to a number, rounds it to a whole one, whose bits are then the last ones of the sum.
const TO_WHOLE: f32 = 12_582_912.0;
/// Bits of each word of a row of residues, which make it a finite number whose bits no device changes.
const FINITE: u32 = 0x4000_0000;

/// Whether velocities have residues in steps of `dt` seconds.
pub(crate) fn has_residues(dt: f32) -> bool {
    dt < SHORT_STEP
}

/// Whether a word may be part of a row of residues.
pub(crate) fn is_residue(word: u32) -> bool {
    word == 0 || word >> 29 == FINITE >> 29
}

/// A velocity and an angular momentum after an increment, and what rounding left of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Increased {
    pub(crate) velocity: Vec3,
    pub(crate) angular_momentum: Vec3,
    pub(crate) residues: Vec4,
}

/// Adds increments to a velocity and an angular momentum with the residues of a row, or without residues.
pub(crate) fn increased(numbers: [Vec3; 2], residues: Option<Vec4>, by: [Vec3; 2]) -> Increased {
    with_sums(numbers, residues, by, Fine::moved)
}

/// The same for the drift of velocity Verlet: the sums do not depend on the residues, so a process that has a copy of a body without
/// its residues computes the same (docs/cluster.md).
pub(crate) fn drifted(numbers: [Vec3; 2], residues: Option<Vec4>, by: [Vec3; 2]) -> Increased {
    with_sums(numbers, residues, by, |number, by| {
        let (high, rest) = two_sum(number.high, by);
        Fine { high, low: rest + number.low }
    })
}

fn with_sums(numbers: [Vec3; 2], residues: Option<Vec4>, by: [Vec3; 2], sum: impl Fn(Fine, Vec3) -> Fine) -> Increased {
    let [velocity, momentum] = numbers;
    let Some(row) = residues else {
        return Increased { velocity: velocity + by[0], angular_momentum: momentum + by[1], residues: Vec4::ZERO };
    };
    let [of_velocity, of_momentum] = unpacked(row, numbers);
    let velocity = sum(Fine { high: velocity, low: of_velocity }, by[0]);
    let momentum = sum(Fine { high: momentum, low: of_momentum }, by[1]);
    Increased { velocity: velocity.high, angular_momentum: momentum.high, residues: packed([velocity, momentum]) }
}

/// The exponent bits of each component, which are the greatest power of 2 that its size reaches.
fn exponents(of: Vec3) -> UVec3 {
    UVec3::from_array(of.to_array().map(|x| x.to_bits() & 0x7f80_0000))
}

fn from_bits(bits: UVec3) -> Vec3 {
    Vec3::from_array(bits.to_array().map(f32::from_bits))
}

/// The residues of two vectors as multiples of 19 bits.
fn multiples(number: Fine) -> UVec3 {
    let inverse = from_bits(UVec3::splat(0x7f00_0000) - exponents(number.high).min(UVec3::splat(0x7f00_0000)));
    let scaled = (number.low * inverse / DIGITS).clamp(Vec3::splat(-MOST), Vec3::splat(MOST));
    let whole = (scaled + Vec3::splat(TO_WHOLE)).to_array().map(f32::to_bits);
    UVec3::from_array(whole) & UVec3::splat(0x7_ffff)
}

/// The residues of a velocity and an angular momentum as a row.
fn packed([velocity, momentum]: [Fine; 2]) -> Vec4 {
    let (of_velocity, of_momentum) = (multiples(velocity), multiples(momentum));
    let words = (of_velocity << 10_u32) | (of_momentum & UVec3::splat(0x3ff)) | UVec3::splat(FINITE);
    let upper = of_momentum >> 10_u32;
    let rest = FINITE | upper.x << 18 | upper.y << 9 | upper.z;
    from_bits(words).extend(f32::from_bits(rest))
}

/// The residues in a row, of a velocity and an angular momentum. No residue exceeds a unit in the last place of its number, also
/// where an impulse has changed the number since.
fn unpacked(row: Vec4, of: [Vec3; 2]) -> [Vec3; 2] {
    let [x, y, z, rest] = row.to_array().map(f32::to_bits);
    let words = UVec3::new(x, y, z);
    let upper = UVec3::new(rest >> 18, rest >> 9, rest) & UVec3::splat(0x1ff);
    let all = [(words >> 10_u32) & UVec3::splat(0x7_ffff), (words & UVec3::splat(0x3ff)) | (upper << 10_u32)];
    let residue = |multiples: UVec3, of: Vec3| {
        let signed = IVec3::from_array(multiples.to_array().map(|word| (word << 13) as i32 >> 13));
        signed.as_vec3() * (from_bits(exponents(of)) * DIGITS)
    };
    [residue(all[0], of[0]), residue(all[1], of[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_keeps_residues_to_a_part_of_the_last_place() {
        let numbers = [[100.0_f32, -3e-20, 7.5], [-2.0, 1e20, 0.3]];
        let halves =
            numbers.map(|vector| Vec3::from_array(vector.map(|x| from_bits(exponents(Vec3::splat(x))).x / 16_777_216.0)));
        let numbers = numbers.map(Vec3::from_array);
        for share in [-1.0, -0.37, 0.0, 2e-5, 1.9] {
            let fine = [0, 1].map(|k| Fine { high: numbers[k], low: share * halves[k] });
            let row = packed(fine);
            assert!(row.to_array().iter().all(|word| word.is_normal()), "{row}");
            for (k, residue) in unpacked(row, numbers).into_iter().enumerate() {
                let error = ((residue - fine[k].low) / halves[k]).abs().max_element();
                assert!(error <= 1.0 / 262_144.0, "{share}: {error}");
            }
        }
        assert_eq!(unpacked(Vec4::ZERO, numbers), [Vec3::ZERO; 2], "a row of zeros has no residues");
        assert_eq!(
            unpacked(packed([0, 1].map(|k| Fine { high: numbers[k], low: halves[k] })), [Vec3::ZERO; 2]),
            [Vec3::ZERO; 2]
        );
    }

    #[test]
    fn increments_far_below_the_last_place_add_up() {
        // Half a kick at 9.81 m/s² in 10 ns at 100 m/s: less than a hundredth of the unit in the last place.
        let by = [Vec3::new(0.0, -4.905e-8, 3e-12), Vec3::new(-1e-9, 0.0, 1e-15)];
        let start = [Vec3::new(5.0, -100.0, 0.0), Vec3::new(0.25, 0.0, 1e-8)];
        let (mut state, mut row) = (start, Vec4::ZERO);
        for k in 0..1_000_000 {
            let after = if k % 2 == 0 { drifted(state, Some(row), by) } else { increased(state, Some(row), by) };
            (state, row) = ([after.velocity, after.angular_momentum], after.residues);
        }
        for k in 0..2 {
            let gained = state[k].as_dvec3() - start[k].as_dvec3();
            let expected = 1e6 * by[k].as_dvec3();
            let error = (gained - expected).abs() - 1e-3 * expected.abs();
            assert!(error.max_element() <= 0.0, "{gained} {expected}");
        }
    }
}
