//! Films of simulations.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::exceptions::{PyIndexError, PyKeyError, PyValueError};
use pyo3::prelude::*;
use rockfall::Checkpoint;
use rockfall_viewer::camera::Camera;
use rockfall_viewer::draw::{Range, Style};
use rockfall_viewer::film::{Follower, Format, Moment, Player, Reel, Shot, Subject, Timing, View, plotted, surveyed};
use rockfall_viewer::legend::Corner;
use rockfall_viewer::overlay::Overlay;
use rockfall_viewer::plot::{Graph, named};
use rockfall_viewer::survey::Survey;

use crate::errors::Raise;
use crate::film::live::Seen;
use crate::fork::{Owned, detached};
use crate::ids::handle;
use crate::picture::{Look, Picture, Tools};
use crate::simulation::Simulation;

mod live;

/// A film that is being taken. First [`Filming::survey`] is called until it returns false, then [`Filming::rewind`], then
/// [`Filming::take`] until it returns false, then [`Filming::finish`]. Python calls them in turn to handle signals in between.
///
/// A live film is of steps that Python runs: [`Filming::see`] is called after [`Filming::due`] steps, then [`Filming::end`].
#[pyclass(frozen, module = "rockfall._rockfall")]
pub(crate) struct Filming(Mutex<Owned<Shooting>>);

/// The body that a camera follows.
#[derive(FromPyObject)]
enum Followed {
    Number(i64),
    Name(String),
}

struct Shooting {
    tools: Tools,
    look: Look,
    style: Style,
    overlay: Overlay,
    view: View,
    timing: Timing,
    moments: Vec<Moment>,
    /// The state before the survey.
    start: Option<Checkpoint>,
    /// What remains of the survey, in reverse order; the number of its steps so far; what it found.
    to_survey: Vec<Moment>,
    surveyed_steps: u64,
    survey: Option<Survey>,
    /// The upper end of a colour scale that is chosen.
    scale: Option<f32>,
    shot: Option<Shot>,
    /// Where the legend is; `None` without one.
    corner: Option<Corner>,
    player: Player,
    follower: Follower,
    first_step: u64,
    reel: Reel,
    seen: Seen,
}

impl Shooting {
    fn new(
        simulation: &mut rockfall::Simulation,
        look: Look,
        graphs: Vec<Graph>,
        timing: Timing,
        follow: Option<Subject>,
        orbit: f32,
        live: bool,
    ) -> PyResult<Self> {
        let (style, overlay) = (look.style()?, look.overlay()?);
        let view = View {
            from: look.direction()?,
            camera: look.camera.map(Into::into),
            look_at: look.look_at.map(Into::into),
            follow,
            orbit: orbit.to_radians(),
            room_above: overlay.room_above(look.layout().scene()),
        };
        let scale = (!live && look.range.is_none() && style.colour_by.title().is_some()).then_some(0.0);
        let moments: Vec<_> = (0..timing.pictures()).map(|index| timing.moment(index)).collect();
        let scene = simulation.sync().or_raise()?;
        let has_camera = view.camera.is_some() && (view.look_at.is_some() || view.follow.is_some());
        // Static objects that hide bodies are found by the survey too.
        let is_known = live
            || has_camera
                && scale.is_none()
                && overlay.arrows.is_none()
                && graphs.is_empty()
                && scene.boxes().is_empty()
                && scene.polygons().is_empty();
        let mut to_survey: Vec<_> = match is_known {
            true => Vec::new(),
            false if graphs.is_empty() => surveyed(&moments).collect(),
            false => plotted(&moments),
        };
        to_survey.reverse();
        let up = look.up(scene)?;
        let survey = is_known.then(|| Survey::with_up(scene, up));
        let start = if is_known { None } else { Some(simulation.checkpoint().or_raise()?) };
        let mut tools = Tools::new(simulation, look.layout().scene().into())?;
        tools.renderer.set_overlay(&overlay);
        tools.renderer.set_plots(graphs);
        Ok(Self {
            tools,
            overlay,
            player: Player::new(timing.dt),
            first_step: simulation.report().steps,
            surveyed_steps: 0,
            shot: None,
            corner: None,
            follower: Follower::default(),
            reel: Reel::new(),
            seen: Seen::default(),
            look,
            style,
            view,
            timing,
            moments,
            start,
            to_survey,
            survey,
            scale,
        })
    }

    /// Looks at the next state from which the camera and the colour scale are chosen.
    fn survey(&mut self, simulation: &mut rockfall::Simulation) -> PyResult<bool> {
        let Some(moment) = self.to_survey.pop() else {
            return Ok(false);
        };
        simulation.run(moment.step - self.surveyed_steps, self.timing.dt).or_raise()?;
        self.surveyed_steps = moment.step;
        self.note(simulation)?;
        Ok(true)
    }

    /// Takes what the camera and the colour scale depend on from a state.
    fn note(&mut self, simulation: &mut rockfall::Simulation) -> PyResult<()> {
        let has_arrows = self.overlay.arrows.is_some();
        if self.scale.is_some() || has_arrows || !self.tools.renderer.motion().plots().is_empty() {
            self.tools.renderer.update(simulation, &self.style).or_raise()?;
            self.tools.renderer.record();
        }
        if let Some(scale) = &mut self.scale {
            *scale = scale.max(self.tools.renderer.range(&self.style)[1]);
        }
        if has_arrows {
            let key = self.tools.renderer.motion().arrow_key();
            self.overlay.arrow_key = Some(self.overlay.arrow_key.map_or(key, |before| before.max(key)));
        }
        let scene = simulation.sync().or_raise()?;
        match &mut self.survey {
            Some(survey) => survey.add(scene),
            None => self.survey = Some(Survey::with_up(scene, self.look.up(scene)?)),
        }
        Ok(())
    }

    /// Looks at a further state of a live film, before the first picture, from which the camera and the colour scale are chosen.
    fn look(&mut self, simulation: &mut rockfall::Simulation) -> PyResult<()> {
        if self.scale.is_none() && self.look.range.is_none() && self.style.colour_by.title().is_some() {
            self.scale = Some(0.0);
        }
        self.note(simulation)
    }

    /// Takes the next picture.
    fn take(&mut self, simulation: &mut rockfall::Simulation) -> PyResult<bool> {
        let index = self.reel.len();
        let Some(moment) = self.moments.get(index).copied() else {
            return Ok(false);
        };
        let shot = match self.shot {
            Some(shot) => shot,
            None => self.begin(simulation)?,
        };
        let Self { tools, player, style, follower, .. } = self;
        let mut show = |moment| player.show(simulation, &mut tools.renderer, style, moment);
        let followed = match &self.view.follow {
            None => show(moment).map(|()| None),
            Some(subject) => {
                let show = |moment| {
                    player.show(simulation, &mut tools.renderer, style, moment)?;
                    subject.place(simulation.sync()?)
                };
                follower.show(moment, show).map(Some)
            }
        };
        let camera = shot.at(index as f64 / f64::from(self.timing.fps), followed.or_raise()?);
        let picture = self.picture(&camera)?;
        self.reel.push(&picture).or_raise()?;
        Ok(true)
    }

    /// Draws the state that the renderer has, with the plots beside it.
    fn picture(&mut self, camera: &Camera) -> PyResult<rockfall_viewer::picture::Picture> {
        let picture = self.tools.take(camera, &self.style, &self.overlay, self.corner)?;
        self.look.layout().complete(picture, self.tools.renderer.motion().plots()).or_raise()
    }

    /// Chooses the camera, before the first picture.
    fn begin(&mut self, simulation: &mut rockfall::Simulation) -> PyResult<Shot> {
        let [width, height] = self.look.layout().scene();
        let scene = simulation.sync().or_raise()?;
        let up = self.look.up(scene)?;
        let survey = self.survey.take().unwrap_or_else(|| Survey::with_up(scene, up));
        let shot = Shot::new(&self.view, &survey, scene, width as f32 / height as f32).or_raise()?;
        let shot =
            shot.ok_or_else(|| PyValueError::new_err("camera and look_at are the same point, expected two different points"))?;
        if let Some(scale) = self.scale {
            // The colours mean the same in all pictures.
            self.style.range = Range::Given(self.style.colour_by.range_to(scale));
        }
        if self.look.colour_by.is_some() {
            let legend = self.tools.renderer.legend(&self.style);
            self.corner = Some(self.overlay.corner(&legend, &survey, &shot.camera(), [width, height]));
        }
        self.tools.renderer.set_scene(simulation);
        self.tools.renderer.set_survey(survey);
        let steps = self.moments.last().map_or(0.0, |last| last.step as f64 + f64::from(last.blend));
        let (start, length) = (simulation.report().time, steps * f64::from(self.timing.dt));
        self.tools.renderer.fix_plots([start, start + length]);
        self.shot = Some(shot);
        Ok(shot)
    }
}

impl Filming {
    fn lock(&self) -> MutexGuard<'_, Owned<Shooting>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn with<R: Send>(
        &self,
        simulation: &Bound<'_, Simulation>,
        call: impl FnOnce(&mut Shooting, &mut rockfall::Simulation) -> PyResult<R> + Send,
    ) -> PyResult<R> {
        simulation.get().change(simulation.py(), |simulation| {
            let mut shooting = self.lock();
            shooting.check(true)?;
            call(&mut shooting, simulation)
        })
    }
}

#[pymethods]
impl Filming {
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        simulation: &Bound<'_, Simulation>,
        look: Look,
        steps: u64,
        dt: f32,
        fps: u32,
        speed: Option<f64>,
        follow: Option<Followed>,
        orbit: f32,
        live: bool,
    ) -> PyResult<Self> {
        simulation.get().read(simulation.py(), |running| {
            let scene = running.simulation.scene();
            let timing = Timing { steps, dt, fps, speed: speed.or(scene.run.speed).unwrap_or(1.0) };
            let find = |followed: Followed| match followed {
                Followed::Number(number) => handle(&running.ids.spheres, "sphere", number),
                Followed::Name(name) => named(scene, &name).map_err(|error| PyKeyError::new_err(format!("follow: {error}"))),
            };
            let follow = follow.map(find).transpose()?.map(|sphere| Subject::of(scene, sphere));
            let mut look = look;
            look.find_trails(running.simulation.scene(), &running.ids)?;
            let graphs = look.graphs(running.simulation.scene(), &running.ids)?;
            let shooting = Shooting::new(&mut running.simulation, look, graphs, timing, follow, orbit, live)?;
            Ok(Self(Mutex::new(Owned::new(shooting))))
        })
    }

    /// Number of pictures.
    fn count(&self) -> usize {
        self.lock().moments.len()
    }

    fn survey(&self, simulation: &Bound<'_, Simulation>) -> PyResult<bool> {
        self.with(simulation, Shooting::survey)
    }

    /// Restores the state before the survey. Handles stay valid.
    fn rewind(&self, simulation: &Bound<'_, Simulation>) -> PyResult<()> {
        self.with(simulation, |shooting, simulation| match shooting.start.take() {
            Some(start) => simulation.restore(&start).or_raise(),
            None => Ok(()),
        })
    }

    fn take(&self, simulation: &Bound<'_, Simulation>) -> PyResult<bool> {
        self.with(simulation, Shooting::take)
    }

    /// Number of steps before the next state that a live film must see; `None` when all pictures are taken.
    fn due(&self) -> Option<u64> {
        self.lock().due()
    }

    /// Looks at a state of a live film before its first picture.
    fn look(&self, simulation: &Bound<'_, Simulation>) -> PyResult<()> {
        self.with(simulation, Shooting::look)
    }

    /// Sees the state after a number of steps. The simulation may be another one each time, with the same objects.
    fn see(&self, simulation: &Bound<'_, Simulation>, step: u64) -> PyResult<()> {
        self.with(simulation, |shooting, simulation| shooting.see(simulation, step))
    }

    /// Returns a live film with the pictures so far.
    fn end(&self) -> Film {
        Film(std::mem::take(&mut self.lock().reel))
    }

    /// Runs the steps after the last picture, and returns the film.
    fn finish(&self, simulation: &Bound<'_, Simulation>) -> PyResult<Film> {
        self.with(simulation, |shooting, simulation| {
            let done = simulation.report().steps - shooting.first_step;
            simulation.run(shooting.timing.steps.saturating_sub(done), shooting.timing.dt).or_raise()?;
            Ok(Film(std::mem::take(&mut shooting.reel)))
        })
    }
}

/// A film in memory.
#[pyclass(frozen, module = "rockfall._rockfall")]
pub(crate) struct Film(Reel);

#[pymethods]
impl Film {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn picture(&self, py: Python<'_>, index: usize) -> PyResult<Picture> {
        let picture = detached(py, || self.0.picture(index));
        picture.map(Picture).ok_or_else(|| PyIndexError::new_err(format!("there is no picture {index}")))
    }

    fn save(&self, py: Python<'_>, path: PathBuf, fps: u32) -> PyResult<()> {
        let Some(format) = Format::of(&path) else {
            let text = format!(
                "path: expected a name that ends in .mp4, .webm, .gif or .apng, or a folder name that ends in /, got {}",
                path.display()
            );
            return Err(PyValueError::new_err(text));
        };
        if format == Format::Gif && fps > 50 {
            return Err(PyValueError::new_err(format!("fps: a GIF has at most 50 pictures per second, got {fps}")));
        }
        detached(py, || self.0.write(&path, format, fps)).or_raise()
    }
}
