//! Translates events of the widget library to commands and mouse actions.

use egui::{Event, MouseWheelUnit, PointerButton, Pos2, Rect};
use rockfall::glam::Vec2;

use super::controls::{self, Command, Key, Modifiers};
use super::navigation::Arrow;
use super::viewer::{Button, Viewer};

/// Scroll distance, in points, that counts as one notch of the wheel.
const NOTCH: f32 = 40.0;
/// Notches of the wheel for a pinch by a factor of e: the picture grows by the factor of the pinch.
const PINCH: f32 = 7.8;

/// Handles the events of a frame; `area` is the picture of the scene. Events are handled one by one, because a slow frame may
/// contain a whole drag.
pub(super) fn handle(ui: &egui::Ui, area: Rect, viewer: &mut Viewer) {
    let context = ui.ctx();
    let pixels = context.pixels_per_point();
    let in_picture = |place: Pos2| {
        let free = context.layer_id_at(place).is_none_or(|layer| layer.order == egui::Order::Background);
        area.contains(place) && free && !context.egui_is_using_pointer()
    };
    let pixel = |place: Pos2| Vec2::new(place.x - area.min.x, place.y - area.min.y) * pixels;
    let over_picture = context.pointer_hover_pos().is_some_and(in_picture);
    let (events, focused, now) = context.input(|input| (input.events.clone(), input.focused, input.time));
    for event in events {
        match event {
            Event::Key { key, pressed, repeat, modifiers, .. } => {
                // A field takes the keys. Escape has then left the field already.
                let typing = (context.egui_wants_keyboard_input() || viewer.dialog.is_shown()) && key != egui::Key::Escape;
                match arrow_of(key) {
                    Some(arrow) => viewer.arrow(arrow, pressed && !typing),
                    None if pressed && !typing => press(viewer, key, repeat, modifiers),
                    None => {}
                }
            }
            Event::PointerMoved(place) => viewer.point((area.contains(place) || viewer.is_dragging()).then(|| pixel(place))),
            Event::PointerGone if !viewer.is_dragging() => viewer.point(None),
            Event::PointerButton { pos, button, pressed, modifiers } => match button_of(button) {
                Some(button) if pressed && in_picture(pos) => {
                    viewer.point(Some(pixel(pos)));
                    viewer.press(button, modifiers_of(modifiers));
                }
                Some(button) if !pressed => viewer.release(button, now),
                _ => {}
            },
            Event::MouseWheel { unit, delta, modifiers, .. } if over_picture => {
                let notches = notches(unit, delta);
                if modifiers.alt || modifiers.shift {
                    // Some systems turn the wheel sideways while Shift is down.
                    viewer.slide(NOTCH * pixels * Vec2::new(notches.x, notches.y));
                } else {
                    viewer.scroll(notches.y);
                }
            }
            // Two fingers that move apart by this factor.
            Event::Zoom(factor) if over_picture && factor > 0.0 => viewer.scroll(factor.ln() * PINCH),
            _ => {}
        }
    }
    if !focused {
        viewer.release_arrows();
    }
}

/// Returns the distance of a scroll in notches of the wheel.
fn notches(unit: MouseWheelUnit, delta: egui::Vec2) -> egui::Vec2 {
    match unit {
        MouseWheelUnit::Point => delta / NOTCH,
        MouseWheelUnit::Line => delta,
        MouseWheelUnit::Page => delta * 5.0,
    }
}

fn modifiers_of(held: egui::Modifiers) -> Modifiers {
    Modifiers { shift: held.shift, ctrl: held.ctrl || held.command, alt: held.alt }
}

fn button_of(button: PointerButton) -> Option<Button> {
    match button {
        PointerButton::Primary => Some(Button::Left),
        PointerButton::Middle => Some(Button::Middle),
        PointerButton::Secondary => Some(Button::Right),
        _ => None,
    }
}

fn arrow_of(key: egui::Key) -> Option<Arrow> {
    match key {
        egui::Key::ArrowUp => Some(Arrow::Up),
        egui::Key::ArrowDown => Some(Arrow::Down),
        egui::Key::ArrowLeft => Some(Arrow::Left),
        egui::Key::ArrowRight => Some(Arrow::Right),
        _ => None,
    }
}

fn press(viewer: &mut Viewer, key: egui::Key, repeat: bool, held: egui::Modifiers) {
    let command = key_of(key).and_then(|key| controls::command(key, modifiers_of(held), viewer.controls));
    // While a key is kept down, its repeats make steps and change constants, but do not toggle anything.
    let repeats = matches!(
        command,
        Some(Command::Nudge { .. } | Command::SingleStep | Command::Rewind { .. } | Command::Undo | Command::Redo)
    );
    if let Some(command) = command.filter(|_| !repeat || repeats) {
        viewer.command(command);
    }
}

fn key_of(key: egui::Key) -> Option<Key> {
    Some(match key {
        egui::Key::F1 => Key::F1,
        egui::Key::F12 => Key::F12,
        egui::Key::Escape => Key::Escape,
        egui::Key::Space => Key::Space,
        egui::Key::Backspace => Key::Backspace,
        egui::Key::Home => Key::Home,
        egui::Key::Comma => Key::Char(','),
        egui::Key::Period => Key::Char('.'),
        egui::Key::Minus => Key::Char('-'),
        egui::Key::Plus => Key::Char('+'),
        egui::Key::Equals => Key::Char('='),
        other => {
            let mut name = other.name().chars();
            match (name.next(), name.next()) {
                (Some(letter), None) if letter.is_ascii_alphanumeric() => Key::Char(letter.to_ascii_lowercase()),
                _ => return None,
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_translated_by_their_names() {
        let keys = [(egui::Key::A, 'a'), (egui::Key::Z, 'z'), (egui::Key::Minus, '-'), (egui::Key::Plus, '+')];
        for (key, letter) in keys {
            assert_eq!(key_of(key), Some(Key::Char(letter)));
        }
        assert_eq!(key_of(egui::Key::F1), Some(Key::F1));
        assert_eq!(key_of(egui::Key::F2), None);
        assert_eq!(key_of(egui::Key::Num1), Some(Key::Char('1')));
    }
}
