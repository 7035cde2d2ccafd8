use glam::Quat;
use proptest::prelude::*;

use super::*;
use crate::scene::{Cuboid, Muscle, Polygon, Rod, Sphere, Spring, Tether};
use crate::settings::Settings;

const EXAMPLE: &str = include_str!("../../../../scenes/thesis-example.txt");
const REUSED: &str = include_str!("../../../../scenes/thesis-example-reused.txt");

fn parse(text: &str) -> Result<Loaded> {
    Scene::parse(text, Path::new("a.txt"))
}

fn scene(text: &str) -> Scene {
    let loaded = parse(text).unwrap();
    assert_eq!(loaded.warnings, []);
    loaded.scene
}

/// Two spheres with references 1 and 2, for lines that need them.
const BALLS: &str = "S 1 0 0 0 0 0 0 0 0 0 1 0.5\nS 2 3 0 0 0 0 0 0 0 0 1 0.5 0\n";

#[test]
fn the_examples_of_the_thesis_load() {
    for text in [EXAMPLE, REUSED] {
        let scene = scene(text);
        let counts = scene.counts();
        assert_eq!((counts.spheres, counts.rods, counts.springs), (6, 3, 1));
        let third = Sphere::new([0.0, 3.4, -1.0], 0.2);
        assert_eq!(scene.spheres()[2], third);
        let ids: Vec<SphereId> = scene.sphere_ids().collect();
        let spring = Spring::new(ids[4], ids[5], 100.0, 2.0).damping(1.0);
        assert_eq!(scene.springs(), [spring]);
        assert_eq!(scene.rods()[1], Rod::new(ids[2], ids[3], 0.1));
    }
}

#[test]
fn every_kind_of_line() {
    let text = format!(
        "{BALLS}R 1 2 0.1\nR 1 2 0.1 -1\nR 1 2 0.1 3.5\nC 0 5 0 0 6 0 1 2 3 4 0.25\nP 0 0 0 0 0 1 1 0 0\n\
         K 2 1 10 3 0.5\n@muscle 0.25 2 -0.125\nB 0 -1 0 1 0 0 0 2 0 0 0 3\nT 2 0 9 0 20 1 0.1\nset gravity 9.81\nset collisions off\n\
         @group 7\nS 4000000000 9 9 9 0 0 0 0 0 0 1 1 1\n@orientation 4000000000 0 1 0 0\n@force 4000000000 1 2 3\n\
         R 1 2 0.5 3\n@capsule 1 2\n"
    );
    let scene = scene(&text);
    let ids: Vec<SphereId> = scene.sphere_ids().collect();
    let rods = scene.rods();
    assert_eq!(rods[..2], [Rod::new(ids[0], ids[1], 0.1); 2]);
    assert_eq!(rods[2], Rod::new(ids[0], ids[1], 0.1).length(3.5));
    let capsule_end = Sphere::new([0.0, 6.0, 0.0], 0.25).mass(2.0).velocity([1.0, 2.0, 3.0]);
    assert_eq!(scene.spheres()[3], capsule_end);
    assert_eq!(scene.capsules().len(), 2);
    assert_eq!(scene.capsules()[1].rod, scene.rod_ids().last().unwrap());
    assert_eq!(scene.polygons(), [Polygon::new([0.0; 3], Vec3::Z, Vec3::X)]);
    let muscle = Muscle::new(0.25, 2.0, -0.125);
    assert_eq!(scene.springs(), [Spring::new(ids[1], ids[0], 10.0, 3.0).damping(0.5).muscle(muscle)]);
    assert_eq!(scene.boxes(), [Cuboid::between([0.0, -1.0, 0.0], [1.0, 1.0, 3.0])]);
    assert_eq!(scene.tethers(), [Tether::new(ids[1], [0.0, 9.0, 0.0], 20.0).length(1.0).damping(0.1)]);
    assert_eq!((scene.settings.gravity, scene.settings.collisions), (9.81, false));
    let last =
        Sphere::new([9.0; 3], 1.0).group(7).fixed().orientation(Quat::from_xyzw(1.0, 0.0, 0.0, 0.0)).force([1.0, 2.0, 3.0]);
    assert_eq!(scene.spheres()[4], last);
    assert_eq!((rods[3].group, rods[4].group), (0, 7));
}

#[test]
fn unusual_files_load() {
    for text in ["", "\n\n", "\u{feff}", "no objects here", "Some words\nBalls\nset\tting\nT\n"] {
        assert_eq!(parse(text).unwrap().scene.counts(), Scene::new().counts());
    }
    let windows = BALLS.replace('\n', "\r\n").replace(' ', "\t");
    assert_eq!(scene(&format!("\u{feff}  {windows}")).counts().spheres, 2);
    let latin = [b"g\xf6mb\xf6k\n", BALLS.as_bytes()].concat();
    let loaded = Scene::parse_bytes(&latin, Path::new("a.txt")).unwrap();
    assert_eq!(loaded.scene.counts().spheres, 2);
    let path = std::env::temp_dir().join("no such scene.txt");
    assert!(matches!(Scene::load(path), Err(Error::File { .. })));
    assert!(matches!(Scene::load(std::env::temp_dir()), Err(Error::File { .. })));
}

#[test]
fn a_direction_is_separated_by_spaces_or_commas() {
    for line in ["set gravity_direction 0  0 -1", "set gravity_direction 0,0,-1"] {
        let loaded = parse(line).unwrap();
        assert_eq!(loaded.warnings, [], "{line}");
        assert_eq!(loaded.scene.settings.gravity_direction, Vec3::NEG_Z, "{line}");
    }
}

/// A file for the thesis's program may contain one line of prose that begins like an extension.
#[test]
fn a_lone_line_that_only_resembles_an_extension_is_a_comment_with_a_warning() {
    for line in ["set", "set colour red", "set the table", "T is for tether", "T", "@groups 1", "@", "set gravty 3"] {
        let loaded = parse(&format!("{BALLS}{line}\n")).unwrap();
        assert_eq!(loaded.warnings.len(), 1, "{line}");
        assert_eq!(loaded.warnings[0].line, 3, "{line}");
        assert!(loaded.warnings[0].text.starts_with("taken for a comment; "), "{line}");
        assert_eq!((loaded.scene.settings, loaded.comments), (Settings::default(), 1), "{line}");
    }
    let warning = &parse("set gravty 3").unwrap().warnings[0].text;
    assert_eq!(warning, "taken for a comment; set 'gravty' is an unknown setting, did you mean gravity?");
}

/// In a file with another extension, such a line is an error, whether the other one comes before or after it.
#[test]
fn a_line_that_is_not_understood_is_an_error_in_a_file_with_extensions() {
    let cases = [
        ("set gravty 3", "set 'gravty': an unknown setting, did you mean gravity?"),
        ("set Gravity 3", "set 'Gravity': an unknown setting, did you mean gravity?"),
        ("set", "set: a setting without a name, expected `set NAME VALUE`"),
        ("@grup 1", "'@grup': an unknown word, did you mean @group?"),
        (
            "@brush hopper",
            "'@brush': an unknown word, expected one of @group, @orientation, @force, @capsule, @muscle, @material, @pair, @use, @name, @colour, @look, @label, @run, @mesh, @triangle, @motion, @servo, @move, @surface, @periodic, @plane, @cylinder, @cone, @ball, @gauge, @grain, @inlet, @outlet, @sensor, @body, @hull, @place, @joint, @repeat, @end",
        ),
    ];
    for (line, expected) in cases {
        for other in ["set restitution 1", "@group 2", "@group", "T 1 0 0 0 1 1 1", "set out"] {
            for text in [format!("{BALLS}{line}\n{other}"), format!("{BALLS}\n{other}\n{line}")] {
                // A line above that is itself an error comes first.
                if !["@group", "set out"].contains(&other) || text.ends_with(other) {
                    let number = text.lines().position(|found| found == line).unwrap() + 1;
                    assert_eq!(parse(&text).unwrap_err().to_string(), format!("a.txt:{number}: {expected}"), "{text}");
                }
            }
        }
    }
    let error = parse("set weight 3\nset gravity 3").unwrap_err().to_string();
    assert!(error.starts_with("a.txt:1: set 'weight': an unknown setting, expected one of activation_threshold, "), "{error}");
}

#[test]
fn a_muscle_belongs_to_the_spring_of_the_last_line() {
    let spring = format!("{BALLS}K 1 2 10 3 0\n");
    let error = |text: String| parse(&text).unwrap_err().to_string();
    assert_eq!(error(format!("{BALLS}@muscle 0.1 2 0")), "a.txt:3: @muscle line: expected after the K line of a spring");
    let second = "the spring of the last K line has a muscle already, expected one per spring";
    assert_eq!(error(format!("{spring}@muscle 0.1 2 0\n@muscle 0.1 2 0")), format!("a.txt:5: @muscle line: {second}"));
    for (line, expected) in [
        ("@muscle 1.5 2 0", "@muscle amplitude: 1.5 is not allowed, expected a number from -1 to 1"),
        ("@muscle 0.1 -2 0", "@muscle frequency: -2 is not allowed, expected a finite number, not negative"),
        ("@muscle 0.1 2", "@muscle phase: missing, expected 3 numbers after @muscle, found 2"),
        ("@muscle 0.1 2 nan", "@muscle phase: 'nan' is not finite (in f32), expected a finite number"),
    ] {
        assert_eq!(error(format!("{spring}{line}")), format!("a.txt:4: {expected}"));
    }
    // Other lines may stand between them.
    let scene = scene(&format!("{spring}K 1 2 5 3 0\nS 3 9 9 9 0 0 0 0 0 0 1 1\n@muscle 0.1 2 0.5"));
    assert_eq!(
        scene.springs().iter().map(|spring| spring.muscle).collect::<Vec<_>>(),
        [None, Some(Muscle::new(0.1, 2.0, 0.5))]
    );
}

#[test]
fn a_comment_that_looks_like_an_object_or_a_setting_has_a_warning() {
    let sphere = "it looks like a line `S reference x y z vx vy vz lx ly lz mass radius [fixed]`";
    let gravity = "it looks like a setting, which is `set gravity VALUE`";
    let cases = [
        ("s 1 0 2 0 0 0 0 0 0 0 1 0.5", sphere),
        ("Sphere 1 0 2 0 0 0 0 0 0 0 1 0.5", sphere),
        ("sphere: 0 2 0 radius 0.5", sphere),
        ("Ball radius=0.5", sphere),
        ("b 0 0 0 1 0 0 0 1 0 0 0 1", "it looks like a line `B x y z i_x i_y i_z j_x j_y j_z k_x k_y k_z`"),
        ("group 3", "it looks like a line `@group number`"),
        ("SET gravity 3", gravity),
        ("Set gravty 3", gravity),
        ("gravity 3", gravity),
        ("Gravity = 3", gravity),
        ("gravity=3", gravity),
        ("let gravity be", ""),
        ("setting gravity 1", gravity),
        ("contact-force 500", "it looks like a setting, which is `set contact_force VALUE`"),
        ("mesh hopper.stl", "it looks like a mesh, which a scene cannot contain"),
        (
            "S1 0 2 0 0 0 0 0 0 0 1 0.5",
            "it looks like an object, but 'S1' is not one of S, R, C, P, K, B, T, @group, @orientation, @force, @muscle",
        ),
    ];
    for (line, what) in cases {
        let loaded = parse(&format!("\n{line}\n")).unwrap();
        let expected: Vec<LineWarning> = (!what.is_empty())
            .then(|| LineWarning { line: 2, text: format!("taken for a comment; {what}; begin a comment with #") })
            .into_iter()
            .collect();
        assert_eq!(loaded.warnings, expected, "{line}");
        assert_eq!((loaded.comments, loaded.scene.settings), (1, Settings::default()), "{line}");
        // With # in front it is a comment without doubt.
        for comment in [format!("#{line}"), format!("  # {line}")] {
            let loaded = parse(&comment).unwrap();
            assert_eq!((loaded.warnings, loaded.comments), (vec![], 1), "{comment}");
        }
    }
}

#[test]
fn prose_has_no_warning() {
    let prose = [
        "Gravity pulls all of them down.",
        "A box of 3 balls, and 2 rods.",
        "Ball 1 is the heavy one.",
        "b 12 is a note, not an object",
        "// S 1 0 0 0 0 0 0 0 0 0 1 1",
        "; gravity 3",
        "Mesh of rods",
        "It takes 3 s",
        "Friction is on the house",
        "3 balls",
        "Set the table.",
        "SET",
    ];
    for line in prose {
        let loaded = parse(line).unwrap();
        assert_eq!((loaded.warnings, loaded.comments), (vec![], 1), "{line}");
    }
}

#[test]
fn number_signs_begin_comments() {
    let text = "# A title\n\n  #set gravity 7\nS 1 0 0 0 0 0 0 0 0 0 1 0.5 # the first ball\nset gravity 3\t#Moon\nprose # 1\n@group 2 #";
    let loaded = parse(text).unwrap();
    assert_eq!((&loaded.warnings, loaded.comments), (&vec![], 3));
    assert_eq!((loaded.scene.counts().spheres, loaded.scene.settings.gravity), (1, 3.0));
    // Within a word, # is part of the word.
    let error = parse("S 1#2 0").unwrap_err().to_string();
    assert!(error.contains("S reference: '1#2' is not a whole number"), "{error}");
}

#[test]
fn a_constant_that_is_set_twice_has_a_warning() {
    let loaded = parse("set gravity 3\nset friction 1\n\nset gravity 4 # again").unwrap();
    let text = "gravity is set again; this replaces line 1".to_owned();
    assert_eq!(loaded.warnings, [LineWarning { line: 4, text }]);
    assert_eq!(loaded.scene.settings.gravity, 4.0);
}

/// The error message for `line` after two spheres. File name and line number are checked and removed.
fn message(line: &str) -> String {
    let text = format!("{BALLS}{line}\nS bad");
    match parse(&text) {
        Ok(_) => "fine".to_owned(),
        Err(error) => {
            let message = error.to_string();
            let rest = message.strip_prefix("a.txt:3: ").map(str::to_owned);
            rest.unwrap_or_else(|| panic!("{message}"))
        }
    }
}

#[test]
fn every_error_names_line_and_field_and_what_was_expected() {
    let cases = [
        ("S 1 0 0 0", "S vx: missing, expected 12 or 13 numbers after S, found 4"),
        ("S", "S reference: missing, expected 12 or 13 numbers after S, found 0"),
        ("S 1 0 0 0 0 0 0 0 0 0 1", "S radius: missing, expected 12 or 13 numbers after S, found 11"),
        ("S 1 0 0 0 0 0 0 0 0 0 1 0.5 0 7", "S '7': one too many, expected 12 or 13 numbers after S"),
        ("S -1 0 0", "S reference: '-1' is not a whole number from 0 to 4294967295"),
        ("S 1.5 0 0", "S reference: '1.5' is not a whole number from 0 to 4294967295"),
        ("S 1 0 high 0", "S y: 'high' is not a number, expected a finite number"),
        ("S 1 0 0 NaN", "S z: 'NaN' is not finite (in f32), expected a finite number"),
        ("S 1 0 0 -inf", "S z: '-inf' is not finite (in f32), expected a finite number"),
        ("S 1 1e39 0 0", "S x: '1e39' is not finite (in f32), expected a finite number"),
        ("S 1 0 0 0 0 0 0 0 0 0 -1 0.5", "S mass: -1 is not allowed, expected a finite number greater than 0"),
        ("S 1 0 0 0 0 0 0 0 0 0 1 0", "S radius: 0 is not allowed, expected a finite number greater than 0"),
        (
            "S 1 0 0 0 0 0 0 0 0 0 1e-30 1e-30",
            "S mass and radius: 0.000000000000000000000000000001 and 0.000000000000000000000000000001 is not allowed, \
             expected an inertia 2/5 m r² and inverses that are neither 0 nor infinite in f32",
        ),
        ("R 1 2", "R radius: missing, expected 3 or 4 numbers after R, found 2"),
        ("R 1 2 0.1 1 1", "R '1': one too many, expected 3 or 4 numbers after R"),
        ("R 1 3 0.1", "R end2: no sphere with reference 3 yet, expected one that a line above defined"),
        ("R 2 2 0.1", "R end2: 2 is the same sphere as end1, expected another one"),
        ("R 1 2 0", "R radius: 0 is not allowed, expected a finite number greater than 0"),
        ("R 1 2 0.1 x", "R length: 'x' is not a number, expected a finite number"),
        ("K 1 2 1 1", "K damping: missing, expected 5 numbers after K, found 4"),
        ("K 1 1 1 1 1", "K b: 1 is the same sphere as a, expected another one"),
        ("K 9 1 1 1 1", "K a: no sphere with reference 9 yet, expected one that a line above defined"),
        ("K 1 2 -1 1 1", "K stiffness: -1 is not allowed, expected a finite number, not negative"),
        ("C 0 0 0 1 0 0 0 0 0 1", "C radius: missing, expected 11 numbers after C, found 10"),
        ("C 0 0 0 1 0 0 0 0 0 -3 1", "C mass: -3 is not allowed, expected a finite number greater than 0"),
        ("C 0 0 0 1 0 0 0 0 0 1 0", "C radius: 0 is not allowed, expected a finite number greater than 0"),
        (
            "C 1 0 0 1 0 0 0 0 0 1 1",
            "C end1 and end2: [1.0, 0.0, 0.0] and [1.0, 0.0, 0.0] is not allowed, expected two points at a distance that is \
             neither 0 nor infinite in f32",
        ),
        ("P 0 0 0 1 0 0 0 1", "P right z: missing, expected 9 numbers after P, found 8"),
        ("P 0 0 0 1 0 0 2 0 0", "P right: [2.0, 0.0, 0.0] is not allowed, expected an edge that is not parallel to the first"),
        (
            "B 0 0 0 1 0 0 1 1 0 0 0 1",
            "B edges: [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]] with 45 degrees between i and j is not allowed, \
             expected three edges at right angles to each other",
        ),
        ("B 0 0 0 1 0 0 0 1 0 0 0 x", "B k z: 'x' is not a number, expected a finite number"),
        ("T 1 0 0 0 1 1", "T damping: missing, expected 7 numbers after T, found 6"),
        ("T 5 0 0 0 1 1 1", "T sphere: no sphere with reference 5 yet, expected one that a line above defined"),
        ("T 1 0 0 0 1 -1 1", "T length: -1 is not allowed, expected a finite number, not negative"),
        ("@group", "@group number: missing, expected 1 number after @group, found 0"),
        ("@group 70000", "@group number: 70000 is too large, expected 0 to 65535"),
        (
            "@orientation 1 1 1 0 0",
            "@orientation orientation: [1.0, 1.0, 0.0, 0.0] is not allowed, expected a unit quaternion w, x, y, z",
        ),
        ("@force 1 0 0 inf", "@force z: 'inf' is not finite (in f32), expected a finite number"),
        ("@capsule 1 2", "@capsule end1: expected right after the R line, with a length, of these two spheres"),
        ("set gravity", "set gravity: no value, expected a finite number"),
        ("set gravity 1 2", "set gravity: '1 2' is not allowed, expected a finite number"),
        ("set gravity fast", "set gravity: 'fast' is not allowed, expected a finite number"),
        ("set restitution -1", "set restitution: '-1' is not allowed, expected a number from 0 to 1"),
        ("a\0b", "text: a NUL byte, expected plain text (UTF-8)"),
    ];
    for (line, expected) in cases {
        assert_eq!(message(line), expected, "{line}");
    }
}

#[test]
fn a_capsule_is_marked_once_and_right_after_its_rod() {
    let rod = format!("{BALLS}R 1 2 0.5 3\n");
    assert_eq!(scene(&format!("{rod}a comment\n@capsule 1 2")).counts().capsules, 1);
    for text in ["@capsule 2 1", "@capsule 1 2\n@capsule 1 2", "R 1 2 0.5\n@capsule 1 2"] {
        assert!(parse(&format!("{rod}{text}")).is_err(), "{text}");
    }
}

#[test]
fn a_reference_is_the_last_sphere_defined_with_it() {
    let text = format!("{BALLS}R 1 2 0.1\n{BALLS}R 1 2 0.1\nS 1 5 5 5 0 0 0 0 0 0 1 1\nR 1 2 0.1");
    let scene = scene(&text);
    let ids: Vec<SphereId> = scene.sphere_ids().collect();
    let ends: Vec<_> = scene.rods().iter().map(|rod| (rod.end1, rod.end2)).collect();
    assert_eq!(ends, [(ids[0], ids[1]), (ids[2], ids[3]), (ids[4], ids[3])]);
}

#[test]
fn a_million_lines_load_within_seconds() {
    use std::fmt::Write as _;
    let mut text = String::new();
    for index in 0..1_000_000 {
        writeln!(text, "S {index} {index}.25 1.5 -2.75 0 0.125 0 0 0 0 1 0.2 0").unwrap();
    }
    let start = std::time::Instant::now();
    assert_eq!(scene(&text).counts().spheres, 1_000_000);
    // It takes about 0.5 s. The rest allows for a loaded machine.
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}

/// Lines with a valid first word, followed by arbitrary words.
fn wild_line() -> impl Strategy<Value = String> {
    let first = prop_oneof![
        prop::sample::select(vec![
            "S",
            "R",
            "C",
            "P",
            "K",
            "B",
            "T",
            "set",
            "@group",
            "@orientation",
            "@force",
            "@name",
            "@colour",
            "@look",
            "@label",
            "@capsule",
            "@",
            "#",
            "gravity",
            "Sphere",
            "mesh",
            ""
        ])
        .prop_map(str::to_owned),
        ".{0,3}",
    ];
    let word = prop_oneof![
        4 => (0_i32..4).prop_map(|number| number.to_string()),
        4 => any::<f32>().prop_map(|number| number.to_string()),
        1 => prop::sample::select(vec!["gravity", "collisions", "on", "inf", "nan", "-0", "1e-46", "0x1", "1,2,3", "+", "#", "=", "a=1"])
            .prop_map(str::to_owned),
        1 => "\\PC{0,4}",
    ];
    (first, prop::collection::vec(word, 0..15)).prop_map(|(first, words)| format!("{first} {}", words.join(" ")))
}

proptest! {
    #[test]
    fn no_text_causes_a_panic(lines in prop::collection::vec(wild_line(), 0..12)) {
        let _ = parse(&lines.join("\n"));
        let _ = parse(&format!("{BALLS}{}", lines.join("\r\n")));
    }

    #[test]
    fn no_bytes_cause_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = Scene::parse_bytes(&bytes, Path::new("a.txt"));
    }

    /// A valid file with one changed byte either loads or is refused.
    #[test]
    fn no_changed_byte_causes_a_panic(place in 0..EXAMPLE.len(), byte in any::<u8>()) {
        let mut bytes = EXAMPLE.as_bytes().to_vec();
        bytes[place] = byte;
        let _ = Scene::parse_bytes(&bytes, Path::new("a.txt"));
    }
}
