//! Lengths and tensions of springs, muscles and tethers on the command line.

use super::common::Rockfall;

/// A fixed ball, and below it one at the end of a muscle, of a spring at rest and of a stretched tether.
const SCENE: &str = "set gravity 0\nS 1 0 3 0 0 0 0 0 0 0 1 0.1 1\nS 2 0 1 0 0 0 0 0 0 0 1 0.1 1\nK 1 2 10 1.5 0\nK 1 2 10 4 0\n\
                     @muscle 0.5 1 0\nT 2 0 0 0 10 0.25 0\n";

#[test]
fn tensions_of_the_final_state_and_of_every_state_are_written() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --dt 0.25 --steps 0 --tensions a.csv", 0);
    let header = "step,time,kind,index,a,b,length,tension\n";
    let start = "0,0,spring,0,0,1,2,5\n0,0,muscle,1,0,1,2,-20\n0,0,tether,0,1,,1,7.5\n";
    assert_eq!(rockfall.read("a.csv"), format!("{header}{start}"));
    rockfall.run("run scene.txt --backend cpu --dt 0.25 --steps 4 --every 2 --tensions b.csv --checkpoint a.ckpt", 0);
    let every = rockfall.read("b.csv");
    let steps: Vec<&str> = every.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(steps, ["0", "0", "0", "2", "2", "2", "4", "4", "4"], "{every}");
    assert!(every.starts_with(&format!("{header}{start}2,0.5,spring,0,")), "{every}");

    // A resumed run goes on in the same file.
    rockfall.run("run --resume a.ckpt --steps 6", 0);
    let longer = rockfall.read("b.csv");
    assert!(longer.starts_with(&every) && longer.lines().count() == every.lines().count() + 3, "{longer}");
}

#[test]
fn a_scene_without_springs_is_told_why_it_has_no_tensions() {
    let rockfall = Rockfall::with("S 1 0 1 0 0 0 0 0 0 0 1 0.1\nS 2 1 1 0 0 0 0 0 0 0 1 0.1\nR 1 2 0.05 1\n");
    let (_, err) = rockfall.run("run scene.txt --backend cpu --steps 1 --tensions a.csv", 0);
    assert!(err.contains("note: --tensions: the scene has no springs, muscles and tethers; the model keeps"), "{err}");
    assert_eq!(rockfall.read("a.csv"), "step,time,kind,index,a,b,length,tension\n");
}

#[test]
fn wrong_names_of_the_file_are_errors() {
    let rockfall = Rockfall::with(SCENE);
    for (more, expected) in [
        ("--tensions a.npz", "--tensions a.npz: unknown extension .npz, expected a name that ends in .csv"),
        ("--tensions a.csv --trace a.csv", "--tensions and --trace name the same file"),
        (
            "--every 2",
            "--every needs a file to write to: expected --out FILE, --contacts FILE, --tensions FILE, --gauges FILE, --bodies FILE or \
             --joints FILE",
        ),
    ] {
        let (_, err) = rockfall.run(&format!("run scene.txt --backend cpu --steps 1 {more}"), 2);
        assert!(err.contains(expected), "{more}: {err}");
    }
}

#[cfg(feature = "view")]
#[test]
fn a_trajectory_with_muscles_has_no_colours_of_tensions() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --dt 0.01 --steps 4 --every 2 --out a.npz", 0);
    let (_, err) = rockfall.run("render a.npz --out a.png --size 32x24 --colour-by tension", 2);
    assert!(err.contains("--colour-by tension: a trajectory has no rest lengths of muscles"), "{err}");
}
