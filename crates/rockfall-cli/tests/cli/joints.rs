//! Joints on the command line.

use super::common::Rockfall;

/// A bar that falls on the limit of its hinge, and one that breaks off.
const SCENE: &str = "set contact_law rigid\nset gravity 9.81\n@run steps=60\n@body bar mass=2\nB 0 -0.05 -0.05 1 0 0 0 0.1 0 0 0 0.1\n@end\n\
                     @place bar at=0,0,0 name=one\n@place bar at=0,0,5 name=two\n\
                     @joint hinge world one at=0,0,0 axis=0,0,1 limits=-30..30 name=stop\n\
                     @joint fixed world two at=0,0,5 break_force=10\n";

fn columns(line: &str) -> Vec<&str> {
    line.split(',').collect()
}

#[test]
fn joints_are_written_at_the_end_or_at_an_interval() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --joints last.csv", 0);
    rockfall.run("run scene.txt --backend cpu --joints each.csv --every 20 --checkpoint a.ckpt", 0);
    let [last, each] = ["last.csv", "each.csv"].map(|name| rockfall.read(name));
    let [last, each] = [&last, &each].map(|text| text.lines().collect::<Vec<_>>());
    assert_eq!(last[0], "step,time,joint,position,speed,fx,fy,fz,tx,ty,tz,error");
    assert_eq!((last.len(), each.len()), (3, 1 + 2 * 4));
    assert_eq!(last[1..], each[each.len() - 2..]);
    let stop = columns(last[1]);
    assert_eq!((stop[0], stop[2]), ("60", "stop"));
    assert!((stop[3].parse::<f64>().unwrap() + 30_f64.to_radians()).abs() < 2e-3, "{last:?}");
    assert!((stop[6].parse::<f64>().unwrap() - 2.0 * 9.81).abs() < 0.2, "{last:?}");
    // The second joint has no name, and is broken.
    assert_eq!(columns(last[2])[2..], ["1", "", "", "", "", "", "", "", "", ""]);
    // A run that goes on adds to the file.
    rockfall.run("run --resume a.ckpt --steps 80", 0);
    assert_eq!(rockfall.read("each.csv").lines().count(), 1 + 2 * 5);
}

#[test]
fn saved_scenes_lack_broken_joints() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --save saved.txt", 0);
    let saved = rockfall.read("saved.txt");
    assert_eq!(saved.matches("@joint").count(), 1, "{saved}");
    rockfall.run("check saved.txt", 0);
}

#[test]
fn joints_are_counted_and_broken_ones_are_told() {
    let rockfall = Rockfall::with(SCENE);
    let (out, _) = rockfall.run("check scene.txt", 0);
    assert!(out.contains("2 rigid bodies, 2 joints"), "{out}");
    let (out, _) = rockfall.run("run scene.txt --backend cpu", 0);
    assert!(out.contains("2 rigid bodies, 2 joints") && out.contains("  joints      1 of 2 broken\n"), "{out}");
    let (out, _) = rockfall.run("run scene.txt --backend cpu --json", 0);
    let summary: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&summary["objects"]["joints"], &summary["broken_joints"]), (&2.into(), &1.into()), "{out}");
    let (out, _) = rockfall.run("run scene.txt --backend cpu --steps 0", 0);
    assert!(!out.contains("broken"), "{out}");
}

/// The energy of a torsion spring of 20 per rad, 30 degrees from its target.
#[test]
fn the_trace_has_the_energy_of_springs_of_joints() {
    let line = "@joint hinge world one at=0,0,0 axis=0,0,1 target=30 stiffness=20\n";
    let rockfall = Rockfall::with(&(SCENE.split("@joint").next().unwrap().to_owned() + line));
    rockfall.run("run scene.txt --backend cpu --steps 2 --trace trace.csv", 0);
    let trace = rockfall.read("trace.csv");
    let mut lines = trace.lines();
    let place = columns(lines.next().unwrap()).iter().position(|name| *name == "spring").unwrap();
    let spring: f64 = columns(lines.next().unwrap())[place].parse().unwrap();
    assert!((spring - 10.0 * 30_f64.to_radians().powi(2)).abs() < 1e-4, "{trace}");
}

#[test]
fn plots_of_joints_name_what_they_expect() {
    let rockfall = Rockfall::with(SCENE);
    for (plot, expected) in [
        ("joint:door", "--plot joint:door: unknown, expected stop, or a number from 0 to 1"),
        ("joint:1", "--plot joint:1: a fixed joint has no position, expected force or torque"),
        ("joint", "expected names or numbers of joints, as in joint:door or joint:door.speed"),
    ] {
        for command in ["render scene.txt --out a.png", "view scene.txt --backend cpu"] {
            let (_, error) = rockfall.run(&format!("{command} --plot {plot}"), 2);
            assert!(error.contains(expected), "{command}: {error}");
        }
    }
}
