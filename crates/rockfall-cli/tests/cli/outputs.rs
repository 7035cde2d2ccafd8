//! Names of output files, the facts in the summary, and the scene that `--save` writes.

use std::fs;

use serde_json::Value;

use crate::common::{Rockfall, mixed};

/// A ball over a floor, with settings and comments.
const SCENE: &str = "# One ball\nset gravity 9\nset restitution 0.25 # soft\nprose\n\nS 17 0 0.7 0 0 0 0 0 0 0 2 0.5\n\
                     B -5 -1 -5 10 0 0 0 1 0 0 0 10\n";

#[test]
fn an_unknown_extension_is_an_error_that_lists_the_known_ones() {
    let rockfall = Rockfall::with(SCENE);
    let states = "expected a name that ends in .csv, .npz or .vtp";
    let series = "expected a name that ends in .csv, .npz, .pvd or .vtp";
    let cases = [
        ("run scene.txt --out final.vtu", format!("--out final.vtu: unknown extension .vtu, {states}")),
        ("run scene.txt --out final", format!("--out final: a name without an extension, {states}")),
        ("run scene.txt --out final.txt --every 2", format!("--out final.txt: unknown extension .txt, {series}")),
        ("run scene.txt --out final.pvd", "--out: a .pvd file holds a series of states, expected --every K".to_owned()),
        ("run scene.txt --contacts c.PNG", format!("--contacts c.PNG: unknown extension .PNG, {states}")),
        ("run scene.txt --contacts c.PVD", "--contacts: a .pvd file holds a series".to_owned()),
        ("run scene.txt --trace t.npz", "--trace t.npz: unknown extension .npz, expected a name that ends in .csv".to_owned()),
        ("run scene.txt --save s.csv", "--save s.csv: unknown extension .csv, expected a name that ends in .txt".to_owned()),
        ("run scene.txt --save s.vtp", "--save s.vtp: unknown extension .vtp, expected a name that ends in .txt".to_owned()),
        (
            "run scene.txt --checkpoint c.npz",
            "--checkpoint c.npz: unknown extension .npz, expected a name that ends in .ckpt".to_owned(),
        ),
        ("run scene.txt --out -", format!("--out -: a name without an extension, {states}")),
        ("bench --plot chart.png", "--plot chart.png: unknown extension .png, expected a name that ends in .svg".to_owned()),
        (
            "generate pile --spheres 3 --out p.csv",
            "--out p.csv: unknown extension .csv, expected a name that ends in .txt".to_owned(),
        ),
    ];
    for (command, message) in cases {
        let (out, err) = rockfall.run(command, 2);
        assert!(err.starts_with(&format!("error: {message}")), "{command}: {err}");
        assert_eq!(out, "");
    }
    assert_eq!(fs::read_dir(rockfall.folder.path()).unwrap().count(), 1, "nothing is written");
}

/// The fields of a ball at rest on a floor: its mass, and the balance of momentum.
#[test]
fn fields_of_a_checkpoint_and_of_a_scene_are_written() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --steps 4000 --dt 0.01 --checkpoint rest.ckpt", 0);
    let (out, _) = rockfall.run("fields rest.ckpt --width 0.4 --spacing 0.1 --out rest.csv", 0);
    assert!(out.contains("smoothing   gaussian, width 0.4 units"), "{out}");
    let share =
        out.split("weight is ").nth(1).and_then(|rest| rest.split(' ').next()).and_then(|number| number.parse::<f64>().ok());
    assert!(share.expect("the balance of momentum") < 1.0, "{out}");
    let table = fs::read_to_string(rockfall.path("rest.csv")).unwrap();
    let mut lines = table.lines();
    let place = lines.next().unwrap().split(',').position(|name| name == "density").unwrap();
    let density: f64 = lines.map(|line| line.split(',').nth(place).unwrap().parse::<f64>().unwrap()).sum();
    assert!((density * 1e-3 - 2.0).abs() < 0.01, "mass {}", density * 1e-3);
    let (out, _) = rockfall.run("fields scene.txt --kernel heaviside --spacing 0.05 --out start.npz", 0);
    assert!(out.contains("pressure    at most 0.0000e0"), "no contact at the start: {out}");
    assert!(fs::read(rockfall.path("start.npz")).unwrap().starts_with(b"PK"));
    for (command, message) in [
        (
            "fields scene.txt --out f.vtp",
            "--out f.vtp: unknown extension .vtp, expected a name that ends in .vti, .npz or .csv",
        ),
        ("fields scene.txt --width -1", "--width: -1 is not allowed, expected a finite number greater than 0"),
        ("fields scene.txt --spacing 0", "--spacing: 0 is not allowed, expected a finite number greater than 0"),
        ("fields none.txt", "none.txt: "),
    ] {
        let (_, err) = rockfall.run(command, 2);
        assert!(err.starts_with(&format!("error: {message}")), "{command}: {err}");
    }
}

#[test]
fn extensions_may_be_upper_case() {
    let rockfall = Rockfall::with(SCENE);
    let files = "--out A.CSV --trace T.Csv --contacts C.NPZ --save S.TXT --checkpoint R.CKPT";
    rockfall.run(&format!("run scene.txt --backend cpu --steps 3 {files}"), 0);
    rockfall.run("run scene.txt --backend cpu --steps 3 --out B.NPZ --contacts C.VTP", 0);
    rockfall.run("run scene.txt --backend cpu --steps 3 --out F.PVD --every 1 --contacts G.VTP", 0);
    rockfall.run("generate pile --spheres 3 --out P.TXT", 0);
    for name in ["A.CSV", "B.NPZ", "C.NPZ", "C.VTP", "F.pvd", "G.pvd", "P.TXT", "R.CKPT", "S.TXT", "T.Csv"] {
        assert!(rockfall.path(name).exists(), "{name}");
    }
    assert!(fs::read(rockfall.path("B.NPZ")).unwrap().starts_with(b"PK"));
}

#[cfg(feature = "view")]
#[test]
fn extensions_of_pictures_may_be_upper_case() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("render scene.txt --backend cpu --size 32x24 --out A.PNG", 0);
    rockfall.run("render scene.txt --backend cpu --size 32x24 --steps 4 --out B.GIF", 0);
    assert!(fs::read(rockfall.path("A.PNG")).unwrap().starts_with(b"\x89PNG"));
    assert!(fs::read(rockfall.path("B.GIF")).unwrap().starts_with(b"GIF8"));
    let (_, err) = rockfall.run("render scene.txt --out a.bmp", 2);
    assert!(err.starts_with("error: --out a.bmp: unknown extension .bmp, expected a name that ends in .png, "), "{err}");
    let (_, err) = rockfall.run("render scene.txt --size 999999x10 --out a.png", 2);
    assert!(err.contains("a picture of 999999x10 pixels cannot be drawn, expected sides from 1 to "), "{err}");
}

/// Devices and pipes have no extension. They get CSV, and scenes.
#[cfg(unix)]
#[test]
fn devices_need_no_extension() {
    let rockfall = Rockfall::with(SCENE);
    let (out, _) = rockfall.run("run scene.txt --backend cpu --steps 2 --json --trace /dev/stdout", 0);
    assert!(out.starts_with("step,time,kinetic"), "{out}");
    let (out, _) = rockfall.run("run scene.txt --backend cpu --steps 2 --json --out /dev/stdout --save /dev/null", 0);
    assert!(out.starts_with("sphere,x,y,z,"), "{out}");
}

fn object(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn json_has_energies_overlap_settings_and_integrator() {
    let rockfall = Rockfall::with(SCENE);
    let run = "run scene.txt --backend cpu --steps 400 --integrator symplectic-euler --set linear_damping=0.1";
    let (out, err) = rockfall.run(&format!("{run} --json --trace t.csv --out s.csv"), 0);
    assert_eq!(err, "");
    assert!(!out.contains("-0.0"), "{out}");
    let object = object(&out);
    assert_eq!(object["integrator"], "symplectic-euler");
    assert_eq!((&object["dt"], &object["time"], &object["comments"]), (&0.02.into(), &8.0.into(), &2.into()));
    let settings = object["settings"].as_object().unwrap();
    let names: Vec<&str> = settings.keys().map(String::as_str).collect();
    let mut known = rockfall::Settings::NAMES.to_vec();
    known.sort_unstable();
    assert_eq!(names, known);
    assert_eq!((&settings["gravity"], &settings["linear_damping"]), (&9.0.into(), &0.1.into()));
    assert_eq!(settings["gravity_direction"], serde_json::json!([0.0, -1.0, 0.0]));
    assert_eq!((&settings["collisions"], &settings["contact_pull"]), (&true.into(), &false.into()));

    // The energies are those of the first and the last line of the trace.
    let trace = rockfall.read("t.csv");
    for (key, line) in [("energy_start", trace.lines().nth(1)), ("energy_end", trace.lines().last())] {
        let columns: Vec<f64> = line.unwrap().split(',').take(15).map(|field| field.parse().unwrap()).collect();
        let energy = &object[key];
        let mut total = 0.0;
        for (column, name) in ["kinetic", "potential", "spring", "contact"].iter().enumerate() {
            let found = energy[name].as_f64().unwrap();
            assert!((found - columns[2 + column]).abs() <= 1e-14 * found.abs(), "{key} {name}: {found}");
            total += columns[2 + column];
        }
        assert!((energy["total"].as_f64().unwrap() - total).abs() < 1e-12, "{energy}");
        assert_eq!(energy.as_object().unwrap().len(), 5);
    }
    let potential = object["energy_start"]["potential"].as_f64().unwrap();
    assert!((potential - 2.0 * 9.0 * f64::from(0.7_f32)).abs() < 1e-12, "{potential}");

    // The ball lies on the floor: m g = Cc m o, and a radius is 0.5.
    let state = rockfall.read("s.csv");
    let y: f64 = state.lines().nth(1).unwrap().split(',').nth(2).unwrap().parse().unwrap();
    let [units, radii] = ["max_overlap", "max_overlap_radii"].map(|key| object[key].as_f64().unwrap());
    assert!((units - 0.009).abs() < 1e-5 && (units - (0.5 - y)).abs() < 1e-6, "{units} {y}");
    assert!((radii - 2.0 * units).abs() < 1e-7, "{radii}");

    // The table has the same facts.
    let (out, _) = rockfall.run(run, 0);
    for text in [
        "integrator  symplectic-euler\n",
        "settings    restitution 0.25, linear_damping 0.1, contact_law thesis, gravity 9; else the default values\n",
        "comments    2 lines of the scene\n",
        " at the end, 0.018 radii",
    ] {
        assert!(out.contains(text), "{text}: {out}");
    }
}

#[test]
fn times_are_printed_as_given() {
    let rockfall = Rockfall::with(SCENE);
    for (dt, steps, substeps, last) in
        [("0.02", 300, 1, "6"), ("0.1", 3, 1, "0.3"), ("0.02", 9, 3, "0.18"), ("1e-7", 3, 1, "3e-7")]
    {
        let run = format!("run scene.txt --backend cpu --json --dt {dt} --substeps {substeps}");
        let files = "--trace t.csv --out f.csv --every 1 --contacts c.csv --checkpoint c.ckpt";
        let (out, _) = rockfall.run(&format!("{run} --steps {steps} {files}"), 0);
        assert_eq!(object(&out)["time"].as_f64(), last.parse().ok(), "{out}");
        for (name, column) in [("t.csv", 1), ("f.csv", 1)] {
            let text = rockfall.read(name);
            for line in text.lines().skip(1) {
                let fields: Vec<&str> = line.split(',').collect();
                let dt: f64 = dt.parse().unwrap();
                let expected = fields[0].parse::<f64>().unwrap() * dt;
                assert!(fields[column].len() <= 6, "{name}: {line}");
                assert!((fields[column].parse::<f64>().unwrap() - expected).abs() <= 1e-9 * expected, "{name}: {line}");
            }
            assert_eq!(text.lines().last().unwrap().split(',').nth(column), Some(last), "{name}");
        }
    }
    // Another time step from step 3 on: 3 * 0.02 + 2 * 0.005.
    rockfall.run("run scene.txt --backend cpu --dt 0.02 --steps 3 --checkpoint c.ckpt", 0);
    let (out, _) = rockfall.run("run --resume c.ckpt --steps 5 --dt 0.005 --trace t.csv --json", 0);
    assert_eq!(object(&out)["time"], 0.07);
    let trace = rockfall.read("t.csv");
    let times: Vec<&str> = trace.lines().skip(1).map(|line| line.split(',').nth(1).unwrap()).collect();
    assert_eq!(times, ["0.06", "0.065", "0.07"]);
}

/// Columns of numbers of a state file.
fn numbers(text: &str) -> Vec<f64> {
    text.lines()
        .skip(1)
        .flat_map(|line| line.split(',').take(14).map(|field| field.parse().unwrap()).collect::<Vec<_>>())
        .collect()
}

/// A run that goes on from the saved scene ends where an uninterrupted run ends.
#[test]
fn a_saved_scene_continues_the_run() {
    for settings in ["", "set resting_overlap 0.02\n@force 900 1 2 3\n@orientation 3 0 1 0 0\n"] {
        let rockfall = Rockfall::with(&(mixed(32) + settings));
        let run = "--backend cpu --dt 0.005 --set friction=20";
        rockfall.run(&format!("run scene.txt {run} --steps 100 --save half.txt --out half.csv"), 0);
        let (_, err) = rockfall.run("run half.txt --backend cpu --dt 0.005 --steps 0 --out same.csv", 0);
        assert!(!err.contains("comment"), "{err}");
        let state = |name: &str| -> Vec<String> {
            rockfall.read(name).lines().map(|line| line.split(',').take(14).collect::<Vec<_>>().join(",")).collect()
        };
        assert_eq!(state("half.csv"), state("same.csv"), "the state is kept to the last bit");
        rockfall.run("run half.txt --backend cpu --dt 0.005 --steps 50 --out parts.csv", 0);
        rockfall.run(&format!("run scene.txt {run} --steps 150 --out whole.csv"), 0);
        let [whole, parts, half] = ["whole.csv", "parts.csv", "half.csv"].map(|name| numbers(&rockfall.read(name)));
        let most = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most(&whole, &parts) < 2e-3, "{}", most(&whole, &parts));
        assert!(most(&whole, &half) > 0.1, "the bodies move");
        let text = rockfall.read("half.txt");
        assert!(
            text.starts_with("# scene.txt after 100 steps, at 0.5 s\n") && text.contains("\n@run dt=0.005 integrator=rk4\n"),
            "{text}"
        );
        assert!(text.contains("\nset friction 20\n") && text.contains("\nS 901 "), "{text}");
    }
}

/// Files that rockfall writes are not scenes, and are not read as one long comment.
#[test]
fn other_files_of_rockfall_are_named_as_what_they_are() {
    let rockfall = Rockfall::with(SCENE);
    let files = "--out a.npz --trace t.csv --contacts c.vtp --checkpoint d.ckpt";
    rockfall.run(&format!("run scene.txt --backend cpu --steps 2 {files}"), 0);
    let cases = [
        ("d.ckpt", "a checkpoint, not a scene: continue its run with `rockfall run --resume d.ckpt`"),
        ("a.npz", "an archive of arrays (.npz), not a scene"),
        ("c.vtp", "a file for ParaView and VTK, not a scene"),
        ("t.csv", "a table of results (.csv), not a scene"),
    ];
    for (file, what) in cases {
        for command in ["run", "check"] {
            let (_, err) = rockfall.run(&format!("{command} {file}"), 2);
            assert!(err.starts_with(&format!("error: {file}: this is {what}")), "{err}");
        }
    }
}

#[test]
fn a_resumed_run_saves_too_and_the_scene_is_not_overwritten() {
    let rockfall = Rockfall::with(SCENE);
    let (_, err) = rockfall.run("run scene.txt --backend cpu --steps 3 --save scene.txt", 2);
    assert!(err.contains("would overwrite the scene file"), "{err}");
    rockfall.run("run scene.txt --backend cpu --steps 30 --save whole.txt", 0);
    rockfall.run("run scene.txt --backend cpu --steps 10 --save parts.txt --checkpoint c.ckpt", 0);
    rockfall.run("run --resume c.ckpt --steps 30", 0);
    assert_eq!(rockfall.read("whole.txt"), rockfall.read("parts.txt"));
    assert!(rockfall.read("parts.txt").contains("after 30 steps, at 0.6 s"));
}

/// The comment at the beginning of the scene is kept, also by a resumed run, and by a run that goes on from the saved scene.
#[test]
fn a_saved_scene_keeps_the_title() {
    let rockfall =
        Rockfall::with(&format!("\n# A pile of balls.\n#\n#   Made for a test\nThree kinds of ball\n\n# No title.\n{SCENE}"));
    let title = "# A pile of balls.\n#\n#   Made for a test\n# Three kinds of ball\n\n";
    rockfall.run("run scene.txt --backend cpu --steps 2 --save one.txt --checkpoint c.ckpt", 0);
    let one = rockfall.read("one.txt");
    assert!(one.starts_with(&format!("{title}# scene.txt after 2 steps, at 0.04 s\n")), "{one}");
    assert!(!one.contains("No title"), "{one}");
    rockfall.run("run --resume c.ckpt --steps 3", 0);
    assert!(rockfall.read("one.txt").starts_with(&format!("{title}# scene.txt after 3 steps, at 0.06 s\n")));
    rockfall.run("run one.txt --backend cpu --steps 1 --save two.txt", 0);
    assert!(rockfall.read("two.txt").starts_with(&format!("{title}# one.txt after 1 step")), "{}", rockfall.read("two.txt"));
}
