use std::path::Path;

use glam::{DVec3, Quat, Vec3};

use crate::Result;
use crate::scene::{Colour, Loaded, ObjectId, Scene};

fn parse(text: &str) -> Result<Loaded> {
    Scene::parse(text, Path::new("a.txt"))
}

fn read(text: &str) -> Scene {
    let loaded = parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(loaded.warnings, [], "{text}");
    loaded.scene
}

/// Everything that a body and its members have, with every digit.
fn contents(scene: &Scene) -> Vec<String> {
    let index = |id| scene.spheres.index(id).unwrap();
    let mut all: Vec<String> = scene.spheres().iter().map(|sphere| format!("{sphere:?}")).collect();
    all.extend(scene.rods().iter().map(|rod| format!("{} {} {:?}", index(rod.end1), index(rod.end2), rod)));
    all.extend(scene.springs().iter().map(|spring| format!("{} {}", index(spring.a), index(spring.b))));
    all.extend(scene.bodies().iter().map(|body| format!("{body:?}")));
    all.extend(scene.shapes().iter().map(|shape| format!("{shape:?}")));
    all.extend(scene.tagged().map(|(id, tag)| format!("{id:?} {tag:?}")));
    all
}

/// The text that a scene is written as, which reads back unchanged.
fn written(scene: &Scene) -> String {
    let text = scene.to_text();
    let again = read(&text);
    // Handles of both scenes print alike: slots count from 0 in both.
    assert_eq!(contents(scene), contents(&again), "{text}");
    assert_eq!(again.to_text(), text);
    text
}

const DUMBBELL: &str = "@body bone mass=9\nS 0 0 0 0 0 0 0 0 0 0 - 1\nS 1 4 0 0 0 0 0 0 0 0 - 0.5\nR 0 1 0.25\n@end\n";

#[test]
fn a_body_is_read_and_written() {
    let text = format!(
        "{DUMBBELL}S 0 0 9 0 0 0 0 0 0 0 1 0.5 0\n@place bone at=1,2,3 velocity=0,-1,0\nS 3 0 12 0 0 0 0 0 0 0 1 0.5 0\n"
    );
    let scene = read(&text);
    assert_eq!(written(&scene), text);
    let counts = scene.counts();
    assert_eq!((counts.spheres, counts.rods, counts.bodies), (4, 1, 1));
    assert_eq!(scene.spheres()[2].position, Vec3::new(5.0, 2.0, 3.0));
    assert_eq!(scene.body_of_sphere(scene.sphere_ids().nth(2).unwrap()), scene.body_ids().next());
}

#[test]
fn all_that_a_line_may_say_is_read() {
    let text = "@material steel density=7\n@body bone density=2\n@use steel\n@group 3\nS 5 0 0 0 0 0 0 0 0 0 1 1\n@use -\n@colour red\n\
                C 0 1 0 0 2 0 0 0 0 - 0.5\nS 6 3 0 0 0 0 0 0 0 0 9 0.5\nR 5 6 0.25 3\n@capsule 5 6 # a comment\n@end\n\
                S 1 50 0 0 0 0 0 0 0 0 1 0.5\n\
                @colour blue\n@place bone centre=0,10,0 axis=0,0,2 turn=90 spin=0,0,2 name=first # another\n\
                @place bone at=0,30,0 orientation=0.6,0,0.8,0 momentum=1,2,3 first=40\nK 1 43 1 1 0\n@force 41 1 0 0\n";
    let scene = read(text);
    let shape = &scene.shapes()[0];
    assert_eq!((shape.spheres.len(), shape.rods.len()), (4, 2));
    let steel = scene.find_material("steel");
    assert_eq!(shape.spheres.iter().map(|part| part.material).collect::<Vec<_>>(), [steel, None, None, None]);
    assert!(shape.spheres.iter().all(|part| part.group == 3) && scene.spheres()[0].group == 0);
    assert_eq!((shape.rods[1].end1, shape.rods[1].end2), (0, 3));
    let [first, second] = [0, 1].map(|index| &scene.bodies()[index]);
    assert_eq!(first.centre(), [0.0, 10.0, 0.0]);
    assert!(first.orientation.abs_diff_eq(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2), 1e-6));
    let id = scene.body_ids().next().unwrap();
    assert!(scene.body_spin(id).unwrap().abs_diff_eq(Vec3::new(0.0, 0.0, 2.0), 1e-6));
    assert_eq!((second.orientation, second.angular_momentum), (Quat::from_xyzw(0.0, 0.8, 0.0, 0.6), Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(scene.springs()[0].b, second.spheres()[3]);
    assert_eq!(scene.sphere(second.spheres()[1]).unwrap().force, Vec3::X);
    assert_eq!(scene.named("first").unwrap().len(), 7);
    let colour = |id: ObjectId| scene.tag(id).unwrap().and_then(|tag| tag.colour);
    assert_eq!(colour(first.spheres()[0].into()), Some(Colour([0, 0, 255])).map(|_| colour(id.into()).unwrap()));
    assert_eq!(colour(first.spheres()[1].into()), Some("red".parse().unwrap()));
    let text = written(&scene);
    assert!(text.contains("\n@place bone "), "{text}");
    assert!(text.contains(" orientation=0.6,0,0.8,0 momentum=1,2,3 first=40\n@force 41 1 0 0\n"), "{text}");
}

/// A fixed body consists of fixed objects, and one below `@move` of walls. They are written as such.
#[test]
fn bodies_that_do_not_move_by_forces() {
    let text = format!(
        "{DUMBBELL}@place bone at=0,0,0 fixed=1 first=10 name=arm\nK 10 11 1 1 0\n@motion up velocity=0,1,0\n@move up\n@place bone at=5,0,0\n"
    );
    let scene = read(&text);
    let counts = scene.counts();
    assert_eq!((counts.spheres, counts.rods, counts.polygons, counts.bodies), (2, 1, 3, 0));
    assert!(scene.spheres().iter().all(|sphere| sphere.fixed) && scene.polygons().iter().all(|wall| wall.motion.is_some()));
    assert_eq!(scene.named("arm").unwrap().len(), 3);
    let again = read(&written(&scene));
    assert_eq!((again.counts(), written(&again)), (counts, written(&scene)));
}

#[test]
fn given_mass_properties_are_kept() {
    let text = "@body top mass=2 centre=0,0.5,0 inertia=1,2,2,0.25,0,0\nS 0 0 0 0 0 0 0 0 0 0 - 1\n@end\n@place top at=0,0,0\n";
    let scene = read(text);
    assert_eq!(written(&scene), text);
    assert_eq!(scene.bodies()[0].position, Vec3::new(0.0, 0.5, 0.0));
    assert!(DVec3::from_array(scene.shapes()[0].mass_properties_of().unwrap().centre) == DVec3::new(0.0, 0.5, 0.0));
}

/// Poses and motions of any kind read back bit by bit, in both precisions.
#[test]
fn every_pose_reads_back() {
    for precision in ["single", "double"] {
        let mut text = format!("set precision {precision}\n{}", DUMBBELL.replace("mass=9", "density=0.3"));
        for number in 1..200 {
            let x = (f64::from(number) * 0.7).sin() * 10.0_f64.powi(number % 7 - 3);
            let [y, z] = [1.3, 2.9].map(|factor| (x * factor).sin());
            text += &format!("@place bone at={x},{y},{z} axis={z},{x},{y} turn={number} velocity={y},{z},{x} spin={x},{y},1\n");
        }
        let text = text + "@place bone centre=0,-0,1e-30\n@place bone centre=1e6,0.1,1e-9 momentum=0,-0,1\n";
        written(&read(&text));
    }
}

/// In single precision, the digits beyond those of an `f32` have no effect on the text.
#[test]
fn a_body_between_two_numbers_of_f32_is_written_in_the_same_way_again() {
    let mut scene = read(&DUMBBELL.replace("mass=9", "density=0.3"));
    let bone = scene.find_shape("bone").unwrap();
    for number in 1..50 {
        let x = (f64::from(number) * 0.7).sin();
        let turn = Quat::from_rotation_y(number as f32);
        scene.add_body(crate::Placement::new(bone).centred_at(DVec3::new(x, 1.0 / x, 5.0 * x)).turned(turn)).unwrap();
    }
    scene.settings.precision = crate::Precision::Single;
    let text = scene.to_text();
    let again = read(&text);
    assert_eq!(again.to_text(), text);
    let positions = |scene: &Scene| scene.bodies().iter().map(|body| body.position).collect::<Vec<_>>();
    assert_eq!(positions(&again), positions(&scene));
}

#[test]
fn a_shape_without_a_name_gets_one() {
    let mut scene = read(&DUMBBELL.replace("bone", "shape1"));
    for _ in 0..2 {
        let ball = scene.add_shape(crate::Shape::new().sphere([0.0; 3], 0.5)).unwrap();
        scene.add_body(crate::Placement::new(ball)).unwrap();
    }
    let text = scene.to_text();
    for name in ["@body shape2 mass=1\n", "@body shape3 mass=1\n", "@place shape2 at=0,0,0\n", "@place shape3 at=0,0,0\n"] {
        assert!(text.contains(name), "{text}");
    }
    assert_eq!(read(&text).to_text(), text);
}

#[test]
fn copies_are_moved_and_references_count_on() {
    let text = format!("{DUMBBELL}@repeat 3 0 5 0\n@place bone at=1,0,0 first=10\nK 10 11 1 1 0\n@end\nK 11 15 1 1 0\n");
    let scene = read(&text);
    let origins: Vec<Vec3> = scene.bodies().iter().map(|body| scene.sphere(body.spheres()[0]).unwrap().position).collect();
    assert_eq!(origins, [0.0, 5.0, 10.0].map(|y| Vec3::new(1.0, y, 0.0)));
    let ids: Vec<_> = scene.sphere_ids().collect();
    assert_eq!(
        scene.springs().iter().map(|spring| [spring.a, spring.b]).collect::<Vec<_>>(),
        [[ids[0], ids[1]], [ids[2], ids[3]], [ids[4], ids[5]], [ids[1], ids[5]]]
    );
    // Parts can be repeated, too.
    let row = "@body row\n@repeat 3 2 0 0\nS 1 0 0 0 0 0 0 0 0 0 - 1\n@end\nR 1 3 0.5\n@end\n@place row at=0,0,0\n";
    let scene = read(row);
    assert_eq!(scene.spheres().iter().map(|sphere| sphere.position.x).collect::<Vec<_>>(), [0.0, 2.0, 4.0]);
    assert_eq!(scene.bodies()[0].position, Vec3::X * 2.0);
}

#[test]
fn wrong_lines_name_the_field_and_what_was_expected() {
    let ball = "S 0 0 0 0 0 0 0 0 0 0 - 1";
    let bodies = |lines: &str| format!("set gravity 1\n{DUMBBELL}{lines}\n");
    let body = |lines: &str| format!("set gravity 1\n@body x\n{ball}\n{lines}\n@end\n");
    for (text, expected) in [
        (bodies("@body"), "7: @body NAME: missing, expected @body NAME"),
        (bodies("@body mass=1"), "7: @body NAME: missing"),
        (bodies("@body bone"), "7: @body NAME: 'bone' is the name of another body above, expected a new name"),
        (bodies("@body x mas=1"), "7: @body 'mas': an unknown key, did you mean mass?"),
        (bodies("@body x 1"), "7: @body '1': expected KEY=VALUE with a key of mass, density, centre, inertia, rounding"),
        (bodies("@body x mass=1 density=1"), "7: @body mass: given with density, expected one of them"),
        (bodies("@body x mass=1 mass=1"), "7: @body mass: given twice in the line"),
        (bodies("@body x mass=a"), "7: @body mass: 'a' is not a finite number"),
        (bodies("@body x centre=0,0,0"), "7: @body centre: given without inertia, expected both"),
        (bodies("@body x inertia=1,1,1 centre=0,0,0"), "7: @body inertia: '1,1,1' is not allowed, expected six numbers"),
        (bodies("@body x"), "7: @body line: no `@end` below"),
        (bodies("@body x\n@end"), "7: @body parts: 0 is not allowed, expected at least one sphere, box or hull"),
        (bodies(&format!("@body x mass=0\n{ball}\n@end")), "7: @body mass: 0 is not allowed, expected a finite number"),
        (bodies(&format!("@body 3\n{ball}\n@end")), "7: @body name: '3' is not allowed, expected one word"),
        (body("@body y"), "4: '@body': not possible between @body and @end, expected S, R, C, B, @hull, @group"),
        (body("B 0 0 0 1 0 0 0 1 0 0 0.1 1"), "4: B edges: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.1, 1.0]] with 84.2894"),
        (
            bodies("@body x rounding=0.5\nB 0 0 0 1 0 0 0 1 0 0 0 1\n@end"),
            "8: B rounding: 0.5 is not allowed, expected a radius less",
        ),
        (body("K 0 0 1 1 1"), "4: 'K': not possible between @body and @end"),
        (body("set gravity 1"), "4: 'set': not possible between @body and @end"),
        (body("S 1 0 0 0 0 2 0 0 0 0 - 1"), "4: S vy: 2 is not allowed, expected 0: a part of a body moves with the body"),
        (body("S 1 0 0 0 0 0 0 0 0 0 - 1 1"), "4: S fixed: not possible between @body and @end"),
        (body("S 1 0 0 0 0 0 0 0 0 0 - -1"), "4: S radius: -1 is not allowed, expected a finite number greater than 0"),
        (body("C 0 0 0 1 0 0 0 0 1 - 1"), "4: C vz: 1 is not allowed"),
        (body("C 0 0 0 0 0 0 0 0 0 - 1"), "4: C rod: [1, 2] is not allowed"),
        (body("R 0 1 1"), "4: R end2: no sphere with reference 1 in this body yet"),
        (body("R 0 0 1"), "4: R end2: 0 is the same sphere as end1"),
        (body("S 1 2 0 0 0 0 0 0 0 0 - 1\nR 0 1 1 3"), "5: R length: 3 is not the distance 2 of the ends"),
        (body("S 1 2 0 0 0 0 0 0 0 0 - 1\n@capsule 0 1"), "5: @capsule end1: expected right after the R line"),
        (body("@end x"), "4: @end: 'x' is one word too many"),
        (bodies("@repeat 2 0 0 1\n@body y\n@end"), "8: @body: not possible between @repeat and @end"),
        (bodies("@place"), "7: @place NAME: missing, expected @place NAME at=x,y,z|centre=x,y,z"),
        (bodies("@place bon at=0,0,0"), "7: @place 'bon': an unknown body, did you mean 'bone'?"),
        (bodies("@place bone"), "7: @place at: missing"),
        (bodies("@place bone at=0,0"), "7: @place at: '0,0' is not allowed, expected three numbers x,y,z without spaces"),
        (bodies("@place bone at=0,0,0 centre=0,0,0"), "7: @place centre: given with at, expected one of them"),
        (bodies("@place bone at=0,0,0 turn=1"), "7: @place turn: given without axis, expected both"),
        (bodies("@place bone at=0,0,0 axis=0,0,0 turn=1"), "7: @place axis: has no direction"),
        (bodies("@place bone at=0,0,0 orientation=1,1,0,0"), "7: @place orientation: [1.0, 1.0, 0.0, 0.0] is not allowed"),
        (bodies("@place bone at=0,0,0 spin=0,0,0 momentum=0,0,0"), "7: @place momentum: given with spin"),
        (bodies("@place bone at=1e39,0,0"), "7: @place position: [inf, 0.0, 0.0] is not allowed"),
        (bodies("@place bone at=0,0,0 name=3"), "7: @place name: '3' is not allowed"),
        (bodies("@place bone at=0,0,0 fixed=2"), "7: @place fixed: '2' is not possible, expected 0 or 1"),
        (bodies("@place bone at=0,0,0 spin=1,0,0 fixed=1"), "7: @place velocity: "),
        (
            bodies("@motion up velocity=0,1,0\n@move up\n@place bone at=0,0,0 first=5"),
            "9: @place first: given for a body without spheres",
        ),
        (bodies("@place bone at=0,0,0 first=-1"), "7: @place first: '-1' is not a whole number"),
        (bodies("@place bone at=0,0,0 first=4294967295"), "7: @place first: '4294967295' is not a whole number, or counts on"),
    ] {
        let error = parse(&text).map(drop).expect_err(&text).to_string();
        assert!(error.contains(&format!("a.txt:{expected}")), "{error}\n{text}");
    }
    // In a file for the thesis's program, such a line is prose.
    let loaded = parse("@body\nS 0 0 0 0 0 0 0 0 0 0 1 1\n").unwrap();
    assert_eq!((loaded.warnings.len(), loaded.scene.counts().spheres), (1, 1));
}
