use std::path::Path;

use crate::Checkpoint;
use crate::scene::{Capsule, Colour, Cuboid, Look, ObjectId, Rod, Scene, Sphere, Spring, Tag};
use crate::{Backend, Options, Simulation};

fn red() -> Colour {
    "red".parse().unwrap()
}

fn read(text: &str) -> Scene {
    let loaded = Scene::parse(text, Path::new("written")).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(loaded.warnings, [], "{text}");
    loaded.scene
}

/// Kind, insertion index and tag of every object with one.
fn tags(scene: &Scene) -> Vec<String> {
    let index = |id: ObjectId| match id {
        ObjectId::Sphere(id) => format!("sphere {}", scene.spheres.index(id).unwrap()),
        ObjectId::Rod(id) => format!("rod {}", scene.rods.index(id).unwrap()),
        ObjectId::Capsule(id) => format!("capsule {}", scene.capsules.index(id).unwrap()),
        ObjectId::Spring(id) => format!("spring {}", scene.springs.index(id).unwrap()),
        ObjectId::Box(id) => format!("box {}", scene.boxes.index(id).unwrap()),
        ObjectId::Polygon(id) => format!("polygon {}", scene.polygons.index(id).unwrap()),
        ObjectId::Body(id) => format!("body {}", scene.bodies.index(id).unwrap()),
    };
    scene.tagged().map(|(id, tag)| format!("{} {tag:?}", index(id))).collect()
}

/// A scene with tags on objects of all kinds but polygons.
fn sample() -> Scene {
    let mut scene = Scene::new();
    let balls = [0.0, 2.0, 4.0].map(|x| scene.add_sphere(Sphere::new([x, 1.0, 0.0], 0.5)).unwrap());
    let rod = scene.add_rod(Rod::new(balls[0], balls[1], 0.1)).unwrap();
    let spring = scene.add_spring(Spring::new(balls[1], balls[2], 1.0, 1.0)).unwrap();
    let capsules = [3.0, 6.0].map(|y| scene.add_capsule(Capsule::new([0.0, y, 0.0], [1.0, y, 0.0], 0.3)).unwrap());
    let floor = scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])).unwrap();
    scene.set_tag(balls[0], Tag::new().name("left").colour(red())).unwrap();
    scene.set_tag(balls[2], Tag::new().name("right").label("the right one")).unwrap();
    scene.set_tag(rod, Tag::new().name("left")).unwrap();
    scene.set_tag(spring, Tag::new().colour(Colour([1, 2, 3]))).unwrap();
    scene.set_tag(capsules[0], Tag::new().name("pill").look(Look::Stone)).unwrap();
    scene.set_tag(floor, Tag::new().name("floor").look(Look::Glass)).unwrap();
    scene
}

#[test]
fn names_find_objects_of_all_kinds() {
    let scene = sample();
    let balls: Vec<_> = scene.sphere_ids().collect();
    let rods: Vec<_> = scene.rod_ids().collect();
    assert_eq!(scene.named("left").unwrap(), [ObjectId::Sphere(balls[0]), ObjectId::Rod(rods[0])]);
    let capsule = scene.capsule_ids().next().unwrap();
    let parts = [ObjectId::Sphere(balls[3]), ObjectId::Sphere(balls[4]), ObjectId::Rod(rods[1]), ObjectId::Capsule(capsule)];
    assert_eq!(scene.named("pill").unwrap(), parts);
    assert_eq!(scene.names(), ["floor", "left", "pill", "right"]);
}

#[test]
fn an_unknown_name_is_an_error_with_a_suggestion() {
    let error = |scene: &Scene, name: &str| scene.named(name).unwrap_err().to_string();
    assert_eq!(error(&sample(), "lefft"), "no object has the name 'lefft': did you mean 'left'?");
    let all = "expected one of 'floor', 'left', 'pill', 'right'";
    assert_eq!(error(&sample(), "roof"), format!("no object has the name 'roof': {all}"));
    let none = "the scene has no names (a line `@name NAME` gives one)";
    assert_eq!(error(&Scene::new(), "roof"), format!("no object has the name 'roof': {none}"));
}

#[test]
fn tags_that_a_text_cannot_express_are_refused() {
    let mut scene = sample();
    let ball = scene.sphere_ids().next().unwrap();
    for name in ["", "-", "a b", "3", "a=b", "a#", "a\n", "a,b"] {
        assert!(scene.set_tag(ball, Tag::new().name(name)).is_err(), "{name:?}");
    }
    for label in ["-", " a", "a ", "a\nb", "#a", "a #b"] {
        assert!(scene.set_tag(ball, Tag::new().label(label)).is_err(), "{label:?}");
    }
    scene.set_tag(ball, Tag::new().name("_ä-1.").label("a#b = c, d")).unwrap();
    assert_eq!(tags(&read(&scene.to_text())), tags(&scene));
}

#[test]
fn a_written_text_has_the_tags() {
    let mut scene = sample();
    let text = scene.to_text();
    assert_eq!(tags(&read(&text)), tags(&scene), "{text}");
    assert_eq!(read(&text).to_text(), text);
    assert_eq!(text.matches("\nC ").count(), 2, "{text}");
    // A C line cannot give one end another name.
    let end = scene.capsules()[0].end2;
    scene.set_tag(end, Tag::new().name("tip")).unwrap();
    let text = scene.to_text();
    assert_eq!(tags(&read(&text)), tags(&scene), "{text}");
    assert_eq!(text.matches("\nC ").count(), 1, "{text}");
}

#[test]
fn a_removed_object_takes_its_name_along() {
    let mut scene = sample();
    let first = scene.sphere_ids().next().unwrap();
    scene.remove_sphere(first).unwrap();
    assert_eq!(scene.names(), ["floor", "pill", "right"]);
    // The slot of the removed sphere is used again, without its name.
    let next = scene.add_sphere(Sphere::new([9.0; 3], 0.5)).unwrap();
    assert_eq!(scene.tag(next).unwrap(), None);
    assert!(scene.tag(first).is_err());
    let right = scene.named("right").unwrap();
    assert_eq!(right, [ObjectId::Sphere(scene.sphere_ids().nth(1).unwrap())]);
    assert_eq!(tags(&read(&scene.to_text())), tags(&scene));
}

#[test]
fn tags_survive_steps_edits_and_checkpoints() {
    let scene = sample();
    let mut simulation = Simulation::with_options(scene.clone(), Options::new().backend(Backend::Cpu)).unwrap();
    simulation.run(3, 0.01).unwrap();
    let last = simulation.scene().sphere_ids().last().unwrap();
    simulation.set_tag(last, Tag::new().name("last")).unwrap();
    let bytes = simulation.checkpoint().unwrap().to_bytes();
    let read = Checkpoint::from_bytes(&bytes, "a.ckpt").unwrap();
    assert_eq!(tags(&read.scene), tags(simulation.scene()));
    assert_eq!(read.to_bytes(), bytes);
    assert_eq!(simulation.scene().names(), ["floor", "last", "left", "pill", "right"]);
    // Without tags, the section is empty.
    let mut plain = Simulation::with_options(read_plain(&scene), Options::new().backend(Backend::Cpu)).unwrap();
    assert!(plain.checkpoint().unwrap().to_bytes().len() < bytes.len());
}

fn read_plain(scene: &Scene) -> Scene {
    let text = scene.to_text();
    let lines: Vec<&str> =
        text.lines().filter(|line| !["@name", "@colo", "@labe"].contains(&&line[..line.len().min(5)])).collect();
    read(&lines.join("\n"))
}

/// `@label -` where no label is in use says that there are none; it is kept, also beside objects that were added before it.
#[test]
fn a_text_can_say_that_there_are_no_labels() {
    let text =
        "@label -\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n@label a\nS 2 2 0 0 0 0 0 0 0 0 1 0.5\n@label -\nS 3 4 0 0 0 0 0 0 0 0 1 0.5\n";
    let labels = |scene: &Scene| -> Vec<Option<String>> {
        scene.sphere_ids().map(|ball| scene.tag(ball).unwrap().and_then(|tag| tag.label.clone())).collect()
    };
    let scene = read(text);
    assert_eq!(labels(&scene), [Some(String::new()), Some("a".to_owned()), None]);
    assert_eq!(labels(&read(&scene.to_text())), labels(&scene), "{}", scene.to_text());
    let late =
        read("S 1 0 0 0 0 0 0 0 0 0 1 0.5\nS 2 2 0 0 0 0 0 0 0 0 1 0.5\n@label -\nR 1 2 0.1\nS 3 4 0 0 0 0 0 0 0 0 1 0.5\n");
    assert!(late.to_text().contains("@label -\n"), "{}", late.to_text());
}
