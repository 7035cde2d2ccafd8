//! The phases of muscles (docs/physics section 4.9), and the clock of muscles and motions.
//!
//! A phase is an integer number of 2^-64 turns. Sums and products of integers are exact modulo one turn. So a phase does not
//! lose precision in a long run, does not depend on how the steps are divided into calls, and is the same on both backends.
//!
//! The table of muscles has a record of [`MUSCLE_WORDS`] for every spring: the amplitude, the phase at the base of the clock, and
//! the change of the phase in half a time step, 64 bits each with the low word first. Force evaluations are a whole number of half
//! steps apart. Springs without a muscle have amplitude 0, which leaves their rest length as it is.

use glam::Vec4;

use crate::model::lanes::LANES;
use crate::model::layout::MUSCLE_WORDS;
use crate::model::status::Status;
use crate::model::step::Step;
use crate::phase::{phase, wide, words};
use crate::scene::Muscle;
use crate::settings::DEFAULT_TIME_STEP;

/// Steps after which the phases in the table are advanced. Counts of half steps since then fit 32 bits.
pub(crate) const BASE_STEPS: u64 = 1 << 30;

/// The time of muscles and motions: a number of equal steps since a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MuscleClock {
    /// Time in s at which the present time step began to be used.
    pub(crate) start: f64,
    /// The same time, where each step counts as the decimal number that it is written as.
    pub(crate) written_start: f64,
    /// Time step in s.
    pub(crate) dt: f32,
    /// Steps since then.
    pub(crate) steps: u64,
}

impl Default for MuscleClock {
    fn default() -> Self {
        Self { start: 0.0, written_start: 0.0, dt: DEFAULT_TIME_STEP, steps: 0 }
    }
}

impl MuscleClock {
    /// Continues with another time step.
    pub(crate) fn set_time_step(&mut self, dt: f32) {
        if self.dt != dt {
            *self = Self { start: self.time(), written_start: self.written_time(), dt, steps: 0 };
        }
    }

    /// Time since the start of the simulation, in s.
    pub(crate) fn time(&self) -> f64 {
        self.start + self.steps as f64 * f64::from(self.dt)
    }

    /// Time since the start of the simulation, in s, where each step counts as the decimal number that it is written as.
    pub(crate) fn written_time(&self) -> f64 {
        self.written_time_after(0)
    }

    /// That time a number of half steps later. It does not depend on how the steps are divided into calls.
    pub(crate) fn written_time_after(&self, half_steps: u64) -> f64 {
        let written = self.dt.to_string().parse().unwrap_or(f64::from(self.dt));
        self.written_start + (2 * self.steps + half_steps) as f64 * 0.5 * written
    }

    /// The last multiple of [`BASE_STEPS`]. Kernels count steps from there.
    fn base(&self) -> u64 {
        self.steps / BASE_STEPS * BASE_STEPS
    }

    /// Time in s of the step that kernels count from.
    pub(crate) fn base_time(&self) -> f64 {
        self.start + self.base() as f64 * f64::from(self.dt)
    }

    /// Value of [`Constants::muscle_step`](crate::model::step::Constants::muscle_step).
    pub(crate) fn steps_since_base(&self) -> u32 {
        (self.steps - self.base()) as u32
    }

    fn half_step(&self, muscle: &Muscle) -> u64 {
        // The product of two f32 is exact in f64.
        phase(f64::from(muscle.frequency) * f64::from(self.dt) * 0.5)
    }

    fn phase_at(&self, muscle: &Muscle, steps: u64) -> u64 {
        let start = phase(f64::from(muscle.frequency) * self.start);
        let since = self.half_step(muscle).wrapping_mul(steps.wrapping_mul(2));
        start.wrapping_add(phase(muscle.phase.into())).wrapping_add(since)
    }

    /// Phase of a muscle, in turns from 0 to 1.
    pub(crate) fn turns(&self, muscle: &Muscle) -> f64 {
        self.phase_at(muscle, self.steps) as f64 * 2.0_f64.powi(-64)
    }

    /// The record of a spring.
    pub(crate) fn record(&self, muscle: Option<Muscle>) -> [u32; MUSCLE_WORDS as usize] {
        let Some(muscle) = muscle else { return [0; MUSCLE_WORDS as usize] };
        let ([low, high], [step_low, step_high]) = (words(self.phase_at(&muscle, self.base())), words(self.half_step(&muscle)));
        [muscle.amplitude.to_bits(), low, high, step_low, step_high]
    }

    /// The record of a muscle for a step in `substeps` equal parts: its phase at the start of the step, and its change in a part.
    pub(crate) fn record_of_substeps(&self, muscle: &Muscle, substeps: u32) -> [u32; MUSCLE_WORDS as usize] {
        let change = phase(f64::from(muscle.frequency) * f64::from(self.dt) / f64::from(substeps));
        let ([low, high], [step_low, step_high]) = (words(self.phase_at(muscle, self.steps)), words(change));
        [muscle.amplitude.to_bits(), low, high, step_low, step_high]
    }

    /// Whether the tables for both clocks are the same.
    pub(crate) fn has_table_of(&self, other: &Self) -> bool {
        (self.start.to_bits(), self.dt.to_bits(), self.base()) == (other.start.to_bits(), other.dt.to_bits(), other.base())
    }
}

/// Half steps since the base of the muscles' clock, at a force evaluation of a step.
pub(crate) fn half_steps(step: &Step, status: &Status, evaluation: u32) -> u32 {
    // RK4 evaluates forces at the start of the step, twice in its middle, and at its end.
    2 * step.constants.muscle_step.wrapping_add(status.steps) + [0, 1, 1, 2][evaluation as usize]
}

/// Rest length of a spring of constant length `length` with this record in the table, after a number of half steps.
pub(crate) fn muscle_length(record: [u32; MUSCLE_WORDS as usize], length: f32, half_steps: u32) -> f32 {
    MusclesOfFour::of(&[record]).lengths(Vec4::splat(length), half_steps).x
}

/// The muscles of four springs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MusclesOfFour {
    amplitudes: Vec4,
    /// Phases at the base of the clock, and their change in half a step.
    phases: [u64; LANES],
    changes: [u64; LANES],
}

impl MusclesOfFour {
    /// The muscles of up to four records.
    pub(crate) fn of(records: &[[u32; MUSCLE_WORDS as usize]]) -> Self {
        let mut four = Self::default();
        for (lane, [amplitude, low, high, step_low, step_high]) in records.iter().enumerate() {
            four.amplitudes[lane] = f32::from_bits(*amplitude);
            four.phases[lane] = wide([*low, *high]);
            four.changes[lane] = wide([*step_low, *step_high]);
        }
        four
    }

    /// Rest lengths of the springs of these constant lengths after a number of half steps.
    #[inline]
    pub(crate) fn lengths(&self, lengths: Vec4, half_steps: u32) -> Vec4 {
        let phase = |lane: usize| self.phases[lane].wrapping_add(self.changes[lane].wrapping_mul(half_steps.into()));
        lengths * (1.0 + self.amplitudes * sines(std::array::from_fn(phase)))
    }
}

/// Sines of phases. The error is less than 2e-7.
#[inline]
fn sines(phases: [u64; LANES]) -> Vec4 {
    const RADIANS: f32 = (std::f64::consts::TAU / 18_446_744_073_709_551_616.0) as f32;
    let folded = |phase: u64| {
        let turns = phase.cast_signed();
        // sin(pi - x) = sin x reduces the angle to a quarter turn to either side, exactly.
        (if turns.unsigned_abs() > 1 << 62 { i64::MIN.wrapping_sub(turns) } else { turns }) as f32
    };
    let x = Vec4::from_array(phases.map(folded)) * RADIANS;
    let xx = x * x;
    let [a3, a5, a7, a9, a11] = [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0];
    x + x * xx * (a3 + xx * (a5 + xx * (a7 + xx * (a9 + xx * a11))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(phase: u64) -> f32 {
        sines([phase; LANES]).w
    }

    #[test]
    fn sines_are_exact_to_f32() {
        for place in 0..10_000_u32 {
            let turns = f64::from(place) / 9973.0;
            let exact = (std::f64::consts::TAU * turns).sin();
            let error = (f64::from(sine(phase(turns))) - exact).abs();
            assert!(error < 2e-7, "{turns} turns: {error}");
        }
        assert_eq!([0, 1 << 62, 1 << 63, 3 << 62].map(sine), [0.0, sine(1 << 62), 0.0, -sine(1 << 62)]);
    }

    #[test]
    fn phases_do_not_lose_precision_in_long_runs() {
        // 1.25 Hz at 1/64 s: 1/51.2 of a turn per step. After 2^40 steps the phase is that after 2^40 mod 256 = 0 steps.
        let muscle = Muscle::new(0.5, 1.25, 0.125);
        let clock = MuscleClock { start: 0.0, written_start: 0.0, dt: 1.0 / 64.0, steps: 1 << 40 };
        assert_eq!(clock.turns(&muscle), 0.125);
        let later = MuscleClock { steps: (1 << 40) + 64, ..clock };
        assert_eq!(later.turns(&muscle), 0.375);
    }

    #[test]
    fn a_record_and_a_count_of_half_steps_give_the_phase_of_the_clock() {
        let muscle = Muscle::new(0.5, 3.7, 0.3);
        for steps in [0, 1, 77, BASE_STEPS - 1, BASE_STEPS, 5 * BASE_STEPS + 3] {
            let clock = MuscleClock { start: 1.7, written_start: 1.7, dt: 0.013, steps };
            let length = muscle_length(clock.record(Some(muscle)), 2.0, 2 * clock.steps_since_base());
            let exact = 2.0 * (1.0 + 0.5 * (std::f64::consts::TAU * clock.turns(&muscle)).sin());
            assert!((f64::from(length) - exact).abs() < 5e-7, "{steps}: {length} {exact}");
        }
        assert_eq!(muscle_length(MuscleClock::default().record(None), 0.7, 12), 0.7);
    }
}
