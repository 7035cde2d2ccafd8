//! A signal ends any command within a second, with exit code 130. The bounds of time hold on a loaded machine.
#![cfg(unix)]

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::{Rockfall, finish, mixed};

/// A second on an idle machine.
const SOON: Duration = Duration::from_secs(8);

fn spawn(rockfall: &Rockfall, arguments: &str) -> Child {
    rockfall.command(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

/// Waits for the end, and kills a command that does not end.
#[track_caller]
fn end_within(mut child: Child, limit: Duration, arguments: &str, code: i32) -> (String, String) {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > limit {
            child.kill().unwrap();
            panic!("{arguments}: no end within {limit:?}");
        }
        sleep(Duration::from_millis(10));
    }
    finish(child.wait_with_output().unwrap(), arguments, code)
}

/// One step of a million parts takes minutes, and nothing ends it in the middle.
#[test]
fn a_signal_ends_a_run_within_a_long_step() {
    for (name, save) in [("-INT", ""), ("-TERM", "--checkpoint run.ckpt --checkpoint-every 1")] {
        let rockfall = Rockfall::with(&mixed(64));
        let arguments = format!("run scene.txt --backend cpu --substeps 1000000 --dt 0.01 --out state.csv {save}");
        let child = spawn(&rockfall, &arguments);
        sleep(Duration::from_millis(1500));
        signal(&child, name);
        let (out, err) = end_within(child, SOON, &arguments, 130);
        assert_eq!(out, "");
        assert_eq!(err.lines().last(), Some("stopped within a step that takes longer than 0.8 s; no results are written"));
        assert!(!rockfall.path("state.csv").exists());
    }
}

/// Commands that have nothing to finish: one that waits for its input, one that computes, one that measures.
#[test]
fn a_signal_ends_every_other_command() {
    let commands = [
        "check -",
        "generate soft --spheres 20000000 --out soft.txt",
        "bench pile --spheres 20000 --backend cpu --steps 100000",
    ];
    for arguments in commands {
        for name in ["-INT", "-TERM"] {
            let rockfall = Rockfall::with("");
            let child = spawn(&rockfall, arguments);
            sleep(Duration::from_millis(500));
            signal(&child, name);
            end_within(child, SOON, arguments, 130);
        }
    }
}

/// Coordinates of 1e20 and more: rounding takes bodies out of the AABBs that the search for contacts uses.
#[test]
fn a_run_with_a_huge_time_step_ends() {
    let rockfall = Rockfall::with("");
    rockfall.run("generate mixed --spheres 300 --out mixed.txt", 0);
    for arguments in [
        "run mixed.txt --dt 1e10 --steps 10 --keep-going --backend cpu --set gravity=1",
        "run mixed.txt --dt 1e10 --steps 10 --keep-going --backend cpu --set gravity=1 --broad-phase grid",
    ] {
        end_within(spawn(&rockfall, arguments), Duration::from_secs(60), arguments, 0);
    }
}

#[cfg(all(feature = "view", feature = "gpu"))]
#[test]
fn a_signal_ends_a_film_which_keeps_its_pictures() {
    let rockfall = Rockfall::with(&mixed(16));
    let arguments = "render scene.txt --out film.gif --steps 1000000 --dt 0.01 --size 200x150 --plain --backend cpu";
    let mut child = spawn(&rockfall, arguments);
    let start = Instant::now();
    while std::fs::metadata(rockfall.path(".film.gif.part")).map_or(0, |file| file.len()) < 1000 {
        assert!(child.try_wait().unwrap().is_none() && start.elapsed() < Duration::from_secs(600), "no film");
        sleep(Duration::from_millis(20));
    }
    signal(&child, "-TERM");
    let (_, err) = end_within(child, SOON, arguments, 130);
    assert!(err.contains(" pictures, written to film.gif"), "{err}");
    assert!(std::fs::read(rockfall.path("film.gif")).unwrap().starts_with(b"GIF89a"));
}
