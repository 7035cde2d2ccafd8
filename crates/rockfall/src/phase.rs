//! Phases in units of 2^-64 turns: sums and products of them are exact modulo one turn.

/// 2^64, the units of a turn.
const UNITS: f64 = 18_446_744_073_709_551_616.0;

/// The fraction of a number of turns.
pub(crate) fn phase(turns: f64) -> u64 {
    // The factor is exact, and the result is below 2^64 because the fraction is at most 1 - 2^-53. A fraction that is rounded to 1
    // becomes u64::MAX, which is 2^-64 turns off.
    (turns.rem_euclid(1.0) * UNITS) as u64
}

/// A phase as a number of turns, from -1/2 to 1/2.
pub(crate) fn turns(phase: u64) -> f64 {
    phase.cast_signed() as f64 / UNITS
}

/// The low and the high word of a phase.
pub(crate) fn words(phase: u64) -> [u32; 2] {
    [phase as u32, (phase >> 32) as u32]
}

/// The phase of a low and a high word.
pub(crate) fn wide([low, high]: [u32; 2]) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}
