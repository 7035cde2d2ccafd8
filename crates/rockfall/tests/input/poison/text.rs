//! Special numbers in every field of every line of the scene text.

use std::path::Path;

use rockfall::{Error, Scene};

/// Every kind of line with valid numbers, and the names of its fields in error messages.
const LINES: &[(&str, &str)] = &[
    ("S 3 1 2 3 0 0 0 0 0 0 1 0.5 0", "reference|x|y|z|vx|vy|vz|lx|ly|lz|mass|radius|fixed"),
    ("R 1 2 0.1 3", "end1|end2|radius|length"),
    ("C 0 5 0 0 6 0 1 2 3 4 0.25", "x1|y1|z1|x2|y2|z2|vx|vy|vz|mass|radius"),
    ("P 0 0 0 0 0 1 1 0 0", "x|y|z|left x|left y|left z|right x|right y|right z"),
    ("K 1 2 10 3 0.5", "a|b|stiffness|length|damping"),
    ("B 0 -1 0 1 0 0 0 2 0 0 0 3", "x|y|z|i x|i y|i z|j x|j y|j z|k x|k y|k z"),
    ("T 1 0 9 0 20 1 0.1", "sphere|x|y|z|stiffness|length|damping"),
    ("@group 7", "number"),
    ("@orientation 1 0 1 0 0", "sphere|w|x|y|z"),
    ("@force 1 1 2 3", "sphere|x|y|z"),
    ("set gravity 9.81", "gravity"),
    ("set gravity_direction 0,-1,0", "gravity_direction"),
    ("set restitution 0.5", "restitution"),
    ("set contact_force 100", "contact_force"),
    ("set contact_damping 10", "contact_damping"),
    ("set friction 10", "friction"),
    ("set activation_threshold 1", "activation_threshold"),
];

const BALLS: &str = "S 1 0 0 0 0 0 0 0 0 0 1 0.5\nS 2 3 0 0 0 0 0 0 0 0 1 0.5 0\n";

fn read(line: &str) -> Result<Scene, String> {
    match Scene::parse(&format!("{BALLS}{line}\n"), Path::new("poison.txt")) {
        Ok(loaded) => Ok(loaded.scene),
        Err(Error::SceneLine { line: 3, field, message, .. }) => Err(format!("{field}: {message}")),
        Err(error) => panic!("{line}: {error}"),
    }
}

/// The line with one word replaced: the value of a setting, otherwise the field of this number.
fn poisoned(line: &str, field: usize, poison: &str) -> String {
    let mut words: Vec<&str> = line.split(' ').collect();
    let last = words.len() - 1;
    let place = if words[0] == "set" { last } else { field + 1 };
    words[place] = poison;
    words.join(" ")
}

#[test]
fn words_that_are_no_finite_number_are_rejected_with_the_name_of_their_field() {
    for (line, names) in LINES {
        assert!(read(line).is_ok(), "{line}");
        for (field, name) in names.split('|').enumerate() {
            for poison in ["nan", "inf", "-inf", "1e39", "-1e39", "x", "1,5", "0x10"] {
                let line = poisoned(line, field, poison);
                // The first word of a tether must be a number. Otherwise the line counts as prose.
                if line.starts_with("T x") || line.starts_with("T 1,5") || line.starts_with("T 0x10") {
                    continue;
                }
                let message = read(&line).expect_err(&line);
                let (word, _) = message.split_once(':').unwrap();
                assert!(word.ends_with(&format!(" {name}")), "{line}: {message}");
                assert!(
                    message.contains(poison) && message.contains("expected") || message.contains("is not a whole number"),
                    "{message}"
                );
            }
        }
    }
}

/// Huge, tiny, zero and negative numbers are rejected with the name of the field, or survive writing and reading
/// unchanged.
#[test]
fn finite_numbers_are_rejected_by_name_or_kept_bit_for_bit() {
    let (mut accepted, mut rejected) = (0, 0);
    for (line, names) in LINES {
        for field in 0..names.split('|').count() {
            for poison in
                ["3.4e38", "-3.4e38", "1e30", "-1e30", "1e-30", "1e-45", "-1e-40", "1e-50", "0", "-0", "-1", "4294967296"]
            {
                let line = poisoned(line, field, poison);
                match read(&line) {
                    Ok(scene) => {
                        let text = scene.to_text();
                        let again = Scene::parse(&text, Path::new("again.txt")).expect(&text).scene;
                        assert_eq!(again.to_text(), text);
                        assert_eq!(again.spheres(), scene.spheres());
                        accepted += 1;
                    }
                    Err(message) => {
                        assert!(message.contains("expected") || message.contains("is not a whole number"), "{line}: {message}");
                        rejected += 1;
                    }
                }
            }
        }
    }
    assert!(accepted > 300 && rejected > 200, "{accepted} {rejected}");
}
