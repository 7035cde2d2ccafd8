//! Every number of every line of the scene text.

use std::path::Path;

use rockfall::{Error, Scene};

/// The lines that there are, with numbers that are right, and the names of the fields as messages tell them.
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

/// A line with one of its words exchanged; of a setting the value, of all others the numbers.
fn poisoned(line: &str, field: usize, poison: &str) -> String {
    let mut words: Vec<&str> = line.split(' ').collect();
    let last = words.len() - 1;
    let place = if words[0] == "set" { last } else { field + 1 };
    words[place] = poison;
    words.join(" ")
}

#[test]
fn what_is_no_finite_number_is_refused_by_the_name_of_its_field() {
    for (line, names) in LINES {
        assert!(read(line).is_ok(), "{line}");
        for (field, name) in names.split('|').enumerate() {
            for poison in ["nan", "inf", "-inf", "1e39", "-1e39", "x", "1,5", "0x10"] {
                let line = poisoned(line, field, poison);
                // A tether's first word must be a number, else the line is prose.
                if line.starts_with("T x") || line.starts_with("T 1,5") || line.starts_with("T 0x10") {
                    continue;
                }
                let told = read(&line).expect_err(&line);
                let (word, _) = told.split_once(':').unwrap();
                assert!(word.ends_with(&format!(" {name}")), "{line}: {told}");
                assert!(told.contains(poison) && told.contains("expected") || told.contains("is not a whole number"), "{told}");
            }
        }
    }
}

/// Huge, tiny, 0 and negative: refused by name, or read, written and read again as the same.
#[test]
fn what_is_finite_is_refused_by_name_or_kept_bit_for_bit() {
    let (mut taken, mut refused) = (0, 0);
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
                        taken += 1;
                    }
                    Err(told) => {
                        assert!(told.contains("expected") || told.contains("is not a whole number"), "{line}: {told}");
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(taken > 300 && refused > 200, "{taken} {refused}");
}
