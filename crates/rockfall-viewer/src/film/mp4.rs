//! Films as MP4, by the program `ffmpeg`.

use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use rockfall::Result;

use crate::film::file_error::file_error;
use crate::picture::Picture;

pub(super) fn write(path: &Path, fps: u32, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    let wrong = file_error(path);
    let mut pictures = pictures.peekable();
    // Before the first picture is made: the program may be missing.
    check().map_err(&wrong)?;
    let Some(Ok(first)) = pictures.peek() else {
        return pictures.next().transpose().map(drop);
    };
    let part = Part::beside(path);
    let mut ffmpeg = start(&part.path, first, fps).map_err(&wrong)?;
    let mut to = ffmpeg.stdin.take();
    let mut result = Ok(());
    for picture in pictures {
        let bytes = picture?.rgb();
        let written = to.as_mut().map_or(Ok(()), |to| to.write_all(&bytes));
        if written.is_err() {
            // What it has to say tells more than the broken pipe.
            result = written;
            break;
        }
    }
    drop(to);
    let said = end(ffmpeg).map_err(&wrong)?;
    match said {
        Some(said) => Err(wrong(io::Error::other(format!("ffmpeg failed: {said}")))),
        None => result.and_then(|()| part.put(path)).map_err(wrong),
    }
}

fn command() -> Command {
    let mut command = Command::new("ffmpeg");
    command.args(["-nostdin", "-hide_banner", "-loglevel", "error"]);
    command
}

fn check() -> io::Result<()> {
    let run = command().arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    run.map(drop).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => io::Error::other(
            "films as .mp4 are made by the program ffmpeg, which is not installed (or not on the PATH); \
             install it, or write a .gif or an .apng",
        ),
        _ => error,
    })
}

fn start(path: &Path, first: &Picture, fps: u32) -> io::Result<Child> {
    let size = format!("{}x{}", first.width, first.height);
    command()
        .args(["-y", "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", &size, "-framerate", &fps.to_string()])
        .args(["-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-movflags", "+faststart"])
        .args(["-f", "mp4"])
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
}

/// What the program said, if it failed.
fn end(mut ffmpeg: Child) -> io::Result<Option<String>> {
    let mut said = String::new();
    if let Some(mut errors) = ffmpeg.stderr.take() {
        errors.read_to_string(&mut said)?;
    }
    let status = ffmpeg.wait()?;
    Ok((!status.success()).then(|| said.trim().to_owned()))
}

/// A file beside its place, removed unless it is put there.
struct Part {
    path: PathBuf,
}

impl Part {
    fn beside(path: &Path) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Self { path: path.with_file_name(format!(".{name}.{}.part", std::process::id())) }
    }

    fn put(&self, path: &Path) -> io::Result<()> {
        std::fs::rename(&self.path, path)
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        // Gone when it was put in its place.
        let _ = std::fs::remove_file(&self.path);
    }
}
