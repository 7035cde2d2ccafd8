//! Labels of bodies: text on a body or above it, where it covers no other label.

use crate::mark::Mark;
use crate::palette::Rgb;
use crate::sheet::width_of;

use super::{DARK, LINE};

/// Length of the line between a ball and its label, in heights of letters.
const LEADER: f32 = 0.8;
/// Number of lines of text by which a label moves up at most to make room for others.
const MOST_RISES: u8 = 6;
/// Part of the height of a label by which it may cover another one.
const SHARED: f32 = 0.1;

/// Places labels one after another.
pub(super) struct Labels {
    /// Height of the letters, in pixels, and colour of lines.
    em: f32,
    ink: Rgb,
    /// Left, upper, right and lower side of the labels so far.
    taken: Vec<[f32; 4]>,
    lines: Vec<Mark>,
    texts: Vec<Mark>,
}

impl Labels {
    pub(super) fn new(em: f32, ink: Rgb) -> Self {
        Self { em, ink, taken: Vec::new(), lines: Vec::new(), texts: Vec::new() }
    }

    /// Adds the text of a ball, in pixels: in its middle if the ball is larger than the text, or else above it with a line. A label
    /// that would cover an earlier one is higher above the ball. If there is no room, it is at its usual place.
    pub(super) fn add(&mut self, at: [f32; 2], radius: f32, text: &str) {
        let (em, width) = (self.em, width_of(text, self.em) + 0.6 * self.em);
        let height = 1.6 * em;
        // About the half of the diagonal of the text with its background.
        let is_inside = radius > 0.5 * (0.6 * em * (text.chars().count() as f32 + 1.0)).hypot(height);
        let top = at[1] - radius;
        let above = (0..=MOST_RISES).map(|rise| top - LEADER * em - LINE * em * f32::from(rise));
        let above: Vec<([f32; 2], bool)> = above.map(|end| ([at[0], end - 0.5 * height], true)).collect();
        let inside = is_inside.then_some((at, false));
        let candidates: Vec<([f32; 2], bool)> = inside.into_iter().chain(above).collect();
        let sides = |[x, y]: [f32; 2]| [x - 0.5 * width, y - 0.5 * height, x + 0.5 * width, y + 0.5 * height];
        let is_free = |(middle, _): &&([f32; 2], bool)| {
            let own = sides(*middle);
            !self.taken.iter().any(|other| overlaps(own, *other, SHARED * height))
        };
        let (middle, has_line) = *candidates.iter().find(is_free).unwrap_or(&candidates[0]);
        self.taken.push(sides(middle));
        if has_line {
            let ends = [[at[0], top], [at[0], middle[1] + 0.5 * height]];
            self.lines.push(Mark::Line { ends, width: (0.1 * em).max(1.0), colour: self.ink, opacity: 0.7 });
        }
        let (at, align) = if has_line { ([at[0], middle[1] + 0.5 * height], [0.5, 1.0]) } else { (at, [0.5, 0.5]) };
        self.texts.push(Mark::Text { text: text.to_owned(), at, align, em, colour: DARK, panel: true });
    }

    /// The marks: the lines, and the texts over them.
    pub(super) fn marks(self) -> impl Iterator<Item = Mark> {
        self.lines.into_iter().chain(self.texts)
    }
}

/// Whether two rectangles overlap by more than a length in both directions.
fn overlaps(one: [f32; 4], other: [f32; 4], by: f32) -> bool {
    let shared = |axis: usize| one[axis + 2].min(other[axis + 2]) - one[axis].max(other[axis]);
    shared(0) > by && shared(1) > by
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_near_balls_do_not_cover_each_other() {
        let mut labels = Labels::new(10.0, DARK);
        for (at, radius, text) in [([100.0, 100.0], 5.0, "left"), ([112.0, 102.0], 5.0, "right"), ([105.0, 84.0], 30.0, "in")] {
            labels.add(at, radius, text);
        }
        let taken = labels.taken.clone();
        for (at, one) in taken.iter().enumerate() {
            assert!(taken[..at].iter().all(|other| !overlaps(*one, *other, 2.0)), "{taken:?}");
        }
        assert_eq!(labels.lines.len(), 3, "the label inside the large ball made room too");
        // Without room, a label is where it would be alone.
        let mut crowd = Labels::new(10.0, DARK);
        (0..20).for_each(|_| crowd.add([100.0, 100.0], 5.0, "ball"));
        assert_eq!(crowd.taken[0], crowd.taken[19]);
    }
}
