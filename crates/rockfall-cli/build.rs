//! Tells the program which commit it is built from, where that is known: results of a benchmark are worth little without it.

use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let version = env::var("CARGO_PKG_VERSION").expect("cargo tells it");
    println!("cargo::rustc-env=ROCKFALL_VERSION={version}");
    if !git(&["rev-parse", "--show-toplevel"]).is_some_and(|repository| is_ours(&repository)) {
        return;
    }
    // All that the program may depend on: with a part alone it would not be noticed that something has changed since the commit.
    println!("cargo::rerun-if-changed=../../Cargo.toml");
    println!("cargo::rerun-if-changed=../../Cargo.lock");
    for package in fs::read_dir("..").expect("the packages of the workspace").flatten() {
        for part in ["Cargo.toml", "src"] {
            println!("cargo::rerun-if-changed={}", package.path().join(part).display());
        }
    }
    for moved in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", moved]) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    if let Some(commit) = git(&["describe", "--always", "--dirty", "--exclude=*", "--abbrev=9"]) {
        println!("cargo::rustc-env=ROCKFALL_COMMIT={commit}");
        println!("cargo::rustc-env=ROCKFALL_VERSION={version} ({commit})");
    }
}

/// Whether a repository is that of this workspace: what is built from a package may lie within another one.
fn is_ours(repository: &str) -> bool {
    let here = env::var_os("CARGO_MANIFEST_DIR").expect("cargo tells it");
    let same = |path: &Path| path.canonicalize().ok();
    Path::new(&here).ancestors().nth(2).is_some_and(|workspace| same(workspace) == same(Path::new(repository)))
}

/// What git prints, run in this package; `None` where there is no git, or no repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}
