//! Each part of the uniform block has one writer.

use std::fs;
use std::path::{Path, PathBuf};

/// The parts of `Step`, and the files that may assign to their fields.
const WRITERS: [(&str, &[&str]); 3] = [
    ("constants", &["model/world/constants.rs"]),
    ("lists", &["simulation/lists.rs"]),
    ("layout", &["model/world.rs", "model/world/build.rs", "model/world/topology.rs", "exec/gpu/world.rs"]),
];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.extension() {
            _ if path.is_dir() => rust_files(&path, found),
            Some(extension) if extension == "rs" => found.push(path),
            _ => {}
        }
    }
}

/// Whether a line assigns to a field of a part, as in `step.layout.large = 0;`. A copy of the block may take a whole part.
fn assigns(line: &str, part: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    let field = format!("step.{part}.");
    code.match_indices(&field).any(|(at, _)| {
        let rest = &code[at + field.len()..];
        let rest = rest.trim_start_matches(|letter: char| letter == '_' || letter.is_alphanumeric());
        let rest = rest.trim_start().trim_start_matches(['+', '-', '|', '&', '*', '^']);
        rest.starts_with('=') && !rest.starts_with("==") && !rest.starts_with("=>")
    })
}

#[test]
fn each_part_of_the_uniform_block_has_one_writer() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    let mut found = [0; WRITERS.len()];
    for file in &files {
        let name = file.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/");
        let text = fs::read_to_string(file).unwrap();
        let product = text.split("#[cfg(test)]\nmod tests").next().unwrap();
        for (line, number) in product.lines().zip(1..) {
            for ((part, writers), count) in WRITERS.iter().zip(&mut found) {
                if assigns(line, part) {
                    assert!(writers.contains(&name.as_str()), "{name}:{number}: `{part}` has other writers: {writers:?}");
                    *count += 1;
                }
            }
        }
    }
    assert!(found.iter().all(|count| *count > 0), "no writer found for a part: {found:?}");
}

#[test]
fn an_assignment_is_told_from_a_comparison() {
    assert!(assigns("self.step.layout.large = 0;", "layout"));
    assert!(assigns("world.step.constants.flags |= flag;", "constants"));
    assert!(!assigns("world.step.lists = other.lists;", "lists"));
    assert!(!assigns("if step.layout.large == 0 {", "layout"));
    assert!(!assigns("let large = step.layout.large;", "layout"));
    assert!(!assigns("// step.layout.large = 0", "layout"));
}
