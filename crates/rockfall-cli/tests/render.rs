//! Tests of `rockfall render` with the binary: pictures, films and arguments that are refused.
#![cfg(feature = "view")]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::PathBuf;
use std::process::{Command, Output};

use tempfile::TempDir;

/// A ball that falls next to a fixed one.
const SCENE: &str = "S 1 0 2 0 0 0 0 0 0 0 1 0.5 0\nS 2 1.5 0.5 0 0 0 0 0 0 0 1 0.5 1\n";

/// A temporary folder with `scene.txt`, in which commands run.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.txt"), SCENE).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Names of all files except the scene.
    fn names(&self) -> Vec<String> {
        let names = fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| name != "scene.txt").collect();
        names.sort();
        names
    }

    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rockfall"));
        command.current_dir(self.0.path()).args(["render", "scene.txt", "--backend", "cpu"]);
        command.args(arguments.split_whitespace()).env("XDG_RUNTIME_DIR", self.0.path());
        command
    }

    /// Runs a command, checks its exit code and returns standard error.
    #[track_caller]
    fn render(&self, arguments: &str, code: i32) -> String {
        finish(&self.command(arguments).output().unwrap(), arguments, code)
    }

    /// Pixels and size of a PNG file.
    fn picture(&self, name: &str) -> (Vec<u8>, [u32; 2]) {
        let mut reader = png::Decoder::new(BufReader::new(File::open(self.path(name)).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        (bytes, [info.width, info.height])
    }
}

#[track_caller]
fn finish(output: &Output, arguments: &str, code: i32) -> String {
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments}\n{err}");
    assert!(!err.contains("panicked"), "{arguments}\n{err}");
    err
}

#[test]
fn pictures_depend_on_step_camera_and_colours() {
    let folder = Folder::new();
    let arguments = [
        "",
        "--at 20",
        "--camera 6,2,-4",
        "--look-at 0,3,0",
        "--colour-by speed",
        "--colour-by speed --range 0,9 --at 20",
        "--plain",
    ];
    let mut pictures = Vec::new();
    for more in arguments {
        assert_eq!(folder.render(&format!("--out a.png --size 96x64 {more}"), 0), "");
        let (pixels, size) = folder.picture("a.png");
        assert_eq!(size, [96, 64]);
        assert!(!pictures.contains(&pixels), "{more} changes nothing");
        pictures.push(pixels);
    }
    assert_eq!(folder.names(), ["a.png"]);
}

#[test]
fn films_have_the_number_of_pictures_for_their_duration() {
    let folder = Folder::new();
    // 0.2 s at 25 pictures per second are 6 with the first one, or 11 at half speed. The shorter film leaves none of the longer
    // one in the folder.
    for (more, pictures) in [("--speed 0.5", 11), ("", 6)] {
        let film = format!("--steps 10 --size 64x48 {more}");
        folder.render(&format!("--out a.gif {film}"), 0);
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(File::open(folder.path("a.gif")).unwrap()).unwrap();
        assert_eq!([decoder.width(), decoder.height()], [64, 48]);
        let mut delays = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            delays.push(frame.delay);
        }
        assert_eq!(delays, vec![4; pictures]);

        folder.render(&format!("--out a.apng {film}"), 0);
        let reader = png::Decoder::new(BufReader::new(File::open(folder.path("a.apng")).unwrap())).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames as usize, pictures);

        folder.render(&format!("--out all/ {film}"), 0);
        assert_eq!(fs::read_dir(folder.path("all")).unwrap().count(), pictures);
        let last = format!("all/{:04}.png", pictures - 1);
        assert_ne!(folder.picture("all/0000.png"), folder.picture(&last));
    }
}

#[test]
fn the_last_picture_of_a_film_shows_the_last_step() {
    let folder = Folder::new();
    let camera = "--size 64x48 --camera 3,3,6 --look-at 0,1,0";
    // Three pictures for every five steps: some are interpolated between two states.
    folder.render(&format!("--out all/ --steps 10 --fps 30 {camera}"), 0);
    folder.render(&format!("--out last.png --at 10 {camera}"), 0);
    assert_eq!(folder.picture("all/0006.png"), folder.picture("last.png"));
    folder.render(&format!("--out next.png --at 9 {camera}"), 0);
    assert_ne!(folder.picture("all/0006.png"), folder.picture("next.png"));
}

#[test]
#[cfg(unix)]
fn mp4_needs_ffmpeg_and_reports_when_it_is_missing_or_fails() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new();
    let program = |body: &str| {
        fs::create_dir_all(folder.path("bin")).unwrap();
        fs::write(folder.path("bin/ffmpeg"), format!("#!/bin/sh\n{body}\n")).unwrap();
        fs::set_permissions(folder.path("bin/ffmpeg"), fs::Permissions::from_mode(0o755)).unwrap();
    };
    let run = |code| {
        let path = format!("{}:/usr/bin:/bin", folder.path("bin").display());
        let arguments = "--out a.mp4 --steps 10 --size 65x48";
        finish(&folder.command(arguments).env("PATH", path).output().unwrap(), arguments, code)
    };
    // A stand-in for ffmpeg that writes the number of bytes of its input to the file in its last argument.
    program("for last; do :; done; [ \"$last\" = -version ] || wc -c > \"$last\"");
    run(0);
    assert_eq!(fs::read_to_string(folder.path("a.mp4")).unwrap().trim(), (6 * 65 * 48 * 3).to_string());
    // An existing file is kept when the next film fails.
    program("for last; do :; done; [ \"$last\" = -version ] && exit 0; cat > /dev/null; echo no such codec >&2; exit 3");
    let err = run(1);
    assert!(err.contains("a.mp4") && err.contains("no such codec"), "{err}");
    assert_eq!(folder.names(), ["a.mp4", "bin"]);
    assert!(fs::metadata(folder.path("a.mp4")).unwrap().len() < 20);

    fs::remove_file(folder.path("a.mp4")).unwrap();
    let arguments = "--out a.mp4 --steps 10 --size 64x48";
    let output = folder.command(arguments).env("PATH", folder.path("nothing")).output().unwrap();
    let err = finish(&output, arguments, 1);
    assert!(err.contains("ffmpeg") && err.contains("not installed") && err.contains(".gif"), "{err}");
    assert_eq!(folder.names(), ["bin"]);
}

#[test]
fn wrong_arguments_are_refused_and_leave_no_files() {
    let folder = Folder::new();
    for (arguments, message) in [
        ("--out a.bmp", ".png, .gif, .apng or .mp4"),
        ("--out a", ".png, .gif, .apng or .mp4"),
        ("--out a.png --steps 5", "--at"),
        ("--out a.gif", "--steps"),
        ("--out a.gif --steps 5 --fps 60", "50 pictures"),
        ("--out a.gif --steps 0", "--steps"),
        ("--out a.gif --steps 5 --fps 0", "--fps"),
        ("--out a.gif --steps 5 --speed -1", "greater than 0"),
        ("--out a.png --size 0x4", "as in 1280x720"),
        ("--out a.png --size 4", "as in 1280x720"),
        ("--out a.png --size 99999x4", "99999x4"),
        ("--out a.png --camera 1,2", "three finite numbers"),
        ("--out a.png --look-at 1,2,nan", "three finite numbers"),
        ("--out a.png --camera 1,2,3 --look-at 1,2,3", "the same point"),
        ("--out a.png --colour-by taste", "kind speed contacts overlap force"),
        ("--out a.png --range 0,1", "--colour-by"),
        ("--out a.png --colour-by speed --range 2,1", "the first less than the second"),
    ] {
        let err = folder.render(arguments, 2);
        assert!(err.contains(message), "{arguments}: {err}");
        assert!(folder.names().is_empty(), "{arguments}: {:?}", folder.names());
    }
    let err = folder.render("--out no/a.png", 1);
    assert!(err.contains("no/a.png"), "{err}");
}

#[test]
#[cfg(not(target_os = "macos"))]
fn without_an_adapter_the_message_names_what_is_missing() {
    let folder = Folder::new();
    // Metal is not available on this system.
    let output = folder.command("--out a.png").env("WGPU_BACKEND", "metal").output().unwrap();
    let err = finish(&output, "", 1);
    assert!(err.contains("drawing needs a graphics adapter") && err.contains("mesa-vulkan-drivers"), "{err}");
    assert!(folder.names().is_empty());
}
