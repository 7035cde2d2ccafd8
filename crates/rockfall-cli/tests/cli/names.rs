//! Names, colours and labels of objects on the command line.

use super::common::Rockfall;

/// A named ball over a named floor.
const SCENE: &str = "@name left\nS 1 0 2 0 0 0 0 0 0 0 1 0.5\n@name right\nS 2 1.5 1 0 0 0 0 0 0 0 1 0.5\n@name floor\n\
                     B -5 -1 -5 10 0 0 0 1 0 0 0 10\n";

#[test]
fn names_colours_and_labels_are_saved_and_are_in_checkpoints() {
    let lines = "@name left\n@colour red\n@look wood\n@label the left one\nS 1 0 2 0 0 0 0 0 0 0 1 0.5\n@name -\n@colour #0a0B0c\n@look glass\n@label -\n\
                 B -5 -1 -5 10 0 0 0 1 0 0 0 10\n";
    let rockfall = Rockfall::with(lines);
    rockfall.run("run scene.txt --backend cpu --steps 0 --save a.txt --checkpoint a.ckpt", 0);
    let saved = rockfall.read("a.txt");
    assert!(saved.ends_with(&lines.replace("1 0.5\n", "1 0.5 0\n").replace("#0a0B0c", "#0a0b0c")), "{saved}");
    rockfall.run("run --resume a.ckpt --steps 0 --save b.txt", 0);
    assert!(
        rockfall.read("b.txt").contains("@name left\n@colour red\n@look wood\n@label the left one\nS 1 "),
        "{}",
        rockfall.read("b.txt")
    );
}

#[test]
fn messages_have_names() {
    let rockfall = Rockfall::with(&SCENE.replace("S 2 1.5 1", "S 2 0.5 2"));
    let (out, err) = rockfall.run("check scene.txt", 0);
    assert!(format!("{out}{err}").contains("sphere 1 ('left') and sphere 2 ('right') overlap"), "{out}{err}");
}

#[test]
fn wrong_lines_are_errors_with_file_line_and_field() {
    let rockfall = Rockfall::with("@name left\n@colour rde\n");
    for command in ["run scene.txt", "check scene.txt"] {
        let (_, err) = rockfall.run(command, 2);
        assert!(err.contains("scene.txt:2: @colour COLOUR: 'rde' (did you mean red?) is not allowed"), "{err}");
    }
    let rockfall = Rockfall::with("@name left\n@look glas\n");
    let (_, err) = rockfall.run("check scene.txt", 2);
    assert!(
        err.contains("scene.txt:2: @look LOOK: 'glas' (did you mean glass?) is not allowed, expected one of plain,"),
        "{err}"
    );
}

#[cfg(feature = "view")]
mod pictures {
    use std::fs;
    use std::hash::{DefaultHasher, Hash, Hasher};

    use super::*;

    /// A hash of the file of a picture of a scene.
    #[track_caller]
    fn picture(scene: &str, more: &str) -> u64 {
        let rockfall = Rockfall::with(scene);
        rockfall.run(&format!("render scene.txt --out a.png --backend cpu --size 96x64 {more}"), 0);
        let mut hasher = DefaultHasher::new();
        fs::read(rockfall.path("a.png")).unwrap().hash(&mut hasher);
        hasher.finish()
    }

    #[test]
    fn objects_of_all_kinds_have_the_colour_of_the_scene_or_of_the_command_line() {
        let ends = "S 1 0 1 0 0 0 0 0 0 0 1 0.2\nS 2 2 1 0 0 0 0 0 0 0 1 0.2\nS 3 1 3 0 0 0 0 0 0 0 1 0.2\n";
        // Two objects, so that the second one is not where an index of 0 would be right too.
        for [first, second] in [
            ["S 4 0 2 0 0 0 0 0 0 0 1 0.5", "S 5 1 2 0 0 0 0 0 0 0 1 0.5"],
            ["R 1 2 0.15", "R 2 3 0.15"],
            ["C 0 2 0 1 2 0 0 0 0 1 0.3", "C 0 4 0 1 4 0 0 0 0 1 0.3"],
            ["K 1 2 1 1 0", "K 2 3 1 1 0"],
            ["B -1 -1 -1 2 0 0 0 1 0 0 0 2", "B 2 -1 -1 2 0 0 0 1 0 0 0 2"],
            ["P -1 0 -1 0 0 2 2 0 0", "P 2 0 -1 0 0 2 2 0 0"],
        ] {
            let scene = |words: &str| format!("{ends}{first}\n{words}{second}");
            let plain = picture(&scene(""), "");
            let red = picture(&scene("@colour red\n"), "");
            assert_ne!(plain, red, "{second}");
            assert!(picture(&scene("@name a\n"), "--colour a=red") == red, "{second}");
            assert!(picture(&scene("@colour navy\n@name a\n"), "--colour a=d62f2f") == red, "{second}");
            assert_eq!(
                picture(&scene("@colour red\n"), "--colour-by speed"),
                picture(&scene(""), "--colour-by speed"),
                "{second}"
            );
        }
    }

    #[test]
    fn a_name_can_be_followed_and_comes_before_a_kind() {
        let view = "--at 3 --plain";
        assert_eq!(picture(SCENE, &format!("--follow right {view}")), picture(SCENE, &format!("--follow 2 {view}")));
        assert_ne!(picture(SCENE, &format!("--follow right {view}")), picture(SCENE, &format!("--follow left {view}")));
        let boxes = SCENE.replace("left", "boxes");
        assert_eq!(picture(&boxes, "--colour boxes=red"), picture(SCENE, "--colour 1=red"));
        // The colours of kinds and of objects are rounded differently, which may show in shadows.
        assert_eq!(picture(SCENE, "--colour boxes=red --plain"), picture(SCENE, "--colour floor=red --plain"));
    }

    #[test]
    fn labels_replace_numbers() {
        let labelled = SCENE.replace("@name left", "@label left");
        assert_eq!(picture(&labelled, ""), picture(SCENE, ""));
        assert_ne!(picture(&labelled, "--label"), picture(SCENE, "--label"));
        let other = SCENE.replace("@name left", "@label other");
        assert_ne!(picture(&labelled, "--label"), picture(&other, "--label"));
    }

    #[test]
    fn a_trajectory_and_a_checkpoint_have_the_looks() {
        let rockfall = Rockfall::with(&SCENE.replace("@name left", "@name left\n@look stone"));
        rockfall.run("run scene.txt --backend cpu --steps 4 --every 2 --out a.npz --checkpoint a.ckpt", 0);
        let plain = Rockfall::with(SCENE);
        plain.run("run scene.txt --backend cpu --steps 4 --every 2 --out a.npz --checkpoint a.ckpt", 0);
        for (file, at) in [("a.npz", "--at 4"), ("a.ckpt", "")] {
            let [stone, usual] = [&rockfall, &plain].map(|rockfall| {
                rockfall.run(&format!("render {file} --out a.png {at} --size 96x64"), 0);
                fs::read(rockfall.path("a.png")).unwrap()
            });
            assert!(stone != usual, "{file}");
        }
    }

    #[test]
    fn a_film_of_a_trajectory_has_the_colours() {
        let rockfall = Rockfall::with(&SCENE.replace("@name left", "@name left\n@colour red"));
        rockfall.run("run scene.txt --backend cpu --steps 4 --every 2 --out a.npz", 0);
        for (file, more) in [("a.png", ""), ("b.png", "--colour left=red"), ("c.png", "--colour left=blue")] {
            rockfall.run(&format!("render a.npz --out {file} --at 2 --size 96x64 {more}"), 0);
        }
        let [a, b, c] = ["a.png", "b.png", "c.png"].map(|file| fs::read(rockfall.path(file)).unwrap());
        assert!(a == b && a != c);
        let film = "render scene.txt --backend cpu --out a.gif --steps 5 --size 96x64 --follow left --colour right=blue";
        rockfall.run(film, 0);
    }

    #[test]
    fn unknown_names_and_colours_are_errors_with_suggestions() {
        let rockfall = Rockfall::with(SCENE);
        for (more, expected) in [
            ("--follow lefft", "--follow lefft: no object has the name 'lefft': did you mean 'left'?"),
            ("--follow me", "no object has the name 'me': expected one of 'floor', 'left', 'right'"),
            ("--follow floor", "--follow floor: only static objects have this name, expected a body"),
            ("--colour lefft=red", "--colour lefft: no object has the name 'lefft': did you mean 'left'?; or the number"),
            ("--colour left=rde", "'rde' (did you mean red?) is not a colour, expected six hexadecimal digits"),
            ("--colour =red", "expected WHAT=COLOUR, where WHAT is a name in the scene"),
        ] {
            let (_, err) = rockfall.run(&format!("render scene.txt --out a.png --backend cpu {more}"), 2);
            assert!(err.contains(expected), "{more}: {err}");
        }
    }
}
