use std::path::Path;

use glam::Vec3;

use crate::Result;
use crate::scene::{Loaded, Scene};

fn parse(text: &str) -> Result<Loaded> {
    Scene::parse(text, Path::new("a.txt"))
}

/// The scene as text, with references from 0.
fn read(text: &str) -> String {
    parse(text).unwrap().scene.to_text()
}

const PAIR: &str = "S 5 0 1 0 0 0 0 0 0 0 1 0.25\nS 7 1 1 0 0 0 0 0 0 0 1 0.25 0\nK 5 7 10 1 0.5\n";

#[test]
fn copies_are_moved_and_references_count_on() {
    let text = format!("set gravity 2\n@repeat 3 0 2 -1\n{PAIR}@end\nK 5 12 3 1 0\n");
    let expected = "set gravity 2\n\
                    S 5 0 1 0 0 0 0 0 0 0 1 0.25\nS 7 1 1 0 0 0 0 0 0 0 1 0.25\nK 5 7 10 1 0.5\n\
                    S 8 0 3 -1 0 0 0 0 0 0 1 0.25\nS 10 1 3 -1 0 0 0 0 0 0 1 0.25\nK 8 10 10 1 0.5\n\
                    S 11 0 5 -2 0 0 0 0 0 0 1 0.25\nS 13 1 5 -2 0 0 0 0 0 0 1 0.25\nK 11 13 10 1 0.5\n";
    // The stride is 3, from 5 to 7.
    assert_eq!(read(&text.replace("K 5 12", "K 5 13")), read(&format!("{expected}K 5 13 3 1 0\n")));
    let error = parse(&text).map(drop).unwrap_err().to_string();
    assert!(error.contains("a.txt:7: K b: no sphere with reference 12 yet"), "{error}");
}

#[test]
fn every_kind_of_object_is_moved() {
    let text = "S 1 0 0 0 0 0 0 0 0 0 1 0.5 1\n@repeat 2 0 0 4\n@group 3\nS 2 1 2 3 0 0 0 0 0 0 1 0.5\n@orientation 2 0 1 0 0\n\
                @force 2 1 2 3\nR 1 2 0.1\nT 2 1 5 3 10 0 0\nK 1 2 1 1 0\n@muscle 0.5 1 0\nC 1 0 0 1 1 0 1 2 3 1 0.25\n\
                B 0 0 0 1 0 0 0 1 0 0 0 1\nP 0 0 0 1 0 0 0 1 0\nS 3 9 0 0 0 0 0 0 0 0 1 0.5\nR 2 3 0.1 8.5\n@end\n";
    let scene = parse(text).unwrap().scene;
    let at = |point: Vec3| point.to_array();
    let spheres: Vec<_> = scene.spheres().iter().skip(1).map(|sphere| at(sphere.position)).collect();
    let copy = |z: f32| [[1.0, 2.0, 3.0 + z], [1.0, 0.0, z], [1.0, 1.0, z], [9.0, 0.0, z]];
    assert_eq!(spheres, [copy(0.0), copy(4.0)].concat());
    let ids: Vec<_> = scene.sphere_ids().collect();
    let rods: Vec<_> = scene.rods().iter().map(|rod| [rod.end1, rod.end2]).collect();
    assert_eq!(rods, [[0, 1], [2, 3], [1, 4], [0, 5], [6, 7], [5, 8]].map(|ends| ends.map(|end: usize| ids[end])));
    assert_eq!(
        scene.tethers().iter().map(|tether| (tether.sphere, at(tether.point))).collect::<Vec<_>>(),
        [(ids[1], [1.0, 5.0, 3.0]), (ids[5], [1.0, 5.0, 7.0])]
    );
    assert_eq!(scene.boxes().iter().map(|cuboid| at(cuboid.corner)).collect::<Vec<_>>(), [[0.0; 3], [0.0, 0.0, 4.0]]);
    assert_eq!(scene.polygons().iter().map(|polygon| at(polygon.corner)).collect::<Vec<_>>(), [[0.0; 3], [0.0, 0.0, 4.0]]);
    assert!(
        [1, 5].iter().all(|index: &usize| scene.spheres()[*index].orientation.x == 1.0 && scene.spheres()[*index].group == 3)
    );
    assert_eq!(at(scene.spheres()[5].force), [1.0, 2.0, 3.0]);
    assert!(scene.springs().iter().all(|spring| spring.muscle.is_some()));
    assert_eq!([ids[1], ids[5]].map(|id| scene.reference(id)), [Some(2), Some(4)]);
}

/// A block inside another one is expanded first: 2 rows of 3.
#[test]
fn blocks_may_be_inside_each_other() {
    let scene =
        parse("@repeat 2 0 1 0\n@repeat 3 2 0 0\nS 4 0 0 0 0 0 0 0 0 0 1 0.5\n@end\nS 9 7 0 0 0 0 0 0 0 0 1 0.5\n@end\n")
            .unwrap()
            .scene;
    let found: Vec<_> =
        scene.sphere_ids().map(|id| (scene.reference(id).unwrap(), scene.sphere(id).unwrap().position)).collect();
    let row = |y: f32, on: u32| [(4, 0.0), (5, 2.0), (6, 4.0), (9, 7.0)].map(|(name, x)| (name + on, Vec3::new(x, y, 0.0)));
    assert_eq!(found, [row(0.0, 0), row(1.0, 6)].concat());
}

/// 1000 times 0.1 is 100, and the sum has the digits of double precision.
#[test]
fn distances_add_up() {
    let text = "@repeat 1001 0.1 0 0\nS 1 0.3 0 0 0 0 0 0 0 0 1 0.01\n@end\n";
    let scene = parse(text).unwrap().scene;
    assert_eq!(scene.spheres()[1000].position.x, 100.3);
    let double = parse(&format!("set precision double\n{text}")).unwrap().scene;
    assert!((double.spheres()[777].centre()[0] - 78.0).abs() < 1e-12, "{:?}", double.spheres()[777].centre());
}

#[test]
fn comments_and_warnings_are_told_once() {
    let loaded =
        parse("@repeat 4 1 0 0 # four\n# a ball\nSphere 1 0 2 0 0\n\nS 1 0 0 0 0 0 0 0 0 0 1 0.1\n@end # of four\n").unwrap();
    assert_eq!((loaded.comments, loaded.warnings.len(), loaded.scene.counts().spheres), (2, 1, 4));
    assert_eq!(loaded.warnings[0].line, 3);
}

#[test]
fn wrong_lines_name_the_field_and_what_was_expected() {
    let ball = "S 1 0 0 0 0 0 0 0 0 0 1 0.5\n";
    let deep = format!("{}{ball}{}", "@repeat 1 0 0 0\n".repeat(9), "@end\n".repeat(9));
    let cases = [
        (format!("{ball}@repeat 0 1 0 0\n{ball}@end\n"), 2, "@repeat N: 0 is not allowed, expected at least 1 copy"),
        (format!("set gravity 1\n@repeat 2.5 1 0 0\n{ball}@end\n"), 2, "@repeat N: '2.5' is not a whole number"),
        (format!("set gravity 1\n@repeat 2 1 0\n{ball}@end\n"), 2, "@repeat dz: missing"),
        (format!("set gravity 1\n@repeat 2 1 0 inf\n{ball}@end\n"), 2, "@repeat dz: 'inf' is not finite"),
        (format!("{ball}@repeat 2 1 0 0\n{ball}"), 2, "@repeat line: no `@end` below"),
        (format!("set gravity 1\n{ball}@end\n"), 3, "@end: no `@repeat` or `@body` above"),
        (format!("@repeat 2 1 0 0\n{ball}@end 2\n"), 3, "@end: '2' is one word too many"),
        (format!("@repeat 2 1 0 0\n{ball}set gravity 3\n@end\n"), 3, "set: not possible between @repeat and @end"),
        (format!("@repeat 2 1 0 0\n{ball}@run dt=1\n@end\n"), 3, "@run: not possible"),
        (format!("@repeat 2 1 0 0\n{ball}@material a\n@end\n"), 3, "@material: not possible"),
        (format!("@repeat 2 1 0 0\n{ball}S 2 0 0\n@end\n"), 3, "S z: missing"),
        (format!("@repeat 2 3e38 0 0\n{}@end\n", ball.replace("S 1 0", "S 1 2e38")), 2, "S position"),
        (format!("@repeat 2 1 0 0\n{ball}R 1 3 0.1\n@end\n"), 3, "no sphere with reference 3 yet"),
        (deep, 9, "more than 8 blocks inside each other"),
        (
            "@repeat 500001 1 0 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n\n@end\n".to_owned(),
            1,
            "the copies are 1000002 lines, expected at most 1000000",
        ),
        ("@repeat 4000000000 0 0 0\n@end\n".to_owned(), 1, "the copies are 4000000000 lines"),
        ("@repeat 2 0 0 0\n@repeat 600000 1 0 0\n#\n@end\n@end\n".to_owned(), 1, "the copies are 1200000 lines"),
        ("@repeat 600000 0 0 0\n#\n@end\n@repeat 600000 1 0 0\n#\n@end\n".to_owned(), 4, "the copies are 600000 lines"),
        (
            "@repeat 2 0 0 0\nS 4294967295 0 0 0 0 0 0 0 0 0 1 0.5\n@end\n".to_owned(),
            1,
            "the references count on to 4294967296",
        ),
    ];
    for (text, number, expected) in cases {
        let error = parse(&text).map(drop).expect_err(&text).to_string();
        assert!(error.starts_with(&format!("a.txt:{number}: ")) && error.contains(expected), "{text}: {error}");
    }
}

/// In a file for the thesis's program, the words are prose.
#[test]
fn prose_of_a_thesis_file_is_a_comment() {
    for line in ["@repeat the run twice", "@end of the file"] {
        let loaded = parse(&format!("S 1 0 0 0 0 0 0 0 0 0 1 0.5\n{line}\n")).unwrap();
        assert_eq!((loaded.scene.counts().spheres, loaded.warnings.len(), loaded.comments), (1, 1, 1), "{line}");
    }
}
