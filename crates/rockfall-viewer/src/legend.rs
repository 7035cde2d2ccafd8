//! The legend of a picture: the meaning of its colours.

use rockfall::Result;

use crate::palette::{Kind, Rgb, SCALE};
use crate::pixels::Picture;
pub use crate::sheet::Corner;
use crate::sheet::{INK, SMALL, Sheet};

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

impl Legend {
    /// Creates a legend with the viridis scale.
    pub fn scale(title: &'static str, range: [f32; 2]) -> Self {
        Self::Scale { title, range, colours: SCALE }
    }

    /// Draws the legend into the lower left corner of a picture, as [`Legend::draw_at`].
    ///
    /// # Errors
    /// As for [`Legend::draw_at`].
    pub fn draw(&self, picture: &mut Picture) -> Result<()> {
        self.draw_at(Corner::default(), picture)
    }

    /// Draws the legend into a corner of a picture. In a picture of less than 286 pixels of height it is a strip
    /// of one line. A strip of kinds that would cover more than half of the picture is left out.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the built-in font cannot be read, which does not happen in practice.
    pub fn draw_at(&self, corner: Corner, picture: &mut Picture) -> Result<()> {
        let is_small = picture.height < SMALL;
        let mut sheet = Sheet::new(picture)?;
        sheet.place = corner;
        match self {
            // Colours without a meaning need no explanation.
            Self::Kinds(kinds) if kinds.is_empty() => {}
            Self::Kinds(kinds) => sheet.kinds(kinds, is_small),
            Self::Scale { title, range, colours } if is_small => sheet.strip(title, *range, colours),
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

impl Sheet<'_> {
    /// Draws the kinds in one column, or in a strip in as many columns as fit.
    fn kinds(&mut self, kinds: &[Kind], is_strip: bool) {
        let em = self.em;
        let widest = kinds.iter().map(|kind| self.width(kind.name)).fold(0.0, f32::max) + 1.4 * em;
        let room = self.room() + 0.8 * em;
        let columns = if is_strip { ((room / (widest + 0.8 * em)) as usize).clamp(1, kinds.len()) } else { 1 };
        let rows = kinds.len().div_ceil(columns);
        let high = 1.35 * em * rows as f32 - 0.35 * em;
        if is_strip && high > 0.5 * self.picture.height as f32 {
            return;
        }
        let [left, top] = self.background((widest + 0.8 * em) * columns as f32 - 0.8 * em, high);
        let corner = left;
        for (index, kind) in kinds.iter().enumerate() {
            let left = corner + (widest + 0.8 * em) * (index % columns) as f32;
            let y = top + 1.35 * em * (index / columns) as f32;
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
        let end = top + 2.25 * em;
        self.bar([left, top + 1.45 * em, left + long, end], colours);
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

    /// Draws a scale in one line: the first value, the colours, the last value, the title.
    fn strip(&mut self, title: &str, range: [f32; 2], colours: &[Rgb]) {
        let em = self.em;
        let [first, last] = range.map(number);
        let [first_width, last_width] = [&first, &last].map(|value| self.width(value) + 0.4 * em);
        let long = (5.0 * em).min(self.room() - first_width - last_width).max(em);
        let short = first_width + long + last_width;
        let with_title = short + 0.5 * em + self.width(title);
        let has_room = with_title <= self.room();
        let [left, top] = self.background(if has_room { with_title } else { short }, em);
        self.text(&first, left, top);
        let bar = left + first_width;
        self.bar([bar, top + 0.1 * em, bar + long, top + 0.9 * em], colours);
        self.text(&last, bar + long + 0.4 * em, top);
        if has_room {
            self.text(title, left + short + 0.5 * em, top);
        }
    }

    /// Fills a rectangle (left, top, right, bottom) with colours from left to right.
    fn bar(&mut self, [left, top, right, bottom]: [f32; 4], colours: &[Rgb]) {
        let long = right - left;
        for x in 0..long as u32 {
            let part = (x as f32 + 0.5) / long * (colours.len() - 1) as f32;
            let stop = (part as usize).min(colours.len() - 2);
            let channel = |k: usize| {
                let [low, high] = [colours[stop][k], colours[stop + 1][k]].map(|c| f32::from(c) / 255.0);
                low + (high - low) * (part - stop as f32)
            };
            let x = left + x as f32;
            self.fill([x, top, x + 1.0, bottom], [channel(0), channel(1), channel(2)], |_, _| 1.0);
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
        let mut sheet = Sheet::new(&mut picture).unwrap();
        sheet.em = 12.0;
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
    fn the_legend_of_a_small_picture_covers_little_of_it() {
        for (width, height) in [(400, 225), (320, 180), (220, 124)] {
            let clear = Picture { width, height, pixels: vec![[90, 90, 90, 255]; (width * height) as usize] };
            for legend in
                [Legend::scale("contact force, mass units/s²", [0.0, 2.0]), Legend::Kinds(crate::palette::KINDS[..4].to_vec())]
            {
                let mut picture = clear.clone();
                legend.draw(&mut picture).unwrap();
                let changed = picture.pixels.iter().filter(|pixel| **pixel != [90, 90, 90, 255]).count();
                let part = changed as f32 / picture.pixels.len() as f32;
                assert!((0.01..0.22).contains(&part), "{width}x{height}: {part}");
            }
        }
    }

    #[test]
    fn a_legend_larger_than_the_picture_is_clipped() {
        let mut picture = Picture { width: 5, height: 3, pixels: vec![[0; 4]; 15] };
        Legend::scale("speed", [0.0, 2.0]).draw(&mut picture).unwrap();
        Legend::Kinds(crate::palette::KINDS.to_vec()).draw(&mut picture).unwrap();
    }
}
