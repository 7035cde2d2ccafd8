//! Films: pictures of a simulation at even times, and the files they go to.

use std::io;
use std::path::{Path, PathBuf};

use rockfall::{Error, Result, Simulation};

use crate::draw::{Renderer, Style};
use crate::picture::Picture;

mod files;
mod gif;
mod mp4;

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

/// When the pictures of a film are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Steps that the film is of.
    pub steps: u64,
    /// Time step in s.
    pub dt: f32,
    /// Pictures a second.
    pub fps: u32,
    /// Simulated seconds in a second of film; 1: real time.
    pub speed: f64,
}

/// A moment between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Steps done before it.
    pub step: u64,
    /// How much of the next step has passed, from 0 to less than 1.
    pub blend: f32,
}

impl Timing {
    /// The time step as it was written: 0.02, not 0.019999999552965164.
    fn step_seconds(&self) -> f64 {
        self.dt.to_string().parse().unwrap_or(f64::from(self.dt))
    }

    /// Number of pictures: one at the start, and as many as begin before the last step has ended.
    pub fn pictures(&self) -> u64 {
        let seconds = self.steps as f64 * self.step_seconds() / self.speed;
        // A rounding error must not lose the last one.
        (seconds * f64::from(self.fps) + 1e-6).floor() as u64 + 1
    }

    /// When picture `index` is taken.
    pub fn moment(&self, index: u64) -> Moment {
        let steps = index as f64 * self.speed / f64::from(self.fps) / self.step_seconds();
        let step = (steps + 1e-5).floor();
        let blend = (steps - step) as f32;
        if step as u64 >= self.steps || blend < 1e-4 {
            return Moment { step: (step as u64).min(self.steps), blend: 0.0 };
        }
        Moment { step: step as u64, blend }
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
/// [`Error::File`] when it cannot be written, or `ffmpeg` is asked for and not there; those of `pictures`.
pub fn write(path: &Path, format: Format, timing: &Timing, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    match format {
        Format::Gif => gif::write(path, timing.fps, pictures),
        Format::Apng => files::write_apng(path, timing, pictures),
        Format::Mp4 => mp4::write(path, timing.fps, pictures),
        Format::Folder => files::write_folder(path, timing, pictures),
    }
}

fn failed(path: &Path) -> impl Fn(io::Error) -> Error {
    let file: PathBuf = path.to_owned();
    move |source| Error::File { file: file.clone(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn real_time_at_the_rate_of_the_steps_shows_every_state_as_it_is() {
        let timing = Timing { steps: 100, dt: 0.02, fps: 50, speed: 1.0 };
        assert_eq!(timing.pictures(), 101);
        for index in 0..=100 {
            assert_eq!(timing.moment(index), Moment { step: index, blend: 0.0 });
        }
    }

    #[test]
    fn other_rates_fall_between_states() {
        let timing = Timing { steps: 10, dt: 0.02, fps: 30, speed: 1.0 };
        // 0.2 s at 30 a second: at 0, 1/30, ... 6/30 s.
        assert_eq!(timing.pictures(), 7);
        let second = timing.moment(1);
        assert_eq!(second.step, 1);
        assert!((second.blend - 2.0 / 3.0).abs() < 1e-5);
        assert_eq!(timing.moment(6), Moment { step: 10, blend: 0.0 });
    }

    #[test]
    fn slow_motion_takes_longer() {
        let timing = Timing { steps: 10, dt: 0.02, fps: 30, speed: 0.5 };
        assert_eq!(timing.pictures(), 13);
        assert_eq!(timing.moment(3).step, 2);
        assert!((timing.moment(3).blend - 0.5).abs() < 1e-5);
    }

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
