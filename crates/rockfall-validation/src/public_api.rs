//! `cargo xtask public-api`: finds every change of the public API.
//!
//! The API comes from rustdoc's JSON, which is unstable in stable toolchains. `scripts/rustdoc-unstable` lets the toolchain in use
//! write it.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use public_api::Builder;
use rockfall_validation::Result;

/// The published libraries.
const LIBRARIES: [&str; 5] = ["rockfall", "rockfall-evolve", "rockfall-import", "rockfall-trajectory", "rockfall-viewer"];

/// Compares the API of every library with its listing, or writes the listings anew. Returns whether none has changed.
///
/// # Errors
/// When the documentation cannot be built, and when a file cannot be read or written.
pub(crate) fn check(update: bool) -> Result<bool> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    document(root)?;
    let mut changed = Vec::new();
    for library in LIBRARIES {
        let now = listing(root, library)?;
        let path = root.join("crates").join(library).join("public-api.txt");
        if update {
            fs::write(&path, now)?;
            continue;
        }
        let before = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        if report(&before, &now) {
            changed.push(library);
        } else {
            println!("{library}: {} public items, unchanged", now.lines().count());
        }
    }
    if changed.is_empty() {
        return Ok(true);
    }
    eprintln!("The public API changed: {}. If that is intended, run", changed.join(", "));
    eprintln!("`cargo xtask public-api --update` and commit the listings.");
    Ok(false)
}

/// Writes the JSON of all crates. The whole workspace is documented, so that it has the same features as in other builds.
fn document(root: &Path) -> Result<()> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["doc", "--workspace", "--no-deps", "--quiet"]).current_dir(root);
    cargo.env("RUSTDOC", root.join("scripts/rustdoc-unstable"));
    cargo.env("RUSTDOCFLAGS", "-Zunstable-options --output-format=json");
    if cargo.status()?.success() { Ok(()) } else { Err("rustdoc failed".into()) }
}

/// The public items of a library, one per line.
fn listing(root: &Path, library: &str) -> Result<String> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    let json = target.join("doc").join(library.replace('-', "_")).with_extension("json");
    let api = Builder::from_rustdoc_json(&json)
        .omit_blanket_impls(true)
        .omit_auto_trait_impls(true)
        .omit_auto_derived_impls(true)
        .build()
        .map_err(|error| format!("{}: {error}", json.display()))?;
    Ok(api.items().map(|item| format!("{item}\n")).collect())
}

/// Prints the items that were removed and added. Returns whether there are any.
fn report(before: &str, now: &str) -> bool {
    let [old, new]: [BTreeSet<&str>; 2] = [before, now].map(|text| text.lines().collect());
    old.difference(&new).for_each(|item| println!("-{item}"));
    new.difference(&old).for_each(|item| println!("+{item}"));
    old != new
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn removed_and_added_items_are_reported() {
        assert!(!report("pub fn a()\npub fn b()\n", "pub fn a()\npub fn b()\n"));
        assert!(report("pub fn a()\n", "pub fn a()\npub fn b()\n"));
        assert!(report("pub fn a()\npub fn b()\n", "pub fn a()\n"));
    }
}
