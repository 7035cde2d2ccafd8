//! Reads trajectories with numpy and VTK and compares every value.

use std::path::Path;
use std::process::Command;

use crate::common::{Rockfall, mixed};

/// Path of a Python with numpy and vtk. Without one the test fails with instructions; it is never skipped.
fn python() -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/python");
    let output = Command::new(script).output().expect("scripts/python runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("a path").trim().to_owned()
}

#[test]
fn numpy_and_vtk_read_every_number_bitwise_identical() {
    let rockfall = Rockfall::with(&mixed(32));
    for out in ["frames.csv", "frames.npz", "frames.pvd"] {
        rockfall.run(&format!("run scene.txt --backend cpu --dt 0.01 --steps 50 --out {out} --every 10"), 0);
    }
    for out in ["state.csv", "state.npz", "state.vtp"] {
        rockfall.run(&format!("run scene.txt --backend cpu --dt 0.01 --steps 50 --out {out}"), 0);
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/check_trajectories.py");
    let output = Command::new(python()).arg(script).arg(rockfall.folder.path()).output().expect("Python runs");
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{out}{err}");
    assert!(out.starts_with("6 frames of "), "{out}");
}

#[test]
fn numpy_and_vtk_read_the_contacts() {
    let rockfall = Rockfall::with(&mixed(32));
    let run = "run scene.txt --backend cpu --dt 0.01 --steps 50";
    rockfall.run(&format!("{run} --every 10 --out frames.npz --contacts contacts.npz"), 0);
    for file in ["contacts.csv", "contacts.pvd"] {
        rockfall.run(&format!("{run} --every 10 --contacts {file}"), 0);
    }
    for file in ["last.csv", "last.npz", "last.vtp"] {
        rockfall.run(&format!("{run} --contacts {file}"), 0);
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/check_contacts.py");
    let output = Command::new(python()).arg(script).arg(rockfall.folder.path()).output().expect("Python runs");
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{out}{err}");
    assert!(out.contains("contacts in 6 frames"), "{out}");
}

/// Three balls of mass 2 lie on each other: the contacts bear 1, 2 and 3 of them. The file names the balls as the scene does.
#[test]
fn the_contacts_of_a_stack_bear_its_weight() {
    let mut scene = String::from("set gravity 9\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\n");
    for ball in 0..3 {
        scene += &format!("S {} 0 {} 0 0 0 0 0 0 0 2 0.5\n", 70 + ball, 0.49 + 0.98 * f64::from(ball));
    }
    let rockfall = Rockfall::with(&scene);
    for backend in if cfg!(feature = "gpu") { vec!["cpu", "gpu"] } else { vec!["cpu"] } {
        rockfall.run(&format!("run scene.txt --backend {backend} --dt 0.01 --steps 2000 --contacts last.csv"), 0);
        let text = rockfall.read("last.csv");
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let place = |name: &str| lines[0].iter().position(|column| *column == name).unwrap();
        assert_eq!(lines.len(), 4, "{text}");
        for line in &lines[1..] {
            assert_eq!((line[place("step")], line[place("time")]), ("2000", "20"));
            let [a, overlap, fx, fy]: [f64; 4] = ["a", "overlap", "fx", "fy"].map(|name| line[place(name)].parse().unwrap());
            assert_eq!(line[place("a_reference")], format!("{}", 70.0 + a), "{text}");
            // Ball A on the floor bears all three. A pair of balls bears those from B on.
            let on_floor = line[place("b_kind")] == "box";
            let (borne, sign) = if on_floor { (3.0, -1.0) } else { (2.0 - a, 1.0) };
            let normal: f64 = line[place("normal_force")].parse().unwrap();
            assert!((normal - borne * 18.0).abs() < 0.05 && line[place("state")].is_empty(), "{text}");
            assert!((fy * sign - borne * 18.0).abs() < 0.05 && fx.abs() < 1e-3, "{text}");
            assert!(overlap > 0.0 && (on_floor == line[place("b_reference")].is_empty()), "{text}");
        }
    }
}

/// A capsule lies across a slope of 0.4. With the friction 0.5 its contacts stick, and their springs hold m g sin. With 0.3 they
/// slip, and their tangential force is 0.3 times the normal force.
#[test]
fn the_contacts_of_a_law_stick_or_slip() {
    for (friction, state) in [(0.5, "stick"), (0.3, "slip")] {
        let rockfall = Rockfall::with(&format!(
            "set contact_law linear\nset gravity_direction 0.4,-1,0\n@material m\n@pair m m restitution=0.1 stiffness=1e4 \
             friction={friction}\n@use m\nB -5 -1 -5 40 0 0 0 1 0 0 0 10\nC 0 0.5 0 2 0.5 0 0 0 0 1 0.5\n"
        ));
        let run = "run scene.txt --backend cpu --integrator symplectic-euler --dt 1e-3 --steps 1000 --contacts last.csv";
        rockfall.run(run, 0);
        let text = rockfall.read("last.csv");
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let place = |name: &str| lines[0].iter().position(|column| *column == name).unwrap();
        assert!(lines.len() > 2, "{text}");
        let (mut held, mut borne) = (0.0, 0.0);
        for line in &lines[1..] {
            assert_eq!(line[place("state")], state, "{text}");
            let [fx, fy, normal, tx, ux]: [f64; 5] =
                ["fx", "fy", "normal_force", "tx", "ux"].map(|name| line[place(name)].parse().unwrap());
            // B is the box.
            assert!((normal + fy).abs() < 1e-4 && (tx - fx).abs() < 1e-4, "{text}");
            if state == "slip" {
                assert!((tx / normal - 0.3).abs() < 1e-3, "{text}");
            } else {
                // k_t = 2/7 k_n; the capsule has come to rest.
                assert!((tx - 2.0 / 7.0 * 1e4 * ux).abs() < 1e-3 * tx, "{text}");
            }
            (held, borne) = (held + tx, borne + normal);
        }
        if state == "stick" {
            assert!((held / borne - 0.4).abs() < 2e-3, "{text}");
        }
    }
}

/// `.vtp` with `--every` writes a series, as `.pvd` does, because a single `.vtp` file cannot hold several states.
#[test]
fn a_series_is_a_list_and_a_folder() {
    let rockfall = Rockfall::with(&mixed(8));
    rockfall.run("run scene.txt --backend cpu --steps 25 --out fall.vtp --every 10", 0);
    let list = rockfall.read("fall.pvd");
    assert_eq!(list.matches("<DataSet ").count(), 6);
    assert!(list.contains("timestep=\"0\" part=\"0\" file=\"fall/0000000000.vtp\""), "{list}");
    assert!(rockfall.path("fall/0000000020.vtp").exists() && rockfall.path("fall/static.vtp").exists());
    assert!(!rockfall.path("fall.vtp").exists());
}
