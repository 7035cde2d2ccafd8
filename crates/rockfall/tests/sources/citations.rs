//! Sections and errata of `docs/physics` that code and documents cite exist there. Its errata name existing tests,
//! and its table of constants holds every setting with its default.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use rockfall::Settings;

/// Folders and files that cite the specification, relative to the root of the repository.
const CITING: [&str; 5] = ["crates", "docs", "scenes", "README.md", "ARCHITECTURE.md"];
const SPECIFICATION: &str = "docs/physics";
/// The files of the specification.
const PARTS: [&str; 7] = ["README.md", "thesis.md", "grains.md", "walls.md", "rigid.md", "constants.md", "errata.md"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The text of the specification.
fn specification() -> String {
    let folder = root().join(SPECIFICATION);
    let mut found = Vec::new();
    files(&folder, &mut found);
    assert_eq!(found.len(), PARTS.len(), "files of the specification: {found:?}");
    PARTS.map(|name| read(&folder.join(name))).join("\n")
}

/// All files below a path that may hold citations.
fn files(path: &Path, found: &mut Vec<PathBuf>) {
    if path.is_dir() {
        if path.ends_with("target") {
            return;
        }
        for entry in fs::read_dir(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())) {
            files(&entry.unwrap().path(), found);
        }
    } else if path.extension().is_some_and(|extension| ["rs", "wgsl", "md", "txt"].iter().any(|known| extension == *known)) {
        found.push(path.to_owned());
    }
}

/// The part of a line that may cite: a comment, or in Markdown the whole line.
fn comment<'a>(line: &'a str, extension: &str) -> Option<&'a str> {
    match extension {
        "md" => Some(line),
        "txt" => line.split_once('#').map(|(_, comment)| comment),
        _ => line.split_once("//").map(|(_, comment)| comment.trim_start_matches(['/', '!'])),
    }
}

/// The comments of a file as one text, with the line that each byte is from. Consecutive comment lines are joined by a
/// space, because citations run over the ends of lines.
fn prose(text: &str, extension: &str) -> (String, Vec<usize>) {
    let (mut prose, mut lines) = (String::new(), Vec::new());
    let mut last = 0;
    for (line, part) in (1..).zip(text.lines()).filter_map(|(line, text)| Some((line, comment(text, extension)?))) {
        prose.push(if line == last + 1 { ' ' } else { '\n' });
        prose.push_str(part.trim());
        lines.resize(prose.len(), line);
        last = line;
    }
    (prose, lines)
}

/// A number such as `3` or `3.2` at the start of a text, and what follows.
fn section_number(text: &str) -> Option<(&str, &str)> {
    let digits = |text: &str| text.len() - text.trim_start_matches(|letter: char| letter.is_ascii_digit()).len();
    let mut length = digits(text);
    if length == 0 {
        return None;
    }
    while let Some(part) = text[length..].strip_prefix('.').map(digits).filter(|part| *part > 0) {
        length += 1 + part;
    }
    Some(text.split_at(length))
}

/// The numbers in `section 3.2`, `sections 4 and 5.1` or `sections 4, 5`, at the start of a text.
fn section_numbers(text: &str) -> Vec<&str> {
    let (plural, mut rest) = match (text.strip_prefix("sections "), text.strip_prefix("section ")) {
        (Some(rest), _) => (true, rest),
        (_, Some(rest)) => (false, rest),
        _ => return Vec::new(),
    };
    let mut numbers = Vec::new();
    while let Some((number, after)) = section_number(rest.trim_start()) {
        numbers.push(number);
        let next = [", and ", " and ", ", ", " to "].iter().find_map(|between| after.strip_prefix(between));
        let Some(next) = next.filter(|_| plural) else { break };
        rest = next;
    }
    numbers
}

/// The cited sections with their offsets. In the specification itself every section is its own.
fn cited_sections(prose: &str, own: bool) -> Vec<(usize, &str)> {
    let key = if own { "section" } else { "docs/physics" };
    let cited = prose.match_indices(key).flat_map(|(at, _)| {
        let after = if own { &prose[at..] } else { prose[at + key.len()..].trim_start_matches(['`', ')', ']', ',', ':', ' ']) };
        section_numbers(after).into_iter().map(move |number| (at, number))
    });
    cited.collect()
}

/// The cited errata, words such as `E7`, with their offsets.
fn cited_errata(prose: &str) -> Vec<(usize, &str)> {
    let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
    let words = prose.split(|letter| !is_word(letter));
    let cited = words.filter(|word| {
        let number = word.strip_prefix('E').filter(|number| (1..=2).contains(&number.len()) && !number.starts_with('0'));
        number.is_some_and(|number| number.bytes().all(|digit| digit.is_ascii_digit()))
    });
    cited.map(|word| (word.as_ptr() as usize - prose.as_ptr() as usize, word)).collect()
}

/// The cells of a row of a Markdown table.
fn cells(row: &str) -> Vec<&str> {
    row.trim().trim_matches('|').split('|').map(str::trim).collect()
}

/// The rows of the errata table.
fn errata(specification: &str) -> Vec<Vec<&str>> {
    let rows = specification.lines().filter(|line| line.starts_with("| E")).map(cells);
    rows.filter(|row| cited_errata(row[0]).len() == 1).collect()
}

#[test]
fn citations_are_found() {
    let text = "a\n//! Forces (docs/physics\n//! sections 4.1, 5 and 6.2, E5).\nlet x = 0xE7; // not 1E5, not E0\n/// `docs/physics` section 3.\n";
    let (prose, lines) = prose(text, "rs");
    let sections: Vec<_> = cited_sections(&prose, false).into_iter().map(|(at, number)| (lines[at], number)).collect();
    assert_eq!(sections, [(2, "4.1"), (2, "5"), (2, "6.2"), (5, "3")]);
    let errata: Vec<_> = cited_errata(&prose).into_iter().map(|(at, word)| (lines[at], word)).collect();
    assert_eq!(errata, [(3, "E5")]);
    assert_eq!(cited_sections("section 2.3, 4 times; thesis section", true), [(0, "2.3")]);
}

#[test]
fn cited_sections_and_errata_exist() {
    let specification = specification();
    let headings = specification.lines().filter_map(|line| line.strip_prefix('#'));
    let sections: BTreeSet<&str> =
        headings.filter_map(|heading| Some(section_number(heading.trim_start_matches('#').trim())?.0)).collect();
    let known_errata: BTreeSet<&str> = errata(&specification).iter().map(|row| row[0]).collect();
    assert!(sections.len() > 30 && known_errata.len() >= 18, "{sections:?} {known_errata:?}");

    let mut paths = Vec::new();
    CITING.iter().for_each(|name| files(&root().join(name), &mut paths));
    paths.sort();
    // The examples in this file cite sections and errata that do not exist.
    paths.retain(|path| !path.ends_with("tests/sources/citations.rs"));
    let (mut bad, mut found) = (Vec::new(), [0, 0]);
    for path in paths {
        let own = path.parent().is_some_and(|folder| folder.ends_with(SPECIFICATION));
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        let (prose, lines) = prose(&read(&path), extension);
        let name = path.strip_prefix(root()).unwrap_or(&path).display();
        for (at, number) in cited_sections(&prose, own) {
            found[0] += usize::from(!own);
            if !sections.contains(number) {
                bad.push(format!("{name}:{}: {SPECIFICATION} has no section {number}", lines[at]));
            }
        }
        for (at, word) in cited_errata(&prose) {
            found[1] += usize::from(!own);
            if !known_errata.contains(word) {
                bad.push(format!("{name}:{}: {SPECIFICATION} has no erratum {word}", lines[at]));
            }
        }
    }
    assert!(bad.is_empty(), "\n{}", bad.join("\n"));
    assert!(found[0] >= 20 && found[1] >= 3, "only {found:?} citations of sections and errata found");
}

#[test]
fn errata_name_their_tests() {
    let specification = specification();
    let tests = |name: &str| {
        let path = root().join("crates/rockfall/tests/physics").join(name);
        path.exists().then(|| read(&path))
    };
    let known = tests("errata.rs").expect("the tests of E1 to E18");
    let mut bad = Vec::new();
    for row in errata(&specification) {
        let (erratum, test) = (row[0], row[row.len() - 1].trim_matches('`'));
        let number: u32 = erratum[1..].parse().expect("a number");
        let exists = if test.ends_with(".rs") {
            // A test file that does not exist yet is accepted.
            tests(test).is_none_or(|text| text.contains(&format!("fn e{number:02}_")))
        } else {
            test.starts_with(&format!("e{number:02}_")) && known.contains(&format!("fn {test}("))
        };
        if !exists {
            bad.push(format!("{erratum}: no test {test}"));
        }
    }
    assert!(bad.is_empty(), "\n{}", bad.join("\n"));
}

#[test]
fn the_table_of_constants_holds_every_setting() {
    let specification = specification();
    let table = specification.split("### 6.1 ").nth(1).and_then(|rest| rest.split("\n#").next()).expect("section 6.1");
    let rows: Vec<_> = table.lines().filter(|line| line.starts_with("| `")).map(cells).collect();
    let defaults = Settings::default();
    for name in Settings::NAMES {
        let row = rows.iter().find(|row| row[0].trim_matches('`') == *name);
        let row = row.unwrap_or_else(|| panic!("{SPECIFICATION} section 6.1 lacks {name}"));
        let mut stated = defaults;
        stated.set(name, row[1]).unwrap_or_else(|error| panic!("default of {name}: {error}"));
        assert_eq!(stated.get(name), defaults.get(name), "default of {name} in {SPECIFICATION} section 6.1");
        assert!(row.len() == 4 && !row[2].is_empty() && !row[3].is_empty(), "{name} has a unit and a meaning");
    }
}

/// The paths of files in backquotes in a document: with a folder, and with the extension of a source.
fn cited_paths(text: &str) -> impl Iterator<Item = &str> {
    let is_path = |code: &&str| {
        let is_source = [".rs", ".wgsl", ".py", ".md", ".toml"].iter().any(|extension| code.ends_with(extension));
        is_source
            && code.contains('/')
            && !code.contains(|letter: char| letter.is_whitespace() || "*{<:".contains(letter))
            && !code.contains("NAME")
    };
    text.lines().flat_map(|line| line.split('`').skip(1).step_by(2)).filter(is_path)
}

/// The files that documents name exist, below the root, the core crate or its sources.
#[test]
fn documents_name_files_that_exist() {
    let core = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = [root(), core.to_owned(), core.join("src"), core.join("tests/physics"), root().join("crates")];
    let mut documents = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root().join(name)).to_vec();
    files(&root().join("docs"), &mut documents);
    let mut wrong = Vec::new();
    for document in documents.iter().filter(|path| path.extension().is_some_and(|extension| extension == "md")) {
        let text = read(document);
        let mut missing: Vec<_> =
            cited_paths(&text).filter(|path| !folders.iter().any(|folder| folder.join(path).exists())).collect();
        missing.retain(|path| !document.parent().is_some_and(|folder| folder.join(path).exists()));
        wrong.extend(missing.iter().map(|path| format!("{}: {path}", document.display())));
    }
    assert!(wrong.is_empty(), "files that do not exist:\n{}", wrong.join("\n"));
}
