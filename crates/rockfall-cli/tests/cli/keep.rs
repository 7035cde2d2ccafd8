//! Runs of the binary that are killed, interrupted and resumed end bitwise identical to uninterrupted ones.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Rockfall, finish, mixed};

/// Waits until a file exists or the program ends.
fn wait_for(rockfall: &Rockfall, name: &str, child: &mut Child) {
    let start = Instant::now();
    while !rockfall.path(name).exists() && child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(120), "no {name}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn spawn(rockfall: &Rockfall, arguments: &str) -> Child {
    rockfall.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Starts a run, kills it after each of the delays (in ms, once there is a checkpoint) and resumes it, then waits for its end.
/// Returns the number of kills.
fn kill_and_resume(rockfall: &Rockfall, arguments: &str, delays: &[u64]) -> usize {
    let mut kills = 0;
    let mut child = spawn(rockfall, &format!("run scene.txt {arguments} --checkpoint run.ckpt"));
    for delay in delays {
        wait_for(rockfall, "run.ckpt", &mut child);
        std::thread::sleep(Duration::from_millis(*delay));
        let ended = child.try_wait().unwrap().is_some();
        // SIGKILL: nothing is cleaned up.
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        if ended {
            finish(output, arguments, 0);
        } else {
            kills += 1;
        }
        child = spawn(rockfall, "run --resume run.ckpt");
    }
    finish(child.wait_with_output().unwrap(), arguments, 0);
    kills
}

/// Compares trajectories and traces of killed and uninterrupted runs. The steps are slow enough for several kills.
fn check_killed_runs_are_bitwise_identical(engine: &str, steps: u32, balls: usize, delays: &[u64]) {
    for integrator in ["rk4", "symplectic-euler"] {
        for broad_phase in ["brute-force", "grid"] {
            let rockfall = Rockfall::with(&mixed(balls));
            let physics = format!("{engine} --integrator {integrator} --broad-phase {broad_phase} --steps {steps} --dt 0.01");
            rockfall
                .run(&format!("run scene.txt {physics} --out whole.csv --every 20 --trace whole-trace.csv --trace-every 5"), 0);
            let files = "--out parts.csv --every 20 --trace parts-trace.csv --trace-every 5 --checkpoint-every 7";
            let kills = kill_and_resume(&rockfall, &format!("{physics} {files}"), delays);
            assert!(kills > delays.len() / 2, "{kills} kills: the run is too short");
            assert!(rockfall.read("whole.csv") == rockfall.read("parts.csv"), "{physics}: states differ");
            assert!(rockfall.read("whole-trace.csv") == rockfall.read("parts-trace.csv"), "{physics}: traces differ");
            let mut left: Vec<_> =
                fs::read_dir(rockfall.folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
            left.sort();
            assert_eq!(left, ["parts-trace.csv", "parts.csv", "run.ckpt", "scene.txt", "whole-trace.csv", "whole.csv"]);
        }
    }
}

#[test]
fn runs_killed_on_the_cpu_are_bitwise_identical() {
    check_killed_runs_are_bitwise_identical("--backend cpu", 600, 96, &[0, 3, 11, 30, 47, 101]);
}

#[cfg(feature = "gpu")]
#[test]
fn runs_killed_on_the_gpu_are_bitwise_identical() {
    check_killed_runs_are_bitwise_identical("--backend gpu", 60, 16, &[20, 150]);
}

/// The library writes checkpoints without the options of a run.
#[test]
fn a_checkpoint_of_the_library_is_continued_up_to_a_given_step() {
    let rockfall = Rockfall::with(&mixed(32));
    let options = rockfall::Options::new().backend(rockfall::Backend::Cpu);
    let scene = rockfall::Scene::load(rockfall.path("scene.txt")).unwrap().scene;
    let mut simulation = rockfall::Simulation::with_options(scene, options).unwrap();
    simulation.run(40, 0.01).unwrap();
    simulation.save_checkpoint(rockfall.path("library.ckpt")).unwrap();
    let (_, message) = rockfall.run("run --resume library.ckpt", 2);
    assert!(message.contains("library.ckpt is at step 40") && message.contains("expected --steps N, 40 or more"), "{message}");
    let (_, message) = rockfall.run("run --resume library.ckpt --steps 39", 2);
    assert!(message.contains("expected at least 40"), "{message}");
    let (summary, _) = rockfall.run("run --resume library.ckpt --steps 100 --out parts.csv", 0);
    assert!(summary.contains("100 of 0.01 s = 1 s"), "{summary}");
    rockfall.run("run scene.txt --backend cpu --dt 0.01 --steps 100 --out whole.csv", 0);
    assert!(rockfall.read("whole.csv") == rockfall.read("parts.csv"), "states differ");
    // The checkpoint is now one of `run`, which knows its steps.
    rockfall.run("run --resume library.ckpt", 0);
}

/// A resumed run continues its trajectory in every format, whether the file was finished or not.
#[test]
fn resumed_runs_continue_their_trajectories() {
    for (option, out) in [
        ("--out", "run.npz"),
        ("--out", "run.pvd"),
        ("--out", "run.csv"),
        ("--contacts", "run.npz"),
        ("--contacts", "run.pvd"),
        ("--contacts", "run.csv"),
    ] {
        let [whole, parts] = [0, 1].map(|_| Rockfall::with(&mixed(32)));
        let run = format!("run scene.txt --backend cpu --dt 0.01 {option} {out} --every 10");
        whole.run(&format!("{run} --steps 100"), 0);
        // A run to its end, then one that continues the finished file, one that is killed, and one that continues the
        // unfinished file.
        parts.run(&format!("{run} --steps 35 --checkpoint run.ckpt"), 0);
        parts.run("run --resume run.ckpt --steps 55", 0);
        let mut child = spawn(&parts, "run --resume run.ckpt --steps 1000000000 --checkpoint-every 5");
        let saved = fs::read(parts.path("run.ckpt")).unwrap();
        while fs::read(parts.path("run.ckpt")).unwrap() == saved {
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let (_, err) = parts.run("run --resume run.ckpt --steps 56", 2);
        assert!(err.contains("already"), "{err}");
        let done: u64 = err.split(" is at step ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        parts.run(&format!("run --resume run.ckpt --steps {}", done.next_multiple_of(100)), 0);
        if done > 100 {
            whole.run(&format!("{run} --steps {}", done.next_multiple_of(100)), 0);
        }
        assert!(fs::read(whole.path(out)).unwrap() == fs::read(parts.path(out)).unwrap(), "{out} differs");
        if out == "run.pvd" {
            for frame in fs::read_dir(whole.path("run")).unwrap() {
                let name = frame.unwrap().file_name();
                let [whole, parts] = [&whole, &parts].map(|run| fs::read(run.path("run").join(&name)).unwrap());
                assert!(whole == parts, "{name:?} differs");
            }
        }
    }
}

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

/// A run that has written its first checkpoint, and its arguments.
#[cfg(unix)]
fn endless_run() -> (Rockfall, String, Child) {
    let rockfall = Rockfall::with(&mixed(32));
    let files = "--out state.csv --trace trace.csv --checkpoint run.ckpt --checkpoint-every 50";
    let arguments = format!("run scene.txt --backend cpu --dt 0.01 --steps 1000000000 {files}");
    let mut child = spawn(&rockfall, &arguments);
    wait_for(&rockfall, "run.ckpt", &mut child);
    (rockfall, arguments, child)
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_run_cleanly() {
    for name in ["-INT", "-TERM"] {
        let (rockfall, arguments, child) = endless_run();
        std::thread::sleep(Duration::from_millis(30));
        signal(&child, name);
        let (out, err) = finish(child.wait_with_output().unwrap(), &arguments, 130);
        assert!(out.contains("energy"), "{out}");
        let (_, rest) = err.split_once("stopped at step ").unwrap();
        let step: u64 = rest.split(' ').next().unwrap().parse().unwrap();
        assert_eq!(
            err,
            format!(
                "written up to step {step}: trace.csv, state.csv\nstopped at step {step} of 1000000000; \
                 continue with: rockfall run --resume run.ckpt\n"
            )
        );
        assert!(step >= 50);
        assert_eq!(rockfall.read("trace.csv").lines().count() as u64, step + 2);

        // The files are those of a run with this number of steps.
        let whole = "--out whole.csv --trace whole-trace.csv";
        rockfall.run(&format!("run scene.txt --backend cpu --dt 0.01 --steps {step} {whole}"), 0);
        assert_eq!(rockfall.read("whole.csv"), rockfall.read("state.csv"));
        assert_eq!(rockfall.read("whole-trace.csv"), rockfall.read("trace.csv"));
        let (out, _) = rockfall.run(&format!("run --resume run.ckpt --steps {} --json", step + 10), 0);
        assert!(out.contains(&format!("\"steps\":{}", step + 10)), "{out}");
        assert_eq!(rockfall.read("trace.csv").lines().count() as u64, step + 12);
    }
}

/// Each would replace the checkpoint of the other.
#[cfg(unix)]
#[test]
fn two_runs_cannot_write_the_same_checkpoint() {
    let (rockfall, arguments, child) = endless_run();
    for run in
        ["run scene.txt --backend cpu --steps 1 --checkpoint run.ckpt", "run --resume run.ckpt --out a.csv --trace b.csv"]
    {
        let (_, err) = rockfall.run(run, 1);
        assert!(err.contains("run.ckpt: cannot be written: another program is writing it"), "{err}");
    }
    signal(&child, "-INT");
    finish(child.wait_with_output().unwrap(), &arguments, 130);
}

/// `timeout` signals the program and its process group, so two signals come within a millisecond.
#[cfg(unix)]
#[test]
fn two_signals_at_a_time_end_a_run_cleanly() {
    for name in ["-INT", "-TERM"] {
        let (rockfall, arguments, child) = endless_run();
        let kill = format!("kill {name} {id}; sleep 0.001; kill {name} {id}", id = child.id());
        Command::new("sh").args(["-c", &kill]).output().unwrap();
        let (_, err) = finish(child.wait_with_output().unwrap(), &arguments, 130);
        let (_, rest) = err.split_once("stopped at step ").unwrap();
        let step: u64 = rest.split(' ').next().unwrap().parse().unwrap();
        assert_eq!(rockfall.read("trace.csv").lines().count() as u64, step + 2);
        rockfall.run(&format!("run scene.txt --backend cpu --dt 0.01 --steps {step} --out whole.csv"), 0);
        assert_eq!(rockfall.read("whole.csv"), rockfall.read("state.csv"));
        rockfall.run(&format!("run --resume run.ckpt --steps {}", step + 10), 0);
    }
}

/// A signal that comes at least 1 s after the first ends a run at once, here one that writes to a pipe which nobody reads.
#[cfg(unix)]
#[test]
fn a_second_signal_after_a_second_ends_a_run_at_once() {
    let rockfall = Rockfall::with(&mixed(2048));
    assert!(Command::new("mkfifo").arg(rockfall.path("state.csv")).status().unwrap().success());
    // Open for both, so that no opening waits for the other end.
    let _pipe = fs::OpenOptions::new().read(true).write(true).open(rockfall.path("state.csv")).unwrap();
    let arguments = "run scene.txt --backend cpu --dt 0.01 --steps 1 --out state.csv --checkpoint run.ckpt";
    let mut child = spawn(&rockfall, arguments);
    wait_for(&rockfall, "run.ckpt", &mut child);
    signal(&child, "-INT");
    std::thread::sleep(Duration::from_millis(100));
    signal(&child, "-INT");
    std::thread::sleep(Duration::from_millis(1500));
    assert!(child.try_wait().unwrap().is_none(), "two signals at a time must not end the run while it writes");
    signal(&child, "-INT");
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(10) {
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let (out, err) = finish(child.wait_with_output().unwrap(), arguments, 130);
    assert!(out.is_empty() && !err.contains("stopped"), "{out} {err}");
}

#[test]
fn options_override_the_checkpoint_and_changes_are_reported() {
    let rockfall = Rockfall::with(&mixed(16));
    let (out, _) = rockfall.run("run scene.txt --backend cpu --dt 0.01 --steps 20 --checkpoint run.ckpt --trace a.csv", 0);
    assert!(out.contains("20 of 0.01 s = 0.2 s,"), "{out}");
    let keep = fs::read(rockfall.path("run.ckpt")).unwrap();
    let (out, err) = rockfall.run(
        "run --resume run.ckpt --steps 30 --dt 0.005 --integrator symplectic-euler --set gravity=2 --set friction=50 --trace b.csv",
        0,
    );
    assert_eq!(
        err,
        "note: --dt 0.005 instead of 0.01 from step 20 on\n\
         note: --integrator symplectic-euler instead of rk4 from step 20 on\n\
         note: --set gravity 2 instead of 9 from step 20 on\n"
    );
    assert!(out.contains("30, the last of 0.005 s, 0.25 s in all,"), "{out}");
    // A new trace begins at the checkpoint. The old one is left unchanged.
    let trace = rockfall.read("b.csv");
    assert!(trace.lines().nth(1).unwrap().starts_with("20,"), "{trace}");
    assert_eq!(trace.lines().count(), 12);
    assert_eq!(rockfall.read("a.csv").lines().count(), 22);
    let time: f64 = trace.lines().nth(11).unwrap().split(',').nth(1).unwrap().parse().unwrap();
    assert!((time - 0.25).abs() < 1e-6, "{time}");

    // A trace that was removed or changed is not continued, nor one with other intervals.
    fs::write(rockfall.path("run.ckpt"), &keep).unwrap();
    let (_, err) = rockfall.run("run --resume run.ckpt --steps 30 --trace a.csv --trace-every 2", 2);
    assert!(err.contains("the existing lines were written with --trace-every 1; omit --trace-every"), "{err}");
    fs::write(rockfall.path("a.csv"), "step\n").unwrap();
    let (_, err) = rockfall.run("run --resume run.ckpt --steps 30", 2);
    assert!(
        err.contains("a.csv: it is not what was written before; --resume cannot continue this file: give another --trace"),
        "{err}"
    );
    fs::remove_file(rockfall.path("a.csv")).unwrap();
    let (_, err) = rockfall.run("run --resume run.ckpt --steps 30", 2);
    assert!(err.contains("a.csv: what was written of it before is not there any more"), "{err}");
    assert!(!rockfall.path(".a.csv.part").exists());
}

#[test]
fn a_run_with_substeps_can_be_resumed() {
    let rockfall = Rockfall::with(&mixed(16));
    let run = "run scene.txt --backend cpu --dt 0.02 --substeps 3 --every 5";
    rockfall.run(&format!("{run} --steps 40 --out whole.csv --trace whole-trace.csv"), 0);
    rockfall.run(&format!("{run} --steps 17 --out parts.csv --trace parts-trace.csv --checkpoint run.ckpt"), 0);
    let (out, _) = rockfall.run("run --resume run.ckpt --steps 40 --json", 0);
    assert!(out.contains("\"steps\":40") && out.contains("\"substeps\":3") && out.contains("\"dt\":0.02,"), "{out}");
    assert_eq!(rockfall.read("whole.csv"), rockfall.read("parts.csv"));
    assert_eq!(rockfall.read("whole-trace.csv"), rockfall.read("parts-trace.csv"));

    // With another number of parts, it continues from the same step.
    let (out, err) = rockfall.run("run --resume run.ckpt --steps 44 --substeps 2 --trace b.csv", 0);
    assert_eq!(err, "note: --substeps 2 instead of 3 from step 40 on\n");
    assert!(out.contains("44 of 0.02 s = 0.88 s in 2 parts each,"), "{out}");
    let trace = rockfall.read("b.csv");
    let steps: Vec<&str> = trace.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(steps, ["40", "41", "42", "43", "44"]);
    let (_, err) = rockfall.run("run --resume run.ckpt --steps 43", 2);
    assert!(err.contains("is at step 44 already"), "{err}");
}

/// The speed of a servo is rounded to f32, so that it may move faster than its speed in f64.
#[test]
fn every_state_of_a_servo_can_be_read_back() {
    let lid = "@servo lid force=0,-30,0 speed=0.1\n@move lid\nB 0 1 0  1 0 0  0 0.1 0  0 0 1\n@move -\n\
               S 1 0.5 0.3 0.5 0 0 0 0 0 0 1 0.1\n";
    let press = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/press.txt")).unwrap();
    for scene in [lid, &press] {
        let rockfall = Rockfall::with(scene);
        rockfall.run("run scene.txt --backend cpu --steps 0 --checkpoint run.ckpt --save state.txt", 0);
        for step in 1..=12 {
            rockfall.run(&format!("run --resume run.ckpt --steps {step}"), 0);
            rockfall.run("run state.txt --backend cpu --steps 1", 0);
        }
        rockfall.run("run scene.txt --backend cpu --steps 12 --save whole.txt", 0);
        assert_eq!(rockfall.read("whole.txt"), rockfall.read("state.txt"));
    }
}

/// What `@run` says is kept, and so is all that depends on it: the scene in a trajectory, and a saved scene.
#[test]
fn a_resumed_run_keeps_what_the_scene_says_about_runs() {
    let line = "@run dt=0.001 integrator=symplectic-euler steps=50 every=5 substeps=2 speed=0.25";
    let rockfall = Rockfall::with(&format!("set gravity 9.81\n{line}\nS 1 0 1 0 0 0 0 0 0 0 1 0.1\n"));
    rockfall.run("run scene.txt --backend cpu --out whole.npz --save whole.txt", 0);
    rockfall.run("run scene.txt --backend cpu --steps 23 --checkpoint run.ckpt --out parts.npz --save parts.txt", 0);
    rockfall.run("run --resume run.ckpt --steps 50", 0);
    assert!(rockfall.read("whole.txt").contains(line), "{}", rockfall.read("whole.txt"));
    assert_eq!(rockfall.read("whole.txt"), rockfall.read("parts.txt"));
    let [whole, parts] = ["whole.npz", "parts.npz"].map(|name| fs::read(rockfall.path(name)).unwrap());
    assert!(whole == parts, "the trajectories differ");
}

#[test]
fn a_damaged_checkpoint_is_refused_with_a_reason() {
    let rockfall = Rockfall::with(&mixed(4));
    rockfall.run("run scene.txt --backend cpu --steps 5 --checkpoint run.ckpt", 0);
    let good = fs::read(rockfall.path("run.ckpt")).unwrap();
    let mut bad = good.clone();
    bad[good.len() / 2] ^= 1;
    for (bytes, reason) in [(&good[..good.len() - 1], "bytes, expected"), (&bad, "its checksum is wrong"), (&[], "it is empty")]
    {
        fs::write(rockfall.path("run.ckpt"), bytes).unwrap();
        let (out, err) = rockfall.run("run --resume run.ckpt --steps 9", 2);
        assert_eq!(out, "");
        assert!(err.starts_with("error: run.ckpt: not a usable checkpoint: ") && err.contains(reason), "{err}");
        assert_eq!(fs::read(rockfall.path("run.ckpt")).unwrap(), bytes);
    }
}
