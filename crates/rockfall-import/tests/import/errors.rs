//! Files that are refused. Each message names the file, the line, the element and what was expected.

use crate::common::{file, refused};

/// A URDF text of two links with a joint. `link` is the content of the second link, `joint` that of the joint.
fn two(link: &str, attributes: &str, joint: &str) -> String {
    let mass = r#"<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>"#;
    format!(
        "<robot name=\"r\">\n<link name=\"a\">{mass}</link>\n<link name=\"b\">{link}</link>\n\
         <joint name=\"j\" {attributes}><parent link=\"a\"/><child link=\"b\"/>{joint}</joint>\n</robot>"
    )
}

#[test]
fn urdf() {
    let mass = r#"<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>"#;
    let hinge = r#"type="continuous""#;
    let mesh = r#"<collision><geometry><mesh filename="package://gone/a.stl"/></geometry></collision>"#;
    let cases = [
        (two(mesh, hinge, ""), r#":3: <mesh filename="package://gone/a.stl">: no file "a.stl" in a folder "gone""#),
        (two(mass, hinge, r#"<mimic joint="k"/>"#), r#":4: <mimic joint="k">: the joint "j" follows another one"#),
        (two(mass, r#"type="planar""#, ""), r#":4: <joint name="j">: the type "planar" is not taken over, expected revolute"#),
        (two("", hinge, ""), r#":3: <link name="b">: it moves and has no mass, expected a mass greater than 0"#),
        (
            two(r#"<inertial><mass value="-1"/></inertial>"#, hinge, ""),
            ":3: <mass>: value=-1 is not allowed, expected a number that",
        ),
        (
            two(r#"<inertial><mass value="NaN"/></inertial>"#, hinge, ""),
            r#":3: <mass>: value="NaN" has "NaN", expected a number"#,
        ),
        (
            two(r#"<inertial><mass value="1e99"/></inertial>"#, hinge, ""),
            r#":3: <mass>: value="1e99" has "1e99", expected a number"#,
        ),
        (two(mass, hinge, r#"<axis xyz="0 0"/>"#), r#":4: <axis>: xyz="0 0" has 2 numbers, expected 3 numbers"#),
        (two(mass, hinge, r#"<axis xyz="0 0 0"/>"#), r#":4: <joint name="j">: the axis is 0, expected a direction"#),
        (two(mass, "", ""), r#":4: <joint name="j">: no attribute type, expected one"#),
        (
            two(mass, hinge, "").replace("child link=\"b\"", "child link=\"c\""),
            r#":4: <joint name="j">: no link has the name "c""#,
        ),
        (two(mass, hinge, "").replace("child link=\"b\"", "child link=\"a\""), ":4: <joint name=\"j\">: the links form a loop"),
        (
            two(mass, hinge, "").replace("link name=\"b\"", "link name=\"a\""),
            ":3: <link name=\"a\">: another link has this name",
        ),
        (
            two(r#"<collision><geometry><box size="1 0 1"/></geometry></collision>"#, hinge, ""),
            ":3: <box>: size=0 is not allowed",
        ),
        ("<robot name=\"r\"/>".to_owned(), ":1: <robot name=\"r\">: no link, expected at least one"),
        ("<robot>\n<link name=\"a\">".to_owned(), ":1: the file: "),
        ("<html/>".to_owned(), ":1: <html>: the root element is unknown, expected <robot> or <mujoco>"),
    ];
    for (text, expected) in cases {
        let message = refused(&text);
        assert!(message.contains("robot.xml:") && message.contains(expected), "{message}\nlacks\n{expected}");
    }
}

#[test]
fn mjcf() {
    let body = |content: &str| format!("<mujoco><worldbody>\n<body name=\"a\">{content}</body>\n</worldbody></mujoco>");
    let cases = [
        (body(r#"<joint axis="0 0 0"/><geom size="1"/>"#), ":2: <joint>: the axis is 0, expected a direction"),
        (body(r#"<joint type="screw"/>"#), r#":2: <joint>: type="screw" is unknown, expected hinge, slide, ball or free"#),
        (body(r#"<joint range="1 -1"/>"#), ":2: <joint>: range: 1 is greater than -1, expected ascending numbers"),
        (body(r#"<joint/><geom type="box" size="1 1"/>"#), ":2: <geom>: size has 2 numbers, expected 3"),
        (body(r#"<joint/><geom type="mesh" mesh="m"/>"#), r#":2: <geom>: no mesh has the name "m""#),
        (body(r#"<joint class="c"/>"#), r#":2: <joint class="c">: no default class has the name "c", expected one"#),
        (body("<joint/>"), ":2: <body name=\"a\">: it moves and has no mass"),
        (body(r#"<joint/><geom size="1" mass="-2"/>"#), ":2: <geom>: mass=-2 is not allowed"),
        (body(r#"<joint/><geom fromto="0 0 0 0 0 0" size="1" type="capsule"/>"#), ":2: <geom>: fromto has equal ends"),
        (body(r#"<body name="a"/>"#), r#":2: <body name="a">: another body has the name "a""#),
        (
            r#"<mujoco><compiler coordinate="global"/></mujoco>"#.to_owned(),
            r#":1: <compiler>: coordinate="global" is not read"#,
        ),
        (
            r#"<mujoco><include file="/etc/passwd"/></mujoco>"#.to_owned(),
            r#":1: <include file="/etc/passwd">: "/etc/passwd" is no path"#,
        ),
        (r#"<mujoco><include file="gone.xml"/></mujoco>"#.to_owned(), r#":1: <include file="gone.xml">: "#),
        (
            r#"<mujoco><actuator><position joint="k"/></actuator></mujoco>"#.to_owned(),
            r#":1: <position joint="k">: no joint has the name "k""#,
        ),
    ];
    for (text, expected) in cases {
        let message = refused(&text);
        assert!(message.contains("robot.xml:") && message.contains(expected), "{message}\nlacks\n{expected}");
    }
}

#[test]
fn files_that_cannot_be_read() {
    let (folder, path) = file("robot.urdf", "<mujoco/>");
    let message = |path: &std::path::Path| rockfall_import::load_urdf(path).unwrap_err().to_string();
    assert!(message(&path).ends_with(":1: <mujoco>: the root element is not that of a URDF file, expected <robot>"));
    assert!(message(&folder.path().join("gone.urdf")).contains("gone.urdf: "));
    assert!(message(folder.path()).ends_with("expected a regular file"));
}
