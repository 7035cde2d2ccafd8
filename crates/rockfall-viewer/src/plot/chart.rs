//! Draws plots beside a picture.

use rockfall::Result;

use super::axes::{exponent, label, multiples, step};
use super::{Plots, Quantity};
use crate::palette::Rgb;
use crate::pixels::Picture;
use crate::sheet::{INK, Sheet, letters};

/// The colours of a plot.
struct Paper {
    paper: [u8; 4],
    grid: [f32; 3],
    axis: [f32; 3],
    ink: [f32; 3],
    /// Part of white in the lines.
    white: f32,
}

const LIGHT: Paper = Paper { paper: [255; 4], grid: [0.88, 0.89, 0.90], axis: [0.45, 0.48, 0.52], ink: INK, white: 0.0 };
/// For pictures with a dark background.
const DARK: Paper =
    Paper { paper: [22, 24, 28, 255], grid: [0.20, 0.22, 0.25], axis: [0.58, 0.61, 0.65], ink: [0.90, 0.92, 0.94], white: 0.4 };
/// Part of the width of a wide picture, and of the height of a high one, that the plots take.
const PART: f32 = 0.36;
/// Height of the letters, divided by that of other text.
const LETTERS: f32 = 0.72;

impl Paper {
    /// The colour of a line that has this one on white paper.
    fn line(&self, colour: Rgb) -> Rgb {
        colour.map(|channel| (f32::from(channel) + self.white * (255.0 - f32::from(channel))).round() as u8)
    }
}

/// Where the scene and the plots are in a picture: the plots are to the right in a wide picture, and below in others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Width and height of the whole picture.
    size: [u32; 2],
    /// Width and height of the picture of the scene, in the upper left corner.
    scene: [u32; 2],
    dark: bool,
}

impl Layout {
    /// Divides a picture between the scene and a number of plots.
    pub fn new(size: [u32; 2], plots: usize) -> Self {
        let [width, height] = size;
        let rest = |side: u32| (side - (PART * side as f32).round() as u32).max(1);
        let scene = match plots {
            0 => size,
            _ if width as f32 >= 1.2 * height as f32 => [rest(width), height],
            _ => [width, rest(height)],
        };
        Self { size, scene, dark: false }
    }

    /// Sets whether the plots are dark, for a picture with a dark background.
    pub fn dark(self, dark: bool) -> Self {
        Self { dark, ..self }
    }

    /// Width and height of the picture of the scene.
    pub fn scene(&self) -> [u32; 2] {
        self.scene
    }

    /// Adds the plots to a picture of the scene.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the built-in font cannot be read, which does not happen in practice.
    pub fn complete(&self, scene: Picture, plots: &Plots) -> Result<Picture> {
        if self.scene == self.size || plots.is_empty() {
            return Ok(scene);
        }
        let [width, height] = self.size;
        let paper = if self.dark { &DARK } else { &LIGHT };
        let mut picture = Picture { width, height, pixels: vec![paper.paper; width as usize * height as usize] };
        let rows = picture.pixels.chunks_mut(width as usize).zip(scene.pixels.chunks(scene.width as usize));
        rows.for_each(|(to, from)| to[..from.len()].copy_from_slice(from));
        let [left, top] = if self.scene[0] < width { [self.scene[0] as f32, 0.0] } else { [0.0, self.scene[1] as f32] };
        let mut sheet = Sheet::new(&mut picture)?;
        sheet.ink = paper.ink;
        sheet.em = (LETTERS * letters(height.min(width))).max(8.0);
        let high = (height as f32 - top) / plots.len() as f32;
        for graph in 0..plots.len() {
            let top = top + high * graph as f32;
            Chart { plots, graph, paper, bottom: top + high, right: width as f32 }.draw(&mut sheet, left, top);
        }
        Ok(picture)
    }
}

/// One plot in a rectangle.
struct Chart<'a> {
    plots: &'a Plots,
    graph: usize,
    paper: &'a Paper,
    right: f32,
    bottom: f32,
}

/// The rectangle of the lines, and the ranges of the axes.
struct Field {
    corners: [f32; 4],
    times: [f64; 2],
    values: [f64; 2],
}

impl Field {
    /// The place of a point; values outside of the range are at its end.
    fn place(&self, [time, value]: [f64; 2]) -> [f32; 2] {
        let [left, top, right, bottom] = self.corners;
        let part = |value: f64, [from, to]: [f64; 2]| ((value - from) / (to - from)).clamp(0.0, 1.0) as f32;
        [left + part(time, self.times) * (right - left), bottom - part(value, self.values) * (bottom - top)]
    }
}

impl Chart<'_> {
    fn draw(&self, sheet: &mut Sheet<'_>, left: f32, top: f32) {
        let em = sheet.em;
        let (times, values) = (self.plots.times(), self.plots.range(self.graph));
        let power = exponent(values);
        let below = self.legend(sheet, [left + 0.8 * em, top + 0.6 * em], power);
        let bottom = self.bottom - 3.0 * em;
        if bottom < below + 1.5 * em {
            return;
        }
        let least = self.least_step();
        let tick = step(values, f64::from((bottom - below) / (2.2 * em))).map(|step| step.max(least));
        let labels: Vec<(f64, String)> = tick
            .map_or_else(Vec::new, |step| multiples(values, step).map(|value| (value, label(value, step, power))).collect());
        let widest = labels.iter().map(|(_, label)| sheet.width(label)).fold(0.0, f32::max);
        let corners = [left + 1.4 * em + widest, below, self.right - 1.2 * em, bottom];
        if corners[2] < corners[0] + em {
            return;
        }
        let field = Field { corners, times, values };
        for (value, label) in &labels {
            let [_, y] = field.place([times[0], *value]);
            sheet.fill([corners[0], y.round(), corners[2], y.round() + 1.0], self.paper.grid, |_, _| 1.0);
            sheet.text(label, corners[0] - 0.4 * em - sheet.width(label), y - 0.5 * em);
        }
        time_axis(sheet, &field, self.paper.axis);
        self.lines(sheet, &field);
    }

    /// There is no half of a contact.
    fn least_step(&self) -> f64 {
        if self.plots.graphs()[self.graph].quantity == Quantity::Contacts { 1.0 } else { 0.0 }
    }

    /// Writes the quantity and the names of the lines, and returns where the field begins.
    fn legend(&self, sheet: &mut Sheet<'_>, [left, top]: [f32; 2], power: i32) -> f32 {
        let em = sheet.em;
        let graph = &self.plots.graphs()[self.graph];
        let factor = if power == 0 { String::new() } else { format!("1e{power} ") };
        let title = match (graph.quantity.unit(), factor.trim()) {
            ("", "") => graph.quantity.title().to_owned(),
            (unit, _) => format!("{} in {factor}{unit}", graph.quantity.title()),
        };
        let title = if graph.quantity == Quantity::Energy { format!("{title}, potential 0 at the start") } else { title };
        sheet.text(&title, left, top);
        let (mut x, mut y) = (left, top + 1.4 * em);
        let mut is_empty = true;
        for (name, colour) in graph.lines.iter().filter(|(name, _)| !name.is_empty()) {
            let width = 1.5 * em + sheet.width(name);
            if !is_empty && x + width > self.right - 0.5 * em {
                (x, y) = (left, y + 1.3 * em);
            }
            sheet.line([[x, y + 0.5 * em], [x + 1.0 * em, y + 0.5 * em]], 0.2 * em, self.paper.line(*colour), 1.0);
            sheet.text(name, x + 1.4 * em, y);
            (x, is_empty) = (x + width + 0.8 * em, false);
        }
        if is_empty { y + 0.3 * em } else { y + 1.6 * em }
    }

    fn lines(&self, sheet: &mut Sheet<'_>, field: &Field) {
        let em = sheet.em;
        let lines = &self.plots.graphs()[self.graph].lines;
        // The first line is drawn last, over the others.
        for (index, (_, colour)) in lines.iter().enumerate().rev() {
            let points: Vec<[f64; 2]> = self.plots.points(self.graph, index).collect();
            let is_shown = |point: &[f64; 2]| point[1].is_finite() && (field.times[0]..=field.times[1]).contains(&point[0]);
            for pair in points.windows(2).filter(|pair| pair.iter().all(is_shown)) {
                sheet.line([field.place(pair[0]), field.place(pair[1])], (0.13 * em).max(1.2), self.paper.line(*colour), 1.0);
            }
            if let Some(last) = points.last().filter(|last| is_shown(last)) {
                dot(sheet, field.place(*last), self.paper.line(*colour));
            }
        }
    }
}

/// Marks the present value.
fn dot(sheet: &mut Sheet<'_>, at: [f32; 2], colour: Rgb) {
    sheet.line([at, at], 0.45 * sheet.em, colour, 1.0);
}

fn time_axis(sheet: &mut Sheet<'_>, field: &Field, axis: [f32; 3]) {
    let em = sheet.em;
    let [left, top, right, bottom] = field.corners;
    sheet.fill([left, top, left + 1.0, bottom], axis, |_, _| 1.0);
    sheet.fill([left, bottom, right, bottom + 1.0], axis, |_, _| 1.0);
    let power = exponent(field.times);
    let most = f64::from((right - left) / (3.2 * em));
    for value in step(field.times, most).into_iter().flat_map(|step| multiples(field.times, step).map(move |at| (at, step))) {
        let text = label(value.0, value.1, power);
        let [x, _] = field.place([value.0, 0.0]);
        sheet.fill([x.round(), bottom, x.round() + 1.0, bottom + 0.3 * em], axis, |_, _| 1.0);
        let width = sheet.width(&text);
        sheet.text(&text, (x - 0.5 * width).min(right + em - width), bottom + 0.45 * em);
    }
    let name = if power == 0 { "time in s".to_owned() } else { format!("time in 1e{power} s") };
    sheet.text(&name, 0.5 * (left + right - sheet.width(&name)), bottom + 1.65 * em);
}
