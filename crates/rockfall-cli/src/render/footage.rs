//! The states that a picture or a film shows: of a simulation that runs, or of a trajectory.

use rockfall::exec::gpu::Gpu;
use rockfall::{Backend, Checkpoint, Energy, Options, Scene, Simulation};
use rockfall_trajectory::{Moment as FrameTime, Reader};
use rockfall_viewer::camera::Vertical;
use rockfall_viewer::draw::{Renderer, Style};
use rockfall_viewer::film::{Moment, Player, Timing};
use rockfall_viewer::survey::Survey;

use super::At;
use crate::aftermath;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::as_written;
use crate::progress::Progress;

/// The states that a picture or a film shows.
pub(super) enum Footage {
    Live(Box<Live>),
    Recorded(Box<Recorded>),
}

/// About the greatest number of states before the first one that are looked at for trails, and for plots.
const STATES: u64 = 200;

/// The states before the first one that are looked at.
#[derive(Clone, Copy)]
pub(super) struct Past {
    /// Length of trails, in s.
    pub(super) trails: f64,
    /// Whether the states from the start on are looked at.
    pub(super) whole: bool,
}

/// Is called with states and their times.
type Look<'a> = &'a mut dyn FnMut(&mut Simulation, f64) -> rockfall::Result<()>;

/// Which part of the states a film shows.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    pub(super) fps: u32,
    /// Simulated seconds per second of film; `None` for that of the scene.
    pub(super) speed: Option<f64>,
    /// Number of steps; `None` for all.
    pub(super) steps: Option<u64>,
}

impl Cut {
    fn speed(self, scene: &Scene) -> f64 {
        self.speed.or(scene.run.speed).unwrap_or(1.0)
    }
}

impl Footage {
    pub(super) fn simulation(&mut self) -> &mut Simulation {
        match self {
            Self::Live(live) => &mut live.simulation,
            Self::Recorded(recorded) => &mut recorded.simulation,
        }
    }

    /// Goes to the first state: after the steps or the time `at`, or to the step or the time `at` of a trajectory. `None` is the start. `look` is called with states
    /// before it, and their times.
    pub(super) fn go_to(
        &mut self,
        at: Option<At>,
        past: Past,
        mut look: impl FnMut(&mut Simulation, f64) -> rockfall::Result<()>,
    ) -> Result<(), Failure> {
        match self {
            Self::Live(live) => live.go_to(at.map_or(0, |at| live.steps_to(at)), past, &mut look),
            Self::Recorded(recorded) => recorded.go_to(at, past, &mut look),
        }
    }

    /// The time of the first state.
    pub(super) fn start_time(&self) -> f64 {
        match self {
            Self::Live(live) => live.start_time,
            Self::Recorded(recorded) => recorded.reader.moments()[recorded.start.step as usize].time,
        }
    }

    /// The time of a moment of a film.
    pub(super) fn time_of(&self, moment: Moment) -> f64 {
        match self {
            Self::Live(live) => live.start_time + (moment.step as f64 + f64::from(moment.blend)) * f64::from(live.dt),
            Self::Recorded(recorded) => recorded.time_of(moment),
        }
    }

    /// Prints the warnings of `run` at the end of a simulation.
    pub(super) fn warn(&mut self) -> Result<(), Failure> {
        match self {
            Self::Live(live) if live.simulation.report().steps > live.start.0 => {
                let step = live.simulation.report().steps / u64::from(live.parts);
                aftermath::warn(&live.name, &mut live.simulation, Some(&live.start.1), step)
            }
            _ => Ok(()),
        }
    }

    /// The moments of the pictures of a film that starts at the present state.
    pub(super) fn moments(&self, cut: Cut) -> Result<Vec<Moment>, Failure> {
        match self {
            Self::Live(live) => {
                let timing = live.timing(cut);
                Ok((0..timing.pictures()).map(|index| timing.moment(index)).collect())
            }
            Self::Recorded(recorded) => recorded.moments(cut),
        }
    }

    /// Shows a moment, which must not be before the last one.
    pub(super) fn show(&mut self, renderer: &mut Renderer, style: &Style, moment: Moment) -> rockfall::Result<()> {
        match self {
            Self::Live(live) => live.show(renderer, style, moment),
            Self::Recorded(recorded) => recorded.show(renderer, style, moment),
        }
    }

    /// Goes through states of a film and back to its first state. `look` is called for every state.
    pub(super) fn survey(
        &mut self,
        moments: &[Moment],
        up: Vertical,
        mut look: impl FnMut(&mut Simulation, f64) -> rockfall::Result<()>,
    ) -> Result<Survey, Failure> {
        let new = |scene: &Scene| Survey::with_up(scene, up.of(scene));
        let mut survey: Option<Survey> = None;
        let mut add = |simulation: &mut Simulation, time: f64| -> rockfall::Result<()> {
            look(simulation, time)?;
            let scene = simulation.sync()?;
            match &mut survey {
                Some(survey) => survey.add(scene),
                None => survey = Some(new(scene)),
            }
            Ok(())
        };
        match self {
            Self::Live(live) => live.each_state(moments, &mut add)?,
            Self::Recorded(recorded) => recorded.each_state(moments, &mut add)?,
        }
        Ok(survey.unwrap_or_else(|| new(self.simulation().scene())))
    }
}

/// A simulation that runs.
pub(super) struct Live {
    name: String,
    simulation: Simulation,
    /// The number of steps and the energy at the start.
    start: (u64, Energy),
    player: Player,
    dt: f32,
    parts: u32,
    interrupt: &'static Interrupt,
    /// The time of the first picture.
    start_time: f64,
}

impl Live {
    /// `parts` is the number of equal parts of a step of `dt` seconds.
    pub(super) fn new(
        name: String,
        mut simulation: Simulation,
        dt: f32,
        parts: u32,
        interrupt: &'static Interrupt,
    ) -> Result<Self, Failure> {
        simulation.set_time_step(dt / parts as f32)?;
        let start = (simulation.report().steps, simulation.energy()?);
        Ok(Self { name, simulation, start, player: Player::new(dt).parts(parts), dt, parts, interrupt, start_time: 0.0 })
    }

    fn timing(&self, cut: Cut) -> Timing {
        Timing {
            steps: cut.steps.or(self.simulation.scene().run.steps).unwrap_or(0),
            dt: self.dt,
            fps: cut.fps,
            speed: cut.speed(self.simulation.scene()),
        }
    }

    fn show(&mut self, renderer: &mut Renderer, style: &Style, moment: Moment) -> rockfall::Result<()> {
        self.player.show(&mut self.simulation, renderer, style, moment)
    }

    fn run(&mut self, steps: u64) -> Result<(), Failure> {
        let parts = self.parts;
        let moved = self.simulation.run(steps.saturating_mul(u64::from(parts)), self.dt / parts as f32);
        moved.map(drop).map_err(|error| Failure::of(error, self.simulation.scene()))
    }

    /// The number of steps to a moment.
    fn steps_to(&self, at: At) -> u64 {
        match at {
            At::Step(step) => step,
            At::Time(time) => (time / as_written(self.dt)).round() as u64,
        }
    }

    /// Runs the steps before the first state.
    fn go_to(&mut self, at: u64, past: Past, look: Look<'_>) -> Result<(), Failure> {
        let mut progress = Progress::new(at);
        let trails = ((past.trails / f64::from(self.dt)).ceil() as u64).min(at);
        let before = at - trails;
        self.go(before, if past.whole { before } else { 0 }, look, &mut progress)?;
        self.go(trails, trails, look, &mut progress)
    }

    /// Runs steps. `look` is called with about [`STATES`] states of the last ones.
    fn go(&mut self, steps: u64, mut last: u64, look: Look<'_>, progress: &mut Progress) -> Result<(), Failure> {
        self.advance_with(steps - last, progress)?;
        let stride = last.div_ceil(STATES).max(1);
        while last > 0 {
            let time = self.simulation.report().time;
            look(&mut self.simulation, time)?;
            let steps = stride.min(last);
            self.advance_with(steps, progress)?;
            last -= steps;
        }
        self.start_time = self.simulation.report().time;
        Ok(())
    }

    fn advance_with(&mut self, steps: u64, progress: &mut Progress) -> Result<(), Failure> {
        let mut left = steps;
        while left > 0 {
            let chunk = progress.chunk().min(left);
            self.run(chunk)?;
            left -= chunk;
            progress.advance(chunk);
            if left > 0 && self.interrupt.is_requested() {
                return Err(Failure::Interrupted(format!("stopped {left} steps before the first picture")));
            }
        }
        Ok(())
    }

    /// Runs through all moments, then restores the first state, from which the film then takes the same steps.
    fn each_state(&mut self, moments: &[Moment], look: Look<'_>) -> Result<(), Failure> {
        let start: Checkpoint = self.simulation.checkpoint()?;
        let mut progress = Progress::survey(moments.last().map_or(0, |moment| moment.step));
        let mut done = 0;
        for moment in moments {
            self.advance_with(moment.step - done, &mut progress)?;
            done = moment.step;
            let time = self.simulation.report().time;
            look(&mut self.simulation, time)?;
        }
        Ok(self.simulation.restore(&start)?)
    }
}

/// A trajectory, and a simulation that takes its states. Its steps are the frames of the trajectory.
pub(super) struct Recorded {
    name: String,
    reader: Reader,
    simulation: Simulation,
    /// The moment that the picture or the film starts at.
    start: Moment,
    /// The frame that the simulation has.
    present: Option<usize>,
}

impl Recorded {
    pub(super) fn new(name: String, reader: Reader) -> Result<Self, Failure> {
        let options = Options::new().backend(Backend::Cpu);
        let mut simulation = Simulation::with_options(reader.scene().clone(), options)?;
        if let [first, second, ..] = reader.moments()
            && second.step > first.step
        {
            // Forces of collisions depend on the time step.
            let dt = (second.time - first.time) / (second.step - first.step) as f64;
            if dt > 0.0 {
                simulation.set_time_step(dt as f32)?;
            }
        }
        Ok(Self { name, reader, simulation, start: Moment { step: 0, blend: 0.0 }, present: None })
    }

    fn ends(&self) -> [FrameTime; 2] {
        let moments = self.reader.moments();
        [moments[0], moments[moments.len() - 1]]
    }

    /// The moment of a value of the frames that rises, such as time or step.
    fn moment_of(&self, value: f64, of: impl Fn(&FrameTime) -> f64) -> Moment {
        let frames = self.reader.moments();
        let after = frames.partition_point(|frame| of(frame) <= value + 1e-9 * value.abs());
        let frame = after.saturating_sub(1);
        let blend = frames
            .get(after)
            .filter(|_| after > 0)
            .map_or(0.0, |next| (value - of(&frames[frame])) / (of(next) - of(&frames[frame])).max(f64::MIN_POSITIVE));
        // As for a simulation that runs, a moment close to a state is that state.
        if blend > 1.0 - 1e-5 {
            return Moment { step: frame as u64 + 1, blend: 0.0 };
        }
        Moment { step: frame as u64, blend: if blend < 1e-4 { 0.0 } else { blend as f32 } }
    }

    fn go_to(&mut self, at: Option<At>, past: Past, look: Look<'_>) -> Result<(), Failure> {
        let [first, last] = self.ends();
        self.start = match at.unwrap_or(At::Step(first.step)) {
            At::Step(step) if (first.step..=last.step).contains(&step) => {
                self.moment_of(step as f64, |frame| frame.step as f64)
            }
            At::Time(time) if (first.time..=last.time).contains(&time) => self.moment_of(time, |frame| frame.time),
            At::Step(step) => return Err(self.outside(&format!("--at {step}"), first.step, last.step)),
            At::Time(time) => {
                let (name, from, to) = (&self.name, first.time, last.time);
                return Err(Failure::usage(format!("--at {time}s: {name} has the times {from} to {to} s")));
            }
        };
        let start = self.start.step as usize;
        let oldest = self.reader.moments()[start].time - past.trails;
        let trails = self.reader.moments()[..start].iter().filter(|frame| frame.time >= oldest).count();
        let trails = if past.trails > 0.0 { start - trails } else { start };
        for frames in [if past.whole { 0 } else { trails }..trails, trails..start] {
            let stride = frames.len().div_ceil(STATES as usize).max(1);
            for frame in frames.step_by(stride) {
                self.apply(frame)?;
                look(&mut self.simulation, self.reader.moments()[frame].time)?;
            }
        }
        Ok(self.apply(start)?)
    }

    fn outside(&self, what: &str, first: u64, last: u64) -> Failure {
        Failure::usage(format!("{what}: {} has the steps {first} to {last}", self.name))
    }

    fn time_of(&self, Moment { step, blend }: Moment) -> f64 {
        let frames = self.reader.moments();
        let from = frames[step as usize].time;
        frames.get(step as usize + 1).map_or(from, |next| from + f64::from(blend) * (next.time - from))
    }

    fn moments(&self, cut: Cut) -> Result<Vec<Moment>, Failure> {
        let frames = self.reader.moments();
        let [first, last] = self.ends();
        let from = self.time_of(self.start);
        let until = match cut.steps {
            None => last.time,
            Some(steps) => {
                let begin = frames[self.start.step as usize];
                let at = begin.step as f64
                    + f64::from(self.start.blend)
                        * frames.get(self.start.step as usize + 1).map_or(0.0, |next| (next.step - begin.step) as f64);
                let end = at.round() as u64 + steps;
                if end > last.step {
                    return Err(self.outside(&format!("--steps {steps}"), first.step, last.step));
                }
                self.time_of(self.moment_of(end as f64, |frame| frame.step as f64))
            }
        };
        let speed = cut.speed(self.simulation.scene());
        let count = ((until - from) * f64::from(cut.fps) / speed + 1e-6).floor().max(0.0) as u64 + 1;
        let time = |index: u64| from + index as f64 * speed / f64::from(cut.fps);
        Ok((0..count).map(|index| self.moment_of(time(index).min(until), |frame| frame.time)).collect())
    }

    /// Gives the states of a frame to the simulation.
    fn apply(&mut self, frame: usize) -> rockfall::Result<()> {
        if self.present != Some(frame) {
            self.reader.show(frame, &mut self.simulation)?;
            self.present = Some(frame);
        }
        Ok(())
    }

    fn show(&mut self, renderer: &mut Renderer, style: &Style, moment: Moment) -> rockfall::Result<()> {
        self.apply(moment.step as usize)?;
        renderer.update(&mut self.simulation, style)?;
        let time = |frame: usize| self.reader.moments()[frame].time;
        renderer.set_time(time(moment.step as usize));
        if moment.blend > 0.0 {
            renderer.remember();
            let next = moment.step as usize + 1;
            let next_time = time(next);
            self.apply(next)?;
            renderer.update(&mut self.simulation, style)?;
            renderer.set_time(next_time);
        }
        renderer.set_blend(if moment.blend > 0.0 { moment.blend } else { 1.0 });
        Ok(())
    }

    fn each_state(&mut self, moments: &[Moment], look: Look<'_>) -> Result<(), Failure> {
        for moment in moments {
            self.apply(moment.step as usize)?;
            look(&mut self.simulation, self.reader.moments()[moment.step as usize].time)?;
        }
        Ok(self.apply(self.start.step as usize)?)
    }
}

/// The device to draw on: that of the simulation, or for a simulation on the CPU any adapter, including software.
pub(super) fn device(simulation: &Simulation) -> Result<Gpu, Failure> {
    match simulation.gpu_view() {
        Some(view) => Ok(view.gpu().clone()),
        None => Gpu::open_blocking(true).map_err(|error| {
            Failure::Run(format!(
                "drawing needs a graphics adapter, even with --backend cpu; software Vulkan is enough: {error}"
            ))
        }),
    }
}
