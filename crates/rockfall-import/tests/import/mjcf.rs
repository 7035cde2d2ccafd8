//! What an MJCF file becomes.

use rockfall::{JointKind, Surface};

use crate::common::{body, close, file, import, joint, mass};

const ROBOT: &str = r#"<mujoco model="robot">
  <compiler angle="degree" eulerseq="zyx"/>
  <option gravity="0 0 -1.62"/>
  <default>
    <joint damping="0.5"/>
    <geom density="500" friction="0.8"/>
    <default class="stiff"><joint stiffness="7" springref="30" range="-90 90"/><geom size="0.1"/></default>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1" friction="1.2"/>
    <geom name="crate" type="box" size="0.1 0.2 0.3" pos="3 0 0.3"/>
    <body name="trunk" pos="0 0 1" childclass="stiff">
      <freejoint/>
      <geom type="box" size="0.1 0.2 0.3" euler="90 0 0"/>
      <body name="head" pos="0 0 0.3"><geom type="sphere" mass="2"/></body>
      <frame pos="0.5 0 0">
        <body name="arm" pos="0.5 0 0">
          <joint name="elbow" axis="0 1 0" pos="-0.5 0 0"/>
          <geom type="capsule" fromto="-0.5 0 0 0.5 0 0"/>
        </body>
      </frame>
    </body>
    <body name="cart" pos="0 2 1">
      <joint name="slide" type="slide" axis="1 0 0" range="-1 1" ref="0.25"/>
      <inertial pos="0.1 0 0" mass="4" diaginertia="0.1 0.2 0.25"/>
      <body name="pole"><joint name="ball" type="ball"/><geom size="0.05" pos="0 0 0.5"/></body>
    </body>
  </worldbody>
  <actuator>
    <position name="p" joint="elbow" kp="21" kv="2" forcerange="-9 9"/>
    <velocity joint="slide" kv="3" gear="2"/>
    <motor name="force" joint="slide"/>
  </actuator>
  <keyframe><key qpos="0"/></keyframe>
</mujoco>"#;

#[test]
fn masses_places_and_joints() {
    let imported = import(ROBOT).unwrap();
    let scene = imported.scene;
    assert_eq!((scene.bodies().len(), scene.joints().len()), (4, 3), "{:?}", imported.notes);
    close([f64::from(scene.settings.gravity)], [1.62]);

    // A box turned by 90 degrees about z, of 500 kg/m³, with a ball of 2 kg above it.
    let trunk = mass(&scene, "trunk");
    let box_mass = 500.0 * 0.2 * 0.4 * 0.6;
    let height = 2.0 * 0.3 / (box_mass + 2.0);
    close([trunk.mass], [box_mass + 2.0]);
    close(trunk.centre, [0.0, 0.0, height]);
    let spread = box_mass * height * height + 2.0 * (0.3 - height) * (0.3 - height);
    let ball = 0.4 * 2.0 * 0.01;
    let third = box_mass / 3.0;
    close(
        trunk.inertia[..3].iter().copied(),
        [third * 0.10 + ball + spread, third * 0.13 + ball + spread, third * 0.05 + ball],
    );
    close(body(&scene, "arm").centre(), [1.0, 0.0, 1.0]);
    let radius = 0.1_f64;
    close([mass(&scene, "arm").mass], [500.0 * std::f64::consts::PI * radius.powi(2) * (1.0 + 4.0 / 3.0 * radius)]);

    // The spring of the joint and the actuator, with the target of both.
    let elbow = joint(&scene, "elbow");
    assert_eq!((elbow.kind, elbow.stiffness, elbow.damping), (JointKind::Hinge, 28.0, 2.5));
    let target = 7.0 * 30.0_f64.to_radians() / 28.0;
    close([f64::from(elbow.target.unwrap())], [target]);
    assert_eq!(elbow.max_force, f32::INFINITY, "it would bound the spring of the joint too");
    close(elbow.limits.unwrap().map(f64::from), [-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2]);

    let slide = joint(&scene, "slide");
    assert_eq!((slide.kind, slide.stiffness, slide.damping), (JointKind::Slider, 0.0, 0.5 + 3.0 * 4.0));
    close(slide.limits.unwrap().map(f64::from), [-1.25, 0.75]);
    close(body(&scene, "cart").centre(), [0.1, 2.0, 1.0]);
    assert_eq!(joint(&scene, "ball").kind, JointKind::Ball);
    for expected in ["a control gives, that of slide", "<keyframe> are not taken over", "greatest force of its actuator"] {
        assert!(imported.notes.iter().any(|note| note.contains(expected)), "{expected:?} in {:#?}", imported.notes);
    }
}

#[test]
fn the_world_has_walls_and_friction() {
    let scene = import(ROBOT).unwrap().scene;
    assert_eq!(scene.boxes().len(), 1);
    let plane = scene.polygons()[0];
    assert!(matches!(plane.surface, Surface::Plane));
    let friction = |a, b| scene.pair(a, b).unwrap().friction.unwrap();
    let rubber = scene.boxes()[0].material;
    assert_eq!((friction(plane.material, rubber), friction(rubber, rubber)), (1.2, 0.8));
}

/// The motion of a body in a plane needs two light bodies. The sum of the masses stays.
#[test]
fn several_joints_of_a_body() {
    let text = r#"<mujoco><worldbody>
      <body name="torso" pos="0 0 1">
        <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/><joint name="turn" axis="0 1 0"/>
        <geom size="0.1" mass="3"/>
        <body name="leg" pos="0 0 -0.2"><joint name="a" axis="1 0 0"/><joint name="b" axis="0 1 0"/><geom size="0.15" mass="1"/></body>
      </body>
    </worldbody></mujoco>"#;
    let imported = import(text).unwrap();
    let scene = imported.scene;
    let masses: f64 = ["torso", "torso_x", "torso_z"].iter().map(|name| mass(&scene, name).mass).sum();
    close([masses, mass(&scene, "torso").mass], [3.0, 2.94]);
    close([mass(&scene, "leg").mass + mass(&scene, "leg_a").mass], [1.0]);
    assert!(imported.notes.iter().any(|note| note.contains("3 joints")), "{:?}", imported.notes);
    // The leg overlaps the torso. They do not touch, although no joint of the file is between them in the scene.
    let apart = joint(&scene, "apart_torso_leg");
    assert_eq!(apart.kind, JointKind::Distance);
    assert!(scene.placement().unwrap().overlaps.is_empty());
}

#[test]
fn loops_and_excluded_pairs() {
    let text = r#"<mujoco><worldbody>
      <body name="a" pos="0 0 1"><joint axis="0 1 0"/><geom size="0.1"/></body>
      <body name="b" pos="1 0 1"><joint axis="0 1 0"/><geom size="0.1"/></body>
      <body name="c" pos="2 0 1"><freejoint/><geom size="0.1"/></body>
    </worldbody>
    <equality><connect name="pin" body1="a" body2="b" anchor="0.5 0 0"/><weld body1="b" body2="c"/><joint joint1="q"/></equality>
    <contact><exclude body1="a" body2="c"/></contact></mujoco>"#;
    let imported = import(text).unwrap();
    let scene = imported.scene;
    let pin = joint(&scene, "pin");
    assert_eq!(pin.kind, JointKind::Ball);
    close(pin.ends().unwrap()[1].place.to_array().map(f64::from), [-0.5, 0.0, 0.0]);
    assert_eq!(joint(&scene, "weld2").kind, JointKind::Fixed);
    assert_eq!(joint(&scene, "apart_a_c").kind, JointKind::Distance);
    assert!(imported.notes.iter().any(|note| note.contains("<joint>: it is left out")), "{:?}", imported.notes);
}

#[test]
fn included_files() {
    let part = r#"<mujocoinclude><body name="part" pos="0 0 2"><freejoint/><geom class="small"/></body></mujocoinclude>"#;
    let defaults = r#"<mujoco><default><default class="small"><geom size="0.05" mass="0.5"/></default></default></mujoco>"#;
    let text = r#"<mujoco><include file="defaults.xml"/><worldbody><include file="parts/part.xml"/></worldbody></mujoco>"#;
    let (folder, path) = file("robot.xml", text);
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    std::fs::write(folder.path().join("parts/part.xml"), part).unwrap();
    std::fs::write(folder.path().join("defaults.xml"), defaults).unwrap();
    let scene = rockfall_import::load_mjcf(&path).unwrap().scene;
    close([mass(&scene, "part").mass], [0.5]);
}

/// Actuators have a bound, and the damping of their joint is a drag then. Their force is an effort.
#[test]
fn actuators_rotors_and_their_bounds() {
    let text = r#"<mujoco><worldbody>
      <body name="a"><freejoint armature="1"/><geom size="0.1"/>
        <body name="b" pos="1 0 0"><joint name="bounded" damping="0.5" armature="0.25"/><geom size="0.1"/>
          <body name="c" pos="1 0 0"><joint name="servo" damping="0.5" actuatorfrcrange="-2 7"/><geom size="0.1"/>
            <body name="d" pos="1 0 0"><joint name="free" damping="0.5" actuatorfrclimited="false" actuatorfrcrange="-2 7"/>
              <geom size="0.1"/>
            </body>
          </body>
        </body>
      </body>
    </worldbody><actuator>
      <motor joint="bounded" gear="30" ctrlrange="-0.5 0.4"/>
      <general joint="bounded" gainprm="4" ctrlrange="-1 1" forcerange="-3 3"/>
      <position joint="servo" kp="20" kv="1" forcerange="-9 9"/>
      <motor joint="free"/>
    </actuator></mujoco>"#;
    let imported = import(text).unwrap();
    let numbers = |name: &str| {
        let joint = joint(&imported.scene, name);
        [joint.stiffness, joint.damping, joint.drag, joint.armature, joint.max_force]
    };
    assert_eq!(numbers("bounded"), [0.0, 0.0, 0.5, 0.25, 15.0 + 3.0]);
    assert_eq!(numbers("servo"), [20.0, 1.0, 0.5, 0.0, 7.0]);
    assert_eq!(numbers("free"), [0.0, 0.5, 0.0, 0.0, f32::INFINITY]);
    let expected = ["a control gives, that of bounded, bounded, free", "<freejoint>: the attribute armature is not taken over"];
    for expected in expected {
        assert!(imported.notes.iter().any(|note| note.ends_with(expected)), "{expected:?} in {:#?}", imported.notes);
    }
}
