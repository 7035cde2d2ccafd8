use std::path::Path;

use super::*;
use crate::scene::Loaded;

fn read(text: &str) -> Result<Loaded> {
    Scene::parse(text, Path::new("scene.txt"))
}

/// Every pair of the groups 0 to 39, by the rule of the documentation.
#[test]
fn words_say_what_lists_say() {
    let mut scene = Scene::new();
    scene.set_group_meets(3, [1, 2]).unwrap();
    scene.set_group_meets(5, []).unwrap();
    scene.set_group_meets(30, [30, 31]).unwrap();
    let touching = [(1, 1), (1, 3), (2, 2), (2, 3), (30, 30), (30, 31), (31, 31)];
    for one in 0..40 {
        for other in 0..40 {
            let has_list = [3, 5, 30].contains(&one) || [3, 5, 30].contains(&other);
            let pair = (one.min(other), one.max(other));
            let expected = touching.contains(&pair) || (one == other && !has_list);
            let [a, b] = [one, other].map(|group| scene.groups.words(group));
            assert_eq!((scene.groups_touch(one, other), a.touches(b)), (expected, expected), "{one} and {other}");
        }
    }
}

#[test]
fn too_many_groups_are_refused() {
    let mut scene = Scene::new();
    scene.set_group_meets(100, 0..29).unwrap();
    let error = scene.set_group_meets(100, 0..30).unwrap_err().to_string();
    assert_eq!(error, "group.meets: 31 groups is not allowed, expected at most 30 groups that have a list or are in one");
    assert_eq!(scene.group_meets(100).unwrap().len(), 29, "the old list stays");
}

#[test]
fn lists_are_read_written_and_kept() {
    let text = "set contact_law rigid\n@group 4 meets=1,7\nS 1 0 0 0 0 0 0 0 0 0 1 1 0\n@group 1\nS 2 5 0 0 0 0 0 0 0 0 1 1 0\n@group 9 meets=none\n";
    let scene = read(text).unwrap().scene;
    assert_eq!((scene.group_meets(4), scene.group_meets(9), scene.group_meets(1)), (Some(vec![1, 7]), Some(vec![]), None));
    let again = read(&scene.to_text()).unwrap().scene;
    assert_eq!(again.groups, scene.groups, "{}", scene.to_text());
    assert_eq!(scene.spheres()[0].group, 4);
    assert_eq!(again.spheres()[0].group, 4);
    scene.check_contact_law(crate::Integrator::SymplecticEuler).unwrap();
    let other = read(&text.replace("rigid", "linear")).unwrap().scene;
    let error = other.check_contact_law(crate::Integrator::SymplecticEuler).unwrap_err().to_string();
    assert!(error.contains("linear with `meets` of group 4"), "{error}");
}

#[test]
fn wrong_lists_are_refused_with_their_line() {
    for (line, expected) in [
        (
            "@group 4 meets=1,x",
            "scene.txt:1: @group meets: 'x' is not a group, expected whole numbers from 0 to 65535 with commas, or none",
        ),
        ("@group 4 meets=65536", "scene.txt:1: @group meets: '65536' is not a group"),
        ("@group 4 meet=1", "scene.txt:1: @group 'meet': an unknown key, did you mean meets?"),
        ("@group 4 meets=1\n@group 4 meets=2", "scene.txt:2: @group meets: group 4 has another list already"),
    ] {
        let error = read(line).unwrap_err().to_string();
        assert!(error.contains(expected), "{line}: {error}");
    }
}
