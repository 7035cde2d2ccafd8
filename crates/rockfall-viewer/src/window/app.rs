//! The window: handles events and draws frames.

use std::fmt;
use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rockfall::glam::Vec2;
use rockfall::output::AtomicFile;
use rockfall::{Error, Options};
use serde_json::json;
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

use super::graphics::{Graphics, Widgets};
use super::launch::{Failure, Launch};
use super::message::Level;
use super::session::Session;
use super::viewer::Viewer;
use super::{report, ui};

/// Size of a new window, in points.
const SIZE: (f64, f64) = (1280.0, 800.0);
/// Number of failures of the device in one session after which the program ends.
const REOPENED: u32 = 3;

/// Opens a window, and returns when it is closed.
///
/// # Errors
/// [`Failure`]. Other errors are shown in the window.
pub fn run(launch: Launch) -> Result<(), Failure> {
    let events = EventLoop::new().map_err(no_display)?;
    let mut app = App { launch, open: None, failure: None, started: Instant::now() };
    events.run_app(&mut app).map_err(no_display)?;
    if let Some(open) = &mut app.open {
        // A film that is being recorded is completed before the program ends.
        open.viewer.stop_recording();
        open.viewer.report_films(true);
    }
    if let Some(failure) = app.failure {
        return Err(failure);
    }
    match (&mut app.open, &app.launch.report) {
        (Some(open), Some(path)) => open.write_report(path),
        _ => Ok(()),
    }
}

/// Extracts the reason from an error of the window library, whose text begins with a position in its source code.
fn no_display(error: impl fmt::Display) -> Failure {
    let text = error.to_string();
    let reason = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": ")).map_or(&*text, |(_, reason)| reason);
    Failure::NoDisplay(reason.trim_end_matches('.').to_owned())
}

struct App {
    launch: Launch,
    open: Option<OpenWindow>,
    failure: Option<Failure>,
    started: Instant,
}

/// An open window.
struct OpenWindow {
    window: Arc<Window>,
    /// `None` only between the loss of a device and the opening of the next one.
    graphics: Option<Graphics>,
    widgets: egui_winit::State,
    viewer: Viewer,
    started: Instant,
    /// Start of the last frame, if the picture changed without input.
    last_frame: Option<Instant>,
    frames: u64,
    first_frame: Option<f64>,
    /// Wall time of all frames except the first, in s, from their start until they were submitted.
    frame_seconds: f64,
    /// What the last picture was drawn from.
    drawn: Option<Drawn>,
    reopened: u32,
}

/// Everything that a picture depends on.
#[derive(Clone, Debug, PartialEq)]
struct Drawn {
    camera: crate::camera::Camera,
    style: crate::draw::Style,
    overlay: crate::overlay::Overlay,
    size: [u32; 2],
    steps: u64,
    objects: u64,
    simulation: u64,
    blend: f32,
    held: bool,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match OpenWindow::new(events, &self.launch, self.started) {
            Ok(open) => self.open = Some(open),
            Err(failure) => {
                self.failure = Some(failure);
                events.exit();
            }
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &self.open) {
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else {
            return;
        };
        // A redraw must not request another redraw.
        if open.widgets.on_window_event(&open.window, &event).repaint && event != WindowEvent::RedrawRequested {
            open.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => {
                open.viewer.leave();
                open.window.request_redraw();
            }
            WindowEvent::Resized(size) => {
                if let Some(graphics) = &mut open.graphics {
                    graphics.resize(size.width, size.height);
                }
            }
            WindowEvent::RedrawRequested => {
                let lose = self.launch.lose_device_after == Some(open.frames);
                let shown = open.frame(events, &self.launch.options, lose);
                let written = self.launch.report.as_ref().map_or(Ok(()), |path| open.write_report(path));
                if let Err(failure) = shown.and(written) {
                    self.failure = Some(failure);
                    events.exit();
                }
            }
            _ => {}
        }
        if open.viewer.quit {
            events.exit();
        }
    }
}

impl OpenWindow {
    fn new(events: &ActiveEventLoop, launch: &Launch, started: Instant) -> Result<Self, Failure> {
        let attributes = Window::default_attributes()
            .with_title(title(&launch.source.name))
            .with_inner_size(LogicalSize::new(SIZE.0, SIZE.1));
        let window = events.create_window(attributes).map_err(no_display)?;
        let window = Arc::new(window);
        let graphics = Graphics::open(&window, events.owned_display_handle())?;
        let opener = graphics.opener(&launch.options);
        let mut session = Session::open(launch.source.clone(), launch.overrides.clone(), launch.time_step, opener)?;
        session.keeps_time_step = launch.keeps_time_step;
        session.prepare.clone_from(&launch.prepare);
        if let Some(playback) = launch.playback.take() {
            session.play(playback);
        }
        for warning in &launch.warnings {
            session.tell(Level::Warning, warning);
        }
        let size = window.inner_size();
        let widgets = widgets(&window);
        let mut viewer = Viewer::new(session, Vec2::new(size.width as f32, size.height as f32).max(Vec2::ONE));
        viewer.controls = launch.controls;
        viewer.overlay.clone_from(&launch.overlay);
        viewer.style = launch.style;
        viewer.find = launch.follow.clone();
        viewer.plotted.clone_from(&launch.plotted);
        viewer.session.plot_joints(launch.joints.clone());
        viewer.show_from(launch.view, launch.up);
        viewer.follow_initially();
        viewer.plot_initially();
        window.request_redraw();
        let (last_frame, first_frame, drawn) = (None, None, None);
        Ok(Self {
            window,
            graphics: Some(graphics),
            widgets,
            viewer,
            started,
            last_frame,
            frames: 0,
            first_frame,
            frame_seconds: 0.0,
            drawn,
            reopened: 0,
        })
    }

    /// Makes the steps that are due, and draws the widgets and the picture.
    fn frame(&mut self, events: &ActiveEventLoop, options: &Options, lose: bool) -> Result<(), Failure> {
        let start = Instant::now();
        let elapsed = self.last_frame.map_or(0.0, |last| (start - last).as_secs_f64());
        self.reopen_lost_device(events, options, lose)?;
        self.advance(elapsed);
        let repaint_after = self.draw();
        self.frames += 1;
        match self.first_frame {
            None => self.first_frame = Some(self.started.elapsed().as_secs_f64()),
            Some(_) => self.frame_seconds += start.elapsed().as_secs_f64(),
        }
        if self.viewer.is_moving() || self.viewer.session.device_failed() {
            self.last_frame = Some(start);
            self.window.request_redraw();
        } else {
            self.last_frame = None;
            // Nothing changes until the next event, or until the widgets request a repaint.
            events.set_control_flow(match Instant::now().checked_add(repaint_after) {
                Some(then) if repaint_after < Duration::from_secs(3600) => ControlFlow::WaitUntil(then),
                _ => ControlFlow::Wait,
            });
        }
        Ok(())
    }

    fn advance(&mut self, elapsed: f64) {
        let now = self.started.elapsed().as_secs_f64();
        self.viewer.walk(elapsed);
        let Some(graphics) = &mut self.graphics else {
            return;
        };
        let (renderer, style) = (&mut graphics.renderer, self.viewer.style);
        let mut error = None;
        self.viewer.session.frame(now, elapsed, |simulation| {
            // Several steps may have been made since the last picture.
            error = renderer.update(simulation, &style).err();
            renderer.remember();
        });
        if let Some(error) = error {
            self.viewer.session.fail(&error);
        }
        self.viewer.follow();
        self.viewer.keep_in_view();
        self.viewer.session.sample(false);
        let steps = self.viewer.session.simulation_ref().report().steps;
        self.viewer.rates.frame(now, steps);
    }

    /// Draws a frame, and returns the time after which the widgets have to be drawn again.
    fn draw(&mut self) -> Duration {
        let input = self.widgets.take_egui_input(&self.window);
        let context = self.widgets.egui_ctx().clone();
        let Some(graphics) = &mut self.graphics else {
            return Duration::ZERO;
        };
        // Asked for before this frame, so that the picture of this frame has its full resolution.
        let wants_picture = self.viewer.capture.wants_picture();
        let output = context.run_ui(input, |ui| {
            ui::show(ui, &mut self.viewer, &mut |size, moving, marks| {
                (graphics.picture(size, moving), marks(graphics.renderer.motion()))
            });
        });
        self.widgets.handle_platform_output(&self.window, output.platform_output);
        let widgets = Widgets {
            primitives: context.tessellate(output.shapes, output.pixels_per_point),
            textures: output.textures_delta,
            pixels_per_point: output.pixels_per_point,
        };
        let (camera, style) = (self.viewer.camera, self.viewer.style);
        let is_new = self.update_renderer();
        if let Some(graphics) = &mut self.graphics {
            graphics.show(&self.window, is_new.then_some((&camera, &style)), widgets);
        }
        self.capture(wants_picture);
        let root = output.viewport_output.get(&egui::ViewportId::ROOT);
        root.map_or(Duration::MAX, |viewport| viewport.repaint_delay)
    }

    /// Reads the picture back for a screenshot or a recording, and reports completed films.
    fn capture(&mut self, wanted: bool) {
        if let Some(graphics) = self.graphics.as_ref().filter(|_| wanted && !self.viewer.session.device_failed()) {
            match graphics.read_picture() {
                Ok(mut picture) => {
                    // The font is built in, so this cannot fail.
                    let _ = self.viewer.overlay.draw(graphics.renderer.motion(), &self.viewer.camera, &mut picture);
                    self.viewer.captured(picture);
                }
                Err(error) => self.viewer.session.fail(&error),
            }
        }
        if self.viewer.capture.wants_picture() {
            self.window.request_redraw();
        }
        self.viewer.report_films(false);
    }

    /// Updates the renderer if the picture would differ from the last one, and returns whether it does.
    fn update_renderer(&mut self) -> bool {
        let Some(Graphics { renderer, picture, .. }) = &mut self.graphics else {
            return false;
        };
        let size = picture.as_ref().map_or([0; 2], |picture| picture.size);
        let session = &mut self.viewer.session;
        if session.device_failed() {
            return false;
        }
        let drawn = Drawn {
            camera: self.viewer.camera,
            style: self.viewer.style,
            overlay: self.viewer.overlay.clone(),
            size,
            steps: session.simulation_ref().report().steps,
            objects: session.objects_version(),
            simulation: session.simulation_version(),
            blend: if session.running() { session.pace.alpha() } else { 1.0 },
            held: session.held().is_some(),
        };
        // The tether of a held body moves with the pointer.
        if self.drawn.as_ref() == Some(&drawn) && !drawn.held {
            return false;
        }
        if self.drawn.as_ref().is_none_or(|last| last.simulation != drawn.simulation) {
            renderer.set_scene(session.simulation_ref());
            self.window.set_title(&title(&session.source().name));
        }
        renderer.set_overlay(&drawn.overlay);
        if let Err(error) = renderer.update(session.simulation(), &drawn.style) {
            session.fail(&error);
            return false;
        }
        renderer.keep_ground_below(session.simulation_ref());
        renderer.set_blend(drawn.blend);
        renderer.record();
        let legend = Some(renderer.legend(&drawn.style));
        if self.viewer.legend != legend {
            self.viewer.legend = legend;
            // The widgets of this frame are already built with the old legend.
            self.window.request_redraw();
        }
        self.drawn = Some(drawn);
        true
    }

    /// Opens another device if the present one was lost.
    fn reopen_lost_device(&mut self, events: &ActiveEventLoop, options: &Options, lose: bool) -> Result<(), Failure> {
        if let Some(graphics) = &self.graphics {
            if lose {
                graphics.lose();
            }
            if let Some(fault) = graphics.fault() {
                self.viewer.session.fail(&Error::Device(fault));
            }
        }
        if !self.viewer.session.device_failed() {
            return Ok(());
        }
        self.reopened += 1;
        if self.reopened > REOPENED {
            return Err(Error::Device("the device failed repeatedly".to_owned()).into());
        }
        // A window can have only one surface at a time.
        self.graphics = None;
        let graphics = Graphics::open(&self.window, events.owned_display_handle())?;
        self.viewer.session.reopen(graphics.opener(options));
        self.graphics = Some(graphics);
        self.drawn = None;
        // The new device does not have the textures of the widgets.
        self.widgets = widgets(&self.window);
        Ok(())
    }

    /// Writes the report as one atomic file, because another process may be reading it.
    fn write_report(&mut self, path: &Path) -> Result<(), Failure> {
        let text = format!("{:#}\n", self.report());
        let write = || {
            let mut file = AtomicFile::create(path)?;
            file.write_all(text.as_bytes())?;
            file.commit()
        };
        write().map_err(|error| Failure::Report(path.to_owned(), error))
    }

    fn report(&mut self) -> serde_json::Value {
        let run = json!({
            "frames": self.frames,
            "first_frame_seconds": self.first_frame,
            "mean_frame_seconds": self.frame_seconds / self.frames.saturating_sub(1).max(1) as f64,
            "devices_reopened": self.reopened,
        });
        let device = self.graphics.as_ref().map_or("", |graphics| &graphics.name);
        report::report(&mut self.viewer, device, &run)
    }
}

fn widgets(window: &Window) -> egui_winit::State {
    let context = egui::Context::default();
    context.set_theme(egui::Theme::Light);
    // Ctrl and + must not zoom the widgets.
    context.options_mut(|options| options.zoom_with_keyboard = false);
    egui_winit::State::new(context, egui::ViewportId::ROOT, window, Some(window.scale_factor() as f32), None, None)
}

fn title(scene: &str) -> String {
    format!("{scene} - rockfall")
}
