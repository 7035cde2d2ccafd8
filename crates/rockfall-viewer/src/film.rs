//! Films: pictures of a simulation at even times, and the files they go to.

use std::path::Path;

use rockfall::{Result, Simulation};

use crate::draw::{Renderer, Style};
use crate::picture::Picture;

mod file_error;
mod files;
mod gif;
mod mp4;
mod timing;

pub use timing::{Moment, Timing};

/// The file formats of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 256 colours a picture; at most 50 pictures a second.
    Gif,
    /// PNG with all pictures in it, lossless.
    Apng,
    /// H.264, made by the program `ffmpeg`.
    Mp4,
    /// A PNG file a picture, `0000.png` first, in a folder.
    Folder,
}

impl Format {
    /// The format that a path asks for by its extension; a folder that is there, or a path that ends in a separator, is a
    /// folder.
    pub fn of(path: &Path) -> Option<Self> {
        let ends_in_separator = path.to_string_lossy().ends_with(std::path::is_separator);
        if ends_in_separator || path.is_dir() {
            return Some(Self::Folder);
        }
        match path.extension()?.to_str()? {
            "gif" => Some(Self::Gif),
            "apng" => Some(Self::Apng),
            "mp4" => Some(Self::Mp4),
            _ => None,
        }
    }
}

/// Shows a simulation at moments that follow one another.
#[derive(Debug)]
pub struct Player {
    dt: f32,
    /// Steps done since the film began.
    done: u64,
}

impl Player {
    /// A player of a simulation as it is now, that goes on in steps of `dt` seconds.
    pub fn new(dt: f32) -> Self {
        Self { dt, done: 0 }
    }

    /// Runs the simulation up to a moment, not before the last one, and has the renderer take it in.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn show(&mut self, simulation: &mut Simulation, renderer: &mut Renderer, style: &Style, moment: Moment) -> Result<()> {
        let Moment { step, blend } = moment;
        if self.done <= step {
            simulation.run(step - self.done, self.dt)?;
            self.done = step;
            renderer.update(simulation, style)?;
        }
        if blend > 0.0 && self.done == step {
            renderer.remember();
            simulation.step(self.dt)?;
            self.done += 1;
            renderer.update(simulation, style)?;
        }
        renderer.set_blend(if self.done == step { 1.0 } else { blend });
        Ok(())
    }
}

/// Writes a film. The file appears when it is complete; in a folder, picture by picture.
///
/// # Errors
/// [`rockfall::Error::File`] when it cannot be written, or `ffmpeg` is asked for and not there; those of `pictures`.
pub fn write(path: &Path, format: Format, timing: &Timing, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    match format {
        Format::Gif => gif::write(path, timing.fps, pictures),
        Format::Apng => files::write_apng(path, timing, pictures),
        Format::Mp4 => mp4::write(path, timing.fps, pictures),
        Format::Folder => files::write_folder(path, timing, pictures),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_go_by_the_name() {
        assert_eq!(Format::of(Path::new("a.gif")), Some(Format::Gif));
        assert_eq!(Format::of(Path::new("a.apng")), Some(Format::Apng));
        assert_eq!(Format::of(Path::new("a.mp4")), Some(Format::Mp4));
        assert_eq!(Format::of(Path::new("frames/")), Some(Format::Folder));
        assert_eq!(Format::of(&std::env::temp_dir()), Some(Format::Folder));
        assert_eq!(Format::of(Path::new("a.avi")), None);
        assert_eq!(Format::of(Path::new("a")), None);
    }
}
