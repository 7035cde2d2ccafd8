//! Names of output files: one rule for all options.

use std::path::Path;

use crate::failure::Failure;

/// Extensions of every output. The first one is also the format of a device or a pipe.
pub(crate) const STATE: &[&str] = &["csv", "npz", "vtp"];
pub(crate) const SERIES: &[&str] = &["csv", "npz", "pvd", "vtp"];
pub(crate) const TRACE: &[&str] = &["csv"];
pub(crate) const TENSIONS: &[&str] = &["csv"];
pub(crate) const GAUGES: &[&str] = &["csv"];
pub(crate) const BODIES: &[&str] = &["csv"];
pub(crate) const JOINTS: &[&str] = &["csv"];
pub(crate) const EVENTS: &[&str] = &["csv"];
pub(crate) const SCENE: &[&str] = &["txt"];
pub(crate) const CHECKPOINT: &[&str] = &["ckpt"];
pub(crate) const EVOLUTION: &[&str] = &["json"];
pub(crate) const FIELDS: &[&str] = &["vti", "npz", "csv"];
pub(crate) const CHART: &[&str] = &["svg"];

/// Returns an error unless a path has one of the known extensions, in upper or lower case, or is a device or a pipe.
pub(crate) fn check(option: &str, path: &Path, known: &[&str]) -> Result<(), Failure> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension {
        Some(extension) if known.contains(&extension.as_str()) => Ok(()),
        None if is_device(path) => Ok(()),
        _ => Err(unknown(option, path, &ends(known))),
    }
}

/// Error for a path without a known extension. `expected` lists them.
pub(crate) fn unknown(option: &str, path: &Path, expected: &str) -> Failure {
    let what = match path.extension() {
        Some(extension) => format!("unknown extension .{}", extension.to_string_lossy()),
        None => "a name without an extension".to_owned(),
    };
    Failure::usage(format!("{option} {}: {what}, expected {expected}", path.display()))
}

/// Lists extensions: `a name that ends in .csv, .npz or .vtp`.
fn ends(known: &[&str]) -> String {
    let all: Vec<String> = known.iter().map(|extension| format!(".{extension}")).collect();
    let list = match all.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => all.concat(),
    };
    format!("a name that ends in {list}")
}

/// Whether a path is neither a file nor a folder, like `/dev/stdout`, also where that is redirected to a file.
fn is_device(path: &Path) -> bool {
    let special = path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir());
    special || cfg!(unix) && path.starts_with("/dev")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_extensions_in_any_case_and_devices_are_accepted() {
        for name in ["a.csv", "a.NPZ", "folder.x/b.Vtp", "/dev/null", "/dev/stdout"] {
            assert!(check("--out", Path::new(name), STATE).is_ok(), "{name}");
        }
        for name in ["a.vtu", "a", "csv", ".csv", "a.csv.gz", "..", "folder.csv/a"] {
            assert!(check("--out", Path::new(name), STATE).is_err(), "{name}");
        }
    }

    #[test]
    fn the_error_lists_what_is_known() {
        let message = |name, known| match check("--out", Path::new(name), known) {
            Err(Failure::Usage(message)) => message,
            other => panic!("{other:?}"),
        };
        let states = "expected a name that ends in .csv, .npz or .vtp";
        assert_eq!(message("final.vtu", STATE), format!("--out final.vtu: unknown extension .vtu, {states}"));
        assert_eq!(message("final", STATE), format!("--out final: a name without an extension, {states}"));
        assert_eq!(message("a.TXT", TRACE), "--out a.TXT: unknown extension .TXT, expected a name that ends in .csv");
    }
}
