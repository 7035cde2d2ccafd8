//! Marks on a picture.

use crate::palette::Rgb;
use crate::sheet::{Sheet, ink};

/// A mark on a picture; lengths are in pixels from its upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A straight line.
    Line {
        /// Its ends.
        ends: [[f32; 2]; 2],
        /// Its width.
        width: f32,
        /// Its colour.
        colour: Rgb,
        /// Its opacity, from 0 to 1.
        opacity: f32,
    },
    /// A filled triangle.
    Triangle {
        /// Its corners.
        corners: [[f32; 2]; 3],
        /// Its colour.
        colour: Rgb,
    },
    /// A filled rectangle.
    Rectangle {
        /// Its left, upper, right and lower side.
        sides: [f32; 4],
        /// Its colour.
        colour: Rgb,
    },
    /// A line of text.
    Text {
        /// The text.
        text: String,
        /// The place that the text is aligned to.
        at: [f32; 2],
        /// Which part of the width and the height is to the left of the place and above it: 0, 0.5 or 1.
        align: [f32; 2],
        /// Height of the letters.
        em: f32,
        /// Colour of the letters.
        colour: Rgb,
        /// Whether there is a light background.
        panel: bool,
    },
}

impl Mark {
    pub(crate) fn draw(&self, sheet: &mut Sheet<'_>) {
        match self {
            Self::Rectangle { sides, colour } => sheet.fill(*sides, ink(*colour), |_, _| 1.0),
            Self::Line { ends, width, colour, opacity } => sheet.line(*ends, *width, *colour, *opacity),
            Self::Triangle { corners, colour } => sheet.triangle(*corners, *colour),
            Self::Text { text, at, align, em, colour, panel } => {
                let old = (sheet.em, sheet.ink);
                (sheet.em, sheet.ink) = (*em, ink(*colour));
                let width = sheet.width(text);
                let margin = if *panel { 0.3 * em } else { 0.0 };
                // The place is that of the background, if there is one.
                let left = at[0] - align[0] * (width + 2.0 * margin);
                let top = at[1] - align[1] * (em + 2.0 * margin);
                if *panel {
                    sheet.panel([left, top, left + width + 2.0 * margin, top + em + 2.0 * margin]);
                }
                sheet.text(text, left + margin, top + margin);
                (sheet.em, sheet.ink) = old;
            }
        }
    }
}
