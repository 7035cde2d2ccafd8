//! Files of strangers: they end in an error or in a scene, soon and without a panic.

use proptest::prelude::*;

use crate::common::{file, import, refused};

#[test]
fn entities_are_refused() {
    let mut text = "<?xml version=\"1.0\"?><!DOCTYPE robot [<!ENTITY a \"aaaaaaaaaa\">".to_owned();
    for letter in 'b'..='z' {
        let before = char::from(letter as u8 - 1);
        text += &format!("<!ENTITY {letter} \"{}\">", format!("&{before};").repeat(10));
    }
    text += "]><robot><link name=\"&z;\"/></robot>";
    assert!(refused(&text).contains("expected XML without a document type"));
}

#[test]
fn deep_and_many_elements_are_refused() {
    let deep = format!("<mujoco><worldbody>{}{}</worldbody></mujoco>", "<body>".repeat(50_000), "</body>".repeat(50_000));
    assert!(refused(&deep).contains("nested deeper than 200"));
    let classes = format!("<mujoco>{}{}</mujoco>", "<default class=\"a\">".repeat(150), "</default>".repeat(150));
    assert!(refused(&classes).contains("another class") || refused(&classes).contains("deeper"));
    let many = format!("<robot>{}</robot>", "<x/>".repeat(600_000));
    assert!(refused(&many).contains("500000 elements"));
}

#[test]
fn includes_end() {
    let (folder, path) = file("robot.xml", "<mujoco><include file=\"robot.xml\"/></mujoco>");
    let message = rockfall_import::load(&path).unwrap_err().to_string();
    assert!(message.contains("nested deeper") || message.contains("files"), "{message}");
    // Two includes each: files grow in number with the power of the depth.
    let two = "<mujoco><x><include file=\"two.xml\"/><include file=\"two.xml\"/></x></mujoco>";
    std::fs::write(folder.path().join("two.xml"), two).unwrap();
    let message = rockfall_import::load(folder.path().join("two.xml")).unwrap_err().to_string();
    assert!(message.contains("nested deeper") || message.contains("files"), "{message}");
}

const ROBOTS: [&str; 2] = [
    r#"<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
    <link name="b"><inertial><origin xyz="0 0 1" rpy="0 1 0"/><mass value="2"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
    <collision><geometry><cylinder radius="0.1" length="1"/></geometry></collision></link>
    <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/><limit lower="-1" upper="2"/></joint></robot>"#,
    r#"<mujoco><compiler angle="radian" eulerseq="XYZ"/><default>
    <geom density="300"/><default class="c"><joint damping="1"/></default></default>
    <worldbody><geom type="plane" size="1 1 1"/><body name="a" pos="0 0 1" euler="0 1 0" childclass="c"><freejoint/>
    <geom size="0.1 0.2" type="capsule"/>
    <body><joint name="j" type="slide" range="-1 1"/><joint name="k"/><geom type="ellipsoid" size="0.1 0.2 0.1"/></body></body></worldbody>
    <actuator><position joint="j" kp="2"/></actuator><equality><weld body1="a"/></equality></mujoco>"#,
];

const WORDS: [&str; 16] =
    ["-1", "0", "1e15", "NaN", "inf", "", "a", "b", "world", "\u{0}", "1 1 1", "-0.0", "<body/>", "\"", "free", "planar"];

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Words of a small file are replaced, removed and doubled.
    #[test]
    fn mutated_files_never_panic(robot in 0..2usize, edits in proptest::collection::vec((0..400usize, 0..18usize), 1..6)) {
        let mut text = ROBOTS[robot].to_owned();
        for (place, edit) in edits {
            let ends: Vec<usize> = text.match_indices(['"', ' ', '<', '>']).map(|(at, _)| at).collect();
            let Some(pair) = ends.windows(2).nth(place % ends.len().max(1)).map(|pair| pair[0] + 1..pair[1]) else { continue };
            match edit {
                16 => { let part = text[pair.clone()].to_owned(); text.insert_str(pair.start, &part); }
                17 => text.replace_range(pair, ""),
                word => text.replace_range(pair, WORDS[word]),
            }
        }
        if let Ok(imported) = import(&text) {
            prop_assert!(rockfall::Scene::parse(&imported.scene.to_text(), std::path::Path::new("scene.txt")).is_ok());
        }
    }
}
