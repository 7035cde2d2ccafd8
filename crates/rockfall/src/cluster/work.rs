//! What the processes of a cluster have to do, and how long it took.

use std::ops::Sub;
use std::time::Instant;

/// What one process has, and where its time went since it began, in s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Number of own spheres, with fixed ones on process 0.
    pub own: u64,
    /// Number of copies of spheres of other processes.
    pub ghosts: u64,
    /// Number of times that the spheres were divided.
    pub divisions: u64,
    /// Steps of the own spheres and the copies, apart from the messages that are exchanged during them.
    pub steps: f64,
    /// Copies of rows between the arrays of the simulation and messages, apart from those during a step.
    pub rows: f64,
    /// Messages between processes, also those that are exchanged during a step.
    pub exchange: f64,
    /// Waiting for the other processes before a step.
    pub waiting: f64,
    /// Divisions of the spheres.
    pub division: f64,
}

/// 32-bit words of a [`Work`].
const WORDS: usize = 16;

impl Work {
    /// The bits of all numbers.
    pub(super) fn words(&self) -> [u32; WORDS] {
        let Self { own, ghosts, divisions, steps, rows, exchange, waiting, division } = *self;
        let times = [steps, rows, exchange, waiting, division].map(f64::to_bits);
        let mut words = [0; WORDS];
        for (pair, value) in words.chunks_exact_mut(2).zip([own, ghosts, divisions].into_iter().chain(times)) {
            pair.copy_from_slice(&[value as u32, (value >> 32) as u32]);
        }
        words
    }

    pub(super) fn from_words(words: &[u32]) -> Self {
        let value = |at: usize| u64::from(words[2 * at]) | u64::from(words[2 * at + 1]) << 32;
        let time = |at: usize| f64::from_bits(value(at));
        let [steps, rows, exchange, waiting, division] = [3, 4, 5, 6, 7].map(time);
        Self { own: value(0), ghosts: value(1), divisions: value(2), steps, rows, exchange, waiting, division }
    }
}

/// The work since an earlier time, and the spheres at the later one.
impl Sub for Work {
    type Output = Self;

    fn sub(self, before: Self) -> Self {
        Self {
            divisions: self.divisions - before.divisions,
            steps: self.steps - before.steps,
            rows: self.rows - before.rows,
            exchange: self.exchange - before.exchange,
            waiting: self.waiting - before.waiting,
            division: self.division - before.division,
            ..self
        }
    }
}

/// Adds the time that a call takes to `seconds`.
pub(super) fn timed<T>(seconds: &mut f64, call: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let value = call();
    *seconds += start.elapsed().as_secs_f64();
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_hold_all_numbers() {
        let (own, ghosts, divisions) = (1 << 40, 2, 3);
        let work = Work { own, ghosts, divisions, steps: 0.1, rows: 0.2, exchange: 0.3, waiting: 0.4, division: 1e9 };
        assert_eq!(Work::from_words(&work.words()), work);
    }
}
