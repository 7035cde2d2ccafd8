//! The values of the picked body and its motion over time, in a window of its own, so that the panel does not move.

use std::collections::VecDeque;

use egui::{Id, Pos2, Rect, RichText, Ui, Vec2};
use egui_plot::{Line, PlotPoints};
use rockfall::glam::Vec3;

use super::track::Point;
use super::viewer::Viewer;
use super::{marks, plots};
use crate::palette::Rgb;
use crate::plot::{Quantity, colours_of};
use crate::whole::ball;

const WIDTH: f32 = 300.0;
/// Size of the text of the values, in points.
const TEXT: f32 = 11.0;
const PLOT_HEIGHT: f32 = 84.0;
/// Number of points above which only some are drawn.
const MOST_POINTS: usize = 1000;
/// Distance of the window from the edges of the picture, in points.
const EDGE: f32 = 8.0;
/// Height that the window is taken to have before it is shown, in points.
const HEIGHT: f32 = 400.0;

/// Shows the window if a body is picked. It opens in the upper left corner of the picture, beside its middle, or where that would
/// cover the body, in the upper right one.
pub(super) fn show(ui: &Ui, area: Rect, viewer: &mut Viewer) {
    let Some(facts) = viewer.session.watch.facts().cloned().filter(|_| viewer.session.picked().is_some()) else {
        return;
    };
    let mut open = true;
    let id = Id::unique("picked body");
    let mut window = egui::Window::new(&facts.title).id(id).open(&mut open).resizable(false);
    if let Some(place) = way_out(ui, area, viewer, id) {
        window = window.current_pos(place);
    }
    window.default_pos(left(area)).constrain_to(area).show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        egui::Grid::new("picked").num_columns(2).spacing([8.0, 2.0]).show(ui, |ui| {
            for (name, value) in &facts.values {
                ui.label(RichText::new(*name).weak().size(TEXT));
                ui.label(RichText::new(value).monospace().size(TEXT));
                ui.end_row();
            }
        });
        motion(ui, &facts.title, viewer);
    });
    if !open {
        viewer.session.set_picked(None);
    }
}

fn left(area: Rect) -> Pos2 {
    area.left_top() + Vec2::splat(EDGE)
}

/// The place to which the window moves when another body is picked that it would cover: the corner on the other side of the picture.
fn way_out(ui: &Ui, area: Rect, viewer: &Viewer, id: Id) -> Option<Pos2> {
    let picked = viewer.session.picked()?;
    let before = ui.data_mut(|data| {
        let before = data.get_temp(id);
        data.insert_temp(id, picked);
        before
    });
    let (centre, radius) = ball(viewer.session.simulation_ref().scene(), picked).filter(|_| before != Some(picked))?;
    let (at, scale) = marks::project(viewer, area, centre)?;
    let usual = Rect::from_min_size(left(area), egui::vec2(WIDTH, HEIGHT));
    let present = ui.memory(|memory| memory.area_rect(id)).unwrap_or(usual);
    let is_left = at.x < area.center().x;
    let right = area.right_top() + egui::vec2(-EDGE - present.width().max(WIDTH), EDGE);
    present.expand(radius * scale).contains(at).then_some(if is_left { right } else { left(area) })
}

/// Plots a quantity of bodies over time, with a colour for each.
fn plot(ui: &mut Ui, tracks: &[(&str, &VecDeque<Point>)], colours: &[Rgb], quantity: Quantity, up: Vec3) {
    let shown = tracks.iter().map(|(_, points)| {
        let stride = points.len().div_ceil(MOST_POINTS).max(1);
        let value = |point: &Point| f64::from(quantity.of_body((point.position, point.velocity), up));
        // The last point is always drawn.
        points.iter().rev().step_by(stride).map(|point| [point.time, value(point)]).collect()
    });
    let shown: Vec<Vec<[f64; 2]>> = shown.collect();
    let title = format!("{} in {} over time in s", quantity.name(), quantity.unit());
    ui.label(RichText::new(&title).weak().small());
    plots::widened(plots::plot(&title, PLOT_HEIGHT), &shown.concat()).show(ui, |plot| {
        for (((name, _), points), colour) in tracks.iter().zip(shown).zip(colours) {
            plot.line(Line::new(*name, PlotPoints::from(points)).stroke(plots::stroke(*colour)));
        }
    });
}

/// Shows height and speed over time, and the buttons for the table and for several bodies.
fn motion(ui: &mut Ui, title: &str, viewer: &mut Viewer) {
    let up = viewer.session.up();
    let points = viewer.session.track().points();
    if points.is_empty() {
        return;
    }
    let mut tracks = vec![(title, points)];
    tracks.extend(viewer.session.kept().map(|kept| (kept.title.as_str(), kept.track.points())));
    let bodies = viewer.session.picked().into_iter().chain(viewer.session.kept().map(|kept| kept.body));
    let colours = colours_of(viewer.session.simulation_ref().scene(), bodies);
    plot(ui, &tracks, &colours, Quantity::Height, up);
    plot(ui, &tracks, &colours, Quantity::Speed, up);
    if tracks.len() > 1 {
        ui.horizontal_wrapped(|ui| {
            for ((title, _), colour) in tracks.iter().zip(&colours) {
                ui.label(RichText::new(*title).color(plots::colour(*colour)).small());
            }
        });
    }
    let count = points.len();
    let is_kept = viewer.session.is_kept();
    ui.horizontal(|ui| {
        let text = if is_kept { "Leave the plots" } else { "Keep in the plots" };
        if ui.button(text).on_hover_text("shows this body together with the next one that is picked").clicked() {
            viewer.session.toggle_kept();
        }
        if ui.button("Save as CSV").on_hover_text("time, position, velocity, height and speed").clicked() {
            viewer.save_track();
        }
        ui.label(RichText::new(format!("{count} points")).weak().small());
    });
}
