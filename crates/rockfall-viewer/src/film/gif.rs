//! Films as GIF. Each picture has its own palette, computed from the pixels that differ from the last picture. The other pixels
//! are transparent, which improves the colours and keeps the file small.

use std::collections::HashMap;
use std::io;
use std::path::Path;

use color_quant::NeuQuant;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use rockfall::Result;
use rockfall::output::AtomicFile;

use crate::film::file_error::file_error;
use crate::picture::Picture;

/// Sample factor of NeuQuant (Dekker 1994), 1 to 30: higher is faster, lower is more accurate.
const SPEED: i32 = 3;
/// Number of colours in a palette; one more entry stands for unchanged pixels.
const COLOURS: usize = 255;
/// Number of these colours that are taken unchanged from the most common ones, because a small error is visible in a large even
/// area.
const COMMON: usize = 55;
/// Squared distance up to which only one of two colours is taken as a common one.
const ALIKE: u32 = 20;

pub(super) fn write(path: &Path, fps: u32, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    let wrong = file_error(path);
    let coded = |error: gif::EncodingError| wrong(io::Error::other(error));
    let mut file = AtomicFile::create(path).map_err(&wrong)?;
    let mut pictures = pictures.peekable();
    let Some(Ok(first)) = pictures.peek() else {
        return pictures.next().transpose().map(drop);
    };
    let sides = u16::try_from(first.width).ok().zip(u16::try_from(first.height).ok());
    let (width, height) = sides.ok_or_else(|| {
        let sides = format!("{}x{} pixels are too many, a GIF has at most 65535 a side", first.width, first.height);
        wrong(io::Error::other(sides))
    })?;
    let mut encoder = Encoder::new(&mut file, width, height, &[]).map_err(coded)?;
    encoder.set_repeat(Repeat::Infinite).map_err(coded)?;
    let mut before: Option<Picture> = None;
    for (number, picture) in pictures.enumerate() {
        let picture = picture?;
        let mut frame = changes(before.as_ref(), &picture);
        frame.delay = delay(number as u64, fps);
        frame.dispose = DisposalMethod::Keep;
        encoder.write_frame(&frame).map_err(coded)?;
        before = Some(picture);
    }
    drop(encoder);
    file.commit().map_err(&wrong)
}

/// Returns the delay of a picture in hundredths of a second, such that rounding errors do not add up over the film.
fn delay(number: u64, fps: u32) -> u16 {
    let end = |number: u64| (100.0 * number as f64 / f64::from(fps)).round() as u64;
    u16::try_from(end(number + 1) - end(number)).unwrap_or(u16::MAX)
}

/// Returns the smallest rectangle that contains all pixels that differ from the picture before.
fn changes(before: Option<&Picture>, picture: &Picture) -> Frame<'static> {
    let differs = |index: usize| before.is_none_or(|before| before.pixels[index] != picture.pixels[index]);
    let wide = picture.width as usize;
    let (mut left, mut right, mut top, mut bottom) = (wide, 0, picture.height as usize, 0);
    for index in (0..picture.pixels.len()).filter(|index| differs(*index)) {
        let (x, y) = (index % wide, index / wide);
        (left, right) = (left.min(x), right.max(x + 1));
        (top, bottom) = (top.min(y), bottom.max(y + 1));
    }
    if left >= right {
        // Nothing changed: one transparent pixel.
        (left, right, top, bottom) = (0, 1, 0, 1);
    }
    let rows = (top..bottom).map(|y| y * wide + left..y * wide + right);
    let changed: Vec<Option<Rgb>> = rows.flatten().map(|index| differs(index).then(|| rgb(picture.pixels[index]))).collect();
    let (palette, indices) = palette(&changed);
    let buffer = changed.iter().map(|colour| colour.and_then(|colour| indices.get(&colour).copied()));
    Frame {
        // These casts lose nothing, because the sides of a GIF fit 16 bits.
        left: left as u16,
        top: top as u16,
        width: (right - left) as u16,
        height: (bottom - top) as u16,
        buffer: buffer.map(|index| index.unwrap_or(UNCHANGED)).collect(),
        palette: Some(palette),
        transparent: Some(UNCHANGED),
        ..Frame::default()
    }
}

type Rgb = [u8; 3];

/// Palette index of unchanged pixels.
const UNCHANGED: u8 = COLOURS as u8;

fn rgb([r, g, b, _]: [u8; 4]) -> Rgb {
    [r, g, b]
}

fn squared_distance(one: Rgb, two: Rgb) -> u32 {
    one.iter().zip(two).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
}

/// Returns the most common colours that differ by more than [`ALIKE`].
fn common(counts: &[(Rgb, u32)]) -> Vec<Rgb> {
    let mut by_count = counts.to_vec();
    by_count.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let mut common: Vec<Rgb> = Vec::with_capacity(COMMON);
    for (colour, _) in by_count {
        if common.len() < COMMON && common.iter().all(|other| squared_distance(*other, colour) > ALIKE) {
            common.push(colour);
        }
    }
    common
}

/// Returns a palette for these colours and the index of each. Apart from the common colours, the weight of a colour is the
/// square root of its number of pixels: with proportional weights small bodies would get the colours of the background.
fn palette(colours: &[Option<Rgb>]) -> (Vec<u8>, HashMap<Rgb, u8>) {
    let mut counts: HashMap<Rgb, u32> = HashMap::new();
    for colour in colours.iter().flatten() {
        *counts.entry(*colour).or_default() += 1;
    }
    // Sorted, so that the same film always gives the same file.
    let mut counts: Vec<(Rgb, u32)> = counts.into_iter().collect();
    counts.sort_unstable();
    let mut palette: Vec<Rgb> = if counts.len() <= COLOURS {
        counts.iter().map(|(colour, _)| *colour).collect()
    } else {
        let weighted = counts.iter().flat_map(|(colour, count)| std::iter::repeat_n(*colour, count.isqrt() as usize));
        let pixels: Vec<u8> = weighted.flat_map(|[r, g, b]| [r, g, b, 255]).collect();
        let others = NeuQuant::new(SPEED, COLOURS - COMMON, &pixels).color_map_rgb();
        common(&counts).into_iter().chain(others.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]])).collect()
    };
    let nearest = |colour: Rgb| (0..palette.len()).min_by_key(|place| squared_distance(palette[*place], colour)).unwrap_or(0);
    let places = counts.iter().map(|(colour, _)| (*colour, nearest(*colour) as u8)).collect();
    palette.resize(COLOURS + 1, [0; 3]);
    (palette.into_iter().flatten().collect(), places)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(red: &[usize]) -> Picture {
        let colour = |index: usize| if red.contains(&index) { [200, 0, 0, 255] } else { [240, 240, 240, 255] };
        Picture { width: 8, height: 4, pixels: (0..32).map(colour).collect() }
    }

    #[test]
    fn only_changed_pixels_are_written() {
        let frame = changes(Some(&picture(&[9])), &picture(&[18]));
        assert_eq!((frame.left, frame.top, frame.width, frame.height), (1, 1, 2, 2));
        let clear = frame.transparent.unwrap();
        let shown: Vec<bool> = frame.buffer.iter().map(|index| *index != clear).collect();
        assert_eq!(shown, [true, false, false, true]);
        assert_eq!(changes(Some(&picture(&[9])), &picture(&[9])).buffer.len(), 1);
        assert_eq!(changes(None, &picture(&[9])).buffer.len(), 32);
    }

    #[test]
    fn few_colours_are_exact_and_rare_ones_among_many_keep_their_hue() {
        let exact = changes(None, &picture(&[9]));
        let palette = exact.palette.clone().unwrap();
        let shown = |frame: &Frame<'_>, palette: &[u8], index: usize| {
            let at = 3 * usize::from(frame.buffer[index]);
            [palette[at], palette[at + 1], palette[at + 2]]
        };
        assert_eq!([shown(&exact, &palette, 9), shown(&exact, &palette, 8)], [[200, 0, 0], [240; 3]]);

        let (width, height) = (64, 64);
        let grey = |index: usize| [(100 + index % 128) as u8, (100 + index % 128) as u8, (100 + index / 40 % 128) as u8, 255];
        let mut pixels: Vec<[u8; 4]> = (0..width * height).map(grey).collect();
        // A body that covers one hundredth of the picture.
        for (index, pixel) in pixels[60..100].iter_mut().enumerate() {
            *pixel = [10 + index as u8 / 4, 140 + index as u8, 90, 255];
        }
        let many = changes(None, &Picture { width: 64, height: 64, pixels });
        let [r, g, b] = shown(&many, &many.palette.clone().unwrap(), 77);
        assert!(g > r.saturating_add(60) && g > b.saturating_add(20), "{r} {g} {b}");
    }

    #[test]
    fn delays_add_up() {
        assert_eq!((0..30).map(|number| u64::from(delay(number, 30))).sum::<u64>(), 100);
        assert_eq!(delay(7, 25), 4);
    }
}
