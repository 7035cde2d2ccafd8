//! Reads trajectories with numpy and VTK and compares every value.

use std::path::Path;
use std::process::Command;

mod common;

use common::{Rockfall, mixed};

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
