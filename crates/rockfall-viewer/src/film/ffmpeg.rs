//! Films as MP4 and WebM, encoded by the program `ffmpeg`.

use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use rockfall::Result;

use crate::film::file_error::file_error;
use crate::picture::Picture;

/// A container with its encoder.
pub(super) struct Encoding {
    /// Name of the container, which is also the extension.
    name: &'static str,
    options: &'static [&'static str],
}

pub(super) const MP4: Encoding = Encoding { name: "mp4", options: &["-movflags", "+faststart"] };
/// Constant quality; ffmpeg's default bit rate is too low for the fine patterns of bodies.
pub(super) const WEBM: Encoding =
    Encoding { name: "webm", options: &["-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-row-mt", "1"] };

pub(super) fn write(path: &Path, encoding: &Encoding, fps: u32, pictures: impl Iterator<Item = Result<Picture>>) -> Result<()> {
    let wrong = file_error(path);
    let mut pictures = pictures.peekable();
    // Before the first picture is drawn, because the program may be missing.
    check(encoding).map_err(&wrong)?;
    let Some(Ok(first)) = pictures.peek() else {
        return pictures.next().transpose().map(drop);
    };
    let temporary = TemporaryFile::beside(path);
    let mut ffmpeg = start(&temporary.path, encoding, first, fps).map_err(&wrong)?;
    let mut to = ffmpeg.stdin.take();
    let mut result = Ok(());
    for picture in pictures {
        let bytes = picture?.with_even_sides().rgb();
        let written = to.as_mut().map_or(Ok(()), |to| to.write_all(&bytes));
        if written.is_err() {
            // The message of ffmpeg, read below, explains more than the broken pipe.
            result = written;
            break;
        }
    }
    drop(to);
    let message = end(ffmpeg).map_err(&wrong)?;
    match message {
        Some(message) => Err(wrong(io::Error::other(format!("ffmpeg failed: {message}")))),
        None => result.and_then(|()| temporary.rename_to(path)).map_err(wrong),
    }
}

fn command() -> Command {
    let mut command = Command::new("ffmpeg");
    command.args(["-nostdin", "-hide_banner", "-loglevel", "error"]);
    // Ctrl-C in a terminal must not reach it, so that it completes the film with the pictures so far.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command
}

fn check(encoding: &Encoding) -> io::Result<()> {
    let run = command().arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    run.map(drop).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => io::Error::other(format!(
            "writing .{} requires the program ffmpeg, which is not installed (or not on the PATH); \
             install it, or write a .gif or an .apng",
            encoding.name
        )),
        _ => error,
    })
}

fn start(path: &Path, encoding: &Encoding, first: &Picture, fps: u32) -> io::Result<Child> {
    let [width, height] = [first.width, first.height].map(|side| side.next_multiple_of(2));
    let size = format!("{width}x{height}");
    command()
        .args(["-y", "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", &size, "-framerate", &fps.to_string()])
        .args(["-i", "-", "-pix_fmt", "yuv420p"])
        .args(encoding.options)
        .args(["-f", encoding.name])
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
}

/// Waits for the program and returns its error output if it failed.
fn end(mut ffmpeg: Child) -> io::Result<Option<String>> {
    let mut message = String::new();
    if let Some(mut errors) = ffmpeg.stderr.take() {
        errors.read_to_string(&mut message)?;
    }
    let status = ffmpeg.wait()?;
    Ok((!status.success()).then(|| message.trim().to_owned()))
}

/// A temporary file in the folder of its destination, removed when dropped unless it was renamed.
struct TemporaryFile {
    path: PathBuf,
}

impl TemporaryFile {
    fn beside(path: &Path) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Self { path: path.with_file_name(format!(".{name}.{}.part", std::process::id())) }
    }

    fn rename_to(&self, path: &Path) -> io::Result<()> {
        std::fs::rename(&self.path, path)
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        // Fails if the file was renamed.
        let _ = std::fs::remove_file(&self.path);
    }
}
