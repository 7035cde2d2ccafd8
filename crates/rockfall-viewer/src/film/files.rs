//! Films as PNG: one file with all pictures, or one file per picture.

use std::io;
use std::path::Path;

use rockfall::Result;
use rockfall::output::AtomicFile;

use crate::film::file_error::file_error;
use crate::picture::Picture;

/// Writes an animated PNG file.
pub(super) fn write_apng(path: &Path, fps: u32, count: u64, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    let wrong = file_error(path);
    let mut file = AtomicFile::create(path).map_err(&wrong)?;
    let mut pictures = pictures.peekable();
    let Some(Ok(first)) = pictures.peek() else {
        return pictures.next().transpose().map(drop);
    };
    let (width, height) = (first.width, first.height);
    let mut writer = start(&mut file, [width, height], fps, count).map_err(&wrong)?;
    for picture in pictures {
        writer.write_image_data(&picture?.rgb()).map_err(io::Error::from).map_err(&wrong)?;
    }
    writer.finish().map_err(io::Error::from).map_err(&wrong)?;
    file.commit().map_err(&wrong)
}

fn start(file: &mut AtomicFile, [width, height]: [u32; 2], fps: u32, count: u64) -> io::Result<png::Writer<&mut AtomicFile>> {
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_animated(u32::try_from(count).unwrap_or(u32::MAX), 0)?;
    encoder.set_frame_delay(1, u16::try_from(fps).unwrap_or(u16::MAX))?;
    Ok(encoder.write_header()?)
}

/// Writes one file per picture, numbered with as many digits as the last one needs and at least four. Files with higher
/// numbers, from a longer film that was in the folder before, are removed: they would look like the end of this film.
pub(super) fn write_folder(path: &Path, pictures_in_all: u64, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    std::fs::create_dir_all(path).map_err(file_error(path))?;
    let digits = pictures_in_all.to_string().len().max(4);
    let place = |number: usize| path.join(format!("{number:0digits$}.png"));
    let mut count = 0;
    for (number, picture) in pictures.enumerate() {
        let picture = picture?;
        let path = place(number);
        let wrong = file_error(&path);
        let mut file = AtomicFile::create(&path).map_err(&wrong)?;
        picture.write_png(&mut file).map_err(&wrong)?;
        file.commit().map_err(&wrong)?;
        count = number + 1;
    }
    for old in (count..).map(place).take_while(|path| path.is_file()) {
        std::fs::remove_file(&old).map_err(file_error(&old))?;
    }
    Ok(())
}
