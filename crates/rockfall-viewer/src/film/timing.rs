//! Times of the pictures of a film.

/// Determines when the pictures of a film are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Number of steps in the film.
    pub steps: u64,
    /// Time step in s.
    pub dt: f32,
    /// Pictures per second.
    pub fps: u32,
    /// Simulated seconds per second of film; 1 is real time.
    pub speed: f64,
}

/// A moment of the simulated time, in steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Number of whole steps before it.
    pub step: u64,
    /// Fraction of the next step that has passed, from 0 to less than 1.
    pub blend: f32,
}

impl Timing {
    /// Returns the time step as the decimal number that was given: 0.02, not 0.019999999552965164.
    fn step_seconds(&self) -> f64 {
        self.dt.to_string().parse().unwrap_or(f64::from(self.dt))
    }

    /// Returns the number of pictures: one at the start, and one at each further picture time up to the end of the last step.
    pub fn pictures(&self) -> u64 {
        let seconds = self.steps as f64 * self.step_seconds() / self.speed;
        // A rounding error must not drop the last picture.
        (seconds * f64::from(self.fps) + 1e-6).floor() as u64 + 1
    }

    /// Returns the moment of picture `index`.
    pub fn moment(&self, index: u64) -> Moment {
        let steps = index as f64 * self.speed / f64::from(self.fps) / self.step_seconds();
        let step = (steps + 1e-5).floor();
        let blend = (steps - step) as f32;
        if step as u64 >= self.steps || blend < 1e-4 {
            return Moment { step: (step as u64).min(self.steps), blend: 0.0 };
        }
        Moment { step: step as u64, blend }
    }
}

/// Number of states from which the camera and the colour scale of a film are chosen.
const SURVEYED: usize = 100;

/// Returns the moments from which the camera and the colour scale of a film are chosen: every n-th, and the last one.
pub fn surveyed(moments: &[Moment]) -> impl Iterator<Item = Moment> {
    let stride = moments.len().div_ceil(SURVEYED).max(1);
    let last = moments.last().filter(|_| !(moments.len() - 1).is_multiple_of(stride)).copied();
    moments.iter().step_by(stride).copied().chain(last)
}

/// Number of states from which the axes of plots are chosen.
const PLOTTED: u64 = 400;

/// Returns the states from which the axes of the plots of a film are chosen too: steps at regular intervals, and the last one.
pub fn plotted(moments: &[Moment]) -> Vec<Moment> {
    let (Some(first), Some(last)) = (moments.first(), moments.last()) else { return Vec::new() };
    let (first, last) = (first.step, last.step + u64::from(last.blend > 0.0));
    let stride = (last - first).div_ceil(PLOTTED).max(1);
    let steps = (first..last).step_by(stride as usize).chain([last]);
    steps.map(|step| Moment { step, blend: 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_of_plots_follow_from_all_steps_of_a_short_film() {
        let moments = |last: u64, blend: f32| [Moment { step: 2, blend: 0.5 }, Moment { step: last, blend }];
        let steps = |last, blend| plotted(&moments(last, blend)).iter().map(|moment| moment.step).collect::<Vec<u64>>();
        assert_eq!((steps(5, 0.0), steps(5, 0.5)), (vec![2, 3, 4, 5], vec![2, 3, 4, 5, 6]));
        assert_eq!((steps(4003, 0.0).len(), steps(4003, 0.0).last()), (365, Some(&4003)));
        assert!(plotted(&[]).is_empty());
    }

    #[test]
    fn pictures_at_the_rate_of_the_steps_need_no_blending() {
        let timing = Timing { steps: 100, dt: 0.02, fps: 50, speed: 1.0 };
        assert_eq!(timing.pictures(), 101);
        for index in 0..=100 {
            assert_eq!(timing.moment(index), Moment { step: index, blend: 0.0 });
        }
    }

    #[test]
    fn pictures_at_other_rates_lie_between_two_states() {
        let timing = Timing { steps: 10, dt: 0.02, fps: 30, speed: 1.0 };
        // 0.2 s at 30 pictures per second: at 0, 1/30, ... 6/30 s.
        assert_eq!(timing.pictures(), 7);
        let second = timing.moment(1);
        assert_eq!(second.step, 1);
        assert!((second.blend - 2.0 / 3.0).abs() < 1e-5);
        assert_eq!(timing.moment(6), Moment { step: 10, blend: 0.0 });
    }

    #[test]
    fn slow_motion_takes_more_pictures() {
        let timing = Timing { steps: 10, dt: 0.02, fps: 30, speed: 0.5 };
        assert_eq!(timing.pictures(), 13);
        assert_eq!(timing.moment(3).step, 2);
        assert!((timing.moment(3).blend - 0.5).abs() < 1e-5);
    }

    #[test]
    fn a_survey_has_at_most_about_a_hundred_moments_and_the_last() {
        let moments: Vec<_> = (0..251).map(|step| Moment { step, blend: 0.0 }).collect();
        let steps: Vec<u64> = surveyed(&moments).map(|moment| moment.step).collect();
        assert_eq!((steps.len(), &steps[..3], steps.last()), (85, &[0, 3, 6][..], Some(&250)));
        assert_eq!(surveyed(&moments[..2]).count(), 2);
        assert_eq!(surveyed(&[]).count(), 0);
    }
}
