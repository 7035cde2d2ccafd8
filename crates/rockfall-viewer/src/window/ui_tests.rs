//! Tests of the widgets without a window: events and their effects.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Event, Key, Modifiers, PointerButton, RawInput, pos2};
use rockfall::glam::Vec3;
use rockfall::{Backend, Options, Scene, Simulation};

use super::*;
use crate::window::session::{Session, Source};

/// A window of 1280 x 800 points with one ball in zero gravity.
struct Screen {
    context: egui::Context,
    viewer: Viewer,
}

impl Screen {
    fn new() -> Self {
        Self::of("set gravity 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n")
    }

    fn of(text: &str) -> Self {
        let scene = Scene::parse(text, Path::new("test")).unwrap().scene;
        let opener = Box::new(|scene| Simulation::with_options(scene, Options::new().backend(Backend::Cpu)));
        let source = Source { name: "test".to_owned(), path: None, scene };
        let session = Session::open(source, Vec::new(), 0.02, opener).unwrap();
        let mut screen = Self { context: egui::Context::default(), viewer: Viewer::new(session, Vec2::ONE) };
        // The widgets need two frames for their layout.
        screen.frame([]);
        screen.frame([]);
        screen
    }

    fn frame(&mut self, events: impl IntoIterator<Item = Event>) {
        self.frame_of(RawInput { events: events.into_iter().collect(), ..RawInput::default() });
    }

    /// The upper left corner of a text that is shown.
    fn place_of(&mut self, wanted: &str) -> Pos2 {
        let output = self.frame_of(RawInput::default());
        let found = output.shapes.iter().find_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) if text.galley.text() == wanted => Some(text.pos),
            _ => None,
        });
        found.unwrap_or_else(|| panic!("{wanted} is not shown"))
    }

    fn frame_of(&mut self, input: RawInput) -> egui::FullOutput {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(1280.0, 800.0)));
        let input = RawInput { screen_rect, focused: true, ..input };
        let viewer = &mut self.viewer;
        let mut output = self.context.run_ui(input, |ui| show(ui, viewer, &mut |_, _, _| (TextureId::default(), Vec::new())));
        output.textures_delta.clear();
        output
    }
}

fn key(key: Key, modifiers: Modifiers) -> [Event; 2] {
    [true, false].map(|pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers })
}

fn button(pos: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) -> Event {
    Event::PointerButton { pos, button, pressed, modifiers }
}

#[test]
fn keys_are_handled() {
    let mut screen = Screen::new();
    screen.frame(key(Key::Space, Modifiers::NONE));
    assert!(screen.viewer.session.running());
    screen.frame(key(Key::Escape, Modifiers::NONE));
    assert!(screen.viewer.quit);
}

#[test]
fn key_repeats_change_constants_but_toggle_nothing() {
    let mut screen = Screen::new();
    let kept = |key: Key| {
        (0..4).map(move |at| Event::Key { key, physical_key: None, pressed: true, repeat: at > 0, modifiers: Modifiers::NONE })
    };
    screen.frame(kept(Key::A));
    assert!(screen.viewer.session.running());
    screen.frame(kept(Key::J));
    assert_eq!(screen.viewer.session.settings().gravity, 1.0);
}

#[test]
fn text_typed_into_a_field_is_no_command() {
    let mut screen = Screen::new();
    screen.frame(key(Key::O, Modifiers::CTRL));
    assert!(screen.viewer.dialog.is_shown());
    screen.frame([]);
    screen.frame([]);
    let typed = key(Key::A, Modifiers::NONE).into_iter().chain([Event::Text("a".to_owned())]);
    screen.frame(typed);
    assert!(!screen.viewer.session.running());
}

/// A slow frame may contain a whole drag, from press to release.
#[test]
fn a_drag_within_one_frame_turns_the_camera() {
    let mut screen = Screen::new();
    let before = screen.viewer.camera;
    let at = |x: f32| pos2(300.0 + x, 300.0);
    screen.frame([
        Event::PointerMoved(at(0.0)),
        button(at(0.0), PointerButton::Primary, true, Modifiers::NONE),
        Event::PointerMoved(at(60.0)),
        button(at(60.0), PointerButton::Primary, false, Modifiers::NONE),
        Event::PointerMoved(at(0.0)),
    ]);
    assert!(screen.viewer.camera.target.distance(before.target) < 1e-4);
    assert!(screen.viewer.camera.eye != before.eye && !screen.viewer.is_dragging());
}

#[test]
fn drags_on_the_panel_and_the_menu_do_not_move_the_camera() {
    let mut screen = Screen::new();
    let before = screen.viewer.camera;
    for place in [pos2(1200.0, 700.0), pos2(500.0, 5.0)] {
        screen.frame([Event::PointerMoved(place), button(place, PointerButton::Secondary, true, Modifiers::NONE)]);
        screen.frame([Event::PointerMoved(place + egui::vec2(0.0, 30.0))]);
        assert!(!screen.viewer.is_dragging());
        screen.frame([button(place, PointerButton::Secondary, false, Modifiers::NONE)]);
    }
    assert_eq!(screen.viewer.camera, before);
}

#[test]
fn ctrl_and_drag_hold_a_ball() {
    let mut screen = Screen::new();
    let middle = marks::project(&screen.viewer, picture_of(&screen), Vec3::ZERO).unwrap().0;
    let ctrl = Modifiers::CTRL;
    screen.frame([Event::PointerMoved(middle), button(middle, PointerButton::Primary, true, ctrl)]);
    assert!(screen.viewer.session.held().is_some());
    screen.frame([button(middle, PointerButton::Primary, false, ctrl)]);
    assert!(screen.viewer.session.held().is_none());
}

/// Returns the part of the screen that the picture covers.
fn picture_of(screen: &Screen) -> Rect {
    let (origin, size) = (screen.viewer.origin, screen.viewer.size());
    Rect::from_min_size(pos2(origin.x, origin.y), egui::vec2(size.x, size.y))
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn dropped_files_are_loaded_and_errors_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.txt");
    std::fs::write(&path, "S 1 0 0 0 0 0 0 0 0 0 1 0.5\nS 2 3 0 0 0 0 0 0 0 0 1 0.5\n").unwrap();
    let mut screen = Screen::new();
    let drop = |path: PathBuf| RawInput { dropped_files: vec![Arc::new(Dropped(path))], ..RawInput::default() };
    screen.frame_of(drop(path));
    assert_eq!(screen.viewer.session.simulation_ref().scene().counts().spheres, 2);
    screen.frame_of(drop(folder.path().join("none.txt")));
    let last = screen.viewer.session.messages.all().last().unwrap();
    assert!(last.level == Level::Error && last.text.contains("none.txt"), "{last:?}");
    assert_eq!(screen.viewer.session.simulation_ref().scene().counts().spheres, 2);
}

fn type_text(screen: &mut Screen, text: &str) {
    screen.frame([Event::Text(text.to_owned())]);
}

fn keep_pressed(key: Key) -> Event {
    Event::Key { key, physical_key: None, pressed: true, repeat: true, modifiers: Modifiers::NONE }
}

/// Enter saves to the typed name. The typed name replaces the proposed one.
#[test]
fn enter_confirms_the_dialogs() {
    let folder = tempfile::tempdir().unwrap();
    let mut screen = Screen::new();
    screen.frame(key(Key::S, Modifiers::CTRL));
    assert!(screen.viewer.dialog.is_shown());
    screen.frame([]);
    let path = folder.path().join("mine.txt");
    type_text(&mut screen, &path.display().to_string());
    screen.frame(key(Key::Enter, Modifiers::NONE));
    assert!(path.is_file() && !screen.viewer.dialog.is_shown(), "{}", screen.viewer.dialog.path);

    screen.frame(key(Key::O, Modifiers::CTRL));
    screen.frame([]);
    type_text(&mut screen, &path.display().to_string());
    screen.frame(key(Key::Enter, Modifiers::NONE));
    assert_eq!(screen.viewer.session.source().path.as_deref(), Some(path.as_path()));
}

#[test]
fn a_file_is_overwritten_only_by_a_click() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.txt");
    std::fs::write(&path, "kept").unwrap();
    let mut screen = Screen::new();
    screen.frame(key(Key::S, Modifiers::CTRL | Modifiers::SHIFT));
    screen.frame([]);
    type_text(&mut screen, &path.display().to_string());
    let [down, up] = key(Key::Enter, Modifiers::NONE);
    screen.frame([down]);
    assert_eq!(screen.viewer.dialog.question(), Some(path.as_path()));
    // A key that is kept down answers nothing, and letters are no commands.
    screen.frame([keep_pressed(Key::Enter), keep_pressed(Key::A)]);
    screen.frame([up]);
    assert!(screen.viewer.dialog.question().is_some() && !screen.viewer.session.running());
    screen.frame(key(Key::Enter, Modifiers::NONE));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "kept");
    assert!(folder.path().join("kept-1.txt").is_file() && !screen.viewer.dialog.is_shown());
}

#[test]
fn escape_closes_dialog_menu_field_and_help_before_the_window() {
    let mut screen = Screen::new();
    let escape = |screen: &mut Screen| {
        screen.frame(key(Key::Escape, Modifiers::NONE));
        screen.frame([]);
        assert!(!screen.viewer.quit);
    };
    screen.frame(key(Key::F1, Modifiers::NONE));
    screen.frame(key(Key::O, Modifiers::CTRL));
    screen.frame([]);
    escape(&mut screen);
    assert!(!screen.viewer.dialog.is_shown() && screen.viewer.help);
    escape(&mut screen);
    assert!(!screen.viewer.help);

    // The first menu.
    let at = pos2(20.0, 10.0);
    for pressed in [true, false] {
        screen.frame([Event::PointerMoved(at), button(at, PointerButton::Primary, pressed, Modifiers::NONE)]);
    }
    screen.frame([]);
    assert!(screen.viewer.busy, "the menu is open");
    escape(&mut screen);
    assert!(!screen.viewer.busy);
    screen.frame(key(Key::Escape, Modifiers::NONE));
    assert!(screen.viewer.quit);
}

/// Two fingers on a touchpad scroll in points, and a pinch is a factor.
#[test]
fn touchpads_zoom_and_move_the_picture() {
    let mut screen = Screen::new();
    // Beside the ball, so that the camera moves to a point at the present distance.
    let at = picture_of(&screen).left_top() + egui::vec2(40.0, 40.0);
    let distance = |screen: &Screen| screen.viewer.camera.eye.distance(screen.viewer.camera.target);
    let wheel = |y: f32, modifiers| Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, y),
        modifiers,
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Trackpad,
    };
    screen.frame([Event::PointerMoved(at)]);
    let before = distance(&screen);
    screen.frame([wheel(40.0, Modifiers::NONE)]);
    let nearer = distance(&screen);
    assert!((nearer / before - 0.88).abs() < 1e-3, "{before} {nearer}");
    // A pinch by a factor of 2 halves the distance.
    screen.frame([Event::Zoom(2.0)]);
    assert!((distance(&screen) / nearer - 0.5).abs() < 0.01, "{nearer} {}", distance(&screen));
    let camera = screen.viewer.camera;
    screen.frame([wheel(40.0, Modifiers::ALT)]);
    assert!(screen.viewer.camera.target.distance(camera.target) > 0.01);
    assert!((screen.viewer.camera.axes().forward - camera.axes().forward).length() < 1e-4);
}

/// The picked body has a window of its own, which does not move the panel and leaves the middle of the picture free.
#[test]
fn the_picked_body_is_shown_beside_the_middle() {
    let mut screen = Screen::new();
    let area = picture_of(&screen);
    let at = marks::project(&screen.viewer, area, Vec3::ZERO).unwrap().0;
    for pressed in [true, false] {
        screen.frame([Event::PointerMoved(at), button(at, PointerButton::Primary, pressed, Modifiers::NONE)]);
    }
    screen.frame([]);
    screen.frame([]);
    assert!(screen.viewer.session.picked().is_some());
    let window = screen.context.memory(|memory| memory.area_rect(egui::Id::unique("picked body"))).unwrap();
    assert!(area.contains_rect(window) && !window.contains(area.center()), "{window} in {area}");
    assert_eq!(picture_of(&screen), area);
}

/// The window of a picked body does not cover the body, also where it is for the next body that is picked.
#[test]
fn the_window_of_the_picked_body_leaves_it_in_view() {
    let mut screen = Screen::new();
    let area = picture_of(&screen);
    let id = egui::Id::unique("picked body");
    let body = rockfall::Body::Sphere(screen.viewer.session.simulation_ref().scene().sphere_ids().next().unwrap());
    for part in [0.15, 0.85, 0.1] {
        screen.viewer.session.set_picked(None);
        screen.context.data_mut(|data| data.remove::<rockfall::Body>(id));
        // The ball is at this part of the width, and near the upper edge.
        let half =
            screen.viewer.camera.eye.distance(screen.viewer.camera.target) * (0.5 * screen.viewer.camera.field_of_view).tan();
        let axes = screen.viewer.camera.axes();
        let aside = half * ((1.0 - 2.0 * part) * screen.viewer.aspect() * axes.right - 0.6 * axes.up);
        screen.viewer.camera = screen.viewer.camera.looking_at(aside);
        screen.viewer.session.set_picked(Some(body));
        screen.frame([]);
        screen.frame([]);
        screen.frame([]);
        let window = screen.context.memory(|memory| memory.area_rect(id)).unwrap();
        let at = marks::project(&screen.viewer, area, Vec3::ZERO).unwrap().0;
        assert!(area.contains(at) && area.contains_rect(window) && !window.contains(at), "{part}: {at} in {window}");
    }
}

/// A window of 1280 x 800 points shows the plot of the energies without scrolling.
#[test]
fn the_plot_of_the_energies_is_in_view() {
    let mut screen = Screen::new();
    let [plot, below] = ["Energy over time", "Colours"].map(|title| screen.place_of(title).y);
    assert!(below > plot + 130.0 && below < 800.0, "{plot} {below}");
}

/// A hinge with a motor, one with a spring, and plots of both.
#[test]
fn motors_and_springs_of_joints_have_sliders() {
    let mut screen = Screen::of(
        "set contact_law rigid\nset gravity 0\n@body bar mass=2\nB 0 -0.05 -0.05 1 0 0 0 0.1 0 0 0 0.1\n@end\n\
         @place bar at=0,0,0 name=one\n@place bar at=0,0,5 name=two\n\
         @joint hinge world one at=0,0,0 axis=0,1,0 speed=0.1 name=motor\n\
         @joint hinge world two at=0,0,5 axis=0,1,0 target=0 stiffness=500 damping=100 limits=-90..90 name=spring\n",
    );
    let plot = |text: &str| crate::plot::Plot::parse(text).unwrap();
    screen.viewer.session.plot_joints(vec![plot("joint:motor,spring"), plot("joint:motor.speed"), plot("joint:door")]);
    screen.viewer.session.sample(true);
    let joint = |screen: &Screen, name: &str| {
        let scene = screen.viewer.session.simulation_ref().scene();
        scene.joint(scene.joint_named(name).unwrap()).unwrap().clone()
    };
    let drag = |screen: &mut Screen, name: &str| {
        // The middle of the slider is to the right of the name.
        let middle = screen.place_of(name) + egui::vec2(108.0 + 8.0 + 32.0, 6.0);
        screen.frame([Event::PointerMoved(middle), button(middle, PointerButton::Primary, true, Modifiers::NONE)]);
        let end = middle + egui::vec2(14.0, 0.0);
        screen.frame([Event::PointerMoved(end)]);
        screen.frame([button(end, PointerButton::Primary, false, Modifiers::NONE)]);
    };
    drag(&mut screen, "motor");
    drag(&mut screen, "spring");
    let (speed, target) = (joint(&screen, "motor").speed.unwrap(), joint(&screen, "spring").target.unwrap());
    assert!((0.3..0.7).contains(&speed) && (0.4..1.0).contains(&target), "{speed} {target}");

    for _ in 0..100 {
        screen.viewer.session.single_step();
    }
    screen.viewer.session.sample(true);
    screen.place_of(&format!("{:.1}°", target.to_degrees()));
    screen.place_of("joint in degrees over time in s");
    let values = &screen.viewer.session.watch.plotted().back().unwrap().values;
    let turned = f64::from(speed.to_degrees()) * 100.0 * 0.02;
    assert!(values.len() == 3 && (values[0] - turned).abs() < 1.0, "{values:?} {turned}");
    assert!(
        (values[1] - f64::from(target.to_degrees())).abs() < 1.0 && (values[2] - f64::from(speed)).abs() < 0.01,
        "{values:?}"
    );

    // Undo takes back the target, and then the speed.
    screen.viewer.session.undo();
    screen.viewer.session.undo();
    assert_eq!((joint(&screen, "spring").target, joint(&screen, "motor").speed), (Some(0.0), Some(0.1)));
    screen.viewer.session.redo();
    assert_eq!(joint(&screen, "motor").speed, Some(speed));
    // A reset has the same plots.
    screen.viewer.session.reset();
    screen.viewer.session.sample(true);
    assert_eq!(screen.viewer.session.watch.plotted().len(), 1);
}
