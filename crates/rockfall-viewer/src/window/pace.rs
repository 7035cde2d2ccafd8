//! Decides when steps are due: in real time with a constant time step, or one step per frame.

/// Wall time that the physics of one frame may take, in s, so that the window stays responsive.
const BUDGET: f64 = 0.04;
/// Time constant of the averages, in s.
const MEMORY: f64 = 1.0;
/// Fraction of the due steps that must be made, or else the physics cannot keep up.
const ENOUGH: f64 = 0.95;
/// Speeds, relative to real time or to one step per frame.
pub const SPEEDS: [f64; 7] = [1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0, 1.0, 2.0, 4.0];

/// Converts the time between frames to a number of steps, and records whether the steps are made in time.
#[derive(Clone, Debug)]
pub struct Pace {
    /// Whether steps follow the clock; else each frame is one step (thesis section 2.12.1, key T).
    pub real_time: bool,
    /// The time step, in s.
    pub time_step: f32,
    /// One of [`SPEEDS`].
    speed: f64,
    /// Number of steps that are due; less than one after a frame.
    owed: f64,
    /// Wall time of a step, in s; `None` before the first.
    step_cost: Option<f64>,
    /// Average of the steps that were due.
    wanted: f64,
    /// Average of the steps that were made.
    done: f64,
    /// Time that the averages cover, in s.
    watched: f64,
}

impl Pace {
    /// Creates a pace of real time at full speed.
    pub fn new(time_step: f32) -> Self {
        let (owed, wanted, done, watched) = (0.0, 0.0, 0.0, 0.0);
        Self { real_time: true, time_step, speed: 1.0, owed, step_cost: None, wanted, done, watched }
    }

    /// Returns the speed: 1 is normal, less is slow motion.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Changes to the next lower or higher speed of [`SPEEDS`].
    pub fn change_speed(&mut self, faster: bool) {
        let next = if faster {
            SPEEDS.iter().copied().find(|speed| *speed > self.speed)
        } else {
            SPEEDS.iter().rev().copied().find(|speed| *speed < self.speed)
        };
        self.speed = next.unwrap_or(self.speed);
        self.forget();
    }

    /// Sets one of [`SPEEDS`].
    pub fn set_speed(&mut self, speed: f64) {
        self.speed = speed;
        self.forget();
    }

    /// Clears the due steps and the averages.
    pub fn forget(&mut self) {
        (self.owed, self.wanted, self.done, self.watched) = (0.0, 0.0, 0.0, 0.0);
    }

    /// Returns the number of steps to make in this frame, `elapsed` s after the last one. Steps that would take too long are
    /// dropped: the simulation is then slower than requested, and [`Pace::lag`] returns by how much.
    pub fn due(&mut self, elapsed: f64) -> u64 {
        let more = if self.real_time { self.speed * elapsed / f64::from(self.time_step) } else { self.speed };
        self.owed += more;
        let whole = self.owed.floor();
        self.owed -= whole;
        let most = self.step_cost.map_or(1.0, |cost| (BUDGET / cost).floor().max(1.0));
        let steps = whole.min(most);
        let kept = (-elapsed / MEMORY).exp();
        self.wanted = self.wanted * kept + more;
        self.done = self.done * kept + more - (whole - steps);
        self.watched += elapsed;
        steps as u64
    }

    /// Records the wall time of a number of steps.
    pub fn note_cost(&mut self, steps: u64, seconds: f64) {
        let cost = seconds / steps.max(1) as f64;
        // The first steps are slow because they compile kernels and grow lists, so a lower cost replaces the average at once.
        self.step_cost = Some(self.step_cost.map_or(cost, |old| cost.min(0.8 * old + 0.2 * cost)));
    }

    /// Returns the smoothed wall time of a step, in s.
    pub fn step_cost(&self) -> Option<f64> {
        self.step_cost
    }

    /// Returns the fraction of the due steps that are made, if the physics cannot keep up; `None` during the first second.
    pub fn lag(&self) -> Option<f64> {
        let part = self.done / self.wanted;
        (self.watched >= MEMORY && part < ENOUGH).then_some(part)
    }

    /// Returns the blend factor of the picture: 0 is the state before the last step, 1 the present one.
    pub fn alpha(&self) -> f32 {
        if !self.real_time && self.speed >= 1.0 { 1.0 } else { self.owed as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn real_time() -> Pace {
        let mut pace = Pace::new(0.02);
        pace.note_cost(1, 1e-4);
        pace
    }

    fn stepwise() -> Pace {
        let mut pace = Pace::new(0.02);
        pace.real_time = false;
        pace
    }

    #[test]
    fn each_frame_is_one_step_whatever_the_elapsed_time() {
        let mut pace = stepwise();
        assert_eq!([0.001, 0.5, 3.0].map(|elapsed| pace.due(elapsed)), [1, 1, 1]);
        assert_eq!(pace.alpha(), 1.0);
        assert_eq!(pace.lag(), None);
    }

    #[test]
    fn in_real_time_the_steps_match_the_elapsed_time() {
        let mut pace = real_time();
        // 60 frames per second for 10 s: 500 steps of 20 ms.
        let done: u64 = (0..600).map(|_| pace.due(1.0 / 60.0)).sum();
        assert!((499..=500).contains(&done), "{done}");
        assert_eq!(pace.lag(), None);
    }

    #[test]
    fn blending_gives_a_steady_motion() {
        let mut pace = real_time();
        let mut last = 0.0;
        let mut steps = 0;
        for _ in 0..100 {
            steps += pace.due(0.007);
            let drawn = steps as f32 + pace.alpha();
            assert!((drawn - last - 0.35).abs() < 1e-3, "0.35 steps per frame, not {}", drawn - last);
            last = drawn;
        }
    }

    #[test]
    fn slow_motion_makes_one_step_in_several_frames() {
        let mut pace = stepwise();
        pace.change_speed(false);
        pace.change_speed(false);
        assert_eq!(pace.speed(), 0.25);
        let done: Vec<u64> = (0..8).map(|_| pace.due(0.1)).collect();
        assert_eq!(done, [0, 0, 0, 1, 0, 0, 0, 1]);
        pace.due(0.1);
        assert_eq!(pace.alpha(), 0.25);
    }

    #[test]
    fn speeds_stay_within_their_range() {
        let mut pace = Pace::new(0.02);
        (0..20).for_each(|_| pace.change_speed(true));
        assert_eq!(pace.speed(), 4.0);
        (0..20).for_each(|_| pace.change_speed(false));
        assert_eq!(pace.speed(), 1.0 / 16.0);
    }

    /// One step of 30 ms fits the budget of a frame, while 2.5 steps are due in a frame of 50 ms.
    #[test]
    fn steps_that_take_too_long_are_dropped_and_reported_as_lag() {
        let mut pace = Pace::new(0.02);
        pace.note_cost(1, 0.03);
        let done: u64 = (0..100).map(|_| pace.due(0.05)).sum();
        assert!((99..=100).contains(&done), "{done}");
        let lag = pace.lag().expect("it cannot keep up");
        assert!((lag - 0.4).abs() < 0.03, "1 of 2.5 steps, not {lag}");
        // At a quarter of the speed it keeps up again.
        pace.change_speed(false);
        pace.change_speed(false);
        (0..100).for_each(|_| {
            pace.due(0.05);
        });
        assert_eq!(pace.lag(), None);
    }
}
