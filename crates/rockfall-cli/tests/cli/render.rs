//! Tests of `rockfall render` with the binary: pictures, films and arguments that are refused.
#![cfg(feature = "view")]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::PathBuf;
use std::process::{Command, Output};

use tempfile::TempDir;

mod plots;

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

    /// Runs any command, checks its exit code and returns standard error.
    #[track_caller]
    fn rockfall(&self, arguments: &str, code: i32) -> String {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rockfall"));
        command.current_dir(self.0.path()).args(arguments.split_whitespace()).env("XDG_RUNTIME_DIR", self.0.path());
        finish(&command.output().unwrap(), arguments, code)
    }

    /// Pictures of a film, drawn into the folder `film`.
    fn film(&self, input: &str, arguments: &str) -> Vec<Vec<u8>> {
        self.rockfall(&format!("render {input} --out film/ --size 96x64 {arguments}"), 0);
        let count = fs::read_dir(self.path("film")).unwrap().count();
        (0..count).map(|number| self.picture(&format!("film/{number:04}.png")).0).collect()
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
        let err = folder.render(&format!("--out a.png --size 96x64 {more}"), 0);
        let camera = if more.contains("--camera") { "" } else { "camera: " };
        assert!(err.starts_with(&format!("wrote a.png: 96x64 pixels\n{camera}")) && err.lines().count() < 3, "{err}");
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
    folder.render(&format!("--out last.png --at 0.2s {camera}"), 0);
    assert_eq!(folder.picture("all/0006.png"), folder.picture("last.png"), "10 steps of 0.02 s");
    folder.render(&format!("--out next.png --at 9 {camera}"), 0);
    assert_ne!(folder.picture("all/0006.png"), folder.picture("next.png"));
}

/// A film needs no second run: that of a trajectory has the pictures of a film of the scene.
#[test]
fn films_of_trajectories_show_the_recorded_states() {
    let folder = Folder::new();
    let camera = "--camera 3,3,6 --look-at 0,1,0";
    let live = folder.film("scene.txt", &format!("--backend cpu --steps 20 --fps 10 {camera}"));
    assert_eq!(live.len(), 5);
    for out in ["run.npz", "run.pvd"] {
        folder.rockfall(&format!("run scene.txt --backend cpu --steps 20 --every 5 --out {out}"), 0);
        // Without --steps, to its end.
        assert_eq!(folder.film(out, &format!("--fps 10 {camera}")), live, "{out}");
        assert_eq!(folder.film(out, &format!("--fps 10 --at 10 --steps 5 {camera}")), live[2..4], "{out}");
        for at in ["15", "0.3s"] {
            folder.rockfall(&format!("render {out} --at {at} --out a.png --size 96x64 {camera}"), 0);
            assert_eq!(folder.picture("a.png").0, live[3], "{out} {at}");
        }
    }
    // Between two frames, bodies are between their places in the frames.
    let between = folder.film("run.npz", &format!("--fps 20 {camera}"));
    assert_eq!((between.len(), &between[2]), (9, &live[1]));
    assert!(between[1] != between[0] && between[1] != between[2]);
    for (arguments, message) in [
        ("run.npz --dt 0.1 --out x.gif", "--dt: run.npz is a trajectory"),
        ("run.npz --set gravity=1 --out x.gif", "--set: run.npz is a trajectory"),
        ("run.npz --at 21 --out x.png", "run.npz has the steps 0 to 20"),
        ("run.npz --at 9s --out x.png", "--at 9s: run.npz has the times 0 to 0.4 s"),
        ("run.npz --at=-1s --out x.png", "expected a whole number of steps, or a time in s as in 0.5s"),
        ("run.npz --at 5 --steps 16 --out x.gif", "run.npz has the steps 0 to 20"),
    ] {
        let err = folder.rockfall(&format!("render {arguments}"), 2);
        assert!(err.contains(message), "{arguments}: {err}");
    }
}

#[test]
fn checkpoints_go_on_with_their_time_step() {
    let folder = Folder::new();
    let camera = "--size 96x64 --camera 3,3,6 --look-at 0,1,0";
    folder.rockfall("run scene.txt --backend cpu --dt 0.01 --substeps 2 --steps 20 --checkpoint run.ckpt", 0);
    folder.rockfall("run scene.txt --backend cpu --dt 0.01 --substeps 2 --steps 40 --checkpoint later.ckpt", 0);
    for (input, more, out) in
        [("run.ckpt", "", "a"), ("run.ckpt", "--at 20", "b"), ("later.ckpt", "", "c"), ("run.ckpt", "--at 20 --dt 0.02", "d")]
    {
        folder.rockfall(&format!("render {input} --out {out}.png {camera} {more}"), 0);
    }
    let [a, b, c, d] = ["a.png", "b.png", "c.png", "d.png"].map(|name| folder.picture(name).0);
    assert!(a != b && b == c && c != d);
}

#[test]
fn damaged_and_unsuitable_files_are_refused_by_name() {
    let folder = Folder::new();
    folder.rockfall("run scene.txt --backend cpu --steps 4 --every 2 --out run.npz --checkpoint run.ckpt", 0);
    folder.rockfall("run scene.txt --backend cpu --steps 4 --out state.csv", 0);
    folder.rockfall("run scene.txt --backend cpu --steps 4 --every 2 --out run.csv", 0);
    folder.rockfall("run scene.txt --backend cpu --steps 4 --out state.vtp", 0);
    for name in ["run.npz", "run.ckpt"] {
        let bytes = fs::read(folder.path(name)).unwrap();
        fs::write(folder.path(&format!("cut-{name}")), &bytes[..bytes.len() / 2]).unwrap();
    }
    fs::write(folder.path("empty.npz"), "").unwrap();
    for (input, message) in [
        ("cut-run.npz", "not a usable trajectory"),
        ("cut-run.ckpt", "not a usable checkpoint"),
        ("empty.npz", "not a usable trajectory"),
        ("state.csv", "a state in CSV cannot be shown"),
        ("run.csv", "a trajectory in CSV cannot be shown"),
        ("state.vtp", "a single .vtp file cannot be shown"),
    ] {
        let commands: &[&str] =
            if cfg!(feature = "window") { &["render --out a.png", "view"] } else { &["render --out a.png"] };
        for command in commands {
            let err = folder.rockfall(&format!("{command} {input}"), 2);
            assert!(err.contains(message) && err.contains(input), "{command} {input}: {err}");
        }
    }
    assert!(!folder.path("a.png").exists());
}

/// Mean brightness of the pixels of a column of a picture.
fn columns([width, height]: [usize; 2], pixels: &[u8]) -> Vec<f32> {
    let sum = |x: usize| (0..height).map(|y| f32::from(pixels[3 * (y * width + x)])).sum::<f32>();
    (0..width).map(|x| sum(x) / height as f32).collect()
}

/// The ball rolls far to the right during the film. A camera that framed the first state would lose it.
#[test]
fn the_camera_frames_what_happens_in_the_whole_film() {
    let folder = Folder::new();
    let scene = "set gravity 0\nS 1 0 0 0 12 0 0 0 0 0 1 0.5 0\nS 2 0 2 0 0 0 0 0 0 0 1 0.5 0\n";
    fs::write(folder.path("scene.txt"), scene).unwrap();
    let style = "--plain --background white --backend cpu --fps 5 --colour spheres=black --at 0";
    let places = |film: &[Vec<u8>]| -> Vec<Option<usize>> {
        let darkest = |picture: &Vec<u8>| {
            let columns = columns([96, 64], picture);
            (0..96).filter(|x| columns[*x] < 250.0).max()
        };
        film.iter().map(darkest).collect()
    };
    let film = folder.film("scene.txt", &format!("--steps 50 {style}"));
    let places = places(&film);
    assert!(places.windows(2).all(|pair| pair[0] <= pair[1]), "{places:?}");
    assert!(places[0] < Some(40) && places[5] > Some(60), "{places:?}");
    // With --follow, the ball stays where it is, and the other one leaves.
    let followed = folder.film("scene.txt", &format!("--steps 50 --follow 1 {style}"));
    assert_ne!(followed[0], followed[5]);
    assert_ne!(film[0], followed[0]);
    // An orbit shows the scene from other sides.
    let turned = folder.film("scene.txt", &format!("--steps 50 --orbit 90 {style} --camera 20,3,0 --look-at 0,0,0"));
    let still = folder.film("scene.txt", &format!("--steps 50 {style} --camera 20,3,0 --look-at 0,0,0"));
    assert!(turned[0] == still[0] && turned[5] != still[5]);
}

/// The ball of a pendulum is as far from its pivot as 50 times the radius of the pivot.
#[test]
fn the_ball_of_a_pendulum_is_in_view_whatever_its_radius() {
    let folder = Folder::new();
    let style =
        "--backend cpu --plain --background white --colour spheres=black --colour rods=white --colour fixed-spheres=white";
    for [pivot, ball] in [[0.02, 0.05], [0.02, 0.1], [0.04, 0.2], [0.05, 0.05]] {
        let ends = [format!("S 1 0 2 0 0 0 0 0 0 0 1 {pivot} 1"), format!("S 2 0.0871557 1.0038053 0 0 0 0 0 0 0 1 {ball} 0")];
        fs::write(folder.path("scene.txt"), format!("set gravity 9.81\n{}\n{}\nR 1 2 0.01 1\n", ends[0], ends[1])).unwrap();
        folder.rockfall(&format!("render scene.txt --out a.png --size 192x128 {style}"), 0);
        let mut pictures = vec![folder.picture("a.png").0];
        folder.rockfall(&format!("render scene.txt --out film/ --size 192x128 --steps 40 --fps 5 {style}"), 0);
        pictures.extend((0..5).map(|number| folder.picture(&format!("film/{number:04}.png")).0));
        for (number, picture) in pictures.iter().enumerate() {
            let black = (0..picture.len() / 3).filter(|at| picture[3 * at] < 100).count();
            assert!(black > 3, "{pivot} {ball}, picture {number}: the ball is out of view");
        }
    }
}

#[test]
fn the_camera_that_was_chosen_is_printed_as_options() {
    let folder = Folder::new();
    let near = |a: &[u8], b: &[u8]| a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>() < a.len() as u64 / 4;
    for more in ["", "--follow 1", "--look-at 0,1,0", "--at 30"] {
        let err = folder.render(&format!("--out a.png --size 96x64 {more}"), 0);
        let options = err.lines().find_map(|line| line.strip_prefix("camera: ")).unwrap().to_owned();
        let at = if more.starts_with("--at") { more } else { "" };
        let again = folder.render(&format!("--out b.png --size 96x64 {options} {at}"), 0);
        assert!(again.starts_with("wrote b.png: 96x64 pixels\n") && !again.contains("camera: "), "{again}");
        assert!(near(&folder.picture("a.png").0, &folder.picture("b.png").0), "{more}: {options}");
    }
    let err = folder.render("--out a.gif --steps 10 --size 64x48", 0);
    assert!(err.starts_with("wrote a.gif: 6 pictures, 0.2 s at 25 per second\ncamera: --camera "), "{err}");
    let err = folder.render("--out film/ --steps 10 --size 64x48 --camera 1,2,3 --look-at 0,0,0", 0);
    assert_eq!(err, "wrote film/: 6 pictures, 0.2 s at 25 per second\n");
}

/// Two balls that a stiff spring connects.
const STIFF: &str = "set gravity 0\nS 1 0 0 0 1 0 0 0 0 0 1 0.1\nS 2 1 0 0 0 0 0 0 0 0 1 0.1\nK 1 2 40000 0.9 0\n";

#[test]
fn pictures_and_films_have_the_warnings_of_a_run() {
    let folder = Folder::new();
    fs::write(folder.path("scene.txt"), STIFF).unwrap();
    let warnings =
        |err: String| -> Vec<String> { err.lines().filter(|line| line.starts_with("warning: ")).map(str::to_owned).collect() };
    let run = warnings(folder.rockfall("run scene.txt --backend cpu --steps 5 --checkpoint a.ckpt", 0));
    assert!(run.iter().any(|line| line.contains("too stiff")) && run.iter().any(|line| line.contains("grew")), "{run:?}");
    assert_eq!(warnings(folder.render("--out a.png --size 32x24 --at 5", 0)), run);
    assert_eq!(warnings(folder.render("--out a.gif --size 32x24 --steps 5 --fps 50", 0)), run);
    let before = warnings(folder.render("--out a.png --size 32x24", 0));
    assert_eq!(before, run[..before.len()]);
    assert!(!before.is_empty());
    let err = folder.rockfall("render a.ckpt --out a.png --size 32x24", 0);
    assert!(err.starts_with("warning: a.ckpt: ") && !err.contains("grew"), "{err}");

    // With the number of parts that `check` recommends, there is nothing to warn of, and the picture is that of `run`.
    let camera = "--size 32x24 --camera 0,0,4 --look-at 0.5,0,0";
    let err = folder.render(&format!("--out a.png --at 5 --substeps auto {camera}"), 0);
    assert_eq!(err, "wrote a.png: 32x24 pixels\n");
    folder.rockfall("run scene.txt --backend cpu --steps 5 --substeps auto --checkpoint b.ckpt", 0);
    folder.rockfall(&format!("render b.ckpt --out b.png {camera}"), 0);
    assert_eq!(folder.picture("a.png"), folder.picture("b.png"));
    let err = folder.rockfall(&format!("render b.ckpt --out b.png --at 5 --substeps 1 {camera}"), 0);
    assert!(err.contains("too stiff"), "{err}");
    for (arguments, message) in [("--substeps 0", "expected a whole number from 1"), ("--substeps many", "or auto")] {
        let err = folder.render(&format!("--out c.png {arguments}"), 2);
        assert!(err.contains(message), "{err}");
    }
    folder.rockfall("run scene.txt --backend cpu --steps 5 --every 1 --substeps auto --out a.npz", 0);
    let err = folder.rockfall("render a.npz --out c.png --substeps 2", 2);
    assert!(err.contains("--substeps: a.npz is a trajectory"), "{err}");
    fs::write(folder.path("scene.txt"), "B 0 0 0 1 0 0 0 1 0 0 0 1\n").unwrap();
    assert!(folder.render("--out a.png --size 32x24", 0).starts_with("warning: scene.txt: no spheres, so nothing will move\n"));
}

#[test]
fn options_of_the_style_change_the_picture_and_jpeg_is_written() {
    let folder = Folder::new();
    folder.render("--out a.png --size 96x64", 0);
    let mut pictures = vec![folder.picture("a.png").0];
    for more in [
        "--background black",
        "--background white,navy",
        "--light 1,0.5,0",
        "--colour 1=red",
        "--colour 1-2=00ff00",
        "--colour fixed-spheres=yellow",
        "--colour-by body",
        "--colour-by contact-force",
        "--colour-by tension",
        "--view front",
        "--view side",
        "--view top",
        "--view iso",
        "--up z",
        "--title Fall",
        "--clock",
        "--scale-bar",
        "--label",
        "--at 9 --arrows velocity",
        "--at 9 --arrows force",
        "--at 9 --trails 1",
    ] {
        folder.render(&format!("--out a.PNG --size 96x64 {more}"), 0);
        let picture = folder.picture("a.PNG").0;
        assert!(!pictures.contains(&picture), "{more} changes nothing");
        pictures.push(picture);
    }
    for name in ["a.jpg", "a.JPEG"] {
        folder.render(&format!("--out {name} --size 96x64"), 0);
        let bytes = fs::read(folder.path(name)).unwrap();
        assert!(bytes.starts_with(b"\xff\xd8\xff") && bytes.ends_with(b"\xff\xd9") && bytes.len() > 1000, "{name}");
    }
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
        let arguments = "--out a.mp4 --steps 10 --size 65x47";
        finish(&folder.command(arguments).env("PATH", path).output().unwrap(), arguments, code)
    };
    // A stand-in for ffmpeg that writes the number of bytes of its input to the file in its last argument.
    program("for last; do :; done; [ \"$last\" = -version ] || { echo \"$@\" > arguments; wc -c > \"$last\"; }");
    finish(
        &folder
            .command("--out a.WebM --steps 10 --size 65x48")
            .env("PATH", format!("{}:/usr/bin:/bin", folder.path("bin").display()))
            .output()
            .unwrap(),
        "",
        0,
    );
    let arguments = fs::read_to_string(folder.path("arguments")).unwrap();
    assert!(arguments.contains("-c:v libvpx-vp9") && arguments.contains("-f webm"), "{arguments}");
    fs::remove_file(folder.path("a.WebM")).unwrap();
    let err = run(0);
    assert!(err.contains("--size 65x47: this format needs even sides, so the film has 66x48"), "{err}");
    fs::remove_file(folder.path("arguments")).unwrap();
    // The codecs need even sides.
    assert_eq!(fs::read_to_string(folder.path("a.mp4")).unwrap().trim(), (6 * 66 * 48 * 3).to_string());
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
        ("--out a.bmp", ".png, .jpg or .jpeg, .gif, .apng, .mp4 or .webm"),
        ("--out a", ".png, .jpg or .jpeg, .gif, .apng, .mp4 or .webm"),
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
        ("--out a.png --colour-by taste", "kind speed contacts overlap force body contact-force tension"),
        ("--out a.png --range 0,1", "--colour-by"),
        ("--out a.jpg --orbit 20", "film"),
        ("--out a.png --follow 3", "no sphere 3"),
        ("--out a.png --follow 1 --look-at 1,2,3", "cannot be used with"),
        ("--out a.gif --steps 5 --orbit fast", "number of degrees"),
        ("--out a.png --colour 9=red", "no sphere 9"),
        ("--out a.png --colour 1=reddish", "six hexadecimal digits"),
        ("--out a.png --colour walls=red", "boxes polygons"),
        ("--out a.png --background ff88", "six hexadecimal digits"),
        ("--out a.png --light 0,0,0", "not all 0"),
        ("--out a.png --view below", "front, side, top, iso"),
        ("--out a.png --up x", "expected one of: y, z, auto"),
        ("--out a.png --view top --camera 1,2,3", "cannot be used with"),
        ("--out a.gif --steps 5 --view top --orbit 9", "around the vertical"),
        ("--out a.png --arrows spin", "velocity, force"),
        ("--out a.png --trails 0", "greater than 0"),
        ("--out a.png --trails 1:left", "--trails left: no object has the name 'left'"),
        ("--out a.png --trails 1:7", "no sphere 7"),
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
