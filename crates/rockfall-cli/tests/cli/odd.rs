//! Unusual uses of the binary: unusual files as scenes, unusual output paths, no graphics driver.
//!
//! Every case ends with one of the exit codes 0, 1 and 2 and a readable message. The common errors are tested in commands.rs, by
//! `errors_in_scenes...` and `wrong_arguments...`.

use std::ffi::OsStr;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

/// One ball above a box.
const SCENE: &str = "S 1 0 1 0 0 0 0 0 0 0 1 0.5\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\n";

fn command(folder: &Path, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rockfall"));
    command.current_dir(folder).args(arguments).env("XDG_RUNTIME_DIR", folder).stdin(Stdio::null());
    command
}

/// Runs a command and returns its exit code, standard output and standard error.
fn run(mut command: Command) -> (i32, String, String) {
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    let (out, err) = (text(output.stdout), text(output.stderr));
    assert!(!err.contains("panicked"), "{err}");
    (output.status.code().expect("it is not ended by a signal"), out, err)
}

/// Creates a folder with unusual files.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("scene.txt", SCENE.as_bytes());
    write("empty.txt", b"");
    write("prose.txt", "Balls, some of them in the air, and not one line that says so.\n".repeat(50).as_bytes());
    write("binary.txt", &fs::read(env!("CARGO_BIN_EXE_rockfall")).unwrap()[..5000]);
    write("noise.txt", &(0..5000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8 | 1).collect::<Vec<u8>>());
    write("static.txt", b"B -5 -1 -5 10 0 0 0 1 0 0 0 10\nP 0 0 0 0 0 1 1 0 0\n");
    write("fixed.txt", b"S 1 0 1 0 0 0 0 0 0 0 1 0.5 1\n");
    write("one.txt", b"S 1 0 1 0 0 0 0 0 0 0 1 0.5\n");
    write("escape.txt", b"S 1 0\x1b[2J 0\n");
    fs::create_dir(folder.path().join("folder")).unwrap();
    folder
}

#[test]
fn unusual_files_and_arguments() {
    let folder = folder();
    let cases = [
        ("run empty.txt --steps 3", 0, "warning: empty.txt: no spheres, so nothing will move"),
        ("run prose.txt --steps 3", 0, "warning: prose.txt: no spheres"),
        ("run static.txt --steps 3", 0, "warning: static.txt: no spheres"),
        ("run noise.txt --steps 3", 0, "warning: noise.txt: no spheres"),
        ("run binary.txt", 2, "binary.txt:1: text: a NUL byte"),
        ("run escape.txt", 2, "escape.txt:1: S x: '0\\u{1b}[2J' is not a number"),
        ("run folder", 2, "folder: "),
        ("run fixed.txt --steps 3", 0, ""),
        ("run one.txt --steps 3", 0, ""),
        ("run scene.txt --steps 0", 0, ""),
        ("run scene.txt --steps 5 --steps 6", 2, "cannot be used multiple times"),
        ("run scene.txt --steps 18446744073709551616", 2, "18446744073709551616"),
        ("run scene.txt --json --json", 2, "cannot be used multiple times"),
        ("run scene.txt --out= --steps 1", 2, "a value is required"),
        ("run scene.txt --out scene.txt", 2, "--out scene.txt: unknown extension .txt"),
        ("run scene.txt --save scene.txt", 2, "scene.txt: this output would overwrite the scene file"),
        ("run scene.txt --save folder/../scene.txt", 2, "scene.txt: this output would overwrite the scene file"),
        ("run scene.txt --steps 1 --out folder", 2, "--out folder: a name without an extension, expected a name that ends"),
        ("run scene.txt --steps 1 --out ..", 2, "--out ..: a name without an extension"),
        ("run scene.txt --steps 1 --out scene.txt/state.csv", 1, "cannot be written"),
        ("run scene.txt --steps 2 --dt 1e38", 1, "stopped being finite"),
        ("run scene.txt --steps 2 --dt 1e-38", 0, ""),
        ("check --dt 0.01 scene.txt scene.txt", 2, "unexpected argument"),
        ("--backend cpu run scene.txt", 2, "'run --backend' exists"),
    ];
    for (arguments, code, message) in cases {
        let cpu = if arguments.starts_with("run") { " --backend cpu" } else { "" };
        let line = format!("{arguments}{cpu}");
        let (found, _, err) = run(command(folder.path(), line.split(' ')));
        assert!(found == code && err.contains(message), "{line}: {found}\n{err}");
        assert!(!message.is_empty() || err.is_empty(), "{line}: {err}");
        assert!(!err.contains('\u{1b}'), "{line}: {err:?}");
    }
    assert_eq!(fs::read_to_string(folder.path().join("scene.txt")).unwrap(), SCENE);
}

/// An output that is a link to the scene is refused. A device as scene and output is allowed.
#[cfg(unix)]
#[test]
fn links_devices_and_names_that_are_not_utf8() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = folder();
    std::os::unix::fs::symlink("scene.txt", folder.path().join("link.csv")).unwrap();
    let steps = ["--backend", "cpu", "--steps", "1"];
    let (code, _, err) = run(command(folder.path(), ["run", "scene.txt", "--out", "link.csv"].iter().chain(&steps)));
    assert!(code == 2 && err.contains("overwrite the scene file"), "{err}");
    let (code, _, err) = run(command(folder.path(), ["run", "/dev/null", "--out", "/dev/null"].iter().chain(&steps)));
    assert_eq!(code, 0, "{err}");

    let odd = OsStr::from_bytes(b"\xff\xfe.txt");
    fs::write(folder.path().join(odd), SCENE).unwrap();
    let (code, _, err) = run(command(folder.path(), [OsStr::new("run"), odd].into_iter().chain(steps.map(OsStr::new))));
    assert_eq!((code, err.as_str()), (0, ""));
    let missing = OsStr::from_bytes(b"\xff.txt");
    let (code, _, err) = run(command(folder.path(), [OsStr::new("check"), missing]));
    assert!(code == 2 && err.contains("No such file"), "{err}");
}

/// As with `| head -1`: the reader closes the pipe after the first line.
#[test]
fn a_reader_that_closes_the_pipe_is_not_an_error() {
    let folder = folder();
    let mut child = command(folder.path(), ["generate", "pile", "--spheres", "50000"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut first).unwrap();
    assert!(first.starts_with("# rockfall generate pile"), "{first}");
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(0), ""));
}

/// Hides the Vulkan drivers, as on a machine without one.
#[cfg(all(feature = "gpu", target_os = "linux"))]
#[test]
fn without_a_driver_the_message_suggests_a_remedy() {
    let folder = folder();
    let bare = |backend: &str| {
        let mut command = command(folder.path(), ["run", "scene.txt", "--steps", "1", "--backend", backend]);
        command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent").env("WGPU_BACKEND", "vulkan");
        run(command)
    };
    let (code, out, err) = bare("gpu");
    assert_eq!((code, out.as_str()), (1, ""));
    for word in ["no usable GPU", "no adapter was found", "install a graphics driver", "--backend cpu"] {
        assert!(err.contains(word), "{err}");
    }
    let (code, out, err) = bare("auto");
    assert!(code == 0 && out.contains("cpu: CPU"), "{out}{err}");
}

/// Mesa can disable the compute shaders of its OpenGL driver, which the kernels need.
#[cfg(all(feature = "gpu", target_os = "linux"))]
#[test]
fn a_driver_without_compute_shaders_is_named_with_the_reason() {
    let folder = folder();
    let on_gl = |arguments: &[&str]| {
        let mut command = command(folder.path(), arguments);
        command.env("WGPU_BACKEND", "gl").env("MESA_EXTENSION_OVERRIDE", "-GL_ARB_compute_shader");
        run(command)
    };
    let (_, devices, _) = on_gl(&["devices"]);
    if !devices.contains("Mesa") {
        println!("NOT TESTED: Mesa's OpenGL driver is not installed\n{devices}");
        return;
    }
    let (code, out, err) = on_gl(&["run", "scene.txt", "--steps", "1", "--backend", "gpu"]);
    assert_eq!((code, out.as_str()), (1, ""));
    for word in ["no usable GPU", "(gl): it has no compute shaders", "install a graphics driver", "--backend cpu"] {
        assert!(err.contains(word), "{err}");
    }
}

/// Messages quote the input without what a terminal obeys, and are short.
#[test]
fn messages_hold_no_control_characters_and_are_short() {
    let ball = "S 1 0 0 0 0 0 0 0 0 0 - 1\n";
    for word in ["\u{1b}]0;title\u{7}\u{1b}[2J\u{7f}\u{9b}".to_owned(), "x".repeat(100_000)] {
        for scene in [
            format!("@body x density=3\n@c{word} x\n{ball}@end\n"),
            format!("#\n@{word}\n"),
            format!("set gravity {word}\n"),
            format!("#\nset {word} 1\n"),
            format!("S {word} 0 0\n"),
            format!("@servo {word} force=0,1,0 speed=1\n@servo {word} force=0,1,0 speed=1\n"),
            format!("@material {word} density=-1\n"),
            format!("@use {word}\n"),
        ] {
            let folder = folder();
            fs::write(folder.path().join("word.txt"), &scene).unwrap();
            let (code, out, err) = run(command(folder.path(), ["run", "word.txt"]));
            let scene: String = scene.chars().take(100).collect();
            assert_eq!((code, out.as_str()), (2, ""), "{scene:?} {err:?}");
            assert!(!err.contains(|letter: char| letter.is_control() && letter != '\n'), "{err:?}");
            assert!(err.len() < 1000, "{scene:?}: a message of {} bytes", err.len());
        }
    }
    // Names that are accepted are printed too.
    let folder = folder();
    fs::write(folder.path().join("\u{1b}[2J.txt"), "S 1 0 0 0 0 0 0 0 0 0 1 1\nx\n").unwrap();
    let (code, out, _) = run(command(folder.path(), ["check", "\u{1b}[2J.txt"]));
    assert!(code == 0 && out.contains("\\u{1b}[2J.txt: ") && !out.contains('\u{1b}'), "{out:?}");
}

#[test]
fn a_restitution_is_from_0_to_1() {
    let folder = folder();
    let expected = "restitution: '5' is not allowed, expected a number from 0 to 1";
    for (scene, code, message) in
        [("set restitution 5\n", 2, expected), ("set restitution 1\n", 0, ""), ("set restitution 0\n", 0, "")]
    {
        fs::write(folder.path().join("set.txt"), format!("{scene}{SCENE}")).unwrap();
        let (found, _, err) = run(command(folder.path(), ["run", "set.txt", "--steps", "1"]));
        assert!(found == code && err.contains(message), "{scene}: {err}");
    }
    let (code, _, err) = run(command(folder.path(), ["run", "scene.txt", "--set", "restitution=5"]));
    assert!(code == 2 && err.contains(expected), "{err}");
}
