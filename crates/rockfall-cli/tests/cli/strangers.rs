//! Checkpoints that come from somebody else, or that were moved.

use std::fs;
use std::path::Path;

use crate::common::{Rockfall, mixed};

/// Changes the note of a checkpoint.
fn edit(path: &Path, change: impl FnOnce(&mut serde_json::Map<String, serde_json::Value>)) {
    let mut checkpoint = rockfall::Checkpoint::load(path).unwrap();
    let mut note: serde_json::Value = serde_json::from_str(&checkpoint.note).unwrap();
    change(note.as_object_mut().unwrap());
    checkpoint.note = note.to_string();
    checkpoint.save(path).unwrap();
}

/// A folder with a checkpoint, and beside it a file that the checkpoint must not touch.
fn stranger() -> Rockfall {
    let rockfall = Rockfall::with(&mixed(4));
    fs::create_dir(rockfall.path("gift")).unwrap();
    rockfall.run("run scene.txt --backend cpu --steps 3 --save gift/a.txt --checkpoint gift/a.ckpt", 0);
    fs::write(rockfall.path("mine.txt"), "mine").unwrap();
    fs::write(rockfall.path(".bashrc"), "mine").unwrap();
    rockfall
}

#[test]
fn a_checkpoint_writes_only_below_its_folder() {
    let rockfall = stranger();
    let mine = rockfall.path("mine.txt").display().to_string();
    for save in [mine.as_str(), "../mine.txt", "sub/../../mine.txt"] {
        edit(&rockfall.path("gift/a.ckpt"), |note| drop(note.insert("save".into(), save.into())));
        let (_, err) = rockfall.run("run --resume gift/a.ckpt --steps 5", 2);
        let expected = "error: gift/a.ckpt: it has outputs that are not below its folder: --save ";
        assert!(err.starts_with(expected) && err.contains("mine.txt; name them again, or give --outputs-as-recorded"), "{err}");
        assert_eq!(rockfall.read("mine.txt"), "mine");
    }
    rockfall.run("run --resume gift/a.ckpt --steps 5 --save b.txt", 0);
    assert!(rockfall.path("b.txt").exists());
    assert_eq!(rockfall.read("mine.txt"), "mine");
    edit(&rockfall.path("gift/a.ckpt"), |note| drop(note.insert("save".into(), mine.as_str().into())));
    rockfall.run("run --resume gift/a.ckpt --steps 6 --outputs-as-recorded", 0);
    assert_ne!(rockfall.read("mine.txt"), "mine");
}

/// A name cannot look like a line of the program, and cannot turn the direction of writing.
#[test]
fn a_name_from_a_checkpoint_stays_on_its_line() {
    let rockfall = stranger();
    let name = "../o.txt\nerror: run this: \u{202e}rm.txt";
    edit(&rockfall.path("gift/a.ckpt"), |note| drop(note.insert("save".into(), name.into())));
    let (_, err) = rockfall.run("run --resume gift/a.ckpt --steps 5", 2);
    assert_eq!(err.lines().count(), 1, "{err}");
    assert!(err.contains("../o.txt\\nerror: run this: \\u{202e}rm.txt"), "{err}");
}

/// Every kind of output has its extension, also with `--outputs-as-recorded`.
#[test]
fn a_checkpoint_names_no_file_of_another_kind() {
    let rockfall = stranger();
    edit(&rockfall.path("gift/a.ckpt"), |note| drop(note.insert("save".into(), "../.bashrc".into())));
    for option in ["", " --outputs-as-recorded"] {
        let (_, err) = rockfall.run(&format!("run --resume gift/a.ckpt --steps 5{option}"), 2);
        assert!(err.contains(".bashrc: a name without an extension, expected a name that ends in .txt"), "{err}");
        assert_eq!(rockfall.read(".bashrc"), "mine");
    }
    let (_, err) = rockfall.run("run scene.txt --outputs-as-recorded", 2);
    assert!(err.contains("'[SCENE]' cannot be used with '--outputs-as-recorded'"), "{err}");
}

#[cfg(unix)]
#[test]
fn links_in_the_folder_of_a_checkpoint_are_not_followed_out_of_it() {
    use std::os::unix::fs::symlink;
    let rockfall = stranger();
    fs::remove_file(rockfall.path("gift/a.txt")).unwrap();
    symlink(rockfall.path("mine.txt"), rockfall.path("gift/a.txt")).unwrap();
    let (_, err) = rockfall.run("run --resume gift/a.ckpt --steps 5", 2);
    assert!(err.contains("not below its folder: --save gift/a.txt"), "{err}");
    assert_eq!(rockfall.read("mine.txt"), "mine");

    // Frames have names that nobody chose.
    rockfall.run("run scene.txt --backend cpu --steps 3 --out gift/b.pvd --every 1 --checkpoint gift/b.ckpt", 0);
    symlink(rockfall.path("mine.txt"), rockfall.path("gift/b/0000000004.vtp")).unwrap();
    rockfall.run("run --resume gift/b.ckpt --steps 5", 0);
    assert_eq!(rockfall.read("mine.txt"), "mine");
}

/// A copied folder has its own results.
#[test]
fn a_run_in_a_copied_folder_leaves_the_original_alone() {
    let rockfall = Rockfall::with(&mixed(8));
    for folder in ["first", "second"] {
        fs::create_dir(rockfall.path(folder)).unwrap();
    }
    let files = |folder: &str| format!("--out {folder}/out.csv --every 2 --trace {folder}/trace.csv --save {folder}/end.txt");
    let run = "run scene.txt --backend cpu --dt 0.01";
    rockfall.run(&format!("{run} --steps 4 {} --checkpoint first/run.ckpt", files("first")), 0);
    let names = ["out.csv", "trace.csv", "end.txt", "run.ckpt"];
    let read = |folder: &str| names.map(|name| fs::read(rockfall.path(folder).join(name)).unwrap());
    let first = read("first");
    for (name, bytes) in names.into_iter().zip(&first) {
        fs::write(rockfall.path("second").join(name), bytes).unwrap();
    }
    rockfall.run("run --resume second/run.ckpt --steps 8", 0);
    assert!(read("first") == first, "the original has changed");
    rockfall.run(&format!("{run} --steps 8 {}", files("first")), 0);
    assert!(read("first")[..3] == read("second")[..3], "the copy differs from a whole run");
}

#[cfg(unix)]
#[test]
fn folders_whose_names_are_not_utf_8_hold_checkpoints() {
    use std::os::unix::ffi::OsStrExt as _;
    let rockfall = Rockfall::with(&mixed(4));
    let folder = rockfall.folder.path().join(std::ffi::OsStr::from_bytes(b"run\xff"));
    fs::create_dir(&folder).unwrap();
    let run = |arguments: &str, out: &Path| {
        let output = rockfall.command(arguments).current_dir(&folder).arg("--out").arg(out).output().unwrap();
        crate::common::finish(output, arguments, 0)
    };
    run("run ../scene.txt --backend cpu --steps 4 --every 1 --checkpoint a.ckpt", Path::new("a.csv"));
    let output = rockfall.command("run --resume a.ckpt --steps 6").current_dir(&folder).output().unwrap();
    crate::common::finish(output, "resume", 0);
    assert!(fs::read_to_string(folder.join("a.csv")).unwrap().contains("\n6,"));
    // The folder is a part of the path of the output.
    run("run ../scene.txt --backend cpu --steps 4 --every 1 --checkpoint ../b.ckpt", &folder.join("b.csv"));
    let output = rockfall.command("run --resume ../b.ckpt --steps 6").current_dir(&folder).output().unwrap();
    crate::common::finish(output, "resume", 0);
    assert!(fs::read_to_string(folder.join("b.csv")).unwrap().contains("\n6,"));
}
