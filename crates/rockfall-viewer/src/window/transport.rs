//! The bar below the picture: start, step, reset, speed, the last seconds, and recording.

use egui::{Color32, RichText, Ui};

use super::controls::Command;
use super::menu;
use super::pace::SPEEDS;
use super::viewer::Viewer;

/// Shows the bar and executes what is chosen.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        let mut asked = buttons(ui, viewer);
        ui.separator();
        asked = asked.or(speed(ui, viewer));
        ui.separator();
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            asked = asked.or(capture(ui, viewer));
            ui.separator();
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| past(ui, viewer));
        });
        if let Some(command) = asked {
            viewer.command(command);
        }
    });
    ui.add_space(2.0);
}

/// Shows buttons with a text, a tooltip and a command, and returns the command of the clicked one.
fn row(ui: &mut Ui, buttons: &[(&str, &str, Command)]) -> Option<Command> {
    let mut asked = None;
    for (text, about, command) in buttons {
        if ui.button(*text).on_hover_text(*about).clicked() {
            asked = Some(*command);
        }
    }
    asked
}

fn buttons(ui: &mut Ui, viewer: &Viewer) -> Option<Command> {
    let text = if viewer.session.running() { "Pause" } else { "Start" };
    // The other buttons must not move when the text changes.
    let start = ui.add(egui::Button::new(RichText::new(text).strong()).min_size(egui::vec2(52.0, 0.0)));
    let asked = start.on_hover_text("space or A").clicked().then_some(Command::ToggleRunning);
    asked.or(row(ui, &[("Step", "S", Command::SingleStep), ("Reset", "Backspace", Command::Reset)]))
}

/// Shows the speed relative to real time, or to one step per frame.
fn speed(ui: &mut Ui, viewer: &mut Viewer) -> Option<Command> {
    let mut asked = row(ui, &[("−", "slower: -", Command::ChangeSpeed { faster: false })]);
    let pace = &mut viewer.session.pace;
    let name = |speed: f64| if speed < 1.0 { format!("1/{}×", (1.0 / speed).round()) } else { format!("{speed}×") };
    let mut speed = pace.speed();
    egui::ComboBox::from_id_salt("speed").width(52.0).selected_text(name(speed)).show_ui(ui, |ui| {
        for other in SPEEDS {
            ui.selectable_value(&mut speed, other, name(other));
        }
    });
    if speed != pace.speed() {
        pace.set_speed(speed);
    }
    asked = asked.or(row(ui, &[("+", "faster: +", Command::ChangeSpeed { faster: true })]));
    let mut real_time = pace.real_time;
    let about = "Steps follow the clock. Otherwise each frame is one step (T).";
    if ui.checkbox(&mut real_time, "real time").on_hover_text(about).changed() {
        asked = Some(Command::ToggleRealTime);
    }
    asked
}

/// Shows the simulated time, and a slider over the recorded states.
fn past(ui: &mut Ui, viewer: &mut Viewer) {
    let session = &mut viewer.session;
    let now = session.simulation_ref().report().time;
    ui.monospace(format!("{now:8.2} s")).on_hover_text("simulated time");
    if !session.can_rewind() {
        ui.label(RichText::new("too large to go back").weak())
            .on_hover_text("The states of the last seconds need too much memory.");
        return;
    }
    let mut times = session.past().times();
    let (first, last) = (times.next().unwrap_or(now).min(now), times.next_back().unwrap_or(now).max(now));
    drop(times);
    let mut at = now;
    ui.spacing_mut().slider_width = (ui.available_width() - 12.0).max(40.0);
    let slider = egui::Slider::new(&mut at, first..=last.max(first + 1e-9)).show_value(false);
    let slider = ui.add_enabled(last > first, slider);
    let about = format!("the last {:.1} s: drag to go back, or use , and .", last - first);
    if slider.on_hover_text(about).changed() && last > first {
        session.seek(at);
    }
}

fn capture(ui: &mut Ui, viewer: &mut Viewer) -> Option<Command> {
    let now = viewer.session.now();
    if let Some(seconds) = viewer.capture.length(now) {
        let text = RichText::new(format!("End the recording ({seconds:.0} s)")).color(Color32::from_rgb(0xa8, 0x1e, 0x1e));
        ui.ctx().request_repaint_after_secs(0.5);
        if ui.button(text).clicked() {
            viewer.stop_recording();
        }
    } else {
        if viewer.capture.is_ending() {
            ui.label(RichText::new("writing the film").weak());
            ui.ctx().request_repaint_after_secs(0.2);
        }
        ui.menu_button("Record", |ui| menu::recording(ui, viewer));
    }
    ui.button("Screenshot").on_hover_text("saves the picture as PNG: F12").clicked().then_some(Command::Screenshot)
}
