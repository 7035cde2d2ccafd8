//! Runs the binary in a temporary folder for each test.

#![allow(dead_code, reason = "every test binary uses only a part of this module")]

use std::fs;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A temporary folder, and commands that run in it.
pub(crate) struct Rockfall {
    pub(crate) folder: TempDir,
}

impl Rockfall {
    /// Creates a folder that contains only `scene.txt`.
    pub(crate) fn with(scene: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.txt"), scene).unwrap();
        Self { folder }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rockfall"));
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        // Without it, graphics drivers print warnings to standard error, which the tests compare.
        command.env("XDG_RUNTIME_DIR", self.folder.path());
        command
    }

    /// Runs a command, checks its exit code and returns standard output and standard error.
    #[track_caller]
    pub(crate) fn run(&self, arguments: &str, code: i32) -> (String, String) {
        finish(self.command(arguments).output().unwrap(), arguments, code)
    }

    #[track_caller]
    pub(crate) fn run_with_input(&self, arguments: &str, input: &[u8], code: i32) -> (String, String) {
        let mut child =
            self.command(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(input).unwrap();
        finish(child.wait_with_output().unwrap(), arguments, code)
    }
}

#[track_caller]
pub(crate) fn finish(output: Output, arguments: &str, code: i32) -> (String, String) {
    let out = String::from_utf8(output.stdout).unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments}\n{out}\n{err}");
    assert!(!err.contains("panicked"), "{arguments}\n{err}");
    (out, err)
}

/// Returns a scene with every kind of object: balls over a box and a polygon, capsules, a chain on a fixed sphere, springs, a
/// tether and two groups. It is stable at a time step of 0.01 s.
pub(crate) fn mixed(balls: usize) -> String {
    let mut scene =
        String::from("set gravity 9\nset contact_force 2000\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\nP -1.6 0 -1.6 0 4 0 0 0 3.2\n");
    for ball in 0..balls {
        let (x, y, z) = (ball % 4, ball / 16, ball / 4 % 4);
        let [x, z] = [x, z].map(|place| place as f32 * 0.6 - 0.9);
        scene += &format!("S {ball} {x} {} {z} 0.1 -2 {} 0 0 0 {} 0.25\n", y as f32 * 0.52 + 0.3, 0.01 * z, 1 + y);
    }
    let top = 0.5 + 0.52 * balls.div_ceil(16) as f32;
    for link in 0..4 {
        scene += &format!("S {} {} {top} 0.1 0 0 0 0 0 0 1 0.1 {}\n", 900 + link, 0.4 * link as f32 - 1.2, u8::from(link == 0));
    }
    for link in 0..3 {
        scene += &format!("R {} {} 0.05 0.4\n", 900 + link, 901 + link);
    }
    for corner in 0..3 {
        let y = top + 0.6 + 0.3 * corner as f32;
        scene += &format!("S {} {} {y} 0 0 0 0 0 0.001 0 1 0.12\n", 910 + corner, 0.3 * corner as f32);
    }
    scene += "R 910 911 0.1\nK 911 912 200 0.4 1\nK 912 910 200 0.6 1\n";
    scene += &format!("T 912 0 {} 0 20 0 0.5\n@group 3\n", top + 2.0);
    for (x, z) in [(-0.8, -0.6), (0.3, 0.7), (0.9, -0.9)] {
        scene += &format!("C {x} {y} {z} {} {} {} 0 -3 0 1 0.15\n", x + 0.4, top + 1.4, z - 0.3, y = top + 1.2);
    }
    scene
}
