//! Draws plots beside a picture.

use rockfall::Result;

use super::axes::{exponent, label, multiples, step};
use super::{Plots, Quantity};
use crate::mark::Mark;
use crate::palette::Rgb;
use crate::pixels::Picture;
use crate::sheet::{Sheet, letters};

/// The colours of a plot.
struct Paper {
    paper: Rgb,
    grid: Rgb,
    axis: Rgb,
    ink: Rgb,
    /// Part of white in the lines.
    white: f32,
}

const LIGHT: Paper =
    Paper { paper: [255; 3], grid: [224, 227, 230], axis: [115, 122, 133], ink: [0x21, 0x29, 0x33], white: 0.0 };
/// For pictures with a dark background.
const DARK: Paper = Paper { paper: [22, 24, 28], grid: [51, 56, 64], axis: [148, 156, 166], ink: [230, 235, 240], white: 0.4 };
/// Part of the width of a wide picture, and of the height of a high one, that the plots take.
const PART: f32 = 0.36;
/// Height of the letters, divided by that of other text.
const LETTERS: f32 = 0.72;

/// Least height and width of a plot with two ticks, in heights of its letters.
const LEAST_HEIGHT: f32 = 9.5;
const LEAST_WIDTH: f32 = 12.0;

impl Paper {
    /// The colour of a line that has this one on white paper.
    fn line(&self, colour: Rgb) -> Rgb {
        colour.map(|channel| (f32::from(channel) + self.white * (255.0 - f32::from(channel))).round() as u8)
    }
}

/// Where the scene and the plots are in a picture: the plots are to the right in a wide picture, one below the other, and below in
/// others, side by side.
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
            _ if is_wide(size) => [rest(width), height],
            _ => [width, rest(height)],
        };
        Self { size, scene, dark: false }
    }

    /// The greatest number of plots that fit into a picture with their axes; one always fits.
    pub fn most_plots(size: [u32; 2]) -> usize {
        let [side, least] = if is_wide(size) { [size[1] as f32, LEAST_HEIGHT] } else { [size[0] as f32, LEAST_WIDTH] };
        ((side / (least * letters_of(size))) as usize).max(1)
    }

    /// Checks that a number of plots fit into a picture.
    ///
    /// # Errors
    /// A text that says how many do.
    pub fn check(size: [u32; 2], plots: usize) -> std::result::Result<(), String> {
        let ([width, height], most) = (size, Self::most_plots(size));
        if plots <= most {
            return Ok(());
        }
        Err(format!("{plots} plots do not fit into a picture of {width}x{height}, expected at most {most}"))
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
        let mut picture = Picture { width, height, pixels: vec![[255; 4]; width as usize * height as usize] };
        let rows = picture.pixels.chunks_mut(width as usize).zip(scene.pixels.chunks(scene.width as usize));
        rows.for_each(|(to, from)| to[..from.len()].copy_from_slice(from));
        let mut sheet = Sheet::new(&mut picture)?;
        let marks = self.marks(plots, &|text, em| sheet.width_of(text, em));
        marks.iter().for_each(|mark| mark.draw(&mut sheet));
        Ok(picture)
    }

    /// Returns the marks of the plots on the whole picture, with their background. `measure` returns the width of a text with
    /// letters of a height, in pixels.
    pub fn marks(&self, plots: &Plots, measure: &dyn Fn(&str, f32) -> f32) -> Vec<Mark> {
        if self.scene == self.size || plots.is_empty() {
            return Vec::new();
        }
        let [width, height] = self.size;
        let paper = if self.dark { &DARK } else { &LIGHT };
        let [left, top] = if self.scene[0] < width { [self.scene[0] as f32, 0.0] } else { [0.0, self.scene[1] as f32] };
        let em = letters_of(self.size);
        let mut pen = Pen { em, ink: paper.ink, measure, marks: Vec::new() };
        pen.fill([left, top, width as f32, height as f32], paper.paper);
        // Plots below a picture are side by side.
        let share =
            |side: u32, from: f32, is_divided: bool| (side as f32 - from) / if is_divided { plots.len() as f32 } else { 1.0 };
        let is_below = self.scene[1] < height;
        let [wide, high] = [share(width, left, is_below), share(height, top, !is_below)];
        for graph in 0..plots.len() {
            let (across, down) = if is_below { (graph as f32, 0.0) } else { (0.0, graph as f32) };
            let [left, top] = [left + wide * across, top + high * down];
            Chart { plots, graph, paper, bottom: top + high, right: left + wide }.draw(&mut pen, left, top);
        }
        pen.marks
    }
}

/// Whether plots are beside the scene, and not below it.
fn is_wide([width, height]: [u32; 2]) -> bool {
    width as f32 >= 1.2 * height as f32
}

/// Height of the letters of plots, in pixels.
fn letters_of([width, height]: [u32; 2]) -> f32 {
    (LETTERS * letters(height.min(width))).max(8.0)
}

/// Collects marks.
struct Pen<'a> {
    em: f32,
    ink: Rgb,
    measure: &'a dyn Fn(&str, f32) -> f32,
    marks: Vec<Mark>,
}

impl Pen<'_> {
    fn width(&self, text: &str) -> f32 {
        (self.measure)(text, self.em)
    }

    fn text(&mut self, text: &str, left: f32, top: f32) {
        let (em, colour) = (self.em, self.ink);
        self.marks.push(Mark::Text { text: text.to_owned(), at: [left, top], align: [0.0; 2], em, colour, panel: false });
    }

    fn fill(&mut self, sides: [f32; 4], colour: Rgb) {
        self.marks.push(Mark::Rectangle { sides, colour });
    }

    fn line(&mut self, ends: [[f32; 2]; 2], width: f32, colour: Rgb) {
        self.marks.push(Mark::Line { ends, width, colour, opacity: 1.0 });
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
    fn draw(&self, pen: &mut Pen<'_>, left: f32, top: f32) {
        let em = pen.em;
        let (times, values) = (self.plots.times(), self.plots.range(self.graph));
        let power = exponent(values);
        let below = self.legend(pen, [left + 0.8 * em, top + 0.6 * em], power);
        let bottom = self.bottom - 3.0 * em;
        if bottom < below + 1.5 * em {
            return;
        }
        let least = self.least_step();
        let tick = step(values, f64::from((bottom - below) / (2.2 * em))).map(|step| step.max(least));
        let labels: Vec<(f64, String)> = tick
            .map_or_else(Vec::new, |step| multiples(values, step).map(|value| (value, label(value, step, power))).collect());
        let widest = labels.iter().map(|(_, label)| pen.width(label)).fold(0.0, f32::max);
        let corners = [left + 1.4 * em + widest, below, self.right - 1.2 * em, bottom];
        if corners[2] < corners[0] + em {
            return;
        }
        let field = Field { corners, times, values };
        for (value, label) in &labels {
            let [_, y] = field.place([times[0], *value]);
            pen.fill([corners[0], y.round(), corners[2], y.round() + 1.0], self.paper.grid);
            pen.text(label, corners[0] - 0.4 * em - pen.width(label), y - 0.5 * em);
        }
        time_axis(pen, &field, self.paper.axis);
        self.lines(pen, &field);
    }

    /// There is no half of a contact.
    fn least_step(&self) -> f64 {
        if self.plots.graphs()[self.graph].quantity == Quantity::Contacts { 1.0 } else { 0.0 }
    }

    /// Writes the quantity and the names of the lines, and returns where the field begins.
    fn legend(&self, pen: &mut Pen<'_>, [left, top]: [f32; 2], power: i32) -> f32 {
        let em = pen.em;
        let graph = &self.plots.graphs()[self.graph];
        let factor = if power == 0 { String::new() } else { format!("1e{power} ") };
        let title = match (graph.unit(), factor.trim()) {
            ("", "") => graph.quantity.title().to_owned(),
            (unit, _) => format!("{} in {factor}{unit}", graph.quantity.title()),
        };
        let mut y = top + 1.4 * em;
        let start = "potential 0 at the start";
        let whole = if graph.quantity == Quantity::Energy { format!("{title}, {start}") } else { title.clone() };
        if whole != title && left + pen.width(&whole) > self.right - 0.3 * em {
            pen.text(&title, left, top);
            pen.text(start, left, y);
            y += 1.4 * em;
        } else {
            pen.text(&whole, left, top);
        }
        let mut x = left;
        let mut is_empty = true;
        for (_, (name, colour)) in self.plots.lines(self.graph).filter(|(_, (name, _))| !name.is_empty()) {
            let width = 1.5 * em + pen.width(name);
            if !is_empty && x + width > self.right - 0.5 * em {
                (x, y) = (left, y + 1.3 * em);
            }
            pen.line([[x, y + 0.5 * em], [x + 1.0 * em, y + 0.5 * em]], 0.2 * em, self.paper.line(*colour));
            pen.text(name, x + 1.4 * em, y);
            (x, is_empty) = (x + width + 0.8 * em, false);
        }
        if is_empty { y + 0.3 * em } else { y + 1.6 * em }
    }

    fn lines(&self, pen: &mut Pen<'_>, field: &Field) {
        let em = pen.em;
        let lines: Vec<_> = self.plots.lines(self.graph).collect();
        // The first line is drawn last, over the others.
        for (index, (_, colour)) in lines.into_iter().rev() {
            let points: Vec<[f64; 2]> = self.plots.points(self.graph, index).collect();
            let is_shown = |point: &[f64; 2]| point[1].is_finite() && (field.times[0]..=field.times[1]).contains(&point[0]);
            for pair in points.windows(2).filter(|pair| pair.iter().all(is_shown)) {
                pen.line([field.place(pair[0]), field.place(pair[1])], (0.13 * em).max(1.2), self.paper.line(*colour));
            }
            if let Some(last) = points.last().filter(|last| is_shown(last)) {
                dot(pen, field.place(*last), self.paper.line(*colour));
            }
        }
    }
}

/// Marks the present value.
fn dot(pen: &mut Pen<'_>, at: [f32; 2], colour: Rgb) {
    pen.line([at, at], 0.45 * pen.em, colour);
}

fn time_axis(pen: &mut Pen<'_>, field: &Field, axis: Rgb) {
    let em = pen.em;
    let [left, top, right, bottom] = field.corners;
    pen.fill([left, top, left + 1.0, bottom], axis);
    pen.fill([left, bottom, right, bottom + 1.0], axis);
    let power = exponent(field.times);
    let most = f64::from((right - left) / (3.2 * em));
    for value in step(field.times, most).into_iter().flat_map(|step| multiples(field.times, step).map(move |at| (at, step))) {
        let text = label(value.0, value.1, power);
        let [x, _] = field.place([value.0, 0.0]);
        pen.fill([x.round(), bottom, x.round() + 1.0, bottom + 0.3 * em], axis);
        let width = pen.width(&text);
        pen.text(&text, (x - 0.5 * width).min(right + em - width), bottom + 0.45 * em);
    }
    let name = if power == 0 { "time in s".to_owned() } else { format!("time in 1e{power} s") };
    pen.text(&name, 0.5 * (left + right - pen.width(&name)), bottom + 1.65 * em);
}
