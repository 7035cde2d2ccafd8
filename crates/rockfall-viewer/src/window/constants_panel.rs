//! Sliders and switches of all constants, with their units.

use egui::{RichText, Ui};
use rockfall::settings::Constant as Entry;
use rockfall::{ContactLaw, Precision, Settings};

use super::constants::CONSTANTS;
use super::controls::Controls;
use super::session::concerns::SETTLED;
use super::viewer::Viewer;

/// Shows all entries of [`Settings::TABLE`]: a slider or a field for a number, a switch, three fields for a direction, or
/// the names of the contact laws or of the precisions.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    let before = *viewer.session.settings();
    let mut settings = before;
    ui.spacing_mut().slider_width = 64.0;
    ui.spacing_mut().interact_size.x = 44.0;
    for entry in Settings::TABLE {
        let is_used = is_used(entry.name, before.contact_law);
        let changed = ui.add_enabled_ui(is_used, |ui| constant(ui, &mut settings, entry, viewer.controls)).inner;
        if let Err(error) = changed {
            viewer.session.fail(&error);
        }
    }
    time_step(ui, viewer);
    let defaults = Settings::default();
    let button = egui::Button::new("Defaults").small();
    if ui.add_enabled(settings != defaults, button).on_hover_text("sets all constants to their defaults").clicked() {
        settings = defaults;
    }
    if settings != before {
        viewer.session.change_settings(|present| *present = settings);
        repaint_for_warnings(ui);
    }
}

/// Constants that only the contact law of the thesis uses.
const OF_THESIS: [&str; 4] = ["contact_force", "contact_damping", "friction", "resting_overlap"];

/// Constants that the contact law `rigid` uses, with the law itself.
const OF_RIGID: [&str; 5] = ["restitution", "coulomb_friction", "gravity", "gravity_direction", "contact_law"];

/// Whether a contact law uses a constant. The panel shows the others grey.
fn is_used(name: &str, law: ContactLaw) -> bool {
    match law {
        ContactLaw::Rigid => OF_RIGID.contains(&name),
        law => !law.has_history() || !OF_THESIS.contains(&name),
    }
}

fn time_step(ui: &mut Ui, viewer: &mut Viewer) {
    if let Some(playback) = viewer.session.played() {
        let text =
            |seconds: Option<f32>| seconds.map_or("none".to_owned(), |seconds| format!("{} ms", short(1000.0 * seconds)));
        let [step, interval] = [playback.step_of_run(), playback.time_step()].map(text);
        row(ui, "time step", "Time step of the run that wrote the trajectory.", |ui| drop(ui.label(step)));
        row(ui, "frame every", "Simulated time between two frames of the trajectory.", |ui| drop(ui.label(interval)));
        return;
    }
    let mut milliseconds = viewer.session.pace.time_step * 1000.0;
    row(ui, "time step", "Simulated time of one step.", |ui| {
        let field = egui::DragValue::new(&mut milliseconds).speed(0.1).max_decimals(4).suffix(" ms");
        if ui.add(field).changed() {
            viewer.session.set_time_step(milliseconds / 1000.0);
            repaint_for_warnings(ui);
        }
    });
}

/// Rounds to six digits, so that rounding errors do not show.
fn short(number: f32) -> f32 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

/// Warnings about a new value appear some time later, when nothing else may cause a frame.
fn repaint_for_warnings(ui: &Ui) {
    ui.ctx().request_repaint_after_secs(SETTLED as f32 + 0.1);
}

/// Shows a label, and widgets to its right.
pub(super) fn row(ui: &mut Ui, label: &str, about: &str, add: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        let size = egui::vec2(108.0, ui.spacing().interact_size.y);
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        ui.allocate_ui_with_layout(size, layout, |ui| {
            ui.set_min_width(size.x);
            ui.label(label).on_hover_text(about);
        });
        add(ui);
    });
}

/// Shows a constant, and changes it. A value that is not allowed changes nothing and is an error.
fn constant(ui: &mut Ui, settings: &mut Settings, entry: &Entry, controls: Controls) -> rockfall::Result<()> {
    let Some(text) = settings.get(entry.name) else { return Ok(()) };
    let about = about(entry, controls);
    let mut changed = None;
    row(ui, &label(entry.name), &about, |ui| changed = value(ui, entry, &text, &about));
    changed.map_or(Ok(()), |text| settings.set(entry.name, &text))
}

/// Shows the value of a constant, and returns the text of a new value.
fn value(ui: &mut Ui, entry: &Entry, text: &str, about: &str) -> Option<String> {
    if let Some(mut on) = switch(text) {
        return ui.checkbox(&mut on, "").on_hover_text(about).changed().then(|| if on { "on" } else { "off" }.to_owned());
    }
    if let Some(names) = names(text) {
        return choice(ui, entry, text, about, &names);
    }
    let mut numbers: Vec<f32> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
    let changed = match (numbers.as_mut_slice(), entry.slider) {
        ([number], Some((low, high))) => {
            let slider = egui::Slider::new(number, low..=high).clamping(egui::SliderClamping::Never).max_decimals(3);
            ui.add(slider).on_hover_text(about).changed()
        }
        (numbers, _) => {
            let fields = numbers.iter_mut().map(|number| egui::DragValue::new(number).speed(0.01).max_decimals(4));
            // All fields have to be shown.
            fields.fold(false, |changed, field| ui.add(field).on_hover_text(about).changed() | changed)
        }
    };
    ui.label(RichText::new(entry.unit).weak().small());
    changed.then(|| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(","))
}

/// The names to choose from, for a value that is a name.
fn names(text: &str) -> Option<Vec<&'static str>> {
    // Only a program can give the law `user`.
    let offered = |law: &ContactLaw| *law != ContactLaw::User || text == law.name();
    let laws = ContactLaw::ALL.into_iter().filter(offered).map(ContactLaw::name).collect();
    let precisions = Precision::ALL.into_iter().map(Precision::name).collect();
    [laws, precisions].into_iter().find(|names: &Vec<&str>| names.contains(&text))
}

/// Shows names, and returns the one that was chosen.
fn choice(ui: &mut Ui, entry: &Entry, text: &str, about: &str, names: &[&str]) -> Option<String> {
    let mut chosen = text.to_owned();
    let box_of_names = egui::ComboBox::from_id_salt(entry.name).selected_text(text);
    let shown = box_of_names.show_ui(ui, |ui| {
        for name in names {
            ui.selectable_value(&mut chosen, (*name).to_owned(), *name);
        }
    });
    shown.response.on_hover_text(about);
    (chosen != text).then_some(chosen)
}

fn switch(text: &str) -> Option<bool> {
    match text {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

/// Returns the name of a constant in the panel.
fn label(name: &str) -> String {
    let known = CONSTANTS.iter().find(|constant| constant.name == name);
    known.map_or_else(|| name.replace('_', " "), |constant| constant.label.to_owned())
}

/// Returns the tooltip of a constant: its name in scene files, its meaning, default and keys.
fn about(entry: &Entry, controls: Controls) -> String {
    let known = CONSTANTS.iter().find(|constant| constant.name == entry.name);
    let meaning = known.map_or_else(|| entry.doc.trim(), |constant| constant.about);
    let default = Settings::default().get(entry.name).unwrap_or_default();
    let keys = known.map_or_else(String::new, |constant| {
        let shift = if constant.up == 'f' && controls == Controls::Standard { "Shift+" } else { "" };
        format!("\nKeys: {shift}{} up, {} down.", constant.up.to_ascii_uppercase(), constant.down.to_ascii_uppercase())
    });
    format!("{}: {meaning}\nDefault: {default} {}{keys}", entry.name, entry.unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_of_the_other_contact_law_are_grey() {
        let grey = |law: ContactLaw| Settings::NAMES.iter().filter(|name| !is_used(name, law)).count();
        assert_eq!(
            [ContactLaw::Thesis, ContactLaw::HertzMindlin, ContactLaw::Linear, ContactLaw::Rigid].map(grey),
            [0, OF_THESIS.len(), OF_THESIS.len(), Settings::NAMES.len() - OF_RIGID.len()]
        );
    }

    /// Every constant is a switch, a name, a number or a direction, so that the panel can show it.
    #[test]
    fn every_constant_has_a_widget_and_a_unit_where_it_needs_one() {
        let settings = Settings::default();
        for entry in Settings::TABLE {
            let text = settings.get(entry.name).unwrap();
            let numbers = text.split(',').filter(|number| number.parse::<f32>().is_ok()).count();
            assert!(
                switch(&text).is_some() || names(&text).is_some() || numbers == 1 || numbers == 3,
                "{}: {text}",
                entry.name
            );
            assert!(about(entry, Controls::Standard).contains(entry.unit), "{}", entry.name);
        }
    }
}
