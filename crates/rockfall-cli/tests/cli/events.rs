//! Events of contacts and sensors on the command line.

use super::common::Rockfall;

/// A ball that bounces under the law rigid, and a cube that falls through a sensor beside it.
const SCENE: &str = "set contact_law rigid\nset gravity 10\nset restitution 0.5\n@run dt=0.0166666667 steps=80\n\
                     B -5 -1 -5 10 0 0 0 1 0 0 0 10\n@body cube mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n\
                     @place cube at=8,1,0\nS 1 0 1.5 0 0 0 0 0 0 0 1 0.5\n@sensor name=gate box=7,-1,-1,9,0,1\n";
/// The same for the law of the thesis.
const THESIS: &str = "set gravity 10\nset restitution 1\nset activation_threshold 0\n@run dt=0.01 steps=80\n\
                      B -5 -1 -5 10 0 0 0 1 0 0 0 10\nS 1 0 1 0 0 0 0 0 0 0 1 0.5\nS 2 8 1 0 0 0 0 0 0 0 1 0.5\n\
                      @sensor name=gate box=7,-1,-1,9,0,1\n";

fn columns(line: &str) -> Vec<&str> {
    line.split(',').collect()
}

#[test]
fn events_have_a_line_each() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --events a.csv", 0);
    let text = rockfall.read("a.csv");
    let lines: Vec<Vec<&str>> = text.lines().map(columns).collect();
    assert_eq!(text.lines().next(), Some("step,time,event,a,b,x,y,z,nx,ny,nz,fx,fy,fz"));
    assert!(lines.iter().all(|line| line.len() == 14), "{text}");
    // It lands after 0.447 s, 0.894 s and 1.118 s. The centre of the cube is in the sensor from 0.447 s to 0.632 s.
    let ball = lines.iter().filter(|line| line[3].starts_with("sphere ")).map(|line| (line[0], line[2]));
    let bounces = [("27", "begin"), ("28", "end"), ("54", "begin"), ("55", "end"), ("68", "begin"), ("69", "end")];
    assert_eq!(ball.take(6).collect::<Vec<_>>(), bounces, "{text}");
    let first = lines.iter().find(|line| line[2] == "begin").unwrap();
    assert_eq!(first[4], "box 0");
    assert!(first[1].starts_with("0.45") && first[9] == "-1", "{first:?}");
    let push: f64 = first[12].parse().unwrap();
    assert!((push + 1.5 * 20_f64.sqrt() * 60.0).abs() < 5.0, "{push}");
    let cube: Vec<_> = lines.iter().filter(|line| line[3] == "body 0").collect();
    assert_eq!(cube.iter().map(|line| (line[2], line[4])).collect::<Vec<_>>(), [("enter", "gate"), ("leave", "gate")]);
    assert!(cube.iter().all(|line| line[8..] == ["", "", "", "", "", ""] && line[5] == "8"), "{text}");
    // Lines are in the order of steps.
    let steps: Vec<u64> = lines[1..].iter().map(|line| line[0].parse().unwrap()).collect();
    assert!(steps.is_sorted(), "{steps:?}");
}

/// A whole run, and one that stops and goes on.
fn stop(scene: &str, backend: &str, substeps: &str) {
    let rockfall = Rockfall::with(scene);
    let run = format!("run scene.txt --backend {backend} {substeps}");
    rockfall.run(&format!("{run} --events whole.csv"), 0);
    rockfall.run(&format!("{run} --steps 45 --events a.csv --checkpoint a.ckpt --checkpoint-every 7"), 0);
    rockfall.run("run --resume a.ckpt --steps 80", 0);
    let whole = rockfall.read("whole.csv");
    assert_eq!(whole, rockfall.read("a.csv"));
    assert!(whole.lines().count() >= 5 && whole.contains(",enter,"), "{whole}");
}

#[test]
fn a_stopped_run_has_the_same_events() {
    stop(SCENE, "cpu", "");
    stop(THESIS, "cpu", "");
    stop(THESIS, "cpu", "--substeps 3");
}

#[test]
fn a_stopped_run_has_the_same_events_on_the_gpu() {
    stop(SCENE, "gpu", "");
    stop(THESIS, "gpu", "");
}

#[test]
fn sensors_are_saved_and_wrong_ones_are_errors() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --steps 3 --save saved.txt", 0);
    assert!(rockfall.read("saved.txt").contains("\n@sensor name=gate box=7,-1,-1,9,0,1\n"));
    rockfall.run("check saved.txt", 0);
    let rockfall = Rockfall::with(&SCENE.replace("9,0,1", "9,-1,1"));
    let (_, err) = rockfall.run("check scene.txt", 2);
    assert!(err.contains("scene.txt:11: @sensor box: ") && err.contains("expected six finite numbers"), "{err}");
}
