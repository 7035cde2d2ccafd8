use std::path::Path;

use glam::{Quat, Vec3};

use crate::scene::{Anchor, Joint, JointFrame, JointKind, Scene};

fn parse(text: &str) -> crate::Result<Scene> {
    Scene::parse(text, Path::new("robot.txt")).map(|loaded| loaded.scene)
}

fn read(text: &str) -> Scene {
    parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

const BODIES: &str = "set contact_law rigid
@body bar mass=2
B -1 -0.1 -0.1  2 0 0  0 0.2 0  0 0 0.2
@end
@place bar at=0,1,0 name=arm
@place bar at=2,1,0 axis=0,0,1 turn=30 name=hand
@place bar at=0.1,3,0 first=20
S 7 0 5 0  0 0 0  0 0 0  1 0.5
S 8 0 9 0  0 0 0  0 0 0  1 0.5 1
";

const JOINTS: &str = "@joint hinge arm hand at=1,1,0 axis=0,0,1 limits=-60..90 speed=2 torque=5 friction=0.1 name=elbow
@joint ball world arm at=-1,1,0 axis=0,1,0 twist=-10..20 cone=30 torque=3 target=5 stiffness=20 damping=0.5
@joint slider 20 7 at=0.1,4,0.2 axis=1,1,0 limits=-0.5..0.25 speed=-1 force=10 collide=yes
@joint fixed 8 hand at=0.1,7,0 break_force=100 break_torque=10
@joint distance 7 8 at=0,5.5,0 to=0,8.5,0 limits=1..4 effort=-2.5 drag=0.75 armature=3
@joint distance hand 20 at=2,1,0 to=0.1,3,0
";

/// Bits of all places, and everything else.
fn contents(scene: &Scene) -> Vec<String> {
    let end = |anchor: Anchor| match anchor {
        Anchor::World => "world".to_owned(),
        Anchor::Body(id) => format!("body {}", scene.bodies.index(id).unwrap()),
        Anchor::Sphere(id) => format!("sphere {}", scene.spheres.index(id).unwrap()),
    };
    let joint = |joint: &Joint| {
        let ends = joint.anchors().map(end);
        format!("{ends:?} {:?}", Joint { a: Anchor::World, b: Anchor::World, ..joint.clone() })
    };
    scene.joints().iter().map(joint).collect()
}

fn assert_round_trip(scene: &Scene) -> String {
    let text = scene.to_text();
    let again = read(&text);
    assert_eq!(contents(scene), contents(&again), "{text}");
    assert_eq!(text, again.to_text());
    text
}

#[test]
fn joints_are_read() {
    let scene = read(&format!("{BODIES}{JOINTS}"));
    let [elbow, shoulder, slider, fixed, rope, rod] = scene.joints() else { panic!("six joints") };
    let bodies: Vec<Anchor> = scene.body_ids().map(Anchor::from).collect();
    let spheres: Vec<Anchor> = scene.sphere_ids().map(Anchor::from).collect();
    let ball = spheres[spheres.len() - 2];
    assert_eq!((elbow.kind, elbow.anchors(), elbow.name.as_deref()), (JointKind::Hinge, [bodies[0], bodies[1]], Some("elbow")));
    assert_eq!(elbow.limits, Some([-60.0, 90.0].map(|angle: f64| angle.to_radians() as f32)));
    assert_eq!((elbow.speed, elbow.max_force, elbow.friction), (Some(2.0), 5.0, 0.1));
    assert_eq!(scene.joint_anchors(scene.joint_named("elbow").unwrap()).unwrap(), [Vec3::new(1.0, 1.0, 0.0); 2]);
    assert_eq!((shoulder.a, shoulder.cone), (Anchor::World, Some(30_f64.to_radians() as f32)));
    assert_eq!(shoulder.limits, Some([-10.0, 20.0].map(|angle: f64| angle.to_radians() as f32)));
    assert_eq!((shoulder.target, shoulder.stiffness, shoulder.damping), (Some(5_f64.to_radians() as f32), 20.0, 0.5));
    assert_eq!((slider.anchors(), slider.limits), ([bodies[2], ball], Some([-0.5, 0.25])));
    assert!(slider.collides && !elbow.collides);
    assert_eq!((fixed.break_force, fixed.break_torque, rope.limits, rope.length), (100.0, 10.0, Some([1.0, 4.0]), Some(3.0)));
    assert!(rod.is_locked() && !rope.is_locked());
    // The axis in coordinates of the turned body.
    let axis = elbow.ends().unwrap().map(|end| end.turn * Vec3::X);
    assert!(axis.iter().all(|axis| axis.distance(Vec3::Z) < 1e-6), "{axis:?}");
}

#[test]
fn joints_in_their_places_are_written_as_they_were_read() {
    let text = assert_round_trip(&read(&format!("{BODIES}{JOINTS}")));
    let kept: String = text.lines().filter(|line| line.starts_with("@joint")).map(|line| line.to_owned() + "\n").collect();
    assert_eq!(kept, JOINTS, "{text}");
}

/// A scene that has moved has the same joints again, though their anchors are apart and their angles are not 0.
#[test]
fn joints_of_a_scene_that_moved_are_kept() {
    for precision in ["single", "double"] {
        let mut scene = read(&format!("set precision {precision}\n{BODIES}{JOINTS}"));
        let ids: Vec<_> = scene.body_ids().collect();
        for (id, angle) in ids.iter().zip([0.3, -1.2, 2.9]) {
            scene
                .update_body(*id, |body| {
                    body.orientation = (Quat::from_rotation_x(angle) * body.orientation).normalize();
                    let [x, y, z] = body.centre();
                    body.set_centre([x + 0.1, y + f64::from(angle), z + 0.001]);
                })
                .unwrap();
        }
        let text = assert_round_trip(&scene);
        assert!(
            text.contains("@joint hinge arm hand frame_a=") && text.contains(" frame_b=") && text.contains(" length=2.7586"),
            "{text}"
        );
    }
}

/// Limits that the program set need not contain the position at the start.
#[test]
fn changed_limits_are_kept() {
    let mut scene = read(&format!("{BODIES}{JOINTS}"));
    let id = scene.joint_named("elbow").unwrap();
    scene.update_joint(id, |joint| joint.limits = Some([0.3, 0.7])).unwrap();
    let rod = scene.joint_ids().last().unwrap();
    scene.update_joint(rod, |joint| joint.length = Some(2.5)).unwrap();
    let text = assert_round_trip(&scene);
    assert!(text.contains("@joint distance hand 20 at=2,1,0 to=0.1,3,0 length=2.5\n"), "{text}");
}

/// A body whose name others have too, or whose name means something else, is written by the reference of its first sphere.
#[test]
fn bodies_without_a_clear_name_have_references() {
    let scene = read(
        "@body a\nS 0 0 0 0 0 0 0 0 0 0 - 1\n@end\n@place a at=0,0,0 name=twin first=5\n@place a at=3,0,0 name=twin first=6\n\
         @place a at=6,0,0 name=world first=9\nC 9 0 0 9 1 0 0 0 0 1 0.25\n@joint ball 5 6 at=1,0,0\n@joint ball 6 9 at=4,0,0\n",
    );
    let text = assert_round_trip(&scene);
    assert!(text.contains("@joint ball 5 6 at=1,0,0\n@joint ball 6 9 at=4,0,0\n"), "{text}");

    // Nothing has a reference, and the end of a capsule has a joint.
    let mut bare = read("@body a\nS 0 0 0 0 0 0 0 0 0 0 - 1\n@end\n@place a at=0,0,0\nC 9 0 0 9 1 0 0 0 0 1 0.25\n");
    let (body, end) = (bare.body_ids().next().unwrap(), bare.capsules()[0].end2);
    bare.add_joint(Joint::ball(body, end, [5.0, 0.0, 0.0])).unwrap();
    let text = assert_round_trip(&bare);
    assert!(text.contains(" first=0\n") && text.contains("@joint ball 0 2 at=5,0,0\n"), "{text}");
}

/// A name in a copy means the body of the copy. Outside, it has the number of the copy.
#[test]
fn names_in_copies_have_numbers() {
    let chain = "@body a\nS 0 0 0 0 0 0 0 0 0 0 - 0.4\n@end\n@place a at=0,0,0 name=hook\n\
                 @repeat 2 0 5 0\n@repeat 3 1 0 0\n@place a at=1,0,0 name=link first=3\n@joint hinge world link at=1,1,0 axis=0,0,1 name=pin\n\
                 @joint ball hook link at=0,0,0\n@end\n@end\n@joint ball link.0.0 link.1.2 at=0,0,0\n";
    let scene = read(chain);
    let number = |anchor: Anchor| match anchor {
        Anchor::Body(id) => scene.bodies.index(id).unwrap(),
        _ => 99,
    };
    let ends: Vec<[usize; 2]> = scene.joints().iter().map(|joint| joint.anchors().map(number)).collect();
    let copies = (1..=6).flat_map(|link| [[99, link], [0, link]]);
    assert_eq!(ends, copies.chain([[1, 6]]).collect::<Vec<_>>());
    let names: Vec<&str> = scene.joints().iter().filter_map(|joint| joint.name.as_deref()).collect();
    assert_eq!(names, ["pin.0.0", "pin.0.1", "pin.0.2", "pin.1.0", "pin.1.1", "pin.1.2"]);
    let at = scene.joint_anchors(scene.joint_named("pin.1.2").unwrap()).unwrap();
    assert_eq!(at, [Vec3::new(3.0, 6.0, 0.0); 2]);
    assert_round_trip(&scene);

    for (line, message) in [
        ("@joint ball link hook at=0,0,0", "@joint A: no body with the name 'link' yet"),
        ("@joint ball link.0.3 hook at=0,0,0", "@joint A: no body with the name 'link.0.3' yet, did you mean 'link."),
    ] {
        let error = parse(&format!("{chain}{line}\n")).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

/// Places of the world move with the copy, those of bodies do not.
#[test]
fn frames_in_copies_are_moved() {
    let text = "@body a\nS 0 0 0 0 0 0 0 0 0 0 - 0.4\n@end\n@repeat 2 0 5 0\n@place a at=1,0,0 name=link\n\
                @joint ball world link frame_a=1,2,3,1,0,0,0 frame_b=0,2,3,0,-1,0,0\n@end\n";
    let scene = read(text);
    let frame = |y: f32, x: f32, turn| JointFrame { place: Vec3::new(x, y, 3.0), turn };
    let turned = Quat::from_xyzw(-1.0, 0.0, 0.0, 0.0);
    let ends: Vec<_> = scene.joints().iter().map(|joint| joint.ends().unwrap()).collect();
    let expected = [2.0, 7.0].map(|y| [frame(y, 1.0, Quat::IDENTITY), frame(2.0, 0.0, turned)]);
    assert_eq!(ends, expected);
}

#[test]
fn wrong_lines_name_the_field() {
    let hinge = "@joint hinge arm hand at=1,1,0";
    for (line, message) in [
        (
            "@joint hinge arm",
            "robot.txt:10: @joint line: too short, expected @joint ball|hinge|slider|fixed|distance A B at=x,y,z",
        ),
        ("@joint hing arm hand at=1,1,0", "robot.txt:10: @joint 'hing': an unknown kind, did you mean hinge?"),
        (
            "@joint weld arm hand at=1,1,0",
            "@joint 'weld': an unknown kind, expected one of ball, hinge, slider, fixed, distance",
        ),
        ("@joint hinge arn hand at=1,1,0", "@joint A: no body with the name 'arn' yet, did you mean 'arm'?"),
        (
            "@joint hinge arm leg at=1,1,0",
            "@joint B: no body with the name 'leg' yet, expected the name of a body that an @place line above",
        ),
        ("@joint hinge arm at=1,1,0", "@joint B: missing before 'at=1,1,0', expected @joint"),
        ("@joint hinge arm 9 at=1,1,0", "@joint B: no sphere with reference 9 yet, expected one that a line above defined"),
        ("@joint hinge arm 9x at=1,1,0", "@joint B: '9x' is not a whole number"),
        ("@joint hinge arm arm at=1,1,0", "@joint b: rigid body number 0 ('arm') is not allowed, expected another body than a"),
        ("@joint hinge 20 20 at=1,1,0", "@joint b: rigid body number 2 is not allowed, expected another body than a"),
        ("@joint hinge world 8 at=1,1,0", "expected at least one body that can move"),
        (
            "@place bar at=9,9,9 fixed=1 name=base\n@joint hinge arm base at=1,1,0",
            "@joint B: 'base' is a body with fixed=1, expected",
        ),
        ("@place bar at=9,9,9 name=arm\n@joint hinge arm hand at=1,1,0", "@joint A: several bodies have the name 'arm'"),
        ("@joint hinge arm later at=1,1,0\n@place bar at=9,9,9 name=later", "@joint B: no body with the name 'later' yet"),
        ("@joint hinge arm hand axis=0,0,1", "@joint at: missing, expected @joint"),
        ("@joint hinge arm hand at=1,1", "@joint at: '1,1' is not allowed, expected three numbers x,y,z"),
        ("@joint distance arm hand at=1,1,0", "@joint to: missing, expected @joint"),
        ("{hinge} to=1,2,3", "@joint to: not possible for the kind hinge, expected it for distance only"),
        ("{hinge} axis=0,0,0", "@joint axis: '0,0,0' is not allowed, expected a direction, not 0"),
        ("@joint distance arm hand at=1,1,0 to=2,1,0 axis=1,0,0", "@joint axis: '1,0,0' is not allowed, expected none"),
        ("{hinge} limit=0..1", "@joint 'limit': an unknown key, did you mean limits?"),
        ("{hinge} colour=red", "@joint 'colour': an unknown key, expected one of at, to, axis"),
        ("{hinge} limits=0..1 limits=0..2", "@joint limits: given twice in the line"),
        ("{hinge} limits=10", "@joint limits: '10' is not allowed, expected a range a..b"),
        ("{hinge} limits=a..2", "@joint limits: 'a' is not a finite number"),
        ("{hinge} limits=20..10", "@joint limits: '20..10' is not allowed, expected two finite numbers in ascending order"),
        ("{hinge} limits=10..20", "@joint limits: '10..20' is not allowed, expected a range that contains 0"),
        ("{hinge} limits=-200..200", "@joint limits: '-200..200' is not allowed, expected a range of at most one turn"),
        ("{hinge} cone=10", "@joint cone: '10' is not allowed, expected nothing in a hinge"),
        ("{hinge} twist=0..10", "@joint twist: not possible for the kind hinge, expected limits"),
        ("@joint ball arm hand at=1,1,0 limits=0..10", "@joint limits: not possible for the kind ball, expected twist"),
        (
            "@joint ball arm hand at=1,1,0 twist=10..20",
            "@joint twist: '10..20' is not allowed, expected a range that contains 0",
        ),
        (
            "@joint ball arm hand at=1,1,0 cone=200",
            "@joint cone: '200' is not allowed, expected an angle from 0 to half a turn",
        ),
        ("@joint fixed arm hand at=1,1,0 speed=1", "@joint speed: '1' is not allowed, expected nothing in a fixed joint"),
        ("@joint fixed arm hand at=1,1,0 twist=0..1", "@joint twist: not possible for the kind fixed, expected nothing"),
        ("{hinge} speed=1 force=1", "@joint force: not possible for the kind hinge, expected torque"),
        ("{hinge} speed=1 torque=1 force=1", "@joint force: given together with torque, expected one of the two"),
        ("@joint slider arm hand at=1,1,0 speed=1 torque=1", "@joint torque: not possible for the kind slider, expected force"),
        ("@joint fixed arm hand at=1,1,0 effort=1", "@joint effort: '1' is not allowed, expected nothing in a fixed joint"),
        ("@joint fixed arm hand at=1,1,0 force=1", "@joint force: '1' is not allowed, expected nothing in a fixed joint"),
        ("{hinge} effort=nan", "@joint effort: 'nan' is not a finite number"),
        ("{hinge} drag=-1", "@joint drag: '-1' is not allowed"),
        ("{hinge} armature=-1", "@joint armature: '-1' is not allowed"),
        ("{hinge} speed=1 torque=-1", "@joint torque: '-1' is not allowed, expected a number, not negative"),
        ("{hinge} target=10", "@joint target: '10' is not allowed, expected a target together with a stiffness"),
        ("{hinge} stiffness=-1", "@joint stiffness: '-1' is not allowed"),
        ("{hinge} damping=1e39", "@joint damping: '1e39' is not allowed"),
        ("{hinge} friction=x", "@joint friction: 'x' is not a finite number"),
        ("{hinge} break_force=0", "@joint break_force: '0' is not allowed, expected a number greater than 0"),
        ("{hinge} collide=maybe", "@joint collide: 'maybe' is not possible, expected yes or no"),
        ("{hinge} length=1", "@joint length: '1' is not allowed, expected nothing in a hinge"),
        ("{hinge} name=1a", "@joint name: '1a' is not allowed, expected one word"),
        (
            "{hinge} name=a\n{hinge} name=a",
            "robot.txt:11: @joint name: 'a' is not allowed, expected a name that no other joint has",
        ),
        ("@joint ball arm hand at=1e20,1,0", "@joint at: '1e20,1,0' is not allowed, expected coordinates of at most 1e15"),
        ("@joint distance arm hand at=1,1,0 to=1,-2e15,0", "@joint to: '1,-2e15,0' is not allowed, expected coordinates"),
        (
            "@joint ball arm hand frame_a=1e16,0,0,1,0,0,0 frame_b=0,0,0,1,0,0,0",
            "@joint place: [1e16, 0.0, 0.0] is not allowed, expected coordinates of at most 1e15",
        ),
        ("{hinge} frame_a=0,0,0,1,0,0,0", "@joint frame_b: missing, expected it with frame_a"),
        (
            "{hinge} frame_a=0,0,0,1,0,0,0 frame_b=0,0,0,1,0,0,0",
            "@joint at: given with frame_a and frame_b, expected one of the two",
        ),
        ("@joint hinge arm hand frame_a=0,0,0 frame_b=0", "@joint frame_a: '0,0,0' is not allowed, expected seven numbers"),
        (
            "@joint hinge arm hand frame_a=0,0,0,1,0,0,0 frame_b=0,0,0,2,0,0,0",
            "@joint turn: [2.0, 0.0, 0.0, 0.0] is not allowed",
        ),
    ] {
        let line = line.replace("{hinge}", hinge);
        let error = parse(&format!("{BODIES}{line}\n")).unwrap_err().to_string();
        assert!(error.contains(message), "{line}: {error}");
    }
    // Prose in a file of the thesis.
    let loaded = Scene::parse("@joint effort of many\n", Path::new("old.txt")).unwrap();
    assert!(loaded.scene.joints().is_empty() && loaded.warnings.len() == 1);
}

/// The orientation of a sphere, and positions that are rounded, count as they are at the end of the text.
#[test]
fn joints_are_laid_at_the_end_of_the_text() {
    let text = "S 1 0.1 0 0 0 0 0 0 0 0 1 0.5\n@joint ball world 1 at=0.1,1,0\n@orientation 1 0 0 0 1\n";
    let scene = read(text);
    let [_, end] = scene.joints()[0].ends().unwrap();
    assert!(end.place.distance(-Vec3::Y) < 1e-6 && end.turn.z.abs() > 0.99, "{end:?}");
    assert!(assert_round_trip(&scene).contains("@joint ball world 1 at=0.1,1,0\n"));
}

/// Bodies of a copy go before those of other blocks with the same names. Outside of the blocks, such a name is ambiguous.
#[test]
fn copies_of_two_blocks_may_have_the_same_names() {
    let block = |x: f32, joint: &str| {
        format!(
            "@repeat 2 0 3 0\n@place bar at={x},20,0 name=arm\n@repeat 2 0 0 5\n@place bar at={x},21,0 name=leg\n\
             @joint hinge arm leg at={x},20.5,0 {joint}\n@end\n@end\n"
        )
    };
    let text = format!("{BODIES}{}{}", block(10.0, "name=knee"), block(20.0, ""));
    let scene = read(&text);
    let bodies: Vec<Anchor> = scene.body_ids().map(Anchor::from).collect();
    let ends: Vec<[Anchor; 2]> = scene.joints().iter().map(Joint::anchors).collect();
    // Three bodies are above, and each copy has an arm and two legs.
    let expected = [3, 6, 9, 12].into_iter().flat_map(|arm| [1, 2].map(|leg| [bodies[arm], bodies[arm + leg]]));
    assert_eq!(ends, expected.collect::<Vec<_>>());
    assert_eq!(scene.joints()[3].name.as_deref(), Some("knee.1.1"));
    assert_round_trip(&scene);

    let error = |more: &str| parse(&format!("{text}{more}")).unwrap_err().to_string();
    assert!(error("@joint ball arm.0 hand at=0,0,0\n").contains("several bodies have the name 'arm.0'"));
    let twice = parse(&format!("{BODIES}{}{}", block(10.0, "name=knee"), block(20.0, "name=knee"))).unwrap_err().to_string();
    let expected = "@joint name: a joint has the name 'knee.0.0' already, expected another name: copies of another @repeat";
    assert!(twice.contains(expected), "{twice}");
}
