//! Tests of the widgets without a window: events and their effects.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Event, Key, Modifiers, PointerButton, RawInput, pos2};
use rockfall::{Backend, Options, Scene, Simulation};

use super::*;
use crate::window::session::{Session, Source};

/// A window of 1000 x 700 points with one ball in zero gravity.
struct Screen {
    context: egui::Context,
    viewer: Viewer,
}

impl Screen {
    fn new() -> Self {
        let text = "set gravity 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n";
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

    fn frame_of(&mut self, input: RawInput) {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(1000.0, 700.0)));
        let input = RawInput { screen_rect, focused: true, ..input };
        let viewer = &mut self.viewer;
        let mut output = self.context.run_ui(input, |ui| show(ui, viewer, &mut |_, _| TextureId::default()));
        output.textures_delta.clear();
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
    screen.frame(key(Key::A, Modifiers::NONE));
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
    assert_eq!(screen.viewer.camera.eye, before.eye);
    assert!(screen.viewer.camera.target != before.target && !screen.viewer.is_dragging());
}

#[test]
fn drags_on_the_panel_and_the_menu_do_not_move_the_camera() {
    let mut screen = Screen::new();
    let before = screen.viewer.camera;
    for place in [pos2(900.0, 650.0), pos2(500.0, 5.0)] {
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
    let middle = project(&screen.viewer, picture_of(&screen), Vec3::ZERO).unwrap().0;
    let ctrl = Modifiers::CTRL;
    screen.frame([Event::PointerMoved(middle), button(middle, PointerButton::Primary, true, ctrl)]);
    assert!(screen.viewer.session.held().is_some());
    screen.frame([button(middle, PointerButton::Primary, false, ctrl)]);
    assert!(screen.viewer.session.held().is_none());
}

/// Returns the part of the screen that the picture covers.
fn picture_of(screen: &Screen) -> Rect {
    let size = egui::vec2(screen.viewer.size().x, screen.viewer.size().y);
    Rect::from_min_max(pos2(0.0, 700.0 - size.y), pos2(size.x, 700.0))
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
