//! Text and shapes drawn into a picture in host memory.

use ab_glyph::{Font as _, FontRef, PxScale, ScaleFont as _};
use rockfall::{Error, Result};

use crate::palette::Rgb;
use crate::pixels::Picture;

pub(crate) const INK: [f32; 3] = [0.13, 0.16, 0.20];
const BACKGROUND: [f32; 3] = [1.0, 1.0, 1.0];
/// Opacity of the background of text.
const OPACITY: f32 = 0.82;
/// Height of a picture below which a legend is a strip, in pixels. Letters of a part of the height would be too small to read.
pub(crate) const SMALL: u32 = 286;

/// Returns the height of letters in a picture of this height, in pixels.
pub(crate) fn letters(height: u32) -> f32 {
    if height < SMALL { (height as f32 / 24.0).max(9.0) } else { (height as f32 / 26.0).min(40.0) }
}

/// The corner of a picture in which a legend is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// Whether it is at the right edge.
    pub right: bool,
    /// The part of the height of the picture that is free above it, for a title; `None` at the lower edge.
    pub below: Option<f32>,
}

/// A picture with a font; lengths are in pixels.
pub(crate) struct Sheet<'a> {
    pub(crate) picture: &'a mut Picture,
    font: FontRef<'a>,
    pub(crate) em: f32,
    /// Colour of text.
    pub(crate) ink: [f32; 3],
    /// Where the background of contents is.
    pub(crate) place: Corner,
}

fn font() -> Result<FontRef<'static>> {
    FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|error| Error::Device(format!("the built-in font: {error}")))
}

/// Width of a text with letters of this height, in pixels.
pub(crate) fn width_of(text: &str, em: f32) -> f32 {
    font().map_or(0.0, |font| width_in(&font, text, em))
}

fn width_in(font: &FontRef<'_>, text: &str, em: f32) -> f32 {
    let font = font.as_scaled(PxScale::from(em));
    text.chars().map(|letter| font.h_advance(font.glyph_id(letter))).sum()
}

/// Whether the font has no shape for a letter, so that a box is drawn.
pub(crate) fn lacks(letter: char) -> bool {
    font().is_ok_and(|font| font.glyph_id(letter).0 == 0)
}

impl<'a> Sheet<'a> {
    pub(crate) fn new(picture: &'a mut Picture) -> Result<Self> {
        let font = font()?;
        let em = letters(picture.height);
        Ok(Self { picture, font, em, ink: INK, place: Corner::default() })
    }
}

impl Sheet<'_> {
    /// The greatest width of the contents of a sheet.
    pub(crate) fn room(&self) -> f32 {
        self.picture.width as f32 - 2.0 * (self.corner() + self.margin())
    }

    /// Distance of a sheet from the edges of the picture.
    pub(crate) fn corner(&self) -> f32 {
        if self.picture.height < SMALL { 0.4 * self.em } else { self.em }
    }

    /// Distance of the contents of a sheet from its edges.
    pub(crate) fn margin(&self) -> f32 {
        if self.picture.height < SMALL { 0.35 * self.em } else { 0.7 * self.em }
    }

    /// Draws a background for contents of this size and returns the upper left corner of the contents.
    pub(crate) fn background(&mut self, width: f32, height: f32) -> [f32; 2] {
        let (margin, corner) = (self.margin(), self.corner());
        let [wide, high] = [width, height].map(|side| side + 2.0 * margin);
        let all = [self.picture.width, self.picture.height].map(|side| side as f32);
        let left = if self.place.right { all[0] - corner - wide } else { corner };
        let top = self.place.below.map_or(all[1] - corner - high, |above| (above * all[1]).max(corner));
        self.panel([left, top, left + wide, top + high]);
        [left + margin, top + margin]
    }

    /// Blends a colour into a rectangle (left, top, right, bottom); `cover` returns the opacity at the centre of each pixel.
    pub(crate) fn fill(&mut self, [left, top, right, bottom]: [f32; 4], ink: [f32; 3], cover: impl Fn(f32, f32) -> f32) {
        for y in top.max(0.0) as u32..(bottom.ceil().max(0.0) as u32).min(self.picture.height) {
            for x in left.max(0.0) as u32..(right.ceil().max(0.0) as u32).min(self.picture.width) {
                self.mix(x, y, ink, cover(x as f32 + 0.5, y as f32 + 0.5));
            }
        }
    }

    pub(crate) fn mix(&mut self, x: u32, y: u32, ink: [f32; 3], part: f32) {
        let index = y as usize * self.picture.width as usize + x as usize;
        let Some(pixel) = self.picture.pixels.get_mut(index).filter(|_| x < self.picture.width) else {
            return;
        };
        for (channel, ink) in pixel.iter_mut().zip(ink) {
            *channel = (f32::from(*channel) * (1.0 - part) + 255.0 * ink * part).round() as u8;
        }
    }

    pub(crate) fn width(&self, text: &str) -> f32 {
        self.width_of(text, self.em)
    }

    /// Width of a text with letters of this height.
    pub(crate) fn width_of(&self, text: &str, em: f32) -> f32 {
        width_in(&self.font, text, em)
    }

    /// Draws a line of text whose upper left corner is given.
    pub(crate) fn text(&mut self, text: &str, left: f32, top: f32) {
        let scale = PxScale::from(self.em);
        let font = self.font.clone();
        let scaled = font.as_scaled(scale);
        let mut x = left;
        for letter in text.chars() {
            let id = scaled.glyph_id(letter);
            let glyph = id.with_scale_and_position(scale, ab_glyph::point(x, top + 0.9 * scaled.ascent()));
            x += scaled.h_advance(id);
            let Some(outline) = font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|dx, dy, part| {
                let (px, py) = (corner.x + dx as f32, corner.y + dy as f32);
                if px >= 0.0 && py >= 0.0 {
                    self.mix(px as u32, py as u32, self.ink, part.min(1.0));
                }
            });
        }
    }

    /// Draws a background with round corners; left, top, right and bottom are given.
    pub(crate) fn panel(&mut self, [left, top, right, bottom]: [f32; 4]) {
        let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
        let half = [0.5 * (right - left), 0.5 * (bottom - top)];
        let round = (0.45 * self.em).min(half[1]);
        self.fill([left, top, right, bottom], BACKGROUND, |x, y| {
            let aside =
                [((x - middle[0]).abs() - half[0] + round).max(0.0), ((y - middle[1]).abs() - half[1] + round).max(0.0)];
            OPACITY * (round - aside[0].hypot(aside[1]) + 0.5).clamp(0.0, 1.0)
        });
    }

    /// Draws a line with round ends.
    pub(crate) fn line(&mut self, [from, to]: [[f32; 2]; 2], width: f32, colour: Rgb, opacity: f32) {
        let along = [to[0] - from[0], to[1] - from[1]];
        let square = (along[0] * along[0] + along[1] * along[1]).max(1e-12);
        let half = 0.5 * width;
        let low = [0, 1].map(|axis| from[axis].min(to[axis]) - half - 1.0);
        let high = [0, 1].map(|axis| from[axis].max(to[axis]) + half + 1.0);
        self.fill([low[0], low[1], high[0], high[1]], ink(colour), |x, y| {
            let offset = [x - from[0], y - from[1]];
            let part = ((offset[0] * along[0] + offset[1] * along[1]) / square).clamp(0.0, 1.0);
            let away = (offset[0] - part * along[0]).hypot(offset[1] - part * along[1]);
            opacity * (half - away + 0.5).clamp(0.0, 1.0)
        });
    }

    /// Fills a triangle.
    pub(crate) fn triangle(&mut self, corners: [[f32; 2]; 3], colour: Rgb) {
        let [a, b, c] = corners;
        let turn = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).signum();
        let bound =
            |axis: usize, pick: fn(f32, f32) -> f32| corners.iter().map(|corner| corner[axis]).reduce(pick).unwrap_or(0.0);
        let rectangle =
            [bound(0, f32::min) - 1.0, bound(1, f32::min) - 1.0, bound(0, f32::max) + 1.0, bound(1, f32::max) + 1.0];
        self.fill(rectangle, ink(colour), |x, y| {
            let inside = |[from, to]: [[f32; 2]; 2]| {
                let along = [to[0] - from[0], to[1] - from[1]];
                let length = along[0].hypot(along[1]).max(1e-6);
                turn * (along[0] * (y - from[1]) - along[1] * (x - from[0])) / length
            };
            let least = [[a, b], [b, c], [c, a]].into_iter().map(inside).fold(f32::INFINITY, f32::min);
            (least + 0.5).clamp(0.0, 1.0)
        });
    }
}

/// The parts of a colour from 0 to 1.
pub(crate) fn ink(colour: Rgb) -> [f32; 3] {
    colour.map(|channel| f32::from(channel) / 255.0)
}
