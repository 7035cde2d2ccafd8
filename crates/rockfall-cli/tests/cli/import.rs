//! `rockfall import`.

use std::fs;

use super::common::Rockfall;

const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="world"/>
  <link name="rod">
    <inertial><origin xyz="0 0 -0.5"/><mass value="2"/><inertia ixx="0.1667" iyy="0.1667" izz="0.001"/></inertial>
    <collision><origin xyz="0 0 -0.5"/><geometry><box size="0.05 0.05 1"/></geometry></collision>
  </link>
  <joint name="hinge" type="revolute">
    <origin xyz="0 0 2" rpy="0 0.1 0"/><parent link="world"/><child link="rod"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="10" velocity="8"/>
  </joint>
</robot>"#;

#[test]
fn a_robot_is_written_checked_and_run() {
    let rockfall = Rockfall::with("");
    fs::write(rockfall.path("robot.urdf"), PENDULUM).unwrap();
    let (out, notes) = rockfall.run("import robot.urdf", 0);
    let note = "robot.urdf:9: <limit>: the attribute velocity is not taken over";
    assert_eq!(notes, format!("note: {note}\n"));
    assert!(out.starts_with(&format!("# rockfall import robot.urdf\n# note: {note}\n\n")), "{out}");
    let (nothing, _) = rockfall.run("import robot.urdf --out robot.txt", 0);
    assert_eq!((nothing.as_str(), rockfall.read("robot.txt")), ("", out));
    rockfall.run("check robot.txt", 0);
    // Half a period later, it is on the other side.
    rockfall.run("run robot.txt --steps 49 --backend cpu --joints joints.csv", 0);
    let position = rockfall.read("joints.csv").lines().last().unwrap().split(',').nth(3).unwrap().parse::<f64>().unwrap();
    assert!((position + 0.2).abs() < 0.01, "{position}");
}

#[test]
fn what_is_refused() {
    let rockfall = Rockfall::with("S 0  0 0 0  0 0 0  0 0 0  1 1\n");
    fs::write(rockfall.path("bad.urdf"), PENDULUM.replace("value=\"2\"", "value=\"-2\"")).unwrap();
    fs::write(rockfall.path("robot.urdf"), PENDULUM).unwrap();
    for (arguments, expected) in [
        ("import bad.urdf", "error: bad.urdf:4: <mass>: value=-2 is not allowed, expected a number that is not negative\n"),
        ("import gone.urdf", "error: gone.urdf: "),
        ("import scene.txt", "error: scene.txt:1: the file: "),
        ("import robot.urdf --out robot.csv", "error: --out"),
    ] {
        let (out, err) = rockfall.run(arguments, 2);
        assert!(out.is_empty() && err.starts_with(expected), "{err}\n{expected}");
    }
    let (_, err) = rockfall.run("import robot.urdf --out gone/robot.txt", 1);
    assert!(err.contains("cannot be written"), "{err}");
}
