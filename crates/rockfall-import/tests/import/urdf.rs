//! What a URDF file becomes.

use rockfall::JointKind;

use crate::common::{body, close, file, import, joint, mass};

const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <link name="world"/>
  <link name="post">
    <inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.2 0.2 1"/></geometry></collision>
  </link>
  <joint name="held" type="fixed"><parent link="world"/><child link="post"/><origin xyz="0 0 0.5"/></joint>
  <link name="upper arm">
    <inertial>
      <origin xyz="0 0 0.25" rpy="0 0 1.5707963267948966"/><mass value="2"/>
      <inertia ixx="0.01" iyy="0.02" izz="0.025" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision><origin xyz="0 0 0.25"/><geometry><cylinder radius="0.05" length="0.5"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="post"/><child link="upper arm"/><origin xyz="0.3 0 0.5" rpy="0 1.5707963267948966 0"/>
    <axis xyz="0 0 2"/><limit lower="-1" upper="2" effort="5" velocity="1"/><dynamics damping="0.3" friction="0.1"/>
  </joint>
  <link name="tool">
    <inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <joint name="wrist" type="fixed"><parent link="upper arm"/><child link="tool"/><origin xyz="0 0 0.5"/></joint>
  <link name="slide">
    <inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><capsule radius="0.05" length="0.2"/></geometry></collision>
  </link>
  <joint name="rail" type="prismatic">
    <parent link="tool"/><child link="slide"/><axis xyz="0 0 1"/><origin xyz="0 0 0.2"/><limit lower="0.1" upper="0.3"/>
  </joint>
</robot>"#;

#[test]
fn masses_places_and_joints() {
    let imported = import(ARM).unwrap();
    let scene = imported.scene;
    assert_eq!((scene.bodies().len(), scene.joints().len()), (2, 2), "{:?}", imported.notes);
    assert_eq!((scene.settings.gravity, scene.settings.gravity_direction.z), (9.81, -1.0));

    // The arm with the tool: 2 kg at 0.25 and 0.5 kg at 0.5, along its z.
    let arm = mass(&scene, "upper_arm");
    let spread = 2.0 * 0.05_f64.powi(2) + 0.5 * 0.2_f64.powi(2);
    close([arm.mass], [2.5]);
    close(arm.centre, [0.0, 0.0, 0.3]);
    // The origin of the inertia turns x into y.
    close(arm.inertia, [0.021 + spread, 0.011 + spread, 0.026, 0.0, 0.0, 0.0]);
    // The arm points along x, from (0.3, 0, 1).
    close(body(&scene, "upper_arm").centre(), [0.6, 0.0, 1.0]);

    let shoulder = joint(&scene, "shoulder");
    assert_eq!((shoulder.kind, shoulder.limits), (JointKind::Hinge, Some([-1.0, 2.0])));
    // The bound is that of motors, so the damping is one without it.
    assert_eq!((shoulder.damping, shoulder.drag, shoulder.friction, shoulder.max_force), (0.0, 0.3, 0.1, 5.0));
    let [world, _] = shoulder.ends().unwrap();
    close(world.place.to_array().map(f64::from), [0.3, 0.0, 1.0]);
    close((world.turn * rockfall::glam::Vec3::X).to_array().map(f64::from), [1.0, 0.0, 0.0]);

    // The rail starts at its lower limit, 0.1 m away from the place of the file.
    assert_eq!(joint(&scene, "rail").kind, JointKind::Slider);
    close(joint(&scene, "rail").limits.unwrap().map(f64::from), [0.0, 0.2]);
    close(body(&scene, "slide").centre(), [1.1, 0.0, 1.0]);
    assert!(imported.notes.iter().any(|note| note.contains("beyond a limit")), "{:?}", imported.notes);
}

/// Notes name the file, the line and the element.
#[test]
fn notes_name_the_place() {
    let notes = import(ARM).unwrap().notes;
    for expected in [
        r#"robot.xml:9: <link name="upper arm">: the name "upper arm" is upper_arm in the scene"#,
        "robot.xml:18: <limit>: the attribute velocity is not taken over",
        "robot.xml:14: <cylinder>: cylinders are prisms of 16 sides with the same volume",
    ] {
        assert!(notes.iter().any(|note| note.ends_with(expected)), "{expected:?} in {notes:#?}");
    }
}

/// The text of the scene is the scene.
#[test]
fn the_text_of_the_scene_is_read_back() {
    let scene = import(ARM).unwrap().scene;
    let again = rockfall::Scene::parse(&scene.to_text(), std::path::Path::new("scene.txt")).unwrap().scene;
    assert_eq!(again.to_text(), scene.to_text());
}

#[test]
fn meshes_are_found_beside_and_above_the_file() {
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    for (name, place) in [
        ("m.obj", "m.obj"),
        ("../shapes/m.obj", "shapes/m.obj"),
        ("package://box/shapes/m.obj", "box/shapes/m.obj"),
        ("package://gone/shapes/m.obj", "shapes/m.obj"),
    ] {
        let text = format!(
            r#"<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
            <collision><geometry><mesh filename="{name}" scale="2 2 2"/></geometry></collision></link></robot>"#
        );
        let (folder, _) = file("unused", "");
        let urdf = folder.path().join(if name == "m.obj" { "r.urdf" } else { "urdf/r.urdf" });
        let mesh = folder.path().join(place);
        for path in [&urdf, &mesh] {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        }
        std::fs::write(&urdf, text).unwrap();
        std::fs::write(mesh, tetrahedron).unwrap();
        let scene = rockfall_import::load_urdf(&urdf).unwrap().scene;
        let shape = scene.shape(body(&scene, "a").shape).unwrap();
        let farthest = shape.hulls[0].points().iter().map(|point| point.max_element()).fold(0.0, f32::max);
        assert_eq!((shape.hulls[0].points().len(), farthest), (4, 2.0), "{name}");
    }
}

/// A root without mass is the world, and a root with mass is free.
#[test]
fn roots() {
    let link = |name: &str, mass: f64| {
        format!(r#"<link name="{name}"><inertial><mass value="{mass}"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>"#)
    };
    let robot = |mass: f64| {
        let joint = r#"<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>"#;
        format!("<robot>{}{}{joint}</robot>", link("a", mass), link("b", 1.0))
    };
    let (held, free) = (import(&robot(0.0)).unwrap(), import(&robot(1.0)).unwrap());
    assert_eq!((held.scene.bodies().len(), free.scene.bodies().len()), (1, 2));
    assert!(free.notes.iter().any(|note| note.contains("@joint fixed world a at=0,0,0")), "{:?}", free.notes);
}
