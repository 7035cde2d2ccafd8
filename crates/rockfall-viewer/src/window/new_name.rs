//! Names of files that do not exist yet, so that nothing is overwritten.

use std::path::{Path, PathBuf};

/// Returns the first of `stem-1.extension`, `stem-2.extension` ... in a folder that does not exist.
pub fn new_name(folder: &Path, stem: &str, extension: &str) -> PathBuf {
    let name = |number: u64| match extension {
        "" => folder.join(format!("{stem}-{number}")),
        extension => folder.join(format!("{stem}-{number}.{extension}")),
    };
    (1..).map(name).find(|path| !path.exists()).unwrap_or_default()
}

/// Returns the name of a scene for the files that are made of it: `bridge` for `scenes/bridge.txt`.
pub fn stem_of(name: &str) -> String {
    let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
    let words = stem.split(|letter: char| !letter.is_alphanumeric() && letter != '_').filter(|word| !word.is_empty());
    let plain = words.collect::<Vec<_>>().join("-");
    if plain.is_empty() { "scene".to_owned() } else { plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_counted_up_past_existing_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        assert_eq!(new_name(folder.path(), "bridge", "png"), path("bridge-1.png"));
        for name in ["bridge-1.png", "bridge-2.png"] {
            std::fs::write(path(name), "").unwrap();
        }
        assert_eq!(new_name(folder.path(), "bridge", "png"), path("bridge-3.png"));
        assert_eq!(new_name(folder.path(), "pile-2000", "txt"), path("pile-2000-1.txt"));
        assert_eq!(new_name(folder.path(), "frames", ""), path("frames-1"));
    }

    #[test]
    fn stems_of_scenes_are_plain() {
        let names = ["scenes/bridge.txt", "the built-in scene", "standard input", "sphere (index 4)", "-", ""].map(stem_of);
        assert_eq!(names, ["bridge", "the-built-in-scene", "standard-input", "sphere-index-4", "scene", "scene"]);
    }
}
