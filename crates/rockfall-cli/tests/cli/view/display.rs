//! A window on a virtual display (Xvfb), with input from xdotool.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

const INSTALL: &str = "this test needs Xvfb and xdotool: apt-get install xvfb xdotool libxkbcommon-x11-0, or run scripts/test";
/// Longest time to wait for a change. A window on software Vulkan is slow.
const PATIENCE: Duration = Duration::from_secs(300);

/// A virtual display.
pub(crate) struct Display {
    server: Child,
    name: String,
}

impl Display {
    pub(crate) fn open() -> Self {
        let arguments = ["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-noreset"];
        let mut command = Command::new("Xvfb");
        let mut server = command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect(INSTALL);
        let mut number = String::new();
        let read = BufReader::new(server.stdout.take().expect("it is piped")).read_line(&mut number);
        read.expect("the server prints its display number");
        Self { server, name: format!(":{}", number.trim()) }
    }

    fn xdotool(&self, arguments: &str) -> Output {
        let mut command = Command::new("xdotool");
        command.args(arguments.split_whitespace()).env("DISPLAY", &self.name).output().expect(INSTALL)
    }

    /// Runs an xdotool command that must succeed.
    pub(crate) fn act(&self, arguments: &str) {
        let output = self.xdotool(arguments);
        assert!(output.status.success(), "xdotool {arguments}: {output:?}");
    }
}

/// The pixels of a display, in rows from above.
pub(crate) struct Screen {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

impl Screen {
    /// Number of pixels of about this colour in a part of the screen: from `x` and `y` up to `x + width` and `y + height`.
    pub(crate) fn count(&self, colour: [u8; 3], [x, y, width, height]: [usize; 4]) -> usize {
        let near = |pixel: &&[u8; 3]| pixel.iter().zip(colour).all(|(one, other)| one.abs_diff(other) <= 12);
        (y..y + height).map(|y| self.pixels[y * self.width..][x..x + width].iter().filter(near).count()).sum()
    }
}

impl Display {
    /// Takes a picture of the whole display.
    pub(crate) fn screen(&self) -> Screen {
        let mut command = Command::new("ffmpeg");
        command.args(["-loglevel", "error", "-f", "x11grab", "-draw_mouse", "0", "-video_size", "1280x800"]);
        command.args(["-i", &self.name, "-frames:v", "1", "-pix_fmt", "rgb24", "-f", "rawvideo", "-"]);
        let output = command.output().expect("this test needs ffmpeg: apt-get install ffmpeg, or run scripts/test");
        assert!(output.status.success(), "{output:?}");
        let pixels: Vec<[u8; 3]> = output.stdout.as_chunks().0.to_vec();
        assert_eq!(pixels.len(), 1280 * 800, "pixels");
        Screen { width: 1280, pixels }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // SIGTERM instead of SIGKILL, so that the server removes its lock file.
        let _ = Command::new("kill").arg(self.server.id().to_string()).status();
        let _ = self.server.wait();
    }
}

/// Lock that allows one window at a time, because software Vulkan uses all cores.
fn window_lock() -> MutexGuard<'static, ()> {
    static LOCK: Mutex<()> = Mutex::new(());
    LOCK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A running `rockfall view` in a temporary folder.
pub(crate) struct Session {
    pub(crate) display: Display,
    folder: TempDir,
    program: Child,
    _lock: MutexGuard<'static, ()>,
}

pub(crate) fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

pub(crate) fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rockfall"));
    command.current_dir(folder).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").env("XDG_RUNTIME_DIR", folder);
    command
}

impl Session {
    /// Opens a window on `scene.txt`.
    pub(crate) fn open(files: &[(&str, &str)], arguments: &str) -> Self {
        Self::show(folder(files), "scene.txt", arguments)
    }

    /// Opens a window on a file of a folder and gives it the keyboard focus, because there is no window manager.
    pub(crate) fn show(folder: TempDir, file: &str, arguments: &str) -> Self {
        let _lock = window_lock();
        let display = Display::open();
        let mut command = command(folder.path());
        command.env("DISPLAY", &display.name).args(["view", file, "--report", "report.json"]);
        let program = command.args(arguments.split_whitespace()).stderr(Stdio::piped()).spawn().expect("it starts");
        let mut session = Self { display, folder, program, _lock };
        let start = Instant::now();
        let window = loop {
            let found = session.display.xdotool("search --onlyvisible --name rockfall");
            if let Some(id) = String::from_utf8_lossy(&found.stdout).lines().next() {
                break id.to_owned();
            }
            assert!(start.elapsed() < PATIENCE, "no window has opened");
            assert!(session.program.try_wait().expect("it is a child").is_none(), "{}", session.errors());
            sleep(Duration::from_millis(50));
        };
        session.display.act(&format!("windowfocus --sync {window}"));
        session
    }

    fn errors(&mut self) -> String {
        let mut text = String::new();
        if let Some(mut errors) = self.program.stderr.take() {
            let _ = std::io::Read::read_to_string(&mut errors, &mut text);
        }
        text
    }

    pub(crate) fn keys(&self, keys: &str) {
        self.display.act(&format!("key --delay 40 {keys}"));
    }

    /// Waits until the report fulfils a condition.
    pub(crate) fn wait(&mut self, what: &str, condition: impl Fn(&Value) -> bool) {
        assert!(self.sees(what, PATIENCE, condition), "{what} did not appear: {:#}", self.report());
    }

    /// Acts again and again until the report fulfils a condition.
    pub(crate) fn act_until(&mut self, what: &str, action: &str, condition: impl Fn(&Value) -> bool) {
        let start = Instant::now();
        self.display.act(action);
        while !self.sees(what, Duration::from_secs(5), &condition) {
            assert!(start.elapsed() < PATIENCE, "{what} did not appear: {:#}", self.report());
            self.display.act(action);
        }
    }

    /// Whether the report fulfils a condition before a time is over.
    fn sees(&mut self, what: &str, longest: Duration, condition: impl Fn(&Value) -> bool) -> bool {
        let start = Instant::now();
        while start.elapsed() < longest {
            let text = fs::read_to_string(self.path("report.json")).unwrap_or_default();
            let report: Option<Value> = serde_json::from_str(&text).ok();
            if report.as_ref().is_some_and(&condition) {
                return true;
            }
            let ended = self.program.try_wait().expect("it is a child").is_some();
            assert!(!ended, "{what} did not appear: {}", self.errors());
            sleep(Duration::from_millis(50));
        }
        false
    }

    /// Hides the panel and waits until the picture has the full width. Its middle is then the middle of the window below the
    /// menu.
    pub(crate) fn hide_panel(&mut self) {
        self.keys("p");
        self.wait("a window without a panel", |report| number(&report["picture"][0]) == 1280.0);
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Closes everything that is open and then the window, also with unsaved changes, and returns the last report.
    pub(crate) fn quit(mut self) -> Value {
        let start = Instant::now();
        let status = loop {
            // The window may be gone already.
            self.display.xdotool("key Escape");
            // The last key answers the question about unsaved changes, which the key before it may open.
            self.display.xdotool("key --delay 40 ctrl+q ctrl+q");
            sleep(Duration::from_millis(500));
            if let Some(status) = self.program.try_wait().expect("it is a child") {
                break status;
            }
            assert!(start.elapsed() < PATIENCE, "the window has not closed");
        };
        assert!(status.success(), "{}", self.errors());
        self.report()
    }

    pub(crate) fn report(&self) -> Value {
        let text = fs::read_to_string(self.path("report.json")).expect("a report");
        serde_json::from_str(&text).expect("good JSON")
    }

    /// Types text into the field that has the focus.
    pub(crate) fn type_text(&self, text: &str) {
        self.display.act(&format!("type --delay 30 {text}"));
    }

    /// Moves the pointer to a place relative to the middle of the picture.
    pub(crate) fn point(&self, x: i32, y: i32) {
        let report = self.report();
        let middle =
            [0, 1].map(|axis| (number(&report["picture_origin"][axis]) + 0.5 * number(&report["picture"][axis])) as i32);
        self.display.act(&format!("mousemove {} {}", middle[0] + x, middle[1] + y));
    }

    pub(crate) fn drag(&self, button: u8, x: i32, y: i32) {
        self.point(0, 0);
        self.display.act(&format!("mousedown {button}"));
        self.point(x / 2, y / 2);
        self.point(x, y);
        self.display.act(&format!("mouseup {button}"));
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}
