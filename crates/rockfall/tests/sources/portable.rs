//! Functions whose last bit depends on the system: a sine of the C library is not that of WebAssembly, nor that of another C library.

use std::fs;
use std::path::{Path, PathBuf};

/// Folders and files of the crate that a step runs.
const OF_STEPS: [&str; 16] = [
    "rotate.rs",
    "laws",
    "physics",
    "step",
    "model",
    "exec/cpu.rs",
    "user_laws",
    "rigid/broad.rs",
    "rigid/collide.rs",
    "rigid/collide",
    "rigid/frame.rs",
    "rigid/frame",
    "rigid/pose.rs",
    "rigid/world.rs",
    "scene/motion.rs",
    "scene/pose.rs",
];
/// Methods of floats and of glam that call the system's functions. The crate `libm` has the same bits everywhere.
const OF_SYSTEM: &str = "sin cos tan sin_cos asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 exp_m1 ln ln_1p log log2 log10 \
                         powf cbrt hypot from_scaled_axis from_axis_angle from_rotation_x from_rotation_y from_rotation_z from_euler slerp";

fn files(path: &Path, found: &mut Vec<PathBuf>) {
    if path.is_dir() {
        fs::read_dir(path).unwrap().for_each(|entry| files(&entry.unwrap().path(), found));
    } else if path.extension().is_some_and(|extension| extension == "rs") && !path.to_str().unwrap().contains("tests") {
        found.push(path.to_owned());
    }
}

/// The calls in a text, but for its tests, with the numbers of their lines.
fn calls(text: &str) -> Vec<(usize, &str)> {
    let code = text.split("#[cfg(test)]").next().unwrap_or("");
    let names: Vec<&str> = OF_SYSTEM.split_whitespace().collect();
    let is_call =
        |line: &str, name: &str| [".", "::"].iter().any(|sign| line.replace("libm::", "").contains(&format!("{sign}{name}(")));
    let lines = code.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
    lines
        .filter(|(_, line)| names.iter().any(|name| is_call(line, name)))
        .map(|(number, line)| (number + 1, line.trim()))
        .collect()
}

#[test]
fn calls_are_found() {
    let text =
        "let a = x.sin();\n// x.sin()\nlet b = libm::sin(x);\nlet q = Quat::from_scaled_axis(v);\n#[cfg(test)]\nx.cos()\n";
    assert_eq!(calls(text).iter().map(|call| call.0).collect::<Vec<_>>(), [1, 4]);
}

#[test]
fn steps_call_no_function_whose_bits_depend_on_the_system() {
    let mut found = Vec::new();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for path in OF_STEPS {
        assert!(source.join(path).exists(), "{path}");
        files(&source.join(path), &mut found);
    }
    assert!(found.len() > 100, "{} files", found.len());
    let wrong: Vec<String> = found
        .iter()
        .flat_map(|path| {
            let text = fs::read_to_string(path).unwrap();
            calls(&text).iter().map(|(number, line)| format!("{}:{number}: {line}", path.display())).collect::<Vec<_>>()
        })
        .collect();
    assert!(wrong.is_empty(), "use libm:\n{}", wrong.join("\n"));
}
