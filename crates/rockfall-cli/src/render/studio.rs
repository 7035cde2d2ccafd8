//! Draws the pictures.

use rockfall::Scene;
use rockfall::glam::Vec3;
use rockfall::output::AtomicFile;
use rockfall_viewer::camera::Camera;
use rockfall_viewer::draw::{FrameTimes, Pass, Range, Renderer, Style};
use rockfall_viewer::film::{self, Follower, Format, Moment, Subject, plotted, surveyed};
use rockfall_viewer::legend::Corner;
use rockfall_viewer::overlay::Overlay;
use rockfall_viewer::picture::{Canvas, FORMAT, Picture};
use rockfall_viewer::plot::Plot;
use rockfall_viewer::survey::Survey;

use super::camera::{Named, Shot};
use super::footage::{Footage, Past, device};
use super::{Arguments, At, Product, colours};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::counted;
use crate::output;
use crate::progress::Progress;
use crate::render::captions::{find_trails, warn_of_letters};
use crate::render::plots::check_names;

/// Quality of a JPEG file, from 1 to 100: no artefacts that the eye sees at the edges of bodies.
const JPEG_QUALITY: u8 = 92;

/// The states to draw, and everything needed to draw them.
pub(super) struct Studio {
    footage: Footage,
    renderer: Renderer,
    canvas: Canvas,
    style: Style,
    overlay: Overlay,
    /// Where the legend is.
    corner: Corner,
    interrupt: &'static Interrupt,
}

impl Studio {
    pub(super) fn new(arguments: &Arguments, mut footage: Footage, interrupt: &'static Interrupt) -> Result<Self, Failure> {
        let gpu = device(footage.simulation())?;
        let [width, height] = arguments.layout().scene();
        let canvas = Canvas::new(gpu.device(), gpu.queue(), width, height)?;
        let mut renderer = Renderer::new(gpu.device(), gpu.queue(), FORMAT)?;
        let mut style = arguments.style();
        let is_recorded = matches!(footage, Footage::Recorded(_));
        let simulation = footage.simulation();
        colours::check_tension(style.colour_by, is_recorded, simulation.scene())?;
        for (object, tag) in colours::apply(&arguments.colour, simulation.scene(), &mut style)? {
            simulation.set_tag(object, tag)?;
        }
        let mut overlay = arguments.captions.overlay();
        overlay.dark = style.background.is_dark();
        let scene = footage.simulation().scene();
        warn_of_letters(&overlay, scene);
        find_trails(&mut overlay, scene)?;
        renderer.set_overlay(&overlay);
        let find = |name: &String| Named::parse(name).map_err(Failure::usage)?.bodies(scene, "--plot");
        for plot in &arguments.plot {
            check_names(plot, is_recorded, scene)?;
        }
        let graph = |plot: &Plot| {
            let found: Vec<_> = plot.bodies().iter().map(find).collect::<Result<_, Failure>>()?;
            plot.of(scene, &found).map_err(|error| Failure::usage(format!("--plot: {error}")))
        };
        let graphs: Result<_, Failure> = arguments.plot.iter().map(graph).collect();
        renderer.set_plots(graphs?);
        Ok(Self { footage, renderer, canvas, style, overlay, corner: Corner::default(), interrupt })
    }

    pub(super) fn picture(mut self, arguments: &Arguments, product: Product) -> Result<(), Failure> {
        let path = &arguments.out;
        let mut file = AtomicFile::create(path).map_err(|error| Failure::file(path, &error))?;
        let start = match &mut self.footage {
            Footage::Live(_) if self.overlay.trails == 0.0 => Some(survey_of(self.footage.simulation().sync()?, arguments)),
            _ => None,
        };
        self.go_to_start(arguments, false)?;
        let simulation = self.footage.simulation();
        let scene = simulation.sync()?;
        let mut survey = survey_of(scene, arguments);
        if let Some(start) = start {
            survey = survey.from_start(start, scene);
        }
        survey.add_trails(self.renderer.motion().past(&self.overlay.trails_of));
        let shot = Shot::new(arguments, &survey, simulation)?;
        let camera = shot.at(0.0, None);
        self.renderer.start_from(simulation);
        self.renderer.update(simulation, &self.style)?;
        self.place_legend(arguments, &survey, &camera);
        self.renderer.set_time(self.footage.start_time());
        let picture = self.take(&camera, arguments)?;
        if let Some(frames) = arguments.bench {
            self.bench(arguments, &camera, frames)?;
        }
        let written = match product {
            Product::Jpeg => picture.write_jpeg(&mut file, JPEG_QUALITY),
            _ => picture.write_png(&mut file),
        };
        written.and_then(|()| file.commit()).map_err(|error| Failure::file(path, &error))?;
        let [width, height] = arguments.size;
        self.finish(arguments, &shot, &format!("{width}x{height} pixels"))
    }

    /// Goes to the first state, and takes the states in the past that trails and the plots of a picture show.
    fn go_to_start(&mut self, arguments: &Arguments, is_film: bool) -> Result<(), Failure> {
        let past = Past { trails: self.overlay.trails, whole: !is_film && !arguments.plot.is_empty() };
        let Self { footage, renderer, style, .. } = self;
        let mut at = arguments.at;
        if at.is_none() && !is_film && matches!(footage, Footage::Live(_)) {
            // Where all bodies come later, a picture shows what a run of the scene ends with. A checkpoint is shown as it is.
            let simulation = &*footage.simulation();
            let is_start = simulation.report().steps == 0 && simulation.scene().spheres().is_empty();
            at = simulation.scene().run.steps.filter(|_| is_start).map(At::Step);
        }
        footage.go_to(at, past, |simulation, time| {
            renderer.update(simulation, style)?;
            renderer.set_time(time);
            renderer.record();
            Ok(())
        })
    }

    /// Prints what was written and the options that give the camera, then the warnings of the run.
    fn finish(&mut self, arguments: &Arguments, shot: &Shot, what: &str) -> Result<(), Failure> {
        output::note(&format!("wrote {}: {what}", arguments.out.display()));
        if let Some(options) = shot.options(arguments) {
            output::note(&format!("camera: {options}"));
        }
        self.footage.warn()
    }

    /// Chooses the corner of the legend in which it covers the fewest bodies.
    fn place_legend(&mut self, arguments: &Arguments, survey: &Survey, camera: &Camera) {
        if arguments.colour_by.is_some() {
            let legend = self.renderer.legend(&self.style);
            self.corner = self.overlay.corner(&legend, survey, camera, arguments.layout().scene());
        }
    }

    fn take(&mut self, camera: &Camera, arguments: &Arguments) -> rockfall::Result<Picture> {
        let mut picture = self.canvas.take(&mut self.renderer, camera, &self.style)?;
        if arguments.colour_by.is_some() {
            self.renderer.legend(&self.style).draw_at(self.corner, &mut picture)?;
        }
        self.renderer.record();
        self.overlay.draw(self.renderer.motion(), camera, &mut picture)?;
        arguments.layout().complete(picture, self.renderer.motion().plots())
    }

    pub(super) fn film(mut self, arguments: &Arguments, format: Format) -> Result<(), Failure> {
        self.go_to_start(arguments, true)?;
        let moments = self.footage.moments(arguments.cut())?;
        let survey = self.survey(arguments, &moments)?;
        let shot = Shot::new(arguments, &survey, self.footage.simulation())?;
        self.place_legend(arguments, &survey, &shot.at(0.0, None));
        self.renderer.set_scene(self.footage.simulation());
        self.renderer.set_survey(survey);
        self.renderer.fix_plots([0, moments.len() - 1].map(|index| self.footage.time_of(moments[index])));
        let mut follower = Follower::default();
        let (interrupt, count) = (self.interrupt, moments.len());
        let mut progress = Progress::pictures(count as u64);
        let mut taken = 0;
        // After a signal the film ends with the pictures so far, at least one.
        let shown = moments.iter().enumerate().take_while(|(index, _)| *index == 0 || !interrupt.is_requested());
        let pictures = shown.map(|(index, moment)| {
            let followed = self.show(&mut follower, shot.followed(), *moment)?;
            let camera = shot.at(index as f64 / f64::from(arguments.fps), followed);
            let picture = self.take(&camera, arguments)?;
            progress.advance(1);
            taken += 1;
            if taken == count {
                interrupt.finishes();
            }
            Ok(picture)
        });
        let result = film::write_all(&arguments.out, format, arguments.fps, count as u64, pictures);
        progress.finish();
        if taken < count && format == Format::Apng && interrupt.is_requested() {
            // Its header has the number of pictures.
            let how = "an APNG cannot end early, so no film is written";
            return Err(Failure::Interrupted(format!("stopped after {taken} of {count} pictures; {how}")));
        }
        result?;
        if taken < count {
            let path = arguments.out.display();
            return Err(Failure::Interrupted(format!("stopped after {taken} of {count} pictures, written to {path}")));
        }
        let (pictures, fps) = (counted(count, "picture", "pictures"), arguments.fps);
        let seconds = count as f64 / f64::from(fps);
        self.finish(arguments, &shot, &format!("{pictures}, {seconds:.1} s at {fps} per second"))
    }

    /// Shows a moment and returns the place of what the camera follows.
    fn show(&mut self, follower: &mut Follower, subject: Option<&Subject>, moment: Moment) -> rockfall::Result<Option<Vec3>> {
        let Self { footage, renderer, style, .. } = self;
        let Some(subject) = subject else {
            return footage.show(renderer, style, moment).map(|()| None);
        };
        let show = |moment| {
            footage.show(renderer, style, moment)?;
            subject.place(footage.simulation().sync()?)
        };
        follower.show(moment, show).map(Some)
    }

    /// Finds out what happens in the film, as far as the camera, walls and the colour scale depend on it, and fixes the scale.
    fn survey(&mut self, arguments: &Arguments, moments: &[Moment]) -> Result<Survey, Failure> {
        let has_camera = arguments.camera.is_some() && (arguments.look_at.is_some() || arguments.follow.is_some());
        let has_scale = arguments.range.is_some() || self.style.colour_by.title().is_none();
        let has_arrows = self.overlay.arrows.is_some();
        let has_plots = !arguments.plot.is_empty();
        let scene = self.footage.simulation().scene();
        if has_camera && has_scale && !has_arrows && !has_plots && scene.boxes().is_empty() && scene.polygons().is_empty() {
            return Ok(survey_of(scene, arguments));
        }
        let (mut end, mut key) = (0.0_f32, 0.0_f32);
        let Self { footage, renderer, style, .. } = self;
        let states = if has_plots { plotted(moments) } else { surveyed(moments).collect() };
        let survey = footage.survey(&states, arguments.up, |simulation, time| {
            if !has_scale || has_arrows || has_plots {
                renderer.update(simulation, style)?;
                renderer.set_time(time);
                renderer.record();
                end = end.max(renderer.range(style)[1]);
                key = key.max(renderer.motion().arrow_key());
            }
            Ok(())
        })?;
        self.overlay.arrow_key = has_arrows.then_some(key);
        if !has_scale {
            // The colours mean the same in all pictures.
            style.range = Range::Given(style.colour_by.range_to(end));
        }
        Ok(survey)
    }

    /// Prints the median time of every pass and the number of spheres drawn by each method.
    fn bench(&mut self, arguments: &Arguments, camera: &Camera, frames: u32) -> Result<(), Failure> {
        self.renderer.time_frames()?;
        let mut found = Vec::new();
        for _ in 0..frames {
            self.canvas.draw(&mut self.renderer, camera, &self.style)?;
            found.extend(self.renderer.frame_times()?);
        }
        let median = |of: &dyn Fn(&FrameTimes) -> f64| {
            let mut times: Vec<f64> = found.iter().map(of).collect();
            times.sort_by(f64::total_cmp);
            1e3 * times[times.len() / 2]
        };
        let last = found.last().copied().unwrap_or_default();
        let [width, height] = arguments.size;
        let mut text = format!("{frames} frames of {width}x{height}, medians\n");
        for pass in Pass::ALL {
            text += &format!("  {:<10} {:9.3} ms\n", pass.name(), median(&|times| times.passes[pass as usize]));
        }
        text += &format!("  {:<10} {:9.3} ms\n", "all", median(&FrameTimes::total));
        text += &format!("  spheres    {} ray-cast, {} as discs, {} in shadows\n", last.near, last.far, last.shadows);
        output::print(&text)
    }
}

/// The survey of the present state of a scene.
fn survey_of(scene: &Scene, arguments: &Arguments) -> Survey {
    Survey::with_up(scene, arguments.up.of(scene))
}
