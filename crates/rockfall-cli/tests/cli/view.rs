//! Tests of the window on a virtual display (Xvfb): keys, drags, bad files and a lost device. The hidden option `--report`
//! writes the state of the window, which the tests check.
#![cfg(all(feature = "window", target_os = "linux"))]

use std::fs;
use std::io::BufReader;
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

mod display;

use display::{Session, command, folder, number};

use crate::common::Rockfall;

/// One ball without gravity. It stays in the middle of the picture.
const BALL: &str = "set gravity 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n";

fn messages(report: &Value) -> String {
    report["messages"].to_string()
}

/// Tests every key of the thesis's table except A and the mouse (section 2.12.1). Each key of a constant is pressed a different
/// number of times, so that a key without effect, or with the effect of another key, is detected.
#[test]
fn every_key_of_the_table_has_its_effect() {
    let files = [("scene.txt", BALL), ("input.txt", &format!("{BALL}S 2 3 0 0 0 0 0 0 0 0 1 0.5\n"))];
    let mut session = Session::open(&files, "--backend cpu --controls thesis");
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
    session.wait("three steps", |report| report["steps"] == 3 && report["help"] == true);
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
    assert_eq!(report["real_time"], false, "T");
    assert_eq!((&report["running"], &report["steps"]), (&false.into(), &3.into()), "S");
    // R reads input.txt, which has two balls; Shift+R then reads the given file again.
    assert!(messages(&report).contains("input.txt was read") && messages(&report).contains("scene.txt was read"), "{report:#}");
    assert_eq!((&report["scene"], &report["spheres"]), (&"scene.txt".into(), &1.into()));
    // Up moves the camera forwards and Left to the left. The arrow keys do not change its height.
    let (eye, target) = (&report["camera"]["eye"], &report["camera"]["target"]);
    assert!(number(&target[0]).abs() > 0.01 && number(&target[2]) < -0.05, "{report:#}");
    assert!(number(&target[1]).abs() < 1e-3 && number(&eye[1]) > 0.1, "{report:#}");
}

/// Esc closes help, a dialog and a menu before the window.
#[test]
fn escape_closes_what_is_open_first() {
    let mut session = Session::open(&[("scene.txt", BALL)], "--backend cpu");
    session.keys("F1");
    session.wait("help", |report| report["help"] == true);
    session.keys("ctrl+o");
    session.wait("a dialog", |report| report["dialog"].is_object());
    session.keys("Escape");
    session.wait("no dialog", |report| report["dialog"].is_null() && report["help"] == true);
    session.keys("Escape");
    session.wait("no help", |report| report["help"] == false);
    session.display.act("mousemove 20 10 click 1");
    session.wait("a menu", |report| report["busy"] == true);
    session.keys("Escape");
    session.wait("no menu", |report| report["busy"] == false);
    session.quit();
}

/// Ctrl+S asks for a name. An existing file is not overwritten by Enter. Ctrl+S then writes the same file again.
#[test]
fn saving_asks_before_it_overwrites() {
    let files = [("scene.txt", BALL), ("mine.txt", "a precious file\n")];
    let mut session = Session::open(&files, "--backend cpu");
    session.keys("ctrl+s");
    session.wait("a dialog with a new name", |report| report["dialog"]["path"] == "scene-1.txt");
    session.type_text("mine");
    session.wait("the typed name", |report| report["dialog"]["path"] == "mine");
    session.keys("Return");
    session.wait("a question", |report| report["dialog"]["overwrite"] == "mine.txt");
    session.keys("Escape");
    session.wait("no question", |report| report["dialog"]["overwrite"].is_null());
    session.keys("Return");
    session.wait("the question again", |report| report["dialog"]["overwrite"] == "mine.txt");
    session.keys("Return");
    session.wait("a new file", |report| messages(report).contains("saved as mine-1.txt") && report["dialog"].is_null());
    session.keys("s ctrl+s");
    session.wait("a step", |report| report["steps"] == 1);
    assert!(session.report()["dialog"].is_null());
    assert_eq!(fs::read_to_string(session.path("mine.txt")).expect("a file"), "a precious file\n");
    assert_eq!(fs::read_to_string(session.path("scene.txt")).expect("a file"), BALL);
    session.quit();
}

/// Space starts and stops in real time. L throws, Ctrl+Z takes the sphere back, and a comma goes back in time.
#[test]
fn space_starts_and_edits_and_time_go_back() {
    let mut session = Session::open(&[("scene.txt", "S 1 0 9 0 0 0 0 0 0 0 1 0.5\n")], "--backend cpu --dt 0.005");
    session.wait("real time", |report| report["real_time"] == true && report["running"] == false);
    session.keys("space");
    session.wait("some steps", |report| report["running"] == true && number(&report["time"]) > 0.3);
    session.keys("space");
    session.wait("a stop", |report| report["running"] == false);
    session.keys("l");
    session.wait("a thrown sphere", |report| report["spheres"] == 2);
    session.keys("ctrl+z");
    session.wait("one sphere", |report| report["spheres"] == 1 && messages(report).contains("undone: throw"));
    let time = number(&session.report()["time"]);
    session.keys("comma comma comma");
    session.wait("an earlier state", |report| number(&report["time"]) < time - 0.1);
    session.keys("j ctrl+z");
    session.wait("the old gravity", |report| messages(report).contains("undone: gravity"));
    assert_eq!(session.quit()["constants"]["gravity"], "1");
}

/// F12 saves a picture, and the button records a film.
#[test]
fn pictures_and_films_are_saved_to_new_files() {
    let mut session = Session::open(&[("scene.txt", BALL), ("scene-1.png", "kept")], "--backend cpu");
    session.keys("F12");
    session.wait("a picture", |report| messages(report).contains("saved as scene-2.png"));
    assert_eq!(fs::read_to_string(session.path("scene-1.png")).expect("a file"), "kept");
    let file = fs::File::open(session.path("scene-2.png")).expect("a picture");
    let reader = png::Decoder::new(BufReader::new(file)).read_info().expect("a good PNG");
    let size = &session.report()["picture"];
    assert_eq!((f64::from(reader.info().width), f64::from(reader.info().height)), (number(&size[0]), number(&size[1])));

    // The bar at the bottom: Record, then the first entry.
    session.display.act("mousemove 1243 784 click 1");
    session.wait("a menu", |report| report["busy"] == true);
    session.display.act("mousemove 1120 734 click 1");
    session.wait("a recording", |report| report["recording"] == true);
    session.keys("a");
    session.wait("some steps", |report| number(&report["steps"]) > 20.0);
    session.keys("Escape");
    session.wait("a film", |report| messages(report).contains("saved as scene-1.gif"));
    let file = fs::File::open(session.path("scene-1.gif")).expect("a film");
    let mut reader = gif::DecodeOptions::new().read_info(file).expect("a good GIF");
    let mut pictures = 0;
    while reader.read_next_frame().expect("a good picture").is_some() {
        pictures += 1;
    }
    assert!(pictures > 10, "{pictures} pictures");
    session.quit();
}

/// What ffprobe finds in the first stream of a finished picture or film: codec, width, height and number of pictures.
fn probed(path: &Path) -> (String, [f64; 2], u32) {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-count_frames", "-select_streams", "v:0", "-of", "json"]);
    command.args(["-show_entries", "stream=codec_name,width,height,nb_read_frames"]).arg(path);
    let output = command.output().expect("this test needs ffprobe: apt-get install ffmpeg, or run scripts/test");
    assert!(output.status.success() && output.stderr.is_empty(), "{}: {output:?}", path.display());
    let found: Value = serde_json::from_slice(&output.stdout).expect("good JSON");
    let stream = &found["streams"][0];
    let pictures = stream["nb_read_frames"].as_str().and_then(|count| count.parse().ok());
    let codec = stream["codec_name"].as_str().expect("a codec").to_owned();
    (codec, [number(&stream["width"]), number(&stream["height"])], pictures.expect("a number of pictures"))
}

/// A picture, a GIF and an MP4 of the window, made with the buttons at the bottom, can be opened by ffprobe.
#[test]
fn recorded_files_can_be_opened() {
    let falling = "S 1 0 2 0 0 0 0 0 0 0 1 0.5\nB -3 -1 -3 6 0 0 0 1 0 0 0 6\n";
    let mut session = Session::open(&[("scene.txt", falling)], "--backend cpu");
    session.wait("a frame", |report| number(&report["run"]["frames"]) >= 1.0);
    let size = [0, 1].map(|axis| number(&session.report()["picture"][axis]));
    session.display.act("mousemove 1166 784 click 1");
    session.wait("a picture", |report| messages(report).contains("saved as scene-1.png"));
    assert_eq!(probed(&session.path("scene-1.png")), ("png".to_owned(), size, 1));
    // The second entry of the menu is above the button, the first one above it.
    let films = [("scene-1.mp4", "h264", 758, 1.0), ("scene-1.gif", "gif", 734, 0.5)];
    for (name, codec, y, scale) in films {
        session.display.act("mousemove 1243 784 click 1");
        session.wait("a menu", |report| report["busy"] == true);
        session.display.act(&format!("mousemove 1120 {y} click 1"));
        session.wait("a recording", |report| report["recording"] == true);
        let before = number(&session.report()["steps"]);
        session.keys("a");
        session.wait("some steps", |report| number(&report["steps"]) > before + 20.0);
        session.keys("a");
        // The button ends the recording that it has started.
        session.display.act("mousemove 1170 784 click 1");
        session.wait("a film", |report| report["recording"] == false && messages(report).contains(&format!("saved as {name}")));
        let (found, [width, height], pictures) = probed(&session.path(name));
        assert_eq!(found, codec);
        // An MP4 has an even width and height.
        assert!((width - scale * size[0]).abs() <= 1.0 && (height - scale * size[1]).abs() <= 1.0, "{width} x {height}");
        assert!(pictures > 10, "{name}: {pictures} pictures");
    }
    session.quit();
}

/// A click on a box or a polygon draws its edges; a click beside all bodies removes them.
#[test]
fn picked_boxes_and_polygons_are_outlined() {
    const MARK: [u8; 3] = [0xd5, 0x5e, 0x00];
    let text =
        "set gravity 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\nB -1.4 -0.2 0 0.4 0 0 0 0.4 0 0 0 0.4\nP 0.8 -0.2 0 0.4 0 0 0 0.4 0\n";
    let mut session = Session::open(&[("scene.txt", text)], "--backend cpu");
    session.hide_panel();
    let [left, right] = [[0, 25, 440, 740], [840, 25, 440, 740]];
    let marked = |session: &Session| {
        let screen = session.display.screen();
        [left, right].map(|part| screen.count(MARK, part))
    };
    assert_eq!(marked(&session), [0, 0]);
    session.point(-370, 4);
    session.display.act("click 1");
    session.wait("a picked box", |report| report["picked"] == "box 0");
    let [of_box, others] = marked(&session);
    assert!(of_box > 600 && others == 0, "{of_box} {others}");
    session.point(350, 64);
    session.display.act("click 1");
    session.wait("a picked polygon", |report| report["picked"] == "polygon 0");
    let [others, of_polygon] = marked(&session);
    assert!(of_polygon > 300 && of_polygon < of_box && others == 0, "{of_polygon} {others}");
    session.point(0, -340);
    session.display.act("click 1");
    session.wait("nothing picked", |report| report["picked"].is_null());
    assert_eq!(marked(&session), [0, 0]);
    session.quit();
}

/// A trajectory plays and pauses, and its first and last frames can be reached.
#[test]
fn a_trajectory_plays_and_pauses() {
    let folder = folder(&[("scene.txt", "set gravity 1\nS 1 0 9 0 0 0 0 0 0 0 1 0.5\n")]);
    let run = "run scene.txt --backend cpu --steps 200 --every 5 --out run.npz";
    let output = command(folder.path()).args(run.split_whitespace()).output().expect("it starts");
    assert!(output.status.success(), "{output:?}");
    let mut session = Session::show(folder, "run.npz", "");
    let height = |report: &Value| number(&report["positions"][0][1]);
    let time = |report: &Value| number(&report["time"]);
    session.wait("the first frame", |report| report["running"] == false && time(report) == 0.0 && height(report) == 9.0);
    session.keys("space");
    session.wait("some frames", |report| report["running"] == true && time(report) > 0.5);
    session.keys("space");
    session.wait("a pause", |report| report["running"] == false);
    // It stays where it is.
    let paused = session.report();
    sleep(Duration::from_secs(2));
    assert_eq!((session.report()["time"].clone(), height(&session.report())), (paused["time"].clone(), height(&paused)));
    let fallen = 0.5 * time(&paused).powi(2);
    assert!(time(&paused) < 4.0 && (height(&paused) - (9.0 - fallen)).abs() < 0.02, "{paused:#}");
    session.keys("space");
    session.wait("the last frame", |report| report["running"] == false && (time(report) - 4.0).abs() < 1e-6);
    assert!((height(&session.report()) - 1.0).abs() < 0.02);
    session.quit();
}

/// A trajectory plays in which spheres come in.
#[test]
fn a_trajectory_with_more_and_more_spheres_plays() {
    let inlet = "@inlet name=feed box=-1,1,-1,1,3,1 rate=10 radius=0.1 velocity=0,-1,0 every=1\n";
    let folder = folder(&[("scene.txt", inlet)]);
    let run = "run scene.txt --backend cpu --steps 100 --every 10 --out run.npz";
    let output = command(folder.path()).args(run.split_whitespace()).output().expect("it starts");
    assert!(output.status.success(), "{output:?}");
    let mut session = Session::show(folder, "run.npz", "");
    session.wait("the first frame", |report| report["running"] == false && report["spheres"] == 0);
    session.keys("space");
    session.wait("the last frame", |report| report["running"] == false && number(&report["spheres"]) > 15.0);
    assert!((number(&session.report()["time"]) - 2.0).abs() < 1e-6);
    session.keys("BackSpace");
    session.wait("the first frame again", |report| report["spheres"] == 0);
    let report = session.quit();
    assert!(!messages(&report).contains("does not have these bodies"), "{report:#}");
}

/// The key A starts the simulation; a drag with Ctrl pulls the ball in the middle.
#[test]
fn a_drag_with_ctrl_pulls_a_body() {
    let mut session = Session::open(&[("scene.txt", BALL)], "--backend cpu");
    session.hide_panel();
    session.keys("a");
    session.point(0, 0);
    session.display.act("keydown ctrl mousedown 1");
    session.wait("a held ball", |report| report["held"] == true);
    for x in [20, 60, 100, 140] {
        session.point(x, 0);
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

/// Left drag orbits, right drag pans, the wheel zooms, and a double click moves the camera to the body.
#[test]
fn the_mouse_moves_the_camera() {
    let mut session = Session::open(&[("scene.txt", BALL)], "--backend cpu");
    session.hide_panel();
    let before = session.report();
    let at = |report: &Value, point: &str, axis: usize| number(&report["camera"][point][axis]);
    session.drag(1, 100, 0);
    session.wait("an orbit", |report| (at(report, "eye", 0) - at(&before, "eye", 0)).abs() > 0.1);
    let orbited = session.report();
    assert!((0..3).all(|axis| (at(&orbited, "target", axis) - at(&before, "target", axis)).abs() < 1e-3), "{orbited:#}");
    session.drag(3, 60, 0);
    session.wait("a pan", |report| (at(report, "target", 0) - at(&before, "target", 0)).abs() > 0.05);
    assert!((camera_distance(&session.report()) - camera_distance(&before)).abs() < 1e-3);
    session.point(-300, 0);
    session.display.act("click 4 click 4");
    // Xvfb may send two events for each click of the wheel.
    session.wait("a zoom", |report| (0.59..0.78).contains(&(camera_distance(report) / camera_distance(&before))));
    session.keys("Home");
    session.wait("the initial camera", |report| report["camera"] == before["camera"]);
    session.display.act("keydown alt");
    session.drag(1, 60, 0);
    session.display.act("keyup alt");
    session.wait("a pan with Alt", |report| (at(report, "target", 0) - at(&before, "target", 0)).abs() > 0.05);
    session.keys("Home");
    session.wait("the initial camera again", |report| report["camera"] == before["camera"]);
    // What a touchpad sends for two fingers that slide while Alt is down. xdotool cannot pinch: see the tests of events in `ui`.
    session.point(0, 0);
    session.display.act("keydown alt click 5 keyup alt");
    session.wait("a slide", |report| (at(report, "target", 1) - at(&before, "target", 1)).abs() > 0.02);
    assert!((camera_distance(&session.report()) - camera_distance(&before)).abs() < 1e-3);
    session.keys("Home");
    session.wait("the initial camera after the slide", |report| report["camera"] == before["camera"]);
    session.keys("Right Right f");
    session.wait("a framed scene", |report| at(report, "target", 0).abs() < 1e-3);
    session.point(10, 0);
    // Where a frame takes longer than the time between two clicks, they are no double click.
    session.act_until("a focused ball", "click --repeat 2 --delay 60 1", |report| {
        report["picked"] == "sphere 1" && camera_distance(report) > camera_distance(&before)
    });
    session.quit();
}

/// The mouse of the thesis: left drag turns the camera, right drag raises it.
#[test]
fn the_mouse_of_the_thesis_can_be_chosen() {
    let mut session = Session::open(&[("scene.txt", BALL)], "--backend cpu --controls thesis");
    session.hide_panel();
    let before = session.report();
    let at = |report: &Value, point: &str, axis: usize| number(&report["camera"][point][axis]);
    assert_eq!(before["controls"], "thesis");
    session.drag(1, 100, 0);
    session.wait("a turn", |report| (at(report, "target", 0) - at(&before, "target", 0)).abs() > 0.1);
    assert_eq!(session.report()["camera"]["eye"], before["camera"]["eye"]);
    session.drag(3, 0, -60);
    session.wait("a raised camera", |report| at(report, "eye", 1) > at(&before, "eye", 1) + 0.05);
    session.quit();
}

/// A bad file is reported in the window and the present scene continues. A click shows what a body is.
#[test]
fn a_bad_file_is_reported_and_the_scene_continues() {
    let mut session = Session::open(&[("scene.txt", BALL), ("input.txt", "S 1 0 0 0\n")], "--backend cpu");
    session.hide_panel();
    session.keys("r");
    session.wait("an error", |report| messages(report).contains("input.txt:1: "));
    session.point(0, 0);
    session.display.act("click 1");
    session.wait("a picked ball", |report| report["picked"] == "sphere 1" && report["track"] == 1);
    session.keys("a");
    session.wait("steps after the error", |report| number(&report["steps"]) > 3.0 && number(&report["track"]) > 2.0);
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

#[test]
fn bodies_to_plot_are_picked_from_the_start() {
    let scene = "@name left\nS 1 0 2 0 0 0 0 0 0 0 1 0.5\n@name right\nS 2 3 2 0 0 0 0 0 0 0 1 0.5\n";
    let mut session = Session::open(&[("scene.txt", scene)], "--backend cpu --plot height:right,left --plot energy");
    session.wait("the picked body", |report| report["picked"] == "right");
    session.quit();
    let rockfall = Rockfall::with(scene);
    for (plot, expected) in [
        ("height:lefft", "--plot lefft: no object has the name 'lefft': did you mean 'left'?"),
        ("contacts", "the window does not plot contacts, expected energy, height, speed, gauge or joint"),
        ("height", "expected names or numbers of bodies, as in height:left,right or height:3"),
    ] {
        let (_, err) = rockfall.run(&format!("view scene.txt --backend cpu --plot {plot}"), 2);
        assert!(err.contains(expected), "{plot}: {err}");
    }
}
