//! Records the commit that the program is built from, if it is known, so that benchmark results can be traced to a version.

use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let version = env::var("CARGO_PKG_VERSION").expect("cargo sets it");
    println!("cargo::rustc-env=ROCKFALL_VERSION={version}");
    if !git(&["rev-parse", "--show-toplevel"]).is_some_and(|repository| is_ours(&repository)) {
        return;
    }
    // Everything that the program may depend on. If a part were missing, an uncommitted change could go unnoticed.
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

/// Whether a repository is that of this workspace. A packaged copy of the sources may lie inside another repository.
fn is_ours(repository: &str) -> bool {
    let here = env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it");
    let same = |path: &Path| path.canonicalize().ok();
    Path::new(&here).ancestors().nth(2).is_some_and(|workspace| same(workspace) == same(Path::new(repository)))
}

/// Output of git, run in this package; `None` without git or outside a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}
