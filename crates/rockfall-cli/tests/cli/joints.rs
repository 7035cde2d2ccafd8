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
