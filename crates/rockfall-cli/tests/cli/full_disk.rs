//! A full disk is reported, and no incomplete file appears under its final name. The tests use `/dev/full` and a limit on the
//! size of files, which needs no privileges.
#![cfg(unix)]

use std::fs;
use std::process::Command;

use crate::common::{Rockfall, finish, mixed};

/// Runs a command that cannot write files larger than about 8 KiB.
#[track_caller]
fn run_limited(rockfall: &Rockfall, arguments: &str, code: i32) -> (String, String) {
    let program = env!("CARGO_BIN_EXE_rockfall");
    // Signal 25, SIGXFSZ, would end the program. It is ignored, so that the write fails instead.
    let script = format!("trap '' 25 && ulimit -f 16 && exec {program} {arguments}");
    let mut command = Command::new("sh");
    command.current_dir(rockfall.folder.path()).env("XDG_RUNTIME_DIR", rockfall.folder.path());
    finish(command.args(["-c", &script]).output().unwrap(), arguments, code)
}

fn names(rockfall: &Rockfall) -> Vec<String> {
    let entries = fs::read_dir(rockfall.folder.path()).unwrap();
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Files below the limit are written, so the failures in the tests below come from the limit alone.
#[test]
fn files_below_the_limit_are_written() {
    let rockfall = Rockfall::with(&mixed(4));
    run_limited(&rockfall, "run scene.txt --backend cpu --steps 3 --out state.csv", 0);
    assert_eq!(names(&rockfall), ["scene.txt", "state.csv"]);
}

#[test]
fn files_above_the_limit_are_reported_and_the_old_ones_kept() {
    for (files, name) in [
        ("--out state.csv", "state.csv"),
        ("--out state.npz", "state.npz"),
        ("--out state.vtp", "state.vtp"),
        ("--out run.csv --every 1", "run.csv"),
        ("--out run.npz --every 1", "run.npz"),
        ("--trace trace.csv", "trace.csv"),
        ("--checkpoint run.ckpt", "run.ckpt"),
        ("--checkpoint run.ckpt --checkpoint-every 10", "run.ckpt"),
    ] {
        let rockfall = Rockfall::with(&mixed(128));
        fs::write(rockfall.path(name), "old").unwrap();
        let (out, err) = run_limited(&rockfall, &format!("run scene.txt --backend cpu --steps 100 {files}"), 1);
        assert_eq!(out, "", "{files}");
        assert!(err.contains(&format!("error: {name}: cannot be written: File too large")), "{files}: {err}");
        assert_eq!(err.matches("error: ").count(), 1, "{err}");
        assert_eq!(rockfall.read(name), "old", "{files}");
        let mut expected = ["scene.txt", name];
        expected.sort_unstable();
        assert_eq!(names(&rockfall), expected, "{files}");
    }
}

#[test]
fn a_frame_above_the_limit_is_reported() {
    let rockfall = Rockfall::with(&mixed(128));
    let (_, err) = run_limited(&rockfall, "run scene.txt --backend cpu --steps 20 --out run.pvd --every 10", 1);
    assert!(err.contains("run.pvd: cannot be written: File too large"), "{err}");
    assert_eq!(fs::read_dir(rockfall.path("run")).unwrap().count(), 0);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_reported() {
    let rockfall = Rockfall::with(&mixed(16));
    for files in ["--out /dev/full", "--trace /dev/full", "--out /dev/full --every 5"] {
        let (out, err) = rockfall.run(&format!("run scene.txt --backend cpu --steps 50 {files}"), 1);
        assert_eq!(out, "");
        assert!(err.contains("error: /dev/full: cannot be written: No space left on device"), "{files}: {err}");
    }
}

/// An unfinished file of a killed program is replaced by the next program that writes to the same path.
#[test]
fn unfinished_files_of_killed_runs_are_replaced() {
    let rockfall = Rockfall::with(&mixed(4));
    fs::write(rockfall.path(".state.csv.part"), "left").unwrap();
    rockfall.run("run scene.txt --backend cpu --steps 3 --out state.csv", 0);
    assert_eq!(names(&rockfall), ["scene.txt", "state.csv"]);
}
