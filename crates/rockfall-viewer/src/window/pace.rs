//! When to step: in real time at a steady step, or a step a frame.

/// Wall time that the physics of one frame may take, in s: beyond that the window would stop answering.
const BUDGET: f64 = 0.04;
/// How fast averages forget, in s.
const MEMORY: f64 = 1.0;
/// Of the steps that are due, this part must be done for physics to keep up.
const ENOUGH: f64 = 0.95;
/// How fast time may go, of real time or of a step a frame.
pub const SPEEDS: [f64; 7] = [1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0, 1.0, 2.0, 4.0];

/// Turns the time that frames take into a number of steps, and keeps account of whether they are done in time.
#[derive(Clone, Debug)]
pub struct Pace {
    /// Steps follow the clock; else each frame is a step (thesis section 2.12.1, key T).
    pub real_time: bool,
    /// The time step, in s.
    pub time_step: f32,
    /// 1, less for slow motion.
    speed: f64,
    /// Steps that are due; what is left after a frame is less than one.
    owed: f64,
    /// Wall time of a step, in s, once one is known.
    step_cost: Option<f64>,
    wanted: f64,
    done: f64,
    watched: f64,
}

impl Pace {
    /// A step a frame, at full speed.
    pub fn new(time_step: f32) -> Self {
        let (owed, wanted, done, watched) = (0.0, 0.0, 0.0, 0.0);
        Self { real_time: false, time_step, speed: 1.0, owed, step_cost: None, wanted, done, watched }
    }

    /// How fast time goes: 1, less for slow motion.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// The next speed of [`SPEEDS`] below or above the present one.
    pub fn change_speed(&mut self, faster: bool) {
        let next = if faster {
            SPEEDS.iter().copied().find(|speed| *speed > self.speed)
        } else {
            SPEEDS.iter().rev().copied().find(|speed| *speed < self.speed)
        };
        self.speed = next.unwrap_or(self.speed);
        self.forget();
    }

    /// Nothing is due, and nothing is known of keeping up.
    pub fn forget(&mut self) {
        (self.owed, self.wanted, self.done, self.watched) = (0.0, 0.0, 0.0, 0.0);
    }

    /// Steps to do in this frame, `elapsed` s after the last one. What would take too long is dropped: then time
    /// goes slower than it should, and [`Pace::lag`] tells.
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

    /// Takes note of the wall time that steps took.
    pub fn note_cost(&mut self, steps: u64, seconds: f64) {
        let cost = seconds / steps.max(1) as f64;
        // The first steps compile kernels and grow lists; a new low is believed at once.
        self.step_cost = Some(self.step_cost.map_or(cost, |old| cost.min(0.8 * old + 0.2 * cost)));
    }

    /// Wall time of a step, in s, smoothed.
    pub fn step_cost(&self) -> Option<f64> {
        self.step_cost
    }

    /// Where physics cannot keep up: the part of the due steps that it does. Known after a second.
    pub fn lag(&self) -> Option<f64> {
        let part = self.done / self.wanted;
        (self.watched >= MEMORY && part < ENOUGH).then_some(part)
    }

    /// What to draw: 0 the state before the last step, 1 the present one.
    pub fn alpha(&self) -> f32 {
        if !self.real_time && self.speed >= 1.0 { 1.0 } else { self.owed as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn real_time() -> Pace {
        let mut pace = Pace::new(0.02);
        pace.real_time = true;
        pace.note_cost(1, 1e-4);
        pace
    }

    #[test]
    fn a_frame_is_a_step_whatever_its_time() {
        let mut pace = Pace::new(0.02);
        assert_eq!([0.001, 0.5, 3.0].map(|elapsed| pace.due(elapsed)), [1, 1, 1]);
        assert_eq!(pace.alpha(), 1.0);
        assert_eq!(pace.lag(), None);
    }

    #[test]
    fn real_time_does_as_many_steps_as_time_has_passed() {
        let mut pace = real_time();
        // 60 frames a second for 10 s: 500 steps of 20 ms.
        let done: u64 = (0..600).map(|_| pace.due(1.0 / 60.0)).sum();
        assert!((499..=500).contains(&done), "{done}");
        assert_eq!(pace.lag(), None);
    }

    #[test]
    fn drawing_goes_steadily_between_steps() {
        let mut pace = real_time();
        let mut last = 0.0;
        let mut steps = 0;
        for _ in 0..100 {
            steps += pace.due(0.007);
            let drawn = steps as f32 + pace.alpha();
            assert!((drawn - last - 0.35).abs() < 1e-3, "0.35 of a step a frame, not {}", drawn - last);
            last = drawn;
        }
    }

    #[test]
    fn slow_motion_takes_a_step_in_several_frames() {
        let mut pace = Pace::new(0.02);
        pace.change_speed(false);
        pace.change_speed(false);
        assert_eq!(pace.speed(), 0.25);
        let done: Vec<u64> = (0..8).map(|_| pace.due(0.1)).collect();
        assert_eq!(done, [0, 0, 0, 1, 0, 0, 0, 1]);
        pace.due(0.1);
        assert_eq!(pace.alpha(), 0.25);
    }

    #[test]
    fn speeds_end_where_they_end() {
        let mut pace = Pace::new(0.02);
        (0..20).for_each(|_| pace.change_speed(true));
        assert_eq!(pace.speed(), 4.0);
        (0..20).for_each(|_| pace.change_speed(false));
        assert_eq!(pace.speed(), 1.0 / 16.0);
    }

    /// Steps of 30 ms fit into a frame once, while frames of 50 ms ask for 2.5.
    #[test]
    fn steps_that_take_too_long_are_dropped_and_told() {
        let mut pace = Pace::new(0.02);
        pace.real_time = true;
        pace.note_cost(1, 0.03);
        let done: u64 = (0..100).map(|_| pace.due(0.05)).sum();
        assert!((99..=100).contains(&done), "{done}");
        let lag = pace.lag().expect("it cannot keep up");
        assert!((lag - 0.4).abs() < 0.03, "1 of 2.5 steps, not {lag}");
        // Half the speed and less asks for less: it keeps up again.
        pace.change_speed(false);
        pace.change_speed(false);
        (0..100).for_each(|_| {
            pace.due(0.05);
        });
        assert_eq!(pace.lag(), None);
    }
}
