//! Tests of the window on a virtual display (Xvfb): keys, drags, bad files and a lost device. The hidden option `--report`
//! writes the state of the window, which the tests check.
#![cfg(all(feature = "window", target_os = "linux"))]

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
const PATIENCE: Duration = Duration::from_secs(120);

/// One ball without gravity. It stays in the middle of the picture.
const BALL: &str = "set gravity 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n";

/// A virtual display.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    fn open() -> Self {
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
    fn act(&self, arguments: &str) {
        let output = self.xdotool(arguments);
        assert!(output.status.success(), "xdotool {arguments}: {output:?}");
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
struct Session {
    display: Display,
    folder: TempDir,
    program: Child,
    _lock: MutexGuard<'static, ()>,
}

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rockfall"));
    command.current_dir(folder).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").env("XDG_RUNTIME_DIR", folder);
    command
}

impl Session {
    /// Opens a window on `scene.txt` and gives it the keyboard focus, because there is no window manager.
    fn open(files: &[(&str, &str)], arguments: &str) -> Self {
        let _lock = window_lock();
        let (display, folder) = (Display::open(), folder(files));
        let mut command = command(folder.path());
        command.env("DISPLAY", &display.name).args(["view", "scene.txt", "--report", "report.json"]);
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

    fn keys(&self, keys: &str) {
        self.display.act(&format!("key --delay 40 {keys}"));
    }

    /// Waits until the report fulfils a condition.
    fn wait(&mut self, what: &str, condition: impl Fn(&Value) -> bool) {
        let start = Instant::now();
        loop {
            let text = fs::read_to_string(self.path("report.json")).unwrap_or_default();
            let report: Option<Value> = serde_json::from_str(&text).ok();
            if report.as_ref().is_some_and(&condition) {
                return;
            }
            let ended = self.program.try_wait().expect("it is a child").is_some();
            assert!(
                !ended && start.elapsed() < PATIENCE,
                "{what} did not appear: {} {text}",
                if ended { self.errors() } else { String::new() }
            );
            sleep(Duration::from_millis(50));
        }
    }

    /// Hides the panel and waits until the picture has the full width. Its middle is then the middle of the window below the
    /// menu.
    fn hide_panel(&mut self) {
        self.keys("p");
        self.wait("a window without a panel", |report| number(&report["picture"][0]) == 1280.0);
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Presses Esc, waits for the end and returns the report.
    fn quit(mut self) -> Value {
        self.keys("Escape");
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.program.try_wait().expect("it is a child") {
                break status;
            }
            assert!(start.elapsed() < PATIENCE, "the window has not closed");
            sleep(Duration::from_millis(50));
        };
        assert!(status.success(), "{}", self.errors());
        let text = fs::read_to_string(self.path("report.json")).expect("a report");
        serde_json::from_str(&text).expect("good JSON")
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn messages(report: &Value) -> String {
    report["messages"].to_string()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

/// Tests every key of the thesis's table except A and the mouse (section 2.12.1). Each key of a constant is pressed a different
/// number of times, so that a key without effect, or with the effect of another key, is detected.
#[test]
fn every_key_of_the_table_has_its_effect() {
    let session =
        Session::open(&[("scene.txt", BALL), ("input.txt", &format!("{BALL}S 2 3 0 0 0 0 0 0 0 0 1 0.5\n"))], "--backend cpu");
    session.keys("r");
    session.keys("shift+r");
    session.keys("Home Up Up Up Left");
    session.keys("k t F1");
    session.keys("d d d c");
    session.keys("f f f f v");
    session.keys("g b b b");
    session.keys("h h h h h n n");
    session.keys("j j j j j m");
    session.keys("z x x x x");
    session.keys("s s s");
    let report = session.quit();

    let constants = &report["constants"];
    let expected = [
        ("activation_threshold", "1.2"),
        ("contact_damping", "14"),
        ("contact_force", "900"),
        ("friction", "65"),
        ("gravity", "1"),
        ("restitution", "0.6"),
        ("collisions", "off"),
    ];
    for (name, value) in expected {
        assert_eq!(constants[name], value, "{name} in {report:#}");
    }
    assert_eq!(report["help"], true, "F1");
    assert_eq!(report["real_time"], true, "T");
    assert_eq!((&report["running"], &report["steps"]), (&false.into(), &3.into()), "S");
    // R reads input.txt, which has two balls; Shift+R then reads the given file again.
    assert!(messages(&report).contains("input.txt was read") && messages(&report).contains("scene.txt was read"), "{report:#}");
    assert_eq!((&report["scene"], &report["spheres"]), (&"scene.txt".into(), &1.into()));
    // Up moves the camera forwards and Left to the left. The arrow keys do not change its height.
    let (eye, target) = (&report["camera"]["eye"], &report["camera"]["target"]);
    assert!(number(&target[0]).abs() > 0.01 && number(&target[2]) < -0.05, "{report:#}");
    assert!(number(&target[1]).abs() < 1e-3 && number(&eye[1]) > 0.1, "{report:#}");
}

/// The key A starts the simulation; a drag with Ctrl pulls the ball in the middle.
#[test]
fn a_drag_with_ctrl_pulls_a_body() {
    let mut session = Session::open(&[("scene.txt", BALL)], "--backend cpu");
    session.hide_panel();
    session.keys("a");
    session.display.act("mousemove 640 410");
    session.display.act("keydown ctrl mousedown 1");
    session.wait("a held ball", |report| report["held"] == true);
    for x in [660, 700, 740, 780] {
        session.display.act(&format!("mousemove {x} 410"));
    }
    session.wait("a ball pulled to the right", |report| number(&report["positions"][0][0]) > 0.2);
    session.display.act("mouseup 1 keyup ctrl");
    session.wait("a released ball", |report| report["held"] == false);
    let report = session.quit();
    assert_eq!(report["running"], true, "A");
    assert_eq!((&report["held"], &report["tethers"]), (&false.into(), &0.into()));
    assert_eq!(messages(&report), "[]");
}

/// Distance from the eye to the point that it looks at.
fn camera_distance(report: &Value) -> f64 {
    let of = |point: &str, axis: usize| number(&report["camera"][point][axis]);
    (0..3).map(|axis| (of("eye", axis) - of("target", axis)).powi(2)).sum::<f64>().sqrt()
}

/// Left and right drags and the wheel move the camera; the space bar throws a sphere.
#[test]
fn the_mouse_moves_the_camera() {
    let reports = [false, true].map(|moves| {
        let mut session = Session::open(&[("scene.txt", BALL)], "--backend cpu");
        session.hide_panel();
        if moves {
            for action in [
                "mousemove 640 410 mousedown 1",
                "mousemove 740 410 mouseup 1",
                "mousemove 640 410 mousedown 3",
                "mousemove 640 350 mouseup 3",
                "mousemove 640 410 click 4 click 4",
                "key space",
            ] {
                session.display.act(action);
            }
        }
        session.quit()
    });
    let [before, after] = &reports;
    let moved = |axis: usize| number(&after["camera"]["target"][axis]) - number(&before["camera"]["target"][axis]);
    assert!(moved(0).abs() > 0.1, "left drag: {after:#}");
    assert!(moved(1).abs() > 0.05, "right drag: {after:#}");
    let nearer = camera_distance(after) / camera_distance(before);
    // Xvfb may send two events for each click of the wheel.
    assert!((0.59..0.78).contains(&nearer), "expected two or four wheel events, distance ratio {nearer}: {after:#}");
    assert_eq!((&before["spheres"], &after["spheres"]), (&1.into(), &2.into()), "space");
}

/// A bad file is reported in the window and the present scene continues. A click shows what a body is.
#[test]
fn a_bad_file_is_reported_and_the_scene_continues() {
    let mut session = Session::open(&[("scene.txt", BALL), ("input.txt", "S 1 0 0 0\n")], "--backend cpu");
    session.hide_panel();
    session.keys("r");
    session.wait("an error", |report| messages(report).contains("input.txt:1: "));
    session.display.act("mousemove 640 410 click 1");
    session.wait("a picked ball", |report| report["picked"] == "sphere 0");
    session.keys("a");
    session.wait("steps after the error", |report| number(&report["steps"]) > 3.0);
    let report = session.quit();
    assert_eq!((&report["scene"], &report["spheres"]), (&"scene.txt".into(), &1.into()));
}

/// A device that is lost during the simulation is opened again. The window reports this, and the scene continues.
#[test]
fn a_lost_device_is_opened_again() {
    let mut session = Session::open(&[("scene.txt", BALL)], "--backend gpu --lose-device-after 4");
    session.keys("a");
    session.wait("another device", |report| report["run"]["devices_reopened"] == 1);
    session.wait("steps on it", |report| number(&report["steps"]) > 2.0);
    let report = session.quit();
    assert!(messages(&report).contains("lost and opened again"), "{report:#}");
}

/// While nothing changes, no frames are drawn.
#[test]
fn a_stopped_scene_is_not_redrawn() {
    let mut session = Session::open(&[("scene.txt", BALL)], "--backend cpu");
    session.wait("a frame", |report| number(&report["run"]["frames"]) >= 1.0);
    let frames = |session: &Session| {
        sleep(Duration::from_secs(4));
        let text = fs::read_to_string(session.path("report.json")).expect("a report");
        let report: Value = serde_json::from_str(&text).expect("good JSON");
        number(&report["run"]["frames"])
    };
    let before = frames(&session);
    assert_eq!(frames(&session), before);
    session.quit();
}

#[test]
fn without_a_display_the_message_suggests_render() {
    let folder = folder(&[("scene.txt", BALL)]);
    let mut command = command(folder.path());
    let output = command.args(["view", "scene.txt"]).env_remove("DISPLAY").output().expect("it starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.starts_with("error: no window can be opened here: neither WAYLAND_DISPLAY nor "), "{errors}");
    assert!(errors.ends_with("; `rockfall render` makes pictures and films without one\n"), "{errors}");
}
