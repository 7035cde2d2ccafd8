//! Text, arrows and trails over a picture.

use std::collections::BTreeSet;

use rockfall::glam::Vec3;
use rockfall::{Result, Scene, Simulation};

use crate::camera::Camera;
pub use crate::draw::Arrows;
use crate::draw::{Motion, Renderer};
use crate::legend::number;
use crate::palette::Rgb;
use crate::pixels::Picture;
use crate::sheet::{Sheet, lacks, letters};

mod projection;

pub use crate::mark::Mark;
use projection::Projection;

/// What is written and drawn over a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// A line of text at the upper edge.
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
    /// Whether the background is dark, so that lines have to be light.
    pub dark: bool,
}

const DARK: Rgb = [0x21, 0x29, 0x33];
const LIGHT: Rgb = [0xe4, 0xe8, 0xec];
const ARROW: Rgb = [0xd5, 0x5e, 0x00];
const TRAIL: Rgb = [0x00, 0x72, 0xb2];
/// Length of the arrow of the key, divided by the height of the picture.
const KEY: f32 = 0.12;
/// Greatest length of the scale bar, divided by the width of the picture.
const BAR: f32 = 0.2;
/// Length of the line between a ball and its label, in heights of letters.
const LEADER: f32 = 0.8;
/// Distance of captions from the edges of the picture, and height of the letters of the title, in heights of letters.
const EDGE: f32 = 0.9;
const TITLE: f32 = 1.2;
/// Length of the head of an arrow, in heights of letters.
const HEAD: f32 = 0.7;

impl Renderer {
    /// Takes what an overlay needs of the states of the following [`Renderer::update`].
    pub fn set_overlay(&mut self, overlay: &Overlay) {
        self.want_motion(overlay.needs_places(), overlay.arrows, overlay.trails);
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
        motion.update(simulation)?;
        motion.record();
        Ok(())
    }

    /// Part of the height of a picture that the title and the clock take at its upper edge.
    pub fn room_above(&self, height: u32) -> f32 {
        let lines = if self.title.is_some() || self.clock { 2.0 * EDGE + TITLE } else { 0.0 };
        lines * letters(height) / height as f32
    }

    /// The letters of the title, and of the labels of a scene if they are shown, that the built-in font lacks. Each is drawn as a box.
    pub fn missing_letters(&self, scene: &Scene) -> Vec<char> {
        let tags = scene.sphere_ids().filter(|_| self.labels).filter_map(|sphere| scene.tag(sphere).ok().flatten());
        let labels = tags.filter_map(|tag| tag.label.as_deref());
        let letters: BTreeSet<char> = self.title.as_deref().into_iter().chain(labels).flat_map(str::chars).collect();
        letters.into_iter().filter(|letter| lacks(*letter)).collect()
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
            trails(motion, &projection, 0.12 * em, &mut marks);
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
            motion
                .labels()
                .for_each(|(place, radius, text)| self.label(&projection, (place, radius), text, 0.75 * em, &mut marks));
        }
        self.captions(motion, &projection, size, em, &mut marks);
        marks
    }

    /// Colour of lines.
    fn ink(&self) -> Rgb {
        if self.dark { LIGHT } else { DARK }
    }

    /// The text of a ball: in its middle if the ball is larger than the text, or else above it with a line.
    fn label(&self, projection: &Projection, (place, radius): (Vec3, f32), text: &str, em: f32, marks: &mut Vec<Mark>) {
        let Some(at) = projection.place(place) else { return };
        let radius = radius * projection.pixels_per_unit_at(place);
        // About the half of the diagonal of the text with its background.
        let half = 0.5 * (0.6 * em * (text.chars().count() as f32 + 1.0)).hypot(1.6 * em);
        let text =
            |at: [f32; 2], align: [f32; 2]| Mark::Text { text: text.to_owned(), at, align, em, colour: DARK, panel: true };
        if radius > half {
            return marks.push(text(at, [0.5, 0.5]));
        }
        let [top, end] = [at[1] - radius, at[1] - radius - LEADER * em];
        marks.push(Mark::Line {
            ends: [[at[0], top], [at[0], end]],
            width: (0.1 * em).max(1.0),
            colour: self.ink(),
            opacity: 0.7,
        });
        marks.push(text([at[0], end], [0.5, 1.0]));
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
        if let Some(title) = &self.title {
            marks.push(text(title.clone(), [edge, edge], [0.0, 0.0], TITLE * em));
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

/// A line with a head at its end. Arrows shorter than 1 pixel are left out.
fn pointed([from, to]: [[f32; 2]; 2], em: f32) -> Vec<Mark> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    if length < 1.0 {
        return Vec::new();
    }
    let unit = along.map(|part| part / length);
    let head = (HEAD * em).min(0.6 * length);
    let neck = [0, 1].map(|axis| to[axis] - head * unit[axis]);
    let side = |sign: f32| [neck[0] - sign * 0.4 * head * unit[1], neck[1] + sign * 0.4 * head * unit[0]];
    let line = Mark::Line { ends: [from, neck], width: (0.14 * em).max(1.2), colour: ARROW, opacity: 1.0 };
    vec![line, Mark::Triangle { corners: [to, side(1.0), side(-1.0)], colour: ARROW }]
}

/// Lines through the past places of the spheres, in their own colours, which fade with age.
fn trails(motion: &Motion, projection: &Projection, width: f32, marks: &mut Vec<Mark>) {
    for (ends, age, colour) in motion.trails() {
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
