//! The legend of a picture: the meaning of its colours.

use ab_glyph::{Font as _, FontRef, PxScale, ScaleFont as _};
use rockfall::Result;

use crate::palette::{Kind, Rgb, SCALE};
use crate::pixels::Picture;

/// The meaning of the colours of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Legend {
    /// One colour per kind of object.
    Kinds(Vec<Kind>),
    /// A scale of values.
    Scale {
        /// Name of the quantity, with its unit.
        title: &'static str,
        /// Values at the two ends of the scale.
        range: [f32; 2],
        /// Evenly spaced colours from one end to the other.
        colours: [Rgb; 9],
    },
}

const INK: [f32; 3] = [0.13, 0.16, 0.20];
const BACKGROUND: [f32; 3] = [1.0, 1.0, 1.0];
/// Opacity of the background.
const OPACITY: f32 = 0.82;

impl Legend {
    /// Creates a legend with the viridis scale.
    pub fn scale(title: &'static str, range: [f32; 2]) -> Self {
        Self::Scale { title, range, colours: SCALE }
    }

    /// Draws the legend into the lower left corner of a picture.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the built-in font cannot be read, which does not happen in practice.
    pub fn draw(&self, picture: &mut Picture) -> Result<()> {
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT)
            .map_err(|error| rockfall::Error::Device(format!("the built-in font: {error}")))?;
        let em = (picture.height as f32 / 26.0).clamp(11.0, 40.0);
        let mut sheet = Sheet { picture, font, em };
        match self {
            // Colours without a meaning need no explanation.
            Self::Kinds(kinds) if kinds.is_empty() => {}
            Self::Kinds(kinds) => sheet.kinds(kinds),
            Self::Scale { title, range, colours } => sheet.scale(title, *range, colours),
        }
        Ok(())
    }
}

/// Formats a value with at most four significant digits and without trailing zeros.
pub(crate) fn number(value: f32) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let digits = (3 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        let text = format!("{value:.2e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'))
    }
}

/// Title of the scale of the number of contacts.
pub(crate) const CONTACTS: &str = "contacts";
/// Number of ticks on a scale.
const MOST_TICKS: usize = 6;

/// Round distances of ticks, in ascending order: 1, 2 and 5 times a power of ten.
fn steps(range: [f32; 2]) -> impl Iterator<Item = f64> {
    let power = f64::from(range[1] - range[0]).log10().floor() as i32 - 1;
    (power..power + 3).flat_map(|power| [1.0, 2.0, 5.0].map(|step| step * 10_f64.powi(power)))
}

/// The multiples of a step in a range.
fn round_values(range: [f32; 2], step: f64) -> Vec<f64> {
    // Rounding errors must not drop the ends.
    let first = (f64::from(range[0]) / step - 1e-4).ceil() as i64;
    let last = (f64::from(range[1]) / step + 1e-4).floor() as i64;
    (first..=last.min(first.saturating_add(100))).map(|multiple| multiple as f64 * step).collect()
}

/// A picture with a font; lengths are in pixels.
struct Sheet<'a> {
    picture: &'a mut Picture,
    font: FontRef<'a>,
    em: f32,
}

impl Sheet<'_> {
    fn kinds(&mut self, kinds: &[Kind]) {
        let em = self.em;
        let widest = kinds.iter().map(|kind| self.width(kind.name)).fold(0.0, f32::max);
        let [left, top] = self.background(widest + 1.4 * em, 1.35 * em * kinds.len() as f32 - 0.35 * em);
        for (row, kind) in kinds.iter().enumerate() {
            let y = top + 1.35 * em * row as f32;
            let middle = [left + 0.45 * em, y + 0.5 * em];
            let ink = kind.colour.map(|channel| f32::from(channel) / 255.0);
            self.fill([left, y, left + em, y + em], ink, |x, y| {
                let distance = (x - middle[0]).hypot(y - middle[1]);
                (0.42 * em - distance + 0.5).clamp(0.0, 1.0)
            });
            self.text(kind.name, left + 1.4 * em, y);
        }
    }

    fn scale(&mut self, title: &str, range: [f32; 2], colours: &[Rgb]) {
        let em = self.em;
        let long = (12.0 * em).max(self.width(title));
        let [left, top] = self.background(long, 3.5 * em);
        self.text(title, left, top);
        let [bar, end] = [top + 1.45 * em, top + 2.25 * em];
        for x in 0..long as u32 {
            let part = (x as f32 + 0.5) / long * (colours.len() - 1) as f32;
            let stop = (part as usize).min(colours.len() - 2);
            let channel = |k: usize| {
                let [low, high] = [colours[stop][k], colours[stop + 1][k]].map(|c| f32::from(c) / 255.0);
                low + (high - low) * (part - stop as f32)
            };
            let x = left + x as f32;
            self.fill([x, bar, x + 1.0, end], [channel(0), channel(1), channel(2)], |_, _| 1.0);
        }
        // There is no half of a contact.
        let least = if title == CONTACTS { 1.0 } else { 0.0 };
        for (part, label) in self.ticks(range, long, least) {
            let x = left + part * long;
            let mark = [x.min(left + long - 1.0), end, x.min(left + long - 1.0) + 1.0, end + 0.25 * em];
            self.fill(mark, INK, |_, _| 1.0);
            let width = self.width(&label);
            // The first and the last label stay within the sheet.
            let x = (x - 0.5 * width).clamp(left - 0.3 * em, left + long - width + 0.3 * em);
            self.text(&label, x, top + 2.55 * em);
        }
    }

    /// Returns as many ticks at round values as fit, at least `least` apart: their positions from 0 to 1, and their labels.
    fn ticks(&self, range: [f32; 2], long: f32, least: f64) -> Vec<(f32, String)> {
        let labelled = |step: f64| -> Vec<(f32, String)> {
            let part = |value: f64| ((value - f64::from(range[0])) / f64::from(range[1] - range[0])) as f32;
            round_values(range, step).into_iter().map(|value| (part(value), number(value as f32))).collect()
        };
        let fits = |ticks: &[(f32, String)]| {
            let needs = |pair: &[(f32, String)]| 0.5 * (self.width(&pair[0].1) + self.width(&pair[1].1)) + 0.8 * self.em;
            ticks.windows(2).all(|pair| pair[0].1 != pair[1].1 && (pair[1].0 - pair[0].0) * long >= needs(pair))
        };
        let found =
            steps(range).filter(|step| *step >= least).map(labelled).find(|ticks| ticks.len() <= MOST_TICKS && fits(ticks));
        found.filter(|ticks| ticks.len() > 1).unwrap_or_else(|| {
            // No two round values fit, so the ends of the range have to do.
            vec![(0.0, number(range[0])), (1.0, number(range[1]))]
        })
    }

    /// Draws a background for contents of this size and returns the upper left corner of the contents.
    fn background(&mut self, width: f32, height: f32) -> [f32; 2] {
        let (em, bottom) = (self.em, self.picture.height as f32);
        let margin = 0.7 * em;
        let sheet = [em, bottom - em - height - 2.0 * margin, em + width + 2.0 * margin, bottom - em];
        let middle = [0.5 * (sheet[0] + sheet[2]), 0.5 * (sheet[1] + sheet[3])];
        let half = [0.5 * (sheet[2] - sheet[0]), 0.5 * (sheet[3] - sheet[1])];
        let round = 0.45 * em;
        self.fill(sheet, BACKGROUND, |x, y| {
            let aside =
                [((x - middle[0]).abs() - half[0] + round).max(0.0), ((y - middle[1]).abs() - half[1] + round).max(0.0)];
            OPACITY * (round - aside[0].hypot(aside[1]) + 0.5).clamp(0.0, 1.0)
        });
        [sheet[0] + margin, sheet[1] + margin]
    }

    /// Blends a colour into a rectangle (left, top, right, bottom); `cover` returns the opacity at the centre of each pixel.
    fn fill(&mut self, [left, top, right, bottom]: [f32; 4], ink: [f32; 3], cover: impl Fn(f32, f32) -> f32) {
        for y in top.max(0.0) as u32..(bottom.ceil().max(0.0) as u32).min(self.picture.height) {
            for x in left.max(0.0) as u32..(right.ceil().max(0.0) as u32).min(self.picture.width) {
                self.mix(x, y, ink, cover(x as f32 + 0.5, y as f32 + 0.5));
            }
        }
    }

    fn mix(&mut self, x: u32, y: u32, ink: [f32; 3], part: f32) {
        let index = y as usize * self.picture.width as usize + x as usize;
        let Some(pixel) = self.picture.pixels.get_mut(index).filter(|_| x < self.picture.width) else {
            return;
        };
        for (channel, ink) in pixel.iter_mut().zip(ink) {
            *channel = (f32::from(*channel) * (1.0 - part) + 255.0 * ink * part).round() as u8;
        }
    }

    fn width(&self, text: &str) -> f32 {
        let font = self.font.as_scaled(PxScale::from(self.em));
        text.chars().map(|letter| font.h_advance(font.glyph_id(letter))).sum()
    }

    /// Draws a line of text whose upper left corner is given.
    fn text(&mut self, text: &str, left: f32, top: f32) {
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
                    self.mix(px as u32, py as u32, INK, part.min(1.0));
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_at_most_four_digits() {
        let shown = [0.0, 0.5, 2.0, 1234.5, 0.0125, 1e-6].map(number);
        assert_eq!(shown, ["0", "0.5", "2", "1234", "0.0125", "1e-6"]);
    }

    fn blank() -> Picture {
        Picture { width: 400, height: 300, pixels: vec![[90, 90, 90, 255]; 400 * 300] }
    }

    #[test]
    fn values_rise_from_left_to_right() {
        let mut picture = blank();
        Legend::scale("speed", [0.0, 2.0]).draw(&mut picture).unwrap();
        let found = |colour: Rgb| {
            let near = |pixel: &[u8; 4]| pixel.iter().zip(colour).all(|(a, b)| a.abs_diff(b) < 12);
            picture.pixels.iter().position(near).map(|index| index % 400)
        };
        let (first, last) = (found(SCALE[0]).unwrap(), found(SCALE[8]).unwrap());
        assert!(last > first + 100, "{first} {last}");
        // Nothing outside the legend changes.
        assert!(picture.pixels[..400 * 200].iter().all(|pixel| *pixel == [90, 90, 90, 255]));
    }

    #[test]
    fn ticks_are_at_round_values() {
        let mut picture = blank();
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).unwrap();
        let sheet = Sheet { picture: &mut picture, font, em: 12.0 };
        let spaced = |range, least| sheet.ticks(range, 150.0, least).into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        let ticks = |range| spaced(range, 0.0);
        assert_eq!(spaced([0.0, 2.0], 1.0), ["0", "1", "2"]);
        assert_eq!(ticks([0.0, 5.0]), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(ticks([0.0, 20.0]), ["0", "5", "10", "15", "20"]);
        assert_eq!(ticks([0.13, 0.94]), ["0.2", "0.4", "0.6", "0.8"]);
        assert_eq!(ticks([-3.0, 4.0]), ["-2", "0", "2", "4"]);
        assert_eq!(ticks([0.0, 2e-7]), ["0", "5e-8", "1e-7", "1.5e-7", "2e-7"]);
        assert_eq!(ticks([1.00001, 1.00002]).len(), 2);
    }

    #[test]
    fn a_legend_larger_than_the_picture_is_clipped() {
        let mut picture = Picture { width: 5, height: 3, pixels: vec![[0; 4]; 15] };
        Legend::scale("speed", [0.0, 2.0]).draw(&mut picture).unwrap();
        Legend::Kinds(crate::palette::KINDS.to_vec()).draw(&mut picture).unwrap();
    }
}
