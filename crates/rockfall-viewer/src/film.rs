//! Films: pictures of a simulation at regular times, and their files.

use std::path::Path;

use rockfall::{Result, Simulation};

use crate::draw::{Renderer, Style};
use crate::picture::Picture;

mod ffmpeg;
mod file_error;
mod files;
mod gif;
mod reel;
mod shot;
mod timing;

pub use crate::subject::Subject;
pub use reel::Reel;
pub use shot::{Follower, Shot, View};
pub use timing::{Moment, Timing, plotted, surveyed};

/// File format of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Animated GIF: 256 colours per picture, at most 50 pictures per second.
    Gif,
    /// Animated PNG: one file with all pictures, lossless.
    Apng,
    /// H.264, encoded by the program `ffmpeg`.
    Mp4,
    /// VP9, encoded by the program `ffmpeg`.
    WebM,
    /// A folder with one PNG file per picture, `0000.png` first.
    Folder,
}

impl Format {
    /// Returns the format that the extension of a path stands for, in upper or lower case. An existing folder, or a path that
    /// ends in a separator, stands for [`Format::Folder`].
    pub fn of(path: &Path) -> Option<Self> {
        let ends_in_separator = path.to_string_lossy().ends_with(std::path::is_separator);
        if ends_in_separator || path.is_dir() {
            return Some(Self::Folder);
        }
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "gif" => Some(Self::Gif),
            "apng" => Some(Self::Apng),
            "mp4" => Some(Self::Mp4),
            "webm" => Some(Self::WebM),
            _ => None,
        }
    }
}

/// Runs a simulation from one moment of a film to the next.
#[derive(Debug)]
pub struct Player {
    dt: f32,
    /// Number of equal parts of a step.
    parts: u32,
    /// Number of steps since the start of the film.
    done: u64,
}

impl Player {
    /// Creates a player that starts from the present state of a simulation and runs it in steps of `dt` seconds.
    pub fn new(dt: f32) -> Self {
        Self { dt, parts: 1, done: 0 }
    }

    /// Divides every step into this number of equal parts.
    pub fn parts(mut self, parts: u32) -> Self {
        self.parts = parts.max(1);
        self
    }

    fn run(&self, simulation: &mut Simulation, steps: u64) -> Result<()> {
        let steps = steps.saturating_mul(u64::from(self.parts));
        simulation.run(steps, self.dt / self.parts as f32).map(drop)
    }

    /// Runs up to a step. For trails and plots, which would have corners otherwise, the renderer also takes states in between.
    fn run_to(&mut self, simulation: &mut Simulation, renderer: &mut Renderer, step: u64) -> Result<()> {
        let stride = renderer.motion().interval().map(|seconds| (seconds / f64::from(self.dt)).ceil().max(1.0) as u64);
        while self.done < step {
            if stride.is_some() {
                renderer.observe(simulation)?;
            }
            let steps = stride.unwrap_or(u64::MAX).min(step - self.done);
            self.run(simulation, steps)?;
            self.done += steps;
        }
        Ok(())
    }

    /// Runs the simulation up to a moment, which must not be before the last one, and updates the renderer.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn show(&mut self, simulation: &mut Simulation, renderer: &mut Renderer, style: &Style, moment: Moment) -> Result<()> {
        let Moment { step, blend } = moment;
        if self.done <= step {
            self.run_to(simulation, renderer, step)?;
            renderer.update(simulation, style)?;
        }
        if blend > 0.0 && self.done == step {
            renderer.remember();
            self.run(simulation, 1)?;
            self.done += 1;
            renderer.update(simulation, style)?;
        }
        renderer.set_blend(if self.done == step { 1.0 } else { blend });
        Ok(())
    }
}

/// Writes a film. A file appears only when it is complete; the files of a folder appear one by one.
///
/// # Errors
/// [`rockfall::Error::File`] when the film cannot be written, or when it needs `ffmpeg` and that is not installed; the errors
/// of `pictures`.
pub fn write(path: &Path, format: Format, timing: &Timing, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    write_all(path, format, timing.fps, timing.pictures(), pictures)
}

/// [`write()`] for `count` pictures that do not follow from a [`Timing`], `fps` per second.
///
/// # Errors
/// As for [`write()`].
pub fn write_all(
    path: &Path,
    format: Format,
    fps: u32,
    count: u64,
    pictures: impl Iterator<Item = Result<Picture>>,
) -> Result<()> {
    match format {
        Format::Gif => gif::write(path, fps, pictures),
        Format::Apng => files::write_apng(path, fps, count, pictures),
        Format::Mp4 => ffmpeg::write(path, &ffmpeg::MP4, fps, pictures),
        Format::WebM => ffmpeg::write(path, &ffmpeg::WEBM, fps, pictures),
        Format::Folder => files::write_folder(path, count, pictures),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_format_follows_from_the_path() {
        assert_eq!(Format::of(Path::new("a.gif")), Some(Format::Gif));
        assert_eq!(Format::of(Path::new("a.apng")), Some(Format::Apng));
        assert_eq!(Format::of(Path::new("a.MP4")), Some(Format::Mp4));
        assert_eq!(Format::of(Path::new("a.webm")), Some(Format::WebM));
        assert_eq!(Format::of(Path::new("frames/")), Some(Format::Folder));
        assert_eq!(Format::of(&std::env::temp_dir()), Some(Format::Folder));
        assert_eq!(Format::of(Path::new("a.avi")), None);
        assert_eq!(Format::of(Path::new("a")), None);
    }
}
