//! WGSL files name the files that they require. No requirement is missing, unused or declared twice, and every file is
//! used.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use rockfall::model::part::Part;
use rockfall::step::catalog::{ALL, OUTSIDE};
use rockfall::step::wgsl::{HOOKS, requires, shared};

/// The text without comments.
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The declarations of a file at module scope, each as one text.
fn declarations(text: &str) -> Vec<String> {
    let (mut found, mut depth, mut current) = (Vec::new(), 0, String::new());
    for letter in code(text).chars() {
        current.push(letter);
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        if depth == 0 && (letter == '}' || letter == ';') {
            found.push(std::mem::take(&mut current));
        }
    }
    assert!(current.trim().is_empty(), "a declaration does not end: {current}");
    found
}

/// Names and single punctuation marks in order, without members of structs (`.name`) and attributes.
fn tokens(text: &str) -> Vec<String> {
    let (mut found, mut word): (Vec<String>, String) = (Vec::new(), String::new());
    for letter in text.chars().chain([' ']) {
        if letter.is_alphanumeric() || letter == '_' {
            word.push(letter);
            continue;
        }
        if !word.is_empty() {
            let is_member = found.last().is_some_and(|last| last == "." || last == "@");
            if is_member {
                found.pop();
            } else {
                found.push(word.clone());
            }
            word.clear();
        }
        if !letter.is_whitespace() {
            found.push(letter.to_string());
        }
    }
    found
}

/// Name that a declaration declares: the one after its keyword.
fn declared(declaration: &str) -> Option<String> {
    let tokens = tokens(declaration);
    let keyword =
        tokens.iter().position(|token| ["fn", "const", "override", "struct", "alias", "var"].contains(&token.as_str()))?;
    let mut rest = tokens[keyword + 1..].iter();
    let first = rest.next()?;
    if first == "<" { rest.skip_while(|token| *token != ">").nth(1).cloned() } else { Some(first.clone()) }
}

/// The names that a declaration uses, other than its own parameters, locals and members.
fn used(declaration: &str) -> BTreeSet<String> {
    let tokens = tokens(declaration);
    let mut locals = BTreeSet::new();
    for pair in tokens.windows(2) {
        if ["let", "var", "const"].contains(&pair[0].as_str()) || pair[1] == ":" {
            locals.insert(if pair[1] == ":" { &pair[0] } else { &pair[1] });
        }
    }
    let own = declared(declaration);
    tokens.iter().filter(|token| !locals.contains(token) && Some(*token) != own.as_ref()).cloned().collect()
}

struct File {
    part: Part,
    declares: BTreeSet<String>,
    uses: BTreeSet<String>,
}

impl File {
    fn of(part: Part) -> Self {
        let declarations = declarations(part.text);
        let declares = declarations.iter().filter_map(|text| declared(text)).collect();
        let uses = declarations.iter().flat_map(|text| used(text)).collect();
        Self { part, declares, uses }
    }
}

/// The files of the stages themselves, each once.
fn own_files() -> BTreeMap<&'static str, Part> {
    ALL.iter().chain(&OUTSIDE).filter_map(|stage| stage.parts().pop()).map(|part| (part.file, part)).collect()
}

fn files() -> BTreeMap<&'static str, File> {
    shared().chain(own_files().into_values()).map(|part| (part.file, File::of(part))).collect()
}

fn wgsl_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            wgsl_below(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "wgsl") {
            found.push(path);
        }
    }
}

/// Modules of their own, which are no part of a step. Those of `rigid` are joined by `rigid/gpu/kernels.rs`. `tests/engine/exchange.rs`, `cluster/tests.rs` and `tests/worlds` run them.
const OWN_MODULES: [&str; 3] = ["exec/gpu/exchange.wgsl", "exec/gpu/share.wgsl", "exec/gpu/world_lengths.wgsl"];

#[test]
fn every_file_belongs_to_a_stage_or_is_shared() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    wgsl_below(&source, &mut found);
    found.retain(|path| !OWN_MODULES.iter().any(|module| path.ends_with(module)));
    found.retain(|path| !path.starts_with(source.join("rigid")));
    let known = files();
    for path in &found {
        let file = path.strip_prefix(&source).expect("below src").to_str().expect("UTF-8").replace('\\', "/");
        assert!(known.contains_key(file.as_str()), "{file} belongs to no stage and is not in a shared file of step/wgsl.rs");
    }
    // Put together from the tables of body forces and contact laws, and from the declaration of `Step`.
    let generated = ["physics/forces/body_forces.wgsl", "laws/chosen.wgsl"];
    assert_eq!(found.len() + generated.len(), known.len());
    assert!(generated.iter().all(|file| known.contains_key(file)));
    let required: BTreeSet<_> = known.values().flat_map(|file| requires(file.part)).map(|part| part.file).collect();
    for part in shared() {
        assert!(required.contains(part.file), "no file requires {}", part.file);
    }
}

/// Files that are one with others: geometry has the arithmetic of positions, which has that of periods.
const COMES_WITH: [(&str, &[&str]); 2] =
    [("physics/fine.wgsl", &["physics/period.wgsl"]), ("physics/geometry.wgsl", &["physics/fine.wgsl", "physics/period.wgsl"])];

/// A file must declare or require every name that it uses, except bindings of the stage and hooks.
#[test]
fn files_require_the_files_that_they_use() {
    let files = files();
    let mut declarers: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (name, file) in &files {
        for declared in &file.declares {
            declarers.entry(declared).or_default().push(name);
        }
    }
    let bindings: BTreeSet<&str> = ALL.iter().flat_map(|stage| stage.bindings).map(|binding| binding.name).collect();
    let is_hook = |name: &str| HOOKS.iter().any(|(hook, _)| *hook == name);
    let mut found = Vec::new();
    for (name, file) in &files {
        let with_others = requires(file.part).flat_map(|part| {
            let others = COMES_WITH.iter().filter(move |(file, _)| *file == part.file).flat_map(|(_, others)| *others);
            std::iter::once(part.file).chain(others.copied())
        });
        let from_requirements: BTreeSet<String> = with_others.flat_map(|file| files[file].declares.clone()).collect();
        for used in file.uses.difference(&from_requirements) {
            let Some(from) = declarers.get(used.as_str()) else { continue };
            let is_own = file.declares.contains(used);
            let is_elsewhere = from.iter().any(|other| shared().any(|part| part.file == *other));
            let is_provided = is_hook(used) || bindings.contains(used.as_str());
            if !(is_own || is_provided || !is_elsewhere) {
                found.push(format!("{name} uses {used} of {from:?} without requiring it"));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn files_use_the_files_that_they_require() {
    let files = files();
    let mut found = Vec::new();
    for (name, file) in &files {
        for part in requires(file.part) {
            let required = &files[part.file];
            let is_used = file.uses.iter().any(|used| required.declares.contains(used));
            let provides = |file: &File| file.declares.iter().any(|declared| HOOKS.iter().any(|(hook, _)| hook == declared));
            let is_stage = shared().all(|part| part.file != *name);
            // A file that provides hooks may provide those of another one too.
            if !(is_used || (is_stage || provides(file)) && provides(required)) {
                found.push(format!("{name} requires {} and uses nothing of it", part.file));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn nothing_is_declared_twice() {
    let files = files();
    for stage in ALL {
        let mut declared: BTreeMap<&str, &str> = BTreeMap::new();
        for part in stage.parts() {
            for name in &files[part.file].declares {
                let before = declared.insert(name, part.file);
                assert!(before.is_none(), "{}: {} and {} declare {name}", stage.name, before.unwrap_or_default(), part.file);
            }
        }
    }
}

#[test]
fn hooks_are_used_and_provided() {
    let files = files();
    for (hook, _) in HOOKS {
        let providers = files.values().filter(|file| file.declares.contains(*hook)).count();
        assert!(providers > 0, "no file declares the hook {hook}");
        let is_used = shared().any(|part| {
            let file = &files[part.file];
            file.uses.contains(*hook) && !file.declares.contains(*hook)
        });
        assert!(is_used, "no shared file uses the hook {hook}");
    }
    for stage in ALL {
        let parts = stage.parts();
        for (hook, meaning) in HOOKS {
            let declares = |part: &Part| files[part.file].declares.contains(*hook);
            let user = parts.iter().find(|part| files[part.file].uses.contains(*hook));
            let is_provided = parts.iter().any(declares);
            assert!(user.is_none() || is_provided, "{}: {user:?} needs {hook} ({meaning})", stage.name);
        }
    }
}

#[test]
fn declarations_and_uses_are_found() {
    let text = "@group(0) @binding(2) var<storage, read> state: array<vec4f>;\nfn f(a: u32) -> u32 {\n    let b = g(a); // h()\n    return b + s.c + SLICE;\n}\n";
    let part = Part { file: "a.wgsl", text };
    let file = File::of(part);
    assert_eq!(file.declares, ["f", "state"].map(str::to_owned).into());
    for (name, is_used) in [("g", true), ("SLICE", true), ("a", false), ("b", false), ("c", false), ("h", false)] {
        assert_eq!(file.uses.contains(name), is_used, "{name}");
    }
}

/// Operators and other tokens in order, without comments. Words and numbers are `x`, keywords before an expression are `k`.
fn operators(text: &str) -> Vec<String> {
    let code = code(text);
    let (mut rest, mut found) = (code.as_str(), Vec::new());
    let longer =
        ["<<=", ">>=", "<<", ">>", "&&", "||", "==", "!=", "<=", ">=", "->", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^="];
    while let Some(first) = rest.chars().next() {
        let word: String = rest.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect();
        let taken = if !word.is_empty() {
            found.push(if ["return", "if", "while"].contains(&word.as_str()) { "k" } else { "x" }.to_owned());
            word.len()
        } else if let Some(long) = longer.iter().find(|long| rest.starts_with(**long)) {
            found.push((*long).to_owned());
            long.len()
        } else {
            if !first.is_whitespace() {
                found.push(first.to_string());
            }
            first.len_utf8()
        };
        rest = &rest[taken..];
    }
    found
}

/// Operators that are mixed without parentheses although the grammar of WGSL requires them: bitwise operators with any other,
/// shifts with arithmetic or another shift, `&&` with `||`.
fn mixed_operators(text: &str) -> Vec<String> {
    const BINARY: [&str; 16] = ["&", "|", "^", "<<", ">>", "+", "-", "*", "/", "%", "&&", "||", "==", "!=", "<=", ">="];
    let (mut found, mut levels, mut before) = (Vec::new(), vec![Vec::<String>::new()], String::new());
    for token in operators(text) {
        match token.as_str() {
            "(" | "[" => levels.push(Vec::new()),
            ")" | "]" => drop(levels.pop()),
            operator if BINARY.contains(&operator) && ["x", ")", "]"].contains(&before.as_str()) => {
                let level = levels.last_mut().expect("brackets are balanced");
                level.push(token.clone());
                let has = |wanted: &[&str]| level.iter().any(|one| wanted.contains(&one.as_str()));
                let differs = level.iter().any(|one| *one != level[0]);
                let shifts = level.iter().filter(|one| *one == "<<" || *one == ">>").count();
                let bitwise = has(&["&", "|", "^"]) && differs;
                let shifted = shifts > 1 || shifts == 1 && has(&["+", "-", "*", "/", "%"]);
                if bitwise || shifted || has(&["&&"]) && has(&["||"]) {
                    found.push(std::mem::take(level).join(" "));
                }
            }
            "k" | "x" | "." | "@" | "!" | "~" | "<" | ">" | "&" | "-" | "*" => {}
            // A separator, an assignment or a brace begins another expression.
            _ => *levels.last_mut().expect("brackets are balanced") = Vec::new(),
        }
        before = token;
    }
    found
}

/// Browsers refuse what wgpu accepts.
#[test]
fn operators_are_mixed_only_within_parentheses() {
    for wrong in
        ["a = b | c << 2u;", "if (a >> b & 1u) == 0u {", "x = a & (b) && c;", "y = f(a << 1u << b);", "z = a + b << 1u;"]
    {
        assert_eq!(mixed_operators(wrong).len(), 1, "{wrong}");
    }
    for right in ["a = b | (c << 2u);", "f(&b, a & b, -c);", "let a = -b * c < d;", "a |= b << c; d &= e | f | g;"] {
        assert_eq!(mixed_operators(right), [""; 0], "{right}");
    }
    let parts = shared().chain(ALL.iter().flat_map(|stage| stage.parts()));
    let files: BTreeMap<&str, &str> = parts.map(|part| (part.file, part.text)).collect();
    for (file, text) in files {
        assert_eq!(mixed_operators(text), [""; 0], "{file}");
    }
}
