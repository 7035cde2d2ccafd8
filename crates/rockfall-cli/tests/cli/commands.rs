//! Tests of the binary with good and bad scenes and arguments.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde_json::Value;

#[cfg(feature = "gpu")]
use crate::common::finish;
use crate::common::{Rockfall, mixed};

/// Two balls that fall on a box.
const SCENE: &str = "Two balls over a box.\nS 1 0 1 0 0 0 0 0 0 0 1 0.5 0\nS 2 0.25 2.5 -0 1e-40 0 1.2345679e-30 0 0 0 1 0.5\n\
                     B -5 -1 -5 10 0 0 0 1 0 0 0 10\n";

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    // The folder of creatures is tested by the crate rockfall-evolve.
    paths.retain(|path| path.is_file());
    paths.sort();
    paths
}

#[test]
fn every_scene_in_the_scenes_folder_is_valid_and_runs() {
    let rockfall = Rockfall::with("");
    assert!(scenes().len() >= 8);
    for path in scenes() {
        let path = path.to_str().unwrap();
        // Contact laws with history have no RK4.
        let has_history = fs::read_to_string(path).unwrap().contains("set contact_law");
        for integrator in ["rk4", "symplectic-euler", "velocity-verlet"].into_iter().skip(usize::from(has_history)) {
            let (out, _) = rockfall.run(&format!("check {path} --integrator {integrator}"), 0);
            assert!((out.contains("spheres") || out.contains("inlet")) && !out.contains("warning"), "{out}");
        }
        let (out, err) = rockfall.run(&format!("run {path} --backend cpu --steps 100"), 0);
        assert!(out.contains("cpu: ") && out.contains("energy"), "{out}");
        assert_eq!(err, "");
    }
}

#[test]
fn run_without_a_scene_uses_the_built_in_one() {
    let rockfall = Rockfall::with("");
    let (out, _) = rockfall.run("run --backend cpu --steps 3", 0);
    assert!(out.starts_with("built-in "), "{out}");
}

#[test]
fn json_is_one_object_with_all_keys() {
    let rockfall = Rockfall::with(SCENE);
    let (out, err) = rockfall.run("run scene.txt --backend cpu --steps 60 --json", 0);
    assert_eq!(err, "");
    let object: Value = serde_json::from_str(&out).unwrap();
    let mut keys: Vec<&str> = object.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    let expected = "backend broad_phase broken_joints collisions comments contacts device dt energy_end energy_growth_without_cause energy_start \
                    flow integrator max_overlap max_overlap_radii non_finite objects passages precision replays scene seconds settings steps steps_per_second substeps time";
    assert_eq!(keys, expected.split(' ').collect::<Vec<_>>());
    assert_eq!(object["scene"], "scene.txt");
    assert_eq!(object["backend"], "cpu");
    assert_eq!(object["steps"], 60);
    assert_eq!(object["substeps"], 1);
    assert_eq!(object["dt"], 0.02);
    assert_eq!(object["objects"]["spheres"], 2);
    assert_eq!(object["objects"]["boxes"], 1);
    assert_eq!(object["objects"].as_object().unwrap().len(), 10);
    assert!(object["collisions"].as_u64().unwrap() > 0, "{out}");
    assert_eq!(object["non_finite"], 0);
    assert!(object["steps_per_second"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_state_file_reads_back_bitwise_identical() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --steps 0 --out state.csv", 0);
    let text = rockfall.read("state.csv");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "sphere,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz,reference");
    assert_eq!(lines.len(), 3);
    assert_eq!(lines[1], "0,0,1,0,0,0,0,1,0,0,0,0,0,0,1");
    let second: Vec<f32> = lines[2].split(',').map(|field| field.parse().unwrap()).collect();
    assert_eq!((second.len(), second[14]), (15, 2.0));
    assert_eq!(second[1], 0.25);
    assert_eq!(second[3].to_bits(), (-0.0_f32).to_bits());
    assert_eq!(second[4].to_bits(), 1e-40_f32.to_bits());
    assert_eq!(second[6].to_bits(), 1.2345679e-30_f32.to_bits());
    assert!(lines[2].len() < 70, "{}", lines[2]);

    // Runs of the same scene end bitwise identical, with and without a trace.
    rockfall.run("run scene.txt --backend cpu --steps 50 --out a.csv", 0);
    rockfall.run("run scene.txt --backend cpu --steps 50 --out b.csv --trace trace.csv", 0);
    assert_eq!(rockfall.read("a.csv"), rockfall.read("b.csv"));
}

#[test]
fn the_trace_has_a_line_for_the_start_and_one_for_every_step() {
    let rockfall = Rockfall::with(&SCENE.replace("1e-40", "0").replace("1.2345679e-30", "0"));
    rockfall.run("run scene.txt --backend cpu --steps 40 --dt 0.01 --trace trace.csv", 0);
    let text = rockfall.read("trace.csv");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "step,time,kinetic,potential,spring,contact,momentum_x,momentum_y,momentum_z,angular_x,angular_y,angular_z,\
         max_overlap,contacts,collisions,work,dissipated"
    );
    assert_eq!(lines.len(), 42);
    assert_eq!(lines[1], "0,0,0,3.5,0,0,0,0,0,0,0,0,0,0,0,0,");
    // What the law of the thesis dissipates is not known.
    let fields =
        |line: &str| -> Vec<f64> { line.strip_suffix(',').unwrap().split(',').map(|field| field.parse().unwrap()).collect() };
    for (step, line) in lines[1..].iter().enumerate() {
        let fields = fields(line);
        assert_eq!(fields.len(), 16, "{line}");
        assert_eq!(fields[0], step as f64);
        assert!((fields[1] - 0.01 * step as f64).abs() < 1e-6, "{line}");
    }
    // Both balls fall freely until the first one hits the box.
    let tenth = fields(lines[11]);
    assert!((tenth[7] + 2.0 * 0.1).abs() < 1e-5, "{tenth:?}");
}

#[test]
fn trace_every_writes_each_kth_line_with_the_collisions_in_between() {
    let rockfall = Rockfall::with(&mixed(16));
    let run = |arguments: &str| rockfall.run(&format!("run scene.txt --backend cpu --steps 203 --dt 0.01 {arguments}"), 0);
    run("--trace fine.csv --out fine-state.csv");
    run("--trace coarse.csv --trace-every 20 --out coarse-state.csv");
    assert_eq!(rockfall.read("fine-state.csv"), rockfall.read("coarse-state.csv"));
    let lines = |name: &str| -> Vec<String> { rockfall.read(name).lines().map(str::to_owned).collect() };
    let (fine, coarse) = (lines("fine.csv"), lines("coarse.csv"));
    assert_eq!((fine.len(), coarse.len()), (205, 12));
    assert_eq!(coarse[0], fine[0]);
    let split = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        (fields[..14].join(","), fields[14].parse::<u64>().unwrap())
    };
    let mut all = 0;
    for (place, line) in coarse[1..].iter().enumerate() {
        let (rest, collisions) = split(line);
        assert_eq!(rest, split(&fine[1 + 20 * place]).0);
        let between = &fine[1 + (20 * place).saturating_sub(19)..=1 + 20 * place];
        assert_eq!(collisions, between.iter().map(|line| split(line).1).sum::<u64>(), "{line}");
        all += collisions;
    }
    assert!(all > 0, "there are collisions");
    for wrong in ["--trace t.csv --trace-every 0", "--trace-every 5"] {
        let (_, err) = rockfall.run(&format!("run scene.txt {wrong}"), 2);
        assert!(err.contains("--trace-every"), "{err}");
    }
}

#[test]
fn arguments_override_settings_and_steps() {
    let rockfall = Rockfall::with(&format!("{SCENE}set gravity 9\n"));
    let momentum = |arguments: &str| -> f64 {
        rockfall.run(&format!("run scene.txt --backend cpu --steps 1 --trace t.csv {arguments}"), 0);
        let text = rockfall.read("t.csv");
        text.lines().nth(2).unwrap().split(',').nth(7).unwrap().parse().unwrap()
    };
    assert!((momentum("") + 2.0 * 9.0 * 0.02).abs() < 1e-6);
    assert!((momentum("--set gravity=3") + 2.0 * 3.0 * 0.02).abs() < 1e-6);
    assert!((momentum("--set gravity=3 --set gravity=1 --dt 0.5e-1") + 2.0 * 0.05).abs() < 1e-6);
    assert!((momentum("--integrator symplectic-euler --broad-phase brute-force --capacity 1") + 2.0 * 9.0 * 0.02).abs() < 1e-6);
    assert!((momentum("--integrator velocity-verlet") + 2.0 * 9.0 * 0.02).abs() < 1e-6);
    rockfall.run("check scene.txt --set gravity_direction=0,0,-1", 0);
}

#[test]
fn errors_in_scenes_name_file_line_and_field() {
    let cases = [
        ("S 1 0 1 0 0 0 0 0 0 0 1", "scene.txt:1: S radius: missing, expected 12 or 13 numbers after S, found 11"),
        ("x\nS 1 0 1 0 0 0 0 0 0 0 -1 1", "scene.txt:2: S mass: -1 is not allowed, expected"),
        ("\n\nR 1 2 0.1", "scene.txt:3: R end1: no sphere with reference 1"),
        ("B 0 0 0 1 0 0 1 1 0 0 0 1", "scene.txt:1: B edges: "),
        ("S 1 nan", "scene.txt:1: S x: 'nan' is not finite"),
        ("set gravity x", "scene.txt:1: set gravity: 'x' is not allowed, expected a finite number"),
        ("a\0", "scene.txt:1: text: a NUL byte"),
    ];
    for (scene, message) in cases {
        let rockfall = Rockfall::with(scene);
        for command in ["run scene.txt --backend cpu", "check scene.txt", "run scene.txt --json"] {
            let (out, err) = rockfall.run(command, 2);
            assert!(err.starts_with(&format!("error: {message}")), "{err}");
            assert_eq!(out, "");
        }
    }
}

#[test]
fn unreadable_scenes_exit_with_code_2() {
    let rockfall = Rockfall::with(SCENE);
    for command in ["run nowhere.txt", "check nowhere.txt", "run .", "check .", "check scene.txt/below"] {
        let (_, err) = rockfall.run(command, 2);
        let name = command.split(' ').nth(1).unwrap();
        assert!(err.starts_with(&format!("error: {name}: ")), "{err}");
    }
}

#[test]
fn a_scene_can_be_read_from_standard_input() {
    let rockfall = Rockfall::with("");
    let (out, _) = rockfall.run_with_input("run - --backend cpu --steps 2 --json", SCENE.as_bytes(), 0);
    let object: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(object["objects"]["spheres"], 2);
    let (_, err) = rockfall.run_with_input("check -", b"\xff\xfe\nS", 2);
    assert!(err.contains("<stdin>:2: S reference: missing"), "{err}");
    // Empty input is a scene without objects.
    let (out, _) = rockfall.run_with_input("check -", b"", 0);
    assert!(out.contains("no spheres"), "{out}");
    rockfall.run_with_input("run - --backend cpu --steps 3", b"", 0);
}

#[test]
fn wrong_arguments_exit_with_code_2() {
    let rockfall = Rockfall::with(SCENE);
    let cases = [
        ("", "Usage"),
        ("bench heap", "thesis, lattice, pile, settled, shuffled, mixed, radii or boxes"),
        ("look", "look"),
        ("render scene.txt", "render"),
        ("run scene.txt more.txt", "more.txt"),
        ("run scene.txt --dt 0", "a finite number of seconds greater than 0"),
        ("run scene.txt --dt -0.02", "a finite number of seconds greater than 0"),
        ("run scene.txt --dt NaN", "a finite number of seconds greater than 0"),
        ("run scene.txt --dt inf", "a finite number of seconds greater than 0"),
        ("run scene.txt --dt 1e-50", "a finite number of seconds greater than 0"),
        ("run scene.txt --dt fast", "a finite number of seconds greater than 0"),
        ("run scene.txt --steps -1", "-1"),
        ("run scene.txt --steps 1e3", "1e3"),
        ("run scene.txt --steps 99999999999999999999999", "99999999999999999999999"),
        ("run scene.txt --backend cpu --capacity 4294967296", "4294967295"),
        ("run scene.txt --backend tpu", "one of: auto gpu cpu"),
        ("run scene.txt --integrator euler", "rk4, symplectic-euler or velocity-verlet"),
        ("run scene.txt --broad-phase luck", "brute-force"),
        ("run scene.txt --set gravity", "expected NAME=VALUE"),
        ("run scene.txt --set weight=1", "'weight=1' for '--set <NAME=VALUE>': unknown setting 'weight'"),
        ("run scene.txt --set restitution=-1", "a number from 0 to 1"),
        ("run scene.txt --set gravity=", "a finite number"),
        ("run scene.txt --out same.csv --trace same.csv", "same file"),
        ("run scene.txt --trace same.csv --contacts same.csv", "same file"),
        ("run scene.txt --out a.pvd --contacts a.VTP --every 2", "same file"),
        ("run scene.txt --every 5", "expected --out FILE"),
        ("run scene.txt --out a.npz --every 0", "'0' for '--every"),
        ("run scene.txt --out a.pvd", "expected --every"),
        ("run scene.txt --checkpoint-every 5", "expected --checkpoint FILE"),
        ("run scene.txt --resume a.ckpt", "cannot be used with"),
        ("run --resume none.ckpt", "none.ckpt: "),
        ("run --resume scene.txt", "scene.txt: not a usable checkpoint: it does not begin as"),
        ("check", "Usage"),
        ("check scene.txt --dt 0", "a finite number of seconds greater than 0"),
        ("generate", "Usage"),
        (
            "generate heap --spheres 10",
            "pile, mixed, clumps, boxes, dominoes, bricks, arch, hulls, soft, chain, hopper, drum, column, vibrated, shear-cell, mixer or screw",
        ),
        ("generate pile", "--spheres"),
        ("generate pile --spheres -5", "-5"),
        ("generate pile --spheres 0", "at least 1"),
        ("generate pile --spheres 4000000000", "too many"),
        ("generate pile --spheres 10 --seed x", "x"),
        ("generate pile rock.stl --spheres 10", "pile has no mesh, got rock.stl"),
        ("generate clump --spheres 10", "the name of a mesh is missing"),
        ("generate clump rock.stl", "--spheres"),
        ("generate pile --spheres 10 --overlap 0.5", "<MESH>"),
        ("generate clump rock.txt --spheres 10", "expected .stl, .obj or .ply"),
        ("devices here", "here"),
    ];
    for (command, message) in cases {
        let (out, err) = rockfall.run(command, 2);
        assert!(err.contains(message), "{command}: {err}");
        assert_eq!(out, "", "{command}");
    }
    assert_eq!(fs::read_dir(rockfall.folder.path()).unwrap().count(), 1, "nothing is written");
}

#[test]
fn bad_output_paths_fail_before_the_run() {
    let rockfall = Rockfall::with(SCENE);
    fs::create_dir(rockfall.path("folder.csv")).unwrap();
    for command in [
        // With this number of steps the test would not end if the run came first.
        "run scene.txt --backend cpu --steps 1000000000000 --out no/state.csv",
        "run scene.txt --backend cpu --steps 1000000000000 --trace no/trace.csv",
        "run scene.txt --backend cpu --steps 1000000000000 --contacts no/contacts.npz",
        "run scene.txt --backend cpu --steps 1000000000000 --save no/scene.txt",
        "run scene.txt --backend cpu --steps 1000000000000 --out folder.csv",
        "generate pile --spheres 10 --out no/pile.txt",
    ] {
        let (_, err) = rockfall.run(command, 1);
        assert!(err.contains("cannot be written"), "{err}");
    }
}

#[test]
fn a_run_that_fails_writes_its_results_so_far() {
    let scene = "S 1 0 0 0 0 0 0 0 0 0 1 0.1\nS 2 9 0 0 0 0 0 0 0 0 1 0.1\nK 1 2 1e6 1 0\n";
    let rockfall = Rockfall::with(scene);
    fs::write(rockfall.path("run.ckpt"), "old").unwrap();
    let files = "--out state.csv --trace trace.csv --checkpoint run.ckpt";
    let (out, err) = rockfall.run(&format!("run scene.txt --backend cpu {files}"), 1);
    assert_eq!(out, "");
    let (_, step) = err.split_once("written up to step ").unwrap();
    let (step, files) = step.split_once(": ").unwrap();
    assert!(files.starts_with("trace.csv, state.csv\nerror: sphere 1 stopped being finite in step "), "{err}");
    assert!(files.contains(&format!("in step {step} ")), "{err}");
    // The state file holds the failed state. The trace ends with the step before it.
    assert_eq!(rockfall.read("state.csv").lines().count(), 3);
    assert_eq!(rockfall.read("trace.csv").lines().count(), 1 + step.parse::<usize>().unwrap());
    assert_eq!(rockfall.read("run.ckpt"), "old", "a failed run leaves the checkpoint unchanged");
    assert_eq!(fs::read_dir(rockfall.folder.path()).unwrap().count(), 4, "no part files");

    let command = "run scene.txt --backend cpu --out state.csv --trace trace.csv";
    let (out, _) = rockfall.run(&format!("{command} --keep-going --steps 5"), 0);
    assert!(out.contains("a body with non-finite values was stopped "), "{out}");
    assert_eq!(rockfall.read("state.csv").lines().count(), 3);
    assert_eq!(rockfall.read("trace.csv").lines().count(), 7);
}

#[test]
fn check_warns_of_suspicious_lines_and_of_stiff_springs_and_contacts() {
    let scene = "S 1 0 0 0 0 0 0 0 0 0 1 1\nS 2 5 0 0 0 0 0 0 0 0 1 1\nK 1 2 12000 5 0\ngravity 3\nset friction 7\n";
    let rockfall = Rockfall::with(scene);
    let (out, err) = rockfall.run("check scene.txt", 0);
    assert_eq!(err, "");
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(lines[0], "scene.txt: 2 spheres, 1 spring, 1 comment");
    assert_eq!(lines[1], "set friction 7");
    assert!(lines[2].starts_with("warning: scene.txt:4: taken for a comment"), "{out}");
    assert_eq!(lines[3], "precision single");
    // dt² (12000 + 12000) <= 8.
    assert!(
        lines[4].contains("the spring from sphere 1 to sphere 2, with all others at its ends, is too stiff")
            && lines[4].contains("it is unstable")
            && lines[4].ends_with("0.0182 s"),
        "{out}"
    );
    assert_eq!(lines[5], "rockfall run --substeps 2 makes the time step short enough for springs and contacts");
    assert_eq!(lines[6], "suggestion: --dt 0.016 (s)");
    assert_eq!(lines[7], "no overlaps at the start");
    assert!(lines[8].starts_with("note: scene.txt: sphere 1 will fall for ever"), "{out}");
    assert_eq!(lines.len(), 9, "{out}");
    let (out, _) = rockfall.run("check scene.txt --dt 0.0182", 0);
    assert!(out.contains("stable at a time step of 0.0182 s (rk4)"), "{out}");
    let (out, _) = rockfall.run("check scene.txt --dt 0.0182 --integrator symplectic-euler", 0);
    // dt² 24000 <= 1 without damping.
    assert!(out.contains("the largest time step that works is 0.00645 s"), "{out}");
    let (out, _) = rockfall.run("check scene.txt --dt 0.0182 --integrator velocity-verlet", 0);
    assert!(out.contains("the largest time step that works is 0.00645 s"), "{out}");
    let (out, _) = rockfall.run("check scene.txt --dt 0.001 --set contact_force=1e8", 0);
    assert!(out.contains("the contact force is too stiff"), "{out}");
    // `run` prints the same warnings.
    let (_, err) = rockfall.run("run scene.txt --backend cpu --steps 1 --json", 0);
    assert!(
        err.starts_with("warning: scene.txt:4: ") && err.contains("the spring from sphere 1 to sphere 2, with all others"),
        "{err}"
    );
}

/// Eight marbles in SI units over a plate that is thinner than the distance that they move in a step.
fn marbles() -> String {
    let mut scene = String::from("set gravity 9.81\nB -1 -0.001 -1 2 0 0 0 0.001 0 0 0 2\n");
    for ball in 0..8 {
        scene += &format!("S {ball} 0 {} 0 0 0 0 0 0 0 0.01 0.005 0\n", 0.01 + 0.02 * f64::from(ball));
    }
    scene
}

#[test]
fn check_and_run_warn_of_sinking_and_of_tunnelling() {
    let rockfall = Rockfall::with(&marbles());
    let (out, _) = rockfall.run("check scene.txt", 0);
    let (_, err) = rockfall.run("run scene.txt --backend cpu --steps 1", 0);
    for text in [&out, &err] {
        let sinks = "warning: scene.txt: bodies at rest overlap by 0.00981 (gravity / contact_force), 196 % of the smallest radius 0.005";
        assert!(text.contains(sinks) && text.contains("`set resting_overlap 0.02`"), "{text}");
        // A fall of 0.145 m gives 1.687 m/s. The plate and a marble stop a body that moves at most 0.0055 per step.
        let passes = "bodies may reach 1.69 units/s, 0.0337 units a step, and pass through box number 0";
        assert!(text.contains(passes) && text.contains("the largest time step that works is 0.00326 s"), "{text}");
    }
    let (out, _) = rockfall.run("check scene.txt --set resting_overlap=0.02 --dt 0.0001", 0);
    assert!(!out.contains("warning") && out.contains("chosen for resting_overlap 0.02"), "{out}");
}

#[test]
fn substeps_equal_a_shorter_time_step() {
    let rockfall = Rockfall::with(SCENE);
    let run = |arguments: &str| rockfall.run(&format!("run scene.txt --backend cpu {arguments}"), 0).0;
    let divided = run("--steps 100 --substeps 4 --out a.csv --trace t.csv");
    assert!(divided.contains("100 of 0.02 s = 2 s in 4 parts each,"), "{divided}");
    run("--steps 400 --dt 0.005 --out b.csv --trace u.csv");
    assert_eq!(rockfall.read("a.csv"), rockfall.read("b.csv"), "the same steps");
    // The trace has every fourth line of the finer trace, with the collisions of all four parts.
    let lines = |name: &str| -> Vec<Vec<String>> {
        let text = rockfall.read(name);
        text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let (coarse, fine) = (lines("t.csv"), lines("u.csv"));
    assert_eq!((coarse.len(), fine.len()), (101, 401));
    let mut collisions = 0;
    for (step, line) in coarse.iter().enumerate() {
        assert_eq!(line[0], step.to_string());
        assert_eq!(line[1..14], fine[4 * step][1..14]);
        let of_parts = fine[(4 * step).saturating_sub(3)..=4 * step].iter().map(|line| line[14].parse::<u64>().unwrap());
        assert_eq!(line[14].parse::<u64>().unwrap(), of_parts.sum::<u64>());
        collisions += line[14].parse::<u64>().unwrap();
    }
    assert!(collisions > 0);
    // Frames count whole steps.
    run("--steps 50 --substeps 4 --out frames.csv --every 25");
    let frames = rockfall.read("frames.csv");
    let steps: Vec<&str> = frames.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(steps, ["0", "0", "25", "25", "50", "50"]);
}

#[test]
fn auto_chooses_the_smallest_stable_number_of_substeps() {
    let rockfall = Rockfall::with("");
    rockfall.run("generate pile --spheres 30 --out scene.txt", 0);
    let substeps = |arguments: &str| -> u64 {
        let (out, err) = rockfall.run(&format!("run scene.txt --backend cpu --steps 2 --substeps auto --json {arguments}"), 0);
        assert_eq!(err, "");
        let object: Value = serde_json::from_str(&out).unwrap();
        assert_eq!((&object["steps"], &object["dt"]), (&Value::from(2), &Value::from(0.02)));
        object["substeps"].as_u64().unwrap()
    };
    assert_eq!(substeps(""), 1);
    // The limit is dt² Cc <= 0.5: 0.02 / sqrt(0.5 / 4000) = 1.8, and 5.7 for Cc = 40000.
    assert_eq!(substeps("--set contact_force=4000"), 2);
    assert_eq!(substeps("--set contact_force=40000"), 6);
    assert!(substeps("--set gravity=5 --set resting_overlap=0.02") > 2);
    for bad in ["0", "-1", "many", "2000000"] {
        let (_, err) = rockfall.run(&format!("run scene.txt --substeps {bad}"), 2);
        assert!(err.contains("or auto"), "{err}");
    }
}

#[test]
fn generated_scenes_are_valid_and_run() {
    let rockfall = Rockfall::with("");
    for kind in ["pile", "mixed", "soft", "chain", "hopper"] {
        rockfall.run(&format!("generate {kind} --spheres 200 --seed 3 --out {kind}.txt"), 0);
        let (out, _) = rockfall.run(&format!("check {kind}.txt"), 0);
        assert!(out.contains(": 200 spheres") && !out.contains("warning"), "{out}");
        let (out, _) = rockfall.run(&format!("run {kind}.txt --backend cpu --steps 50 --json"), 0);
        let object: Value = serde_json::from_str(&out).unwrap();
        assert_eq!(object["objects"]["spheres"], 200);
        let (out, _) = rockfall.run(&format!("generate {kind} --spheres 200 --seed 3"), 0);
        assert_eq!(out, rockfall.read(&format!("{kind}.txt")));
        let (other, _) = rockfall.run(&format!("generate {kind} --spheres 200 --seed 4"), 0);
        assert!(out.lines().skip(1).ne(other.lines().skip(1)), "{kind}");
    }
    let runs = [("drum", "dt=0.00001", "steps=50000 speed=0.125"), ("column", "dt=0.00004", "steps=25000 speed=0.25")];
    for (kind, dt, length) in runs {
        rockfall.run(&format!("generate {kind} --spheres 200 --seed 3 --out {kind}.txt"), 0);
        let text = rockfall.read(&format!("{kind}.txt"));
        let line = format!("\n@run {dt} integrator=velocity-verlet {length}\n");
        assert!(text.contains(&line), "the file says how it is run: {text}");
        let (out, _) = rockfall.run(&format!("check {kind}.txt"), 0);
        assert!(out.contains(": 200 spheres") && !out.contains("warning"), "{out}");
        let (_, err) = rockfall.run(&format!("run {kind}.txt --backend cpu --steps 50"), 0);
        assert_eq!(err, "", "{kind}");
    }
    let (out, _) = rockfall.run("generate pile --spheres 1", 0);
    let (out, _) = rockfall.run_with_input("check -", out.as_bytes(), 0);
    assert!(out.contains(": 1 sphere, 5 boxes"), "{out}");
}

/// A tetrahedron as an OBJ file, without its last face unless `closed`.
fn tetrahedron(closed: bool) -> String {
    let faces = "v 0 0 0\nv 30 0 0\nv 0 30 0\nv 0 0 30\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
    format!("{faces}{}", if closed { "f 2 3 4\n" } else { "" })
}

#[test]
fn a_mesh_becomes_a_clump_that_falls() {
    let rockfall = Rockfall::with("");
    fs::write(rockfall.path("rock.obj"), tetrahedron(true)).unwrap();
    fs::write(rockfall.path("open.obj"), tetrahedron(false)).unwrap();
    let command = "generate clump rock.obj --spheres 30 --scale 0.1 --density 2 --min-radius 0.05 --overlap 0.5 --cells 50000";
    let (_, err) = rockfall.run(&format!("{command} --out clump.txt"), 0);
    assert!(err.contains("30 spheres with radii from") && err.contains("volume of the spheres: -"), "{err}");
    let text = rockfall.read("clump.txt");
    // The volume is 27 / 6.
    assert!(text.contains("@body clump mass=9 centre=0.75,0.75,0.75 inertia="), "{text}");
    assert!(text.contains("# volume of the spheres: -"), "{text}");
    let (out, _) = rockfall.run("check clump.txt", 0);
    assert!(out.contains("30 spheres") && !out.contains("warning"), "{out}");
    let (_, err) = rockfall.run("run clump.txt --backend cpu", 0);
    assert_eq!(err, "");
    assert_eq!(rockfall.run(command, 0).0, text);
    for (command, message) in [
        ("open.obj --spheres 3", "open.obj: mesh: "),
        ("open.obj --spheres 3", "not closed, with 3 open edges"),
        ("rock.obj --spheres 0", "spheres: 0 is not allowed, expected a whole number from 1 to 1000"),
        ("rock.obj --spheres 4000000000", "spheres: 4000000000 is not allowed"),
        ("rock.obj --spheres 3 --overlap 1", "overlap: 1 is not allowed"),
        ("rock.obj --spheres 3 --min-radius 40", "less than the radius of the largest sphere"),
    ] {
        let (_, err) = rockfall.run(&format!("generate clump {command}"), 2);
        assert!(err.contains(message), "{command}: {err}");
    }
}

#[test]
fn devices_always_lists_the_cpu() {
    let (out, _) = Rockfall::with("").run("devices", 0);
    assert!(out.contains("cpu  ") && out.contains("gpu "), "{out}");
}

/// The number that `devices` shows chooses the device.
#[test]
fn a_device_is_chosen_by_its_number() {
    let rockfall = Rockfall::with("S 1 0 0 0 0 0 0 0 0 0 1 0.1\n");
    let (out, _) = rockfall.run("devices", 0);
    let name = out.lines().find_map(|line| line.strip_prefix("gpu 0  ")).expect("a device").to_owned();
    let (out, _) = rockfall.run("run scene.txt --steps 1 --device 0 --json", 0);
    let found: Value = serde_json::from_str(&out).unwrap();
    let device = found["device"].as_str().unwrap_or_default();
    assert!(!device.is_empty() && name.starts_with(device.split(" (").next().unwrap()), "{name}: {found}");
    let (_, err) = rockfall.run("run scene.txt --steps 1 --device 7", 1);
    assert!(err.contains("there is no GPU 7, `rockfall devices` lists"), "{err}");
    let (_, err) = rockfall.run("run scene.txt --steps 1 --device 0 --backend cpu", 2);
    assert!(err.contains("device: 0 is not allowed, expected no device with the backend cpu"), "{err}");
}

#[test]
fn completions_and_manual_pages_are_printed() {
    let rockfall = Rockfall::with("");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (out, err) = rockfall.run(&format!("completions {shell}"), 0);
        assert!(out.contains("rockfall") && out.contains("generate") && out.contains("substeps"), "{shell}: {out}");
        assert_eq!(err, "");
    }
    let (out, _) = rockfall.run("man", 0);
    assert!(out.contains(".TH rockfall 1") && out.contains("generate"), "{out}");
    let (out, _) = rockfall.run("man run", 0);
    assert!(out.contains(".TH rockfall-run 1") && out.contains("substeps"), "{out}");
    let (_, err) = rockfall.run("man nothing", 2);
    assert!(err.contains("unknown command nothing: expected one of run, check"), "{err}");
    rockfall.run("completions csh", 2);
}

#[test]
fn help_and_version_exit_with_code_0() {
    let rockfall = Rockfall::with("");
    let (out, _) = rockfall.run("run --help", 0);
    for option in
        ["--steps", "--dt", "--backend", "--integrator", "--broad-phase", "--set", "--out", "--trace", "--json", "--substeps"]
    {
        assert!(out.contains(option), "{option}: {out}");
    }
    for (command, text) in
        [("help", "Simulate a scene and print a summary"), ("help run", "--checkpoint-every"), ("help help", "help")]
    {
        let (out, err) = rockfall.run(command, 0);
        assert!(out.contains("Usage: rockfall") && out.contains(text) && err.is_empty(), "{command}: {out}");
    }
    rockfall.run("help nothing", 2);
    let (out, _) = rockfall.run("--version", 0);
    assert_eq!(out, concat!("rockfall ", env!("ROCKFALL_VERSION"), "\n"));
}

#[test]
fn a_closed_standard_output_is_not_an_error() {
    let rockfall = Rockfall::with(SCENE);
    for arguments in [
        "run scene.txt --backend cpu --steps 5",
        "run scene.txt --backend cpu --steps 5 --json",
        "check scene.txt",
        "devices",
        "generate pile --spheres 20000",
    ] {
        let mut child = rockfall.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), err.as_str()), (Some(0), ""), "{arguments}");
    }
}

/// Requests a graphics API that the system does not have: DX12 on macOS, Metal elsewhere.
#[cfg(feature = "gpu")]
#[test]
fn without_an_adapter_gpu_fails_and_auto_uses_the_cpu() {
    let rockfall = Rockfall::with(SCENE);
    let foreign = if cfg!(target_os = "macos") { "dx12" } else { "metal" };
    let run = |arguments: &str, code| {
        finish(rockfall.command(arguments).env("WGPU_BACKEND", foreign).output().unwrap(), arguments, code)
    };
    let (_, err) = run("run scene.txt --steps 1 --backend gpu", 1);
    assert!(err.contains("no usable GPU") && err.contains("--backend cpu"), "{err}");
    run("generate pile --spheres 80 --out many.txt", 0);
    for (scene, reason) in [("many.txt", "no hardware GPU was found"), ("scene.txt", "faster than a GPU for up to 64 spheres")]
    {
        let (out, _) = run(&format!("run {scene} --steps 1"), 0);
        assert!(out.contains("cpu: CPU") && out.contains(reason), "{out}");
    }
}

/// Compares the output of the first command in the README, except for the speed and the repeated steps. On other systems, the mathematical library may
/// round sines differently.
#[test]
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
fn the_readme_shows_the_output_of_its_first_command() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let readme = fs::read_to_string(format!("{root}/README.md")).unwrap();
    let shown = readme.split("```text\n").nth(1).and_then(|rest| rest.split("\n```").next()).expect("a block of text");
    let (out, _) = Rockfall::with("").run(&format!("run {root}/scenes/bridge.txt --steps 500 --backend cpu"), 0);
    let lines = |text: &str| -> Vec<String> {
        // The number of repeated steps depends on how many steps are submitted at once, and so on the speed of the machine.
        let lines =
            text.lines().skip_while(|line| !line.starts_with("  objects")).filter(|line| !line.starts_with("  replays"));
        lines.map(|line| line.split(", done in").next().unwrap_or_default().trim_end().to_owned()).collect()
    };
    assert!(lines(shown).len() > 10, "{shown}");
    assert_eq!(lines(shown), lines(out.trim_end()));
}
