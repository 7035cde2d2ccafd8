//! Films as GIF. A picture has a palette of its own, made of the pixels that changed since the last one; the others are
//! left as they were, which keeps both the colours and the file good.

use std::io;
use std::path::Path;

use gif::{DisposalMethod, Encoder, Frame, Repeat};
use rockfall::Result;
use rockfall::output::AtomicFile;

use crate::film::failed;
use crate::picture::Picture;

/// 1 to 30, of NeuQuant (Dekker 1994): the higher, the faster and the worse.
const SPEED: i32 = 8;
/// What an unchanged pixel is called in a picture. Any colour that bodies do not have will do.
const UNCHANGED: [u8; 4] = [255, 0, 255, 0];

pub(super) fn write(path: &Path, fps: u32, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    let wrong = failed(path);
    let coded = |error: gif::EncodingError| wrong(io::Error::other(error));
    let mut file = AtomicFile::create(path).map_err(&wrong)?;
    let mut pictures = pictures.peekable();
    let Some(Ok(first)) = pictures.peek() else {
        return pictures.next().transpose().map(drop);
    };
    let sides = u16::try_from(first.width).ok().zip(u16::try_from(first.height).ok());
    let (width, height) = sides.ok_or_else(|| wrong(io::Error::other("a GIF has at most 65535 pixels a side")))?;
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

/// Hundredths of a second that a picture is shown, so that the whole film keeps its time.
fn delay(number: u64, fps: u32) -> u16 {
    let end = |number: u64| (100.0 * number as f64 / f64::from(fps)).round() as u64;
    u16::try_from(end(number + 1) - end(number)).unwrap_or(u16::MAX)
}

/// The part of a picture that differs from the one before.
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
        // Nothing changed: one pixel, which is as it was.
        (left, right, top, bottom) = (0, 1, 0, 1);
    }
    let mut pixels = Vec::with_capacity(4 * (right - left) * (bottom - top));
    for y in top..bottom {
        for index in y * wide + left..y * wide + right {
            pixels.extend(if differs(index) { picture.pixels[index] } else { UNCHANGED });
        }
    }
    // All of them fit: they are parts of the sides of a GIF.
    let mut frame = Frame::from_rgba_speed((right - left) as u16, (bottom - top) as u16, &mut pixels, SPEED);
    (frame.left, frame.top) = (left as u16, top as u16);
    frame
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(red: &[usize]) -> Picture {
        let colour = |index: usize| if red.contains(&index) { [200, 0, 0, 255] } else { [240, 240, 240, 255] };
        Picture { width: 8, height: 4, pixels: (0..32).map(colour).collect() }
    }

    #[test]
    fn only_what_changed_is_written() {
        let frame = changes(Some(&picture(&[9])), &picture(&[18]));
        assert_eq!((frame.left, frame.top, frame.width, frame.height), (1, 1, 2, 2));
        let clear = frame.transparent.unwrap();
        let shown: Vec<bool> = frame.buffer.iter().map(|index| *index != clear).collect();
        assert_eq!(shown, [true, false, false, true]);
        assert_eq!(changes(Some(&picture(&[9])), &picture(&[9])).buffer.len(), 1);
        assert_eq!(changes(None, &picture(&[9])).buffer.len(), 32);
    }

    #[test]
    fn delays_add_up() {
        assert_eq!((0..30).map(|number| u64::from(delay(number, 30))).sum::<u64>(), 100);
        assert_eq!(delay(7, 25), 4);
    }
}
