//! `rockfall bench` with the real binary, on scenes of a few spheres.

use std::collections::BTreeSet;
use std::process::Command;

use serde_json::Value;

/// Runs `rockfall bench` with further arguments, checks the exit code and returns standard output.
#[track_caller]
fn bench(arguments: &str, code: i32) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_rockfall")).arg("bench").args(arguments.split_whitespace()).output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments}\n{err}");
    assert!(!err.contains("panicked"), "{arguments}\n{err}");
    String::from_utf8(output.stdout).unwrap()
}

fn keys(value: &Value) -> BTreeSet<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

fn words(text: &str) -> BTreeSet<&str> {
    text.split_whitespace().collect()
}

const PHASES: &str = "aabb_update collision_detection collision_response forces_and_integration";

#[track_caller]
fn check_json(backend: &str) {
    let out = bench(&format!("lattice --spheres 27,64 --steps 40 --runs 2 --warmup 2 --backend {backend} --json"), 0);
    let object: Value = serde_json::from_str(&out).unwrap();
    let expected = "version commit scene without backend device driver integrator broad_phase dt steps warmup runs seed \
                    copy_bytes_per_second sizes";
    assert_eq!(keys(&object), words(expected));
    assert_eq!(object["backend"], backend);
    assert_eq!(object["commit"], option_env!("ROCKFALL_COMMIT").map_or(Value::Null, Value::from));
    assert_eq!(object["dt"], 0.02);
    assert!(object["copy_bytes_per_second"].as_f64().unwrap() > 1e6, "{out}");
    assert_eq!(object["sizes"].as_array().unwrap().len(), 2);
    let size = &object["sizes"][1];
    let expected = "bodies broad_phase objects seconds steps_per_second sphere_steps_per_second memory_bytes memory_bytes_per_sphere \
                    buffers least_bytes_per_sphere_step bandwidth_used contacts collisions replays list_builds \
                    steps_with_warmup profile";
    assert_eq!(keys(size), words(expected));
    assert_eq!(size["objects"]["spheres"], 64);
    for spread in ["seconds", "steps_per_second", "sphere_steps_per_second"] {
        let number = |key: &str| size[spread][key].as_f64().unwrap();
        assert!(0.0 < number("min") && number("min") <= number("median") && number("median") <= number("max"));
    }
    let buffers = size["buffers"].as_object().unwrap();
    let sum: u64 = buffers.values().map(|bytes| bytes.as_u64().unwrap()).sum();
    assert_eq!(size["memory_bytes"].as_u64(), Some(sum));
    // The lattice starts with 3 n² (n - 1) contacts, n = 4; some may have opened since.
    assert!(size["contacts"].as_u64().unwrap() > 0);
    assert!(size["least_bytes_per_sphere_step"].as_f64().unwrap() > 500.0);

    let profile = &size["profile"];
    assert_eq!(keys(profile), words("clock steps seconds rejected_seconds phase_seconds_per_step stages"));
    assert_eq!(profile["steps"], 40);
    let phases = &profile["phase_seconds_per_step"];
    assert_eq!(keys(phases), words(PHASES));
    let mut sums = [0.0; 4];
    for stage in profile["stages"].as_array().unwrap() {
        assert_eq!(keys(stage), words("name phase runs seconds least_bytes"));
        assert!(stage["runs"].as_u64().unwrap() >= 40, "{stage}");
        let phase = words(PHASES).into_iter().position(|phase| stage["phase"] == phase).unwrap();
        sums[phase] += stage["seconds"].as_f64().unwrap() / 40.0;
    }
    for (phase, sum) in words(PHASES).into_iter().zip(sums) {
        let reported = phases[phase].as_f64().unwrap();
        assert!(reported > 0.0 && (reported - sum).abs() < 1e-6 * sum, "{phase}: {reported} and {sum}");
    }
}

/// Worlds side by side are measured with the number of stopped worlds, and their options do not mix with those of scenes.
#[test]
fn worlds_are_measured() {
    let out = bench("worlds --worlds 3,5 --spheres 8 --steps 20 --runs 2 --backend cpu --json", 0);
    let result: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&result["scene"], &result["spheres"], &result["dt"]), (&"worlds".into(), &8.into(), &0.005.into()));
    let sizes = result["sizes"].as_array().unwrap();
    assert_eq!(sizes.iter().map(|size| size["worlds"].as_u64()).collect::<Vec<_>>(), [Some(3), Some(5)]);
    for size in sizes {
        assert!(size["world_steps_per_second"]["median"].as_f64().unwrap() > 100.0, "{size}");
        assert_eq!((&size["stopped"], &size["path"]), (&0.into(), &"simulation".into()));
    }
    let table = bench("worlds --worlds 2 --spheres 20 --steps 5 --runs 1 --backend cpu --collisions", 0);
    assert!(table.starts_with("rockfall bench worlds, 20 spheres and 60 springs with muscles each, ground"), "{table}");
    assert!(table.contains("collisions and contact forces, rk4: CPU"), "{table}");
    let out = bench("worlds --creatures 2 --spheres 8 --steps 5 --runs 1 --backend cpu --contacts ground --json", 0);
    let result: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&result["contacts"], &result["sizes"][0]["worlds"]), (&"ground".into(), &2.into()));
    for wrong in ["worlds --contacts none", "worlds --warmup 3", "worlds --worlds 0", "--spheres 8 worlds"] {
        bench(wrong, 2);
    }
}

#[track_caller]
fn check_drum(backend: &str) {
    let options = "--steps 40 --warmup 10 --runs 2 --turn-every 15 --rpm 60 --radius 0.003 --dt 2e-5";
    let out = bench(&format!("drum --grains 60,200 {options} --backend {backend} --json"), 0);
    let result: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&result["scene"], &result["backend"], &result["dt"]), (&"drum".into(), &backend.into(), &2e-5.into()));
    assert_eq!((&result["turn_every"], &result["integrator"]), (&15.into(), &"velocity-verlet".into()));
    let sizes = result["sizes"].as_array().unwrap();
    for (size, grains) in sizes.iter().zip([60, 200]) {
        assert_eq!((&size["objects"]["spheres"], &size["objects"]["polygons"]), (&grains.into(), &48.into()));
        assert!(size["sphere_steps_per_second"]["median"].as_f64().unwrap() > 100.0, "{size}");
        assert!(size["memory_bytes_per_sphere"].as_f64().unwrap() > 200.0, "{size}");
        assert!(size["profile"]["steps"] == 40, "{size}");
    }
    // The volume of the drum is proportional to the number of grains.
    let radius = |place: usize| result["drum_radii"][place].as_f64().unwrap();
    assert!((radius(1) / radius(0) - (200.0_f64 / 60.0).cbrt()).abs() < 0.25, "{out}");
}

/// The drum turns: 90 steps at 60 revolutions per minute are 0.6 degrees. Wrong options are refused.
#[test]
fn a_drum_is_measured() {
    check_drum("cpu");
    let table = bench("drum --grains 50 --steps 40 --warmup 10 --runs 2 --rpm 60 --dt 2e-5 --backend cpu --facets 12", 0);
    assert!(
        table.starts_with("rockfall bench drum, hertz-mindlin, rolling model c, velocity-verlet, 12 polygons, 60 rev"),
        "{table}"
    );
    assert!(table.contains("50 grains: turned by 0.6 degrees in 0.002 s, "), "{table}");
    for wrong in
        ["drum --grains 0", "drum --turn-every 0", "drum --facets 3", "drum --integrator rk4", "drum --rpm x", "--rpm 3 thesis"]
    {
        bench(wrong, 2);
    }
}

#[test]
#[cfg(feature = "gpu")]
fn a_drum_is_measured_on_the_gpu() {
    check_drum("gpu");
}

#[test]
fn json_has_all_keys_on_the_cpu() {
    check_json("cpu");
}

#[test]
#[cfg(feature = "gpu")]
fn json_has_all_keys_on_the_gpu() {
    check_json("gpu");
}

#[test]
fn every_scene_has_a_table_with_its_phases() {
    for scene in ["thesis", "lattice", "pile", "settled", "shuffled", "mixed", "radii"] {
        let out = bench(
            &format!("{scene} --spheres 40 --steps 5 --runs 1 --warmup 5 --backend cpu --integrator symplectic-euler"),
            0,
        );
        for line in [
            "AABB update",
            "Collision detection",
            "Collision response",
            "Force calculations & integration",
            "  symplectic_euler",
            "sphere-steps/s",
        ] {
            assert!(out.contains(line), "{scene} {line}: {out}");
        }
    }
}

#[test]
fn the_chart_has_a_bar_for_each_phase_of_each_size() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bench.svg");
    let sizes = "8,27,64";
    bench(&format!("--spheres {sizes} --steps 3 --runs 1 --backend cpu --plot {}", file.display()), 0);
    let text = std::fs::read_to_string(file).unwrap();
    let svg = roxmltree::Document::parse(&text).unwrap();
    let nodes = || svg.descendants();
    let texts: Vec<&str> = nodes().filter_map(|node| node.text()).map(str::trim).collect();
    for label in [
        "AABB update",
        "Collision detection",
        "Collision response",
        "Force calculations & integration",
        "Whole step, without timestamps",
        "spheres",
        "ms per step",
        "8",
        "27",
        "64",
    ] {
        assert!(texts.contains(&label), "{label}: {texts:?}");
    }
    // One bar for each of the three sizes and one in the legend.
    for colour in ["#4477AA", "#66CCEE", "#CCBB44", "#EE6677"] {
        let bars = nodes().filter(|node| node.tag_name().name() == "rect" && node.attribute("fill") == Some(colour));
        assert_eq!(bars.count(), 4, "{colour}: {text}");
    }
    // The whole step also has three lines and one in the legend. They are wider than an axis.
    let wide = nodes().filter(|node| node.tag_name().name() == "polyline" && node.attribute("stroke-width") == Some("2"));
    assert_eq!(wide.count(), 4, "{text}");
}

/// Every benchmark and every kind of generated scene.
#[test]
fn all_scenes_repeat_on_the_cpu() {
    let out = bench("repeat --spheres 120 --steps 20 --every 10 --runs 2 --backend cpu", 0);
    assert_eq!(out.lines().count(), 22, "{out}");
    assert!(out.lines().all(|line| line.contains(": 2 equal runs, state ")), "{out}");
}

/// In these scenes the device repeats steps by itself, and the host repeats some for more room.
#[test]
fn states_and_schedules_repeat_on_the_gpu() {
    let out = bench("repeat pile mixed generate:clumps --spheres 700 --steps 60 --runs 3 --backend gpu", 0);
    assert_eq!(out.lines().filter(|line| line.contains(": 3 equal runs, state ")).count(), 3, "{out}");
    bench("repeat heap.txt --backend cpu", 2);
    bench("repeat pile --runs 1", 2);
}

/// Forty bricks fall for a second, on both backends.
#[test]
fn frames_of_hard_contacts_are_measured() {
    for backend in ["cpu", "gpu"] {
        let arguments = format!("frames --bodies 40 --warmup 50 --frames 5 --runs 2 --backend {backend}");
        let table = bench(&arguments, 0);
        assert!(table.contains("substeps") && table.lines().any(|line| line.starts_with("40        8 ")), "{table}");
        let object: Value = serde_json::from_str(&bench(&format!("{arguments} --json"), 0)).expect("an object");
        assert!(object["bodies"] == 40 && object["substeps"] == 8 && object["lost"] == 0, "{object}");
        assert!(object["contacts"].as_u64() > Some(20) && object["overlap_p99"].as_f64() < Some(0.05), "{object}");
    }
    bench("frames --bodies 0", 2);
    bench("frames heap", 2);
}

#[test]
fn wrong_arguments_exit_with_code_2() {
    for arguments in [
        "heap",
        "--spheres 0",
        "--spheres x",
        "--spheres -1",
        "--plot chart.png",
        "--steps 0",
        "--runs 0",
        "--dt 0",
        "--backend abacus",
        "--broad-phase none",
    ] {
        bench(arguments, 2);
    }
    bench("--spheres 8 --steps 1 --runs 1 --backend cpu --plot /no/such/folder/chart.svg", 1);
}
