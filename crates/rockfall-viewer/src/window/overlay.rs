//! Text, arrows and trails over the picture.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Ui};

use super::viewer::Viewer;
use crate::overlay::{Arrows, Mark};
use crate::palette::Rgb;

const PANEL: Color32 = Color32::from_rgba_premultiplied(209, 209, 209, 209);
/// Length of the trails that the menu switches on, in s.
const TRAILS: f64 = 2.0;

/// Draws marks; `scale` is the size of a pixel in points, and `origin` the upper left corner of the picture.
pub(super) fn show(painter: &Painter, origin: Pos2, scale: f32, marks: &[Mark]) {
    let place = |at: [f32; 2]| origin + scale * egui::vec2(at[0], at[1]);
    for mark in marks {
        match mark {
            Mark::Line { ends, width, colour, opacity } => {
                painter.line_segment(ends.map(place), Stroke::new(scale * width, of(*colour).gamma_multiply(*opacity)));
            }
            Mark::Triangle { corners, colour } => {
                painter.add(Shape::convex_polygon(corners.map(place).to_vec(), of(*colour), Stroke::NONE));
            }
            Mark::Rectangle { sides: [left, top, right, bottom], colour } => {
                painter.rect_filled(Rect::from_two_pos(place([*left, *top]), place([*right, *bottom])), 0.0, of(*colour));
            }
            Mark::Text { text, at, align, em, colour, panel } => {
                let (font, ink) = (FontId::proportional(scale * em), of(*colour));
                let galley = painter.layout_no_wrap(text.clone(), font.clone(), ink);
                let margin = if *panel { 0.3 * scale * em } else { 0.0 };
                let size = galley.size() + egui::Vec2::splat(2.0 * margin);
                let left_top = place(*at) - egui::vec2(align[0] * size.x, align[1] * size.y);
                if *panel {
                    painter.rect_filled(Rect::from_min_size(left_top, size), 0.4 * scale * em, PANEL);
                }
                painter.text(left_top + egui::Vec2::splat(margin), Align2::LEFT_TOP, text, font, ink);
            }
        }
    }
}

fn of([red, green, blue]: Rgb) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// Shows the switches of the menu.
pub(super) fn switches(ui: &mut Ui, viewer: &mut Viewer) {
    let overlay = &mut viewer.overlay;
    ui.checkbox(&mut overlay.clock, "Time");
    ui.checkbox(&mut overlay.scale_bar, "Scale bar");
    ui.checkbox(&mut overlay.labels, "Labels or numbers of spheres");
    ui.checkbox(&mut overlay.joints, "Joints");
    let mut has_trails = overlay.trails > 0.0;
    let seconds = if has_trails { overlay.trails } else { TRAILS };
    let of = if overlay.trails_of.is_empty() { String::new() } else { format!(", {}", overlay.trails_of.join(", ")) };
    if ui.checkbox(&mut has_trails, format!("Trails of {seconds} s{of}")).changed() {
        overlay.trails = if has_trails { seconds } else { 0.0 };
    }
    ui.radio_value(&mut overlay.arrows, None, "No arrows");
    ui.radio_value(&mut overlay.arrows, Some(Arrows::Velocity), "Arrows of velocity");
    ui.radio_value(&mut overlay.arrows, Some(Arrows::Force), "Arrows of force");
    ui.radio_value(&mut overlay.arrows, Some(Arrows::Gravity), "Arrows of gravity");
}
