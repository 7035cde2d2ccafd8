//! Screenshots and recordings of the window. Films are encoded by a thread, so that the window goes on meanwhile.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;

use rockfall::Result;

use crate::film::{self, Format, Timing};
use crate::pixels::Picture;

/// Pictures per second of a recording.
const FPS: u32 = 25;
/// Greatest length of a recording, in s.
const LONGEST: f64 = 600.0;
/// Number of pictures that wait for the encoder. Further ones are left out, and the ones before are shown longer.
const WAITING: usize = 8;
/// Width above which the pictures of a GIF are halved, in pixels.
const WIDE_GIF: u32 = 800;

/// A picture, and for how many pictures of the film it is shown.
type Shown = (Arc<Picture>, u64);

/// Screenshots and recordings.
#[derive(Debug, Default)]
pub struct Capture {
    screenshot: bool,
    recording: Option<Recording>,
    /// Films that are being completed.
    ending: Vec<Film>,
}

/// A film that a thread writes.
#[derive(Debug)]
struct Film {
    path: PathBuf,
    thread: JoinHandle<Result<()>>,
}

#[derive(Debug)]
struct Recording {
    film: Film,
    format: Format,
    sender: SyncSender<Shown>,
    started: f64,
    /// Number of pictures of the film that were sent.
    sent: u64,
    /// The last picture, which is shown until the next one.
    last: Option<Arc<Picture>>,
    /// Whether the thread has ended because of an error.
    failed: bool,
}

impl Capture {
    /// Asks for a screenshot with the next frame.
    pub fn ask_for_screenshot(&mut self) {
        self.screenshot = true;
    }

    /// Whether the next frame has to be read back at its full resolution.
    pub fn wants_picture(&self) -> bool {
        self.screenshot || self.recording.is_some()
    }

    /// Whether a film is being recorded.
    pub fn is_recording(&self) -> bool {
        self.recording.is_some()
    }

    /// Whether films are being completed.
    pub fn is_ending(&self) -> bool {
        !self.ending.is_empty()
    }

    /// Returns the length of the recording at the time `now`, in s.
    pub fn length(&self, now: f64) -> Option<f64> {
        self.recording.as_ref().map(|recording| now - recording.started)
    }

    /// Whether a screenshot was asked for; the request is then done.
    pub(super) fn take_screenshot(&mut self) -> bool {
        std::mem::take(&mut self.screenshot)
    }

    /// Starts a recording at the time `now`, in s.
    pub(super) fn start(&mut self, path: &Path, format: Format, now: f64) {
        if self.recording.is_some() {
            return;
        }
        let (sender, receiver) = sync_channel(WAITING);
        let to = path.to_owned();
        let thread = std::thread::spawn(move || {
            let timing = Timing { steps: 0, dt: 1.0, fps: FPS, speed: 1.0 };
            film::write(&to, format, &timing, pictures(receiver))
        });
        let film = Film { path: path.to_owned(), thread };
        self.recording = Some(Recording { film, format, sender, started: now, sent: 0, last: None, failed: false });
    }

    /// Adds the picture that is shown from the time `now` on.
    pub(super) fn add(&mut self, picture: Picture, now: f64) {
        let Some(recording) = &mut self.recording else {
            return;
        };
        recording.send_until(now);
        recording.show(picture);
        if recording.failed || now - recording.started > LONGEST {
            self.stop(now);
        }
    }

    /// Ends the recording.
    pub(super) fn stop(&mut self, now: f64) {
        if let Some(mut recording) = self.recording.take() {
            recording.send_last(now);
            self.ending.push(recording.film);
        }
    }

    /// Returns the films that were completed with their results; with `wait`, waits for all.
    pub(super) fn finished(&mut self, wait: bool) -> Vec<(PathBuf, Result<()>)> {
        let (done, ending) = std::mem::take(&mut self.ending).into_iter().partition(|film| wait || film.thread.is_finished());
        self.ending = ending;
        let result = |film: Film| {
            let broken = || Err(rockfall::Error::Device("the encoder of the film failed".to_owned()));
            (film.path, film.thread.join().unwrap_or_else(|_| broken()))
        };
        done.into_iter().map(result).collect()
    }
}

fn pictures(receiver: Receiver<Shown>) -> impl Iterator<Item = Result<Picture>> {
    receiver.into_iter().flat_map(|(picture, times)| (0..times).map(move |_| Ok((*picture).clone())))
}

impl Recording {
    /// Number of pictures from the last one sent until the time `now`.
    fn due(&self, now: f64) -> u64 {
        (((now - self.started) * f64::from(FPS)).round() as u64).saturating_sub(self.sent)
    }

    /// Sends the last picture for the time that it was shown.
    fn send_until(&mut self, now: f64) {
        let (due, Some(last)) = (self.due(now), &self.last) else {
            return;
        };
        if due > 0 {
            match self.sender.try_send((Arc::clone(last), due)) {
                Ok(()) => self.sent += due,
                // The encoder is behind. The time goes to the next picture.
                Err(TrySendError::Full(_)) => {}
                Err(TrySendError::Disconnected(_)) => self.failed = true,
            }
        }
    }

    /// Sends the last picture and waits for the encoder.
    fn send_last(&mut self, now: f64) {
        if let Some(last) = self.last.take() {
            // The thread has ended only after an error, which it returns.
            let _ = self.sender.send((last, self.due(now).max(1)));
        }
    }

    /// Sets the picture that is shown from now on. All pictures of a film have the size of the first.
    fn show(&mut self, picture: Picture) {
        let picture = if self.format == Format::Gif && picture.width > WIDE_GIF { halved(&picture) } else { picture };
        let fits = self.last.as_ref().is_none_or(|last| (last.width, last.height) == (picture.width, picture.height));
        let picture = match &self.last {
            Some(last) if !fits => fitted(&picture, last.width, last.height),
            _ => picture,
        };
        self.last = Some(Arc::new(picture));
    }
}

/// Returns a picture of half the width and height.
fn halved(picture: &Picture) -> Picture {
    let (width, height) = (picture.width / 2, picture.height / 2);
    let row = picture.width as usize;
    let pixels = (0..height as usize).flat_map(|y| (0..width as usize).map(move |x| (2 * x, 2 * y)));
    let mean = |(x, y): (usize, usize)| {
        let four = [y * row + x, y * row + x + 1, (y + 1) * row + x, (y + 1) * row + x + 1].map(|at| picture.pixels[at]);
        std::array::from_fn(|channel| (four.iter().map(|pixel| u16::from(pixel[channel])).sum::<u16>() / 4) as u8)
    };
    Picture { width, height, pixels: pixels.map(mean).collect() }
}

/// Returns a picture of this size with the nearest pixels of another one, because the window was resized while it is recorded.
fn fitted(picture: &Picture, width: u32, height: u32) -> Picture {
    let at = |to: u32, size: u32, from: u32| (u64::from(to) * u64::from(from) / u64::from(size.max(1))) as usize;
    let pixel = |(x, y): (u32, u32)| {
        picture.pixels[at(y, height, picture.height) * picture.width as usize + at(x, width, picture.width)]
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(pixel).collect();
    Picture { width, height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: u32, height: u32, value: u8) -> Picture {
        Picture { width, height, pixels: vec![[value, value, value, 255]; (width * height) as usize] }
    }

    /// A picture every 0.2 s is shown for five pictures of the film, whether or not frames are drawn in between.
    #[test]
    fn a_recording_lasts_as_long_as_the_film() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.gif");
        let mut capture = Capture::default();
        assert!(!capture.wants_picture());
        capture.start(&path, Format::Gif, 10.0);
        assert!(capture.wants_picture() && capture.is_recording());
        for (index, value) in [10, 80, 160, 240].into_iter().enumerate() {
            // The third picture comes after the window was resized.
            capture.add(if index == 2 { grey(60, 20, value) } else { grey(40, 30, value) }, 10.0 + 0.2 * index as f64);
        }
        capture.stop(11.0);
        let [(_, Ok(()))] = &capture.finished(true)[..] else { panic!("the film was not written") };
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut reader = options.read_info(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!((reader.width(), reader.height()), (40, 30));
        let (mut hundredths, mut pictures) = (0, 0);
        while let Some(frame) = reader.read_next_frame().unwrap() {
            hundredths += u64::from(frame.delay);
            pictures += 1;
        }
        assert_eq!((hundredths, pictures), (100, 25));
    }

    #[test]
    fn an_error_of_the_encoder_is_reported() {
        let mut capture = Capture::default();
        capture.start(Path::new("/no/such/folder/film.gif"), Format::Gif, 0.0);
        for frame in 0..50 {
            capture.add(grey(4, 4, frame), 0.1 * f64::from(frame));
        }
        capture.stop(5.0);
        let [(_, Err(error))] = &capture.finished(true)[..] else { panic!("there is no error") };
        assert!(error.to_string().contains("/no/such/folder/film.gif"), "{error}");
    }

    #[test]
    fn pictures_are_halved_by_the_mean_of_four_pixels() {
        let mut picture = grey(4, 2, 100);
        picture.pixels[0] = [200, 100, 100, 255];
        let half = halved(&picture);
        assert_eq!(
            (half.width, half.height, half.pixels[0], half.pixels[1]),
            (2, 1, [125, 100, 100, 255], [100, 100, 100, 255])
        );
    }
}
