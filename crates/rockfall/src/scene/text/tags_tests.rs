use std::path::Path;

use crate::Result;
use crate::scene::{Colour, Loaded, Look, Scene, Tag};

fn parse(text: &str) -> Result<Loaded> {
    Scene::parse(text, Path::new("a.txt"))
}

fn scene(text: &str) -> Scene {
    let loaded = parse(text).unwrap();
    assert_eq!(loaded.warnings, [], "{text}");
    loaded.scene
}

const BALLS: &str = "S 1 0 0 0 0 0 0 0 0 0 1 0.5\nS 2 3 0 0 0 0 0 0 0 0 1 0.5\n";

#[test]
fn names_colours_and_labels_hold_for_the_lines_below() {
    let text = "S 0 9 0 0 0 0 0 0 0 0 1 0.5\n@name left\n@colour #FF8800 # orange\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n\
                @label the heavy one # a comment\n@colour red\nS 2 3 0 0 0 0 0 0 0 0 1 0.5\nR 1 2 0.1\n@name -\n@label -\nK 1 2 1 1 0\n\
                @colour -\nB 0 -1 0 1 0 0 0 1 0 0 0 1\n@name Böden\nP 0 0 0 1 0 0 0 0 1\nC 0 5 0 1 5 0 0 0 0 1 0.25\n";
    let scene = scene(text);
    let spheres: Vec<_> = scene.sphere_ids().map(|id| scene.tag(id).unwrap().cloned()).collect();
    let left = Tag::new().name("left").colour(Colour([255, 136, 0]));
    let heavy = Tag::new().name("left").colour("red".parse().unwrap()).label("the heavy one");
    let floor = Some(Tag::new().name("Böden"));
    assert_eq!(spheres, [None, Some(left), Some(heavy.clone()), floor.clone(), floor.clone()]);
    let rods: Vec<_> = scene.rod_ids().map(|id| scene.tag(id).unwrap().cloned()).collect();
    assert_eq!(rods, [Some(heavy), floor.clone()]);
    let spring = scene.tag(scene.spring_ids().next().unwrap()).unwrap();
    assert_eq!(spring, Some(&Tag::new().colour("red".parse().unwrap())));
    assert_eq!(scene.tag(scene.box_ids().next().unwrap()).unwrap(), None);
    assert_eq!(scene.tag(scene.polygon_ids().next().unwrap()).unwrap().cloned(), floor);
    assert_eq!(scene.tag(scene.capsule_ids().next().unwrap()).unwrap().cloned(), floor);
}

#[test]
fn looks_hold_for_the_lines_below() {
    let scene = scene(
        "@look Wood # of a beech\nS 0 9 0 0 0 0 0 0 0 0 1 0.5\n@look glass\nB 0 -1 0 1 0 0 0 1 0 0 0 1\n\
         P 0 0 0 1 0 0 0 0 1\n@look -\nP 0 0 0 1 0 0 0 0 1\n",
    );
    let look = |id: crate::ObjectId| scene.tag(id).unwrap().map(|tag| tag.look.unwrap());
    assert_eq!(look(scene.sphere_ids().next().unwrap().into()), Some(Look::Wood));
    assert_eq!(look(scene.box_ids().next().unwrap().into()), Some(Look::Glass));
    let polygons: Vec<_> = scene.polygon_ids().map(|id| look(id.into())).collect();
    assert_eq!(polygons, [Some(Look::Glass), None]);
}

#[test]
fn copies_of_a_block_have_the_same_name() {
    let scene = scene("@repeat 3 1 0 0\n@name row\nS 0 0 0 0 0 0 0 0 0 0 1 0.5\n@end\nS 9 0 5 0 0 0 0 0 0 0 1 0.5\n");
    assert_eq!(scene.named("row").unwrap().len(), 4);
}

#[test]
fn wrong_names_and_colours_are_errors_with_line_and_field() {
    let word = "expected one word that begins with a letter or _ and has no = , or #";
    let colours = format!("expected six hexadecimal digits, as in #ff8800, or one of {}", Colour::NAMES.join(", "));
    let label = "expected a line of text other than -, without white space at its ends and without # at its beginning or after \
                 white space";
    let cases = [
        ("@name", "@name NAME: missing, expected `@name NAME`, or `@name -` for none".to_owned()),
        ("@name a b", "@name 'b': one word too many, expected `@name NAME`, or `@name -` for none".to_owned()),
        ("@name 3", format!("@name NAME: '3' is not allowed, {word}")),
        ("@name a=b", format!("@name NAME: 'a=b' is not allowed, {word}")),
        ("@colour", "@colour COLOUR: missing, expected `@colour COLOUR`, or `@colour -` for none".to_owned()),
        ("@colour # red", "@colour COLOUR: missing, expected `@colour COLOUR`, or `@colour -` for none".to_owned()),
        ("@colour yelow", format!("@colour COLOUR: 'yelow' (did you mean yellow?) is not allowed, {colours}")),
        (
            "@colour light blue",
            "@colour 'blue': one word too many, expected `@colour COLOUR`, or `@colour -` for none".to_owned(),
        ),
        ("@look", "@look LOOK: missing, expected `@look LOOK`, or `@look -` for none".to_owned()),
        ("@look marble", format!("@look LOOK: 'marble' is not allowed, expected one of {}", Look::NAMES.join(", "))),
        (
            "@look wod",
            format!("@look LOOK: 'wod' (did you mean wood?) is not allowed, expected one of {}", Look::NAMES.join(", ")),
        ),
        ("@label", "@label TEXT: missing, expected `@label TEXT`, or `@label -` for none".to_owned()),
        ("@label a\tb", format!("@label TEXT: 'a\\tb' is not allowed, {label}")),
        ("@color red", "'@color': an unknown word, did you mean @colour?".to_owned()),
    ];
    for (line, expected) in cases {
        let error = parse(&format!("{BALLS}{line}\nset gravity 1\n")).map(drop).unwrap_err().to_string();
        assert_eq!(error, format!("a.txt:3: {expected}"), "{line}");
    }
    // In a file for the thesis's program, such a line is prose.
    let loaded = parse(&format!("@name of the scene\n{BALLS}")).unwrap();
    assert_eq!((loaded.warnings.len(), loaded.scene.counts().spheres), (1, 2));
}
