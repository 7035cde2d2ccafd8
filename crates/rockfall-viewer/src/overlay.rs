//! Text, arrows, trails and marks of joints over a picture.

use std::collections::BTreeSet;

use rockfall::{Body, Result, Scene, Simulation, SphereId};

use crate::camera::Camera;
pub use crate::draw::Arrows;
use crate::draw::{Motion, Renderer};
use crate::legend::number;
use crate::palette::Rgb;
use crate::pixels::Picture;
use crate::sheet::{Sheet, lacks, letters, width_of};
use crate::whole::{spheres, whole};

mod corner;
mod joints;
mod labels;
mod projection;

pub use crate::mark::Mark;
use labels::Labels;
use projection::Projection;

/// What is written and drawn over a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Text at the upper edge. A long one has several lines, or smaller letters.
    pub title: Option<String>,
    /// Whether the time of the simulation is shown.
    pub clock: bool,
    /// Whether a bar shows the length of a round number of units at the distance of the middle of the picture.
    pub scale_bar: bool,
    /// Whether spheres have their labels ([`rockfall::Tag`]), or in a scene without labels and without a line `@label -` their numbers:
    /// their references in the scene text, or the order of addition.
    pub labels: bool,
    /// The vector of every sphere that an arrow shows.
    pub arrows: Option<Arrows>,
    /// The value that the arrow of the key shows; by default a round number that follows from the last states.
    pub arrow_key: Option<f32>,
    /// Length of the trails of the spheres, in s of the simulation; 0 for none.
    pub trails: f64,
    /// Names or numbers of the bodies that have trails; empty for all bodies.
    pub trails_of: Vec<String>,
    /// Whether joints are marked: the anchors, and the axes of hinges and sliders.
    pub joints: bool,
    /// Whether the background is dark, so that lines have to be light.
    pub dark: bool,
}

const DARK: Rgb = [0x21, 0x29, 0x33];
const LIGHT: Rgb = [0xe4, 0xe8, 0xec];
const ARROW: Rgb = [0xd5, 0x5e, 0x00];
const EDGING: Rgb = [0xff, 0xff, 0xff];
const TRAIL: Rgb = [0x00, 0x72, 0xb2];
/// Length of the arrow of the key, divided by the height of the picture.
const KEY: f32 = 0.12;
/// Greatest length of the scale bar, divided by the width of the picture.
const BAR: f32 = 0.2;
/// Distance of captions from the edges of the picture, and height of the letters of the title, in heights of letters.
const EDGE: f32 = 0.9;
const TITLE: f32 = 1.2;
/// Heights of the letters of a long title, from the usual one on. The first ones are taken for a single line if that is enough. Then the
/// title has up to [`MOST_LINES`] lines before smaller ones are taken.
const TITLES: [f32; 4] = [TITLE, 1.0, 0.85, 0.7];
const OF_ONE_LINE: usize = 2;
const MOST_LINES: usize = 2;
/// Height of a line of text with its background, in heights of letters.
const LINE: f32 = 1.7;
/// Length of the head of an arrow, in heights of letters.
const HEAD: f32 = 0.7;
/// Width of the outline of an arrow, in heights of letters, which sets it off from bodies of its own colour.
const OUTLINE: f32 = 0.06;

/// The number of the body that a sphere is part of, as [`Overlay::trails_of`] has it: the reference of its first sphere in the scene
/// text, or in a scene without references the index of that sphere.
pub fn body_number(scene: &Scene, sphere: SphereId) -> String {
    let first = spheres(scene, whole(scene, Body::Sphere(sphere))).next().unwrap_or(sphere);
    match scene.reference(first) {
        Some(reference) => reference.to_string(),
        None => Body::Sphere(first).index(scene).map_or_else(|_| String::new(), |index| index.to_string()),
    }
}

/// Parses the length of trails in s, and the names or numbers of the bodies that have them, as in `2` or `2:left,right`.
///
/// # Errors
/// A text that says what was expected.
pub fn trails_of(text: &str) -> std::result::Result<(f64, Vec<String>), String> {
    let (seconds, names) = text.split_once(':').map_or((text, None), |(seconds, names)| (seconds, Some(names)));
    let found = seconds.trim().parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds > 0.0);
    let seconds = found.ok_or_else(|| "expected a finite number of seconds greater than 0".to_owned())?;
    let names: Vec<String> = names.map_or_else(Vec::new, |all| all.split(',').map(|one| one.trim().to_owned()).collect());
    if names.iter().any(String::is_empty) {
        return Err("expected names or numbers of bodies, as in 2:left,right or 2:3".to_owned());
    }
    Ok((seconds, names))
}

impl Renderer {
    /// Takes what an overlay needs of the states of the following [`Renderer::update`].
    pub fn set_overlay(&mut self, overlay: &Overlay) {
        self.want_motion(overlay.needs_places(), overlay.arrows, overlay.trails);
        self.want_joints(overlay.joints);
    }
}

impl Overlay {
    /// Whether it needs the places of the spheres.
    pub fn needs_places(&self) -> bool {
        self.labels || self.arrows.is_some() || self.trails > 0.0
    }

    /// Takes the present state of a simulation that no [`Renderer`] draws, for this overlay and for plots.
    ///
    /// # Errors
    /// As for [`Simulation::contacts`].
    pub fn observe(&self, motion: &mut Motion, simulation: &mut Simulation) -> Result<()> {
        motion.want(self.needs_places(), self.arrows, self.trails);
        motion.want_joints(self.joints);
        motion.update(simulation)?;
        motion.record();
        Ok(())
    }

    /// Part of the height of a picture of this size that the title and the clock take at its upper edge.
    pub fn room_above(&self, [width, height]: [u32; 2]) -> f32 {
        if self.title.is_none() && !self.clock {
            return 0.0;
        }
        let em = letters(height);
        let (lines, letters) = self.title_lines(width as f32, em);
        let more = LINE * letters * (lines.len().max(1) - 1) as f32;
        ((2.0 * EDGE + TITLE) * em + more) / height as f32
    }

    /// The lines of the title that fit beside the clock into a picture of this width, and the height of their letters.
    fn title_lines(&self, width: f32, em: f32) -> (Vec<String>, f32) {
        let Some(title) = &self.title else { return (Vec::new(), TITLE * em) };
        let clock = if self.clock { width_of("t = 000.00 s", em) + (EDGE + 0.6) * em } else { 0.0 };
        let room = (width - 2.0 * EDGE * em - clock).max(em);
        let lines = TITLES.map(|size| (wrapped(title, room - 0.6 * size * em, size * em), size * em));
        let least = lines.iter().map(|(lines, _)| lines.len()).min().unwrap_or(0).max(MOST_LINES);
        let fits = |(lines, em): &&(Vec<String>, f32)| {
            lines.len() <= least && lines.iter().all(|line| width_of(line, *em) <= room - 0.6 * em)
        };
        let single = lines.iter().take(OF_ONE_LINE).filter(fits).find(|(lines, _)| lines.len() == 1);
        single.or_else(|| lines.iter().find(fits)).unwrap_or(&lines[TITLES.len() - 1]).clone()
    }

    /// The letters of the title, and of the labels of a scene if they are shown, that the built-in font lacks. Each is drawn as a box.
    pub fn missing_letters(&self, scene: &Scene) -> Vec<char> {
        let tags = scene.sphere_ids().filter(|_| self.labels).filter_map(|sphere| scene.tag(sphere).ok().flatten());
        let labels = tags.filter_map(|tag| tag.label.as_deref());
        let letters: BTreeSet<char> = self.title.as_deref().into_iter().chain(labels).flat_map(str::chars).collect();
        letters.into_iter().filter(|letter| lacks(*letter)).collect()
    }

    /// A warning that names the letters of [`Overlay::missing_letters`]; `None` if there are none.
    pub fn warning_of_letters(&self, scene: &Scene) -> Option<String> {
        let missing = self.missing_letters(scene);
        let letters: String = missing.iter().take(20).collect();
        let more = if missing.len() > 20 { " and others" } else { "" };
        let text = || format!("the built-in font lacks the letters {letters}{more}, which are drawn as boxes");
        (!missing.is_empty()).then(text)
    }

    /// Draws the overlay for the state that a renderer has.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the built-in font cannot be read, which does not happen in practice.
    pub fn draw(&self, motion: &Motion, camera: &Camera, picture: &mut Picture) -> Result<()> {
        let marks = self.marks_of(motion, camera, [picture.width, picture.height]);
        let mut sheet = Sheet::new(picture)?;
        marks.iter().for_each(|mark| mark.draw(&mut sheet));
        Ok(())
    }

    /// Returns the marks that [`Overlay::draw`] draws on a picture of this size, in pixels.
    pub fn marks_of(&self, motion: &Motion, camera: &Camera, size: [u32; 2]) -> Vec<Mark> {
        self.marks(motion, camera, size.map(|side| side as f32), letters(size[1]))
    }

    /// Returns the marks on a picture of this size, with letters of this height, in pixels.
    pub fn marks(&self, motion: &Motion, camera: &Camera, size: [f32; 2], em: f32) -> Vec<Mark> {
        let projection = Projection::new(camera, size);
        let mut marks = Vec::new();
        if self.trails > 0.0 {
            self.trails(motion, &projection, 0.12 * em, &mut marks);
        }
        if self.joints {
            motion.joints().for_each(|joint| joints::mark(&joint, &projection, em, &mut marks));
        }
        if self.arrows.is_some() {
            let end = self.arrow_key.unwrap_or_else(|| motion.arrow_key());
            let length = KEY * size[1] / projection.pixels_per_unit() / end;
            for (place, arrow) in motion.arrows() {
                if let (Some(from), Some(to)) = (projection.place(place), projection.place(place + length * arrow)) {
                    marks.extend(pointed([from, to], em));
                }
            }
        }
        if self.labels {
            let mut labels = Labels::new(0.75 * em, self.ink());
            for (place, radius, text) in motion.labels() {
                if let Some(at) = projection.place(place) {
                    labels.add(at, radius * projection.pixels_per_unit_at(place), text);
                }
            }
            marks.extend(labels.marks());
        }
        self.captions(motion, &projection, size, em, &mut marks);
        marks
    }

    /// Colour of lines.
    fn ink(&self) -> Rgb {
        if self.dark { LIGHT } else { DARK }
    }

    /// Lines through the past places of the bodies, in their own colours, which fade with age.
    fn trails(&self, motion: &Motion, projection: &Projection, width: f32, marks: &mut Vec<Mark>) {
        for (ends, age, colour) in motion.trails(&self.trails_of) {
            if let [Some(from), Some(to)] = ends.map(|place| projection.place(place)) {
                marks.push(Mark::Line {
                    ends: [from, to],
                    width: width.max(1.0),
                    colour: colour.unwrap_or(TRAIL),
                    opacity: 0.9 * (1.0 - age) + 0.05,
                });
            }
        }
    }

    /// The title, the clock, and the keys of arrows and lengths in the corners.
    fn captions(&self, motion: &Motion, projection: &Projection, [width, height]: [f32; 2], em: f32, marks: &mut Vec<Mark>) {
        let edge = EDGE * em;
        let text = |text: String, at: [f32; 2], align: [f32; 2], em: f32| Mark::Text {
            text,
            at,
            align,
            em,
            colour: DARK,
            panel: true,
        };
        let (lines, letters) = self.title_lines(width, em);
        for (index, line) in lines.into_iter().enumerate() {
            marks.push(text(line, [edge, edge + LINE * letters * index as f32], [0.0, 0.0], letters));
        }
        if self.clock {
            marks.push(text(clock(motion.time()), [width - edge, edge], [1.0, 0.0], em));
        }
        let mut bottom = height - edge;
        if self.scale_bar {
            let length = round_below(BAR * width / projection.pixels_per_unit());
            let pixels = length * projection.pixels_per_unit();
            let [left, right] = [width - edge - pixels, width - edge];
            let unit = if length == 1.0 { "unit" } else { "units" };
            marks.push(text(format!("{} {unit}", number(length)), [right, bottom - 0.6 * em], [1.0, 1.0], em));
            let line = |ends: [[f32; 2]; 2]| Mark::Line { ends, width: 0.14 * em, colour: self.ink(), opacity: 1.0 };
            let tick = |x: f32| line([[x, bottom - 0.25 * em], [x, bottom + 0.25 * em]]);
            marks.extend([line([[left, bottom], [right, bottom]]), tick(left), tick(right)]);
            bottom -= 3.2 * em;
        }
        if let Some(arrows) = self.arrows {
            let end = self.arrow_key.unwrap_or_else(|| motion.arrow_key());
            let right = width - edge;
            let label = format!("{} {}", number(end), arrows.unit());
            marks.push(text(label, [right, bottom - 0.6 * em], [1.0, 1.0], em));
            marks.extend(pointed([[right - KEY * height, bottom], [right, bottom]], em));
        }
    }
}

/// A line with a head at its end, with an outline. Arrows shorter than 1 pixel are left out.
fn pointed([from, to]: [[f32; 2]; 2], em: f32) -> Vec<Mark> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    if length < 1.0 {
        return Vec::new();
    }
    let unit = along.map(|part| part / length);
    let head = (HEAD * em).min(0.6 * length);
    let width = (0.14 * em).max(1.2);
    // The arrow, and behind it one that is wider by the outline on all sides.
    let arrow = |outline: f32, colour: Rgb| {
        let point = |forward: f32, aside: f32| {
            [to[0] + forward * unit[0] - aside * unit[1], to[1] + forward * unit[1] + aside * unit[0]]
        };
        let [back, side] = [-head - outline, 0.4 * head + 1.6 * outline];
        let line = Mark::Line { ends: [from, point(-head, 0.0)], width: width + 2.0 * outline, colour, opacity: 1.0 };
        [line, Mark::Triangle { corners: [point(2.5 * outline, 0.0), point(back, side), point(back, -side)], colour }]
    };
    [arrow((OUTLINE * em).max(1.0).min(0.08 * length), EDGING), arrow(0.0, ARROW)].concat()
}

/// The lines of a text, broken between words so that none is wider than `room`, unless it is a single word.
fn wrapped(text: &str, room: f32, em: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let longer = lines.last().map(|line| format!("{line} {word}")).filter(|line| width_of(line, em) <= room);
        match (longer, lines.last_mut()) {
            (Some(longer), Some(line)) => *line = longer,
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Formats a time in s with the digits that a film needs.
fn clock(time: f64) -> String {
    format!("t = {time:.2} s")
}

/// The greatest of 1, 2, 5, 10, ... times a power of ten that is not above a length.
fn round_below(length: f32) -> f32 {
    if !(length > 0.0 && length.is_finite()) {
        return 1.0;
    }
    let power = 10_f32.powf(length.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|step| step * power).find(|step| *step <= length).unwrap_or(power)
}

#[cfg(test)]
mod tests;
