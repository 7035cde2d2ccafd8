//! Rewrites the WGSL of a stage for arrays that are larger than the device's limit for one binding and are stored in several
//! chunks.
//!
//! Each chunk is a buffer and a binding of its own. All chunks of an array have the same size except the last. The kernel
//! sources do not mention chunks. If the array `a` is split, these accesses are replaced:
//! - `a[e]` becomes `a_get(e)`, and for an array of rows `a[r][e]` becomes `a_get(r, e)`;
//! - `a[e] = v` becomes `a_put(e, v)`;
//! - `atomicAdd(&a[e], v)` becomes `a_atomicAdd(e, v)`.
//!
//! These functions choose the chunk by the index. They are appended at the end, so lines keep their numbers. Kernels whose
//! arrays fit one binding each are compiled unchanged. Arrays of bindings (`binding_array`) would make the functions
//! unnecessary, but few devices support them.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::Range;

use crate::model::layout::SLICE;
use crate::step::stage::Stage;

/// An array of a kernel that is stored in several chunks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    /// Name of the array in the WGSL.
    pub name: &'static str,
    /// Bytes of each chunk except the last, which is not larger: a multiple of 128, the size of the largest element.
    pub chunk_bytes: u64,
    /// Binding numbers of the chunks from the second on. The first chunk keeps the binding number of the array.
    pub bindings: Vec<u32>,
}

impl Split {
    /// The arrays of a stage that have more than one chunk. `counts` holds the number of chunks of each array, in the order of
    /// the stage's bindings.
    pub fn of(stage: &Stage, counts: &[u32], chunk_bytes: u64) -> Vec<Self> {
        let split = stage.bindings.iter().zip(binding_numbers(counts)).filter(|(_, numbers)| numbers.len() > 1);
        split.map(|(binding, numbers)| Self { name: binding.name, chunk_bytes, bindings: numbers[1..].to_vec() }).collect()
    }
}

/// Binding numbers of the chunks of each array of a stage. The first chunks are numbered in order from 2 on; all further chunks
/// follow.
pub(crate) fn binding_numbers(counts: &[u32]) -> Vec<Vec<u32>> {
    let mut next = 2 + counts.len() as u32;
    let numbers = |(first, count): (u32, &u32)| {
        let more = next..next + count.saturating_sub(1);
        next = more.end;
        std::iter::once(first).chain(more).collect()
    };
    (2..).zip(counts).map(numbers).collect()
}

/// Returns the WGSL with these arrays split. Some accesses cannot be rewritten: a pointer to an element that is not atomic, and
/// an assignment to a member of an element. They are left as they are, and the compiler reports them, because the original
/// array no longer exists.
pub fn split(text: &str, arrays: &[Split]) -> String {
    if arrays.is_empty() {
        return text.to_owned();
    }
    let rows = arrays.iter().map(|array| array.name).filter(|name| text.contains(&format!("> {name}: array<array<"))).collect();
    let mut rewriter = Rewriter { arrays, rows, atomics: BTreeSet::new() };
    let mut result = rewriter.rewrite(text);
    for array in arrays {
        if let Some(declared) = declare_chunks(&mut result, array) {
            rewriter.add_functions(&mut result, array, &declared);
        }
    }
    result
}

struct Rewriter<'a> {
    arrays: &'a [Split],
    /// Names of the split arrays whose elements are rows.
    rows: BTreeSet<&'static str>,
    /// Atomic functions that are called on elements, as (array, function).
    atomics: BTreeSet<(&'static str, String)>,
}

impl Rewriter<'_> {
    fn rewrite(&mut self, text: &str) -> String {
        let mut out = String::with_capacity(text.len() + text.len() / 8);
        let mut rest = text;
        while let Some(next) = rest.chars().next() {
            let length = if rest.starts_with("//") {
                rest.find('\n').unwrap_or(rest.len())
            } else if is_word(next) {
                rest.find(|c| !is_word(c)).unwrap_or(rest.len())
            } else {
                next.len_utf8()
            };
            let (token, after) = rest.split_at(length);
            rest = match self.array(token, &out) {
                Some(array) if after.starts_with('[') => self.access(array, after, &mut out),
                _ => {
                    out.push_str(token);
                    after
                }
            };
        }
        out
    }

    /// The split array that a token names, unless the token is a member name.
    fn array(&self, token: &str, before: &str) -> Option<&'static str> {
        let array = self.arrays.iter().find(|array| array.name == token)?;
        (!before.ends_with('.')).then_some(array.name)
    }

    /// Writes an access to `out`. `text` begins with the opening bracket of the index. Returns the text after the access.
    fn access<'t>(&mut self, name: &'static str, text: &'t str, out: &mut String) -> &'t str {
        let (index, mut after) = enclosed(text);
        let mut index = self.rewrite(index);
        if self.rows.contains(name) {
            let (place, rest) = enclosed(after);
            index = format!("{index}, {}", self.rewrite(place));
            after = rest;
        }
        if let Some((at, function)) = address_taken(out) {
            out.truncate(at);
            out.push_str(&format!("{name}_{function}({index}"));
            self.atomics.insert((name, function));
            return after;
        }
        let Some((operator, value)) = assignment(after) else {
            out.push_str(&format!("{name}_get({index})"));
            return after;
        };
        let end = end_of_statement(value);
        // Line breaks are kept, so that lines keep their numbers.
        let value_text = self.rewrite(value[..end].trim_start_matches(' '));
        match operator {
            None => out.push_str(&format!("{name}_put({index}, {value_text})")),
            Some(operator) => out.push_str(&format!("{name}_put({index}, {name}_get({index}) {operator} ({value_text}))")),
        }
        &value[end..]
    }

    /// Appends the functions that the rewritten accesses call.
    fn add_functions(&self, out: &mut String, array: &Split, declared: &Declared) {
        let Declared { element, size, written } = declared;
        let mut functions = Vec::new();
        let row = element.strip_prefix("array<").and_then(|element| element.strip_suffix(", SLICE>"));
        if let Some(inner) = row {
            functions.push((format!("get(i: u32, k: u32) -> {inner}"), "return @[k]".to_owned()));
            if *written {
                functions.push((format!("put(i: u32, k: u32, v: {inner})"), "@[k] = v".to_owned()));
            }
        } else if let Some(inner) = element.strip_prefix("atomic<").and_then(|element| element.strip_suffix('>')) {
            for (_, called) in self.atomics.iter().filter(|(name, _)| *name == array.name) {
                functions.push(match called.as_str() {
                    "atomicLoad" => (format!("{called}(i: u32) -> {inner}"), format!("return {called}(&@)")),
                    "atomicStore" => (format!("{called}(i: u32, v: {inner})"), format!("{called}(&@, v)")),
                    _ => (format!("{called}(i: u32, v: {inner}) -> {inner}"), format!("return {called}(&@, v)")),
                });
            }
        } else {
            functions.push((format!("get(i: u32) -> {element}"), "return @".to_owned()));
            if *written {
                functions.push((format!("put(i: u32, v: {element})"), "@ = v".to_owned()));
            }
        }
        for (head, action) in functions {
            let body = choose(array.name, array.chunk_bytes / size, 0..array.bindings.len() as u64 + 1, &action);
            // Writing to a String cannot fail.
            let _ = writeln!(out, "fn {}_{head} {{ {body} }}", array.name);
        }
    }
}

/// Facts from the declaration of an array.
struct Declared {
    element: String,
    /// Bytes of an element.
    size: u64,
    written: bool,
}

/// Bytes of an element of one of the types that arrays have, or `None` for an unknown type.
fn size_of_element(element: &str) -> Option<u64> {
    match element {
        "u32" | "f32" | "atomic<u32>" => Some(4),
        "vec2u" | "vec2f" => Some(8),
        "vec4f" | "vec4u" => Some(16),
        "Aabb" => Some(32),
        "array<u32, SLICE>" | "array<f32, SLICE>" => Some(4 * u64::from(SLICE)),
        _ => None,
    }
}

/// Replaces the declaration of an array by one declaration per chunk. Every array declaration has the form `@group(0)
/// @binding(2) var<storage, read> name: array<u32>;`.
fn declare_chunks(text: &mut String, array: &Split) -> Option<Declared> {
    let name = array.name;
    let name_at = text.find(&format!("> {name}: array<"))?;
    let start = text[..name_at].rfind("@group")?;
    let end = name_at + text[name_at..].find(';')? + 1;
    let declaration = text[start..end].to_owned();
    let element = declaration.split_once("array<")?.1.strip_suffix(">;")?.to_owned();
    let size = size_of_element(&element)?;
    let (number, kind) = declaration.split_once("@binding(")?.1.split_once(')')?;
    let kind = kind.strip_suffix(&format!("{name}: array<{element}>;"))?;
    let numbers = [number.to_owned()].into_iter().chain(array.bindings.iter().map(u32::to_string));
    let chunks: Vec<String> = numbers
        .enumerate()
        .map(|(chunk, number)| format!("@group(0) @binding({number}){kind}{name}_{chunk}: array<{element}>;"))
        .collect();
    text.replace_range(start..end, &chunks.join(" "));
    Some(Declared { element, size, written: kind.contains("read_write") })
}

/// Returns statements that apply `action` to element `i` of an array of several chunks with `elements` elements each. `@` in
/// `action` stands for the element. The chunk is found by bisection, which takes few comparisons.
fn choose(name: &str, elements: u64, chunks: Range<u64>, action: &str) -> String {
    let middle = chunks.start.midpoint(chunks.end);
    if middle == chunks.start {
        let element = match middle {
            0 => format!("{name}_0[i]"),
            chunk => format!("{name}_{chunk}[i - {}u]", chunk * elements),
        };
        return format!("{};", action.replace('@', &element));
    }
    let low = choose(name, elements, chunks.start..middle, action);
    let high = choose(name, elements, middle..chunks.end, action);
    format!("if i < {}u {{ {low} }} else {{ {high} }}", middle * elements)
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// The text between the bracket at the start of `text` and its closing bracket, and the text after that.
fn enclosed(text: &str) -> (&str, &str) {
    let mut depth = 0_u32;
    for (at, c) in text.char_indices() {
        match c {
            '[' => depth += 1,
            ']' if depth == 1 => return (&text[1..at], &text[at + 1..]),
            ']' => depth -= 1,
            _ => {}
        }
    }
    (&text[1..], "")
}

/// The atomic function that is called on the address of the next token, and the position of the function's name.
fn address_taken(before: &str) -> Option<(usize, String)> {
    let call = before.strip_suffix("(&")?;
    let at = call.rfind(|c| !is_word(c)).map_or(0, |at| at + 1);
    call[at..].starts_with("atomic").then(|| (at, call[at..].to_owned()))
}

/// If `after` continues an assignment, returns its compound operator, if any, and the text from the value on.
fn assignment(after: &str) -> Option<(Option<char>, &str)> {
    let after = after.trim_start();
    let operator = after.chars().next().filter(|c| "+-*/%&|^".contains(*c));
    let value = after[operator.map_or(0, char::len_utf8)..].strip_prefix('=')?;
    (!value.starts_with('=')).then_some((operator, value))
}

/// Position at which the assigned value ends.
fn end_of_statement(value: &str) -> usize {
    let mut depth = 0_u32;
    for (at, c) in value.char_indices() {
        match c {
            ';' => return at,
            ')' if depth == 0 => return at,
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
    }
    value.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(name: &'static str, chunk_bytes: u64, bindings: &[u32]) -> Split {
        Split { name, chunk_bytes, bindings: bindings.to_vec() }
    }

    /// Returns the WGSL with the array `a` split.
    fn rewritten(text: &str) -> String {
        split(text, &[array("a", 32, &[9])])
    }

    #[test]
    fn reads_become_calls() {
        assert_eq!(rewritten("let x = a[i];"), "let x = a_get(i);");
        assert_eq!(rewritten("a[a[i] + b[a[0]]].xyz"), "a_get(a_get(i) + b[a_get(0)]).xyz");
        assert_eq!(rewritten("if a[i] <= a[j] {"), "if a_get(i) <= a_get(j) {");
        assert_eq!(rewritten("a[i] == a[j]"), "a_get(i) == a_get(j)");
        assert_eq!(rewritten("mine & a[i]"), "mine & a_get(i)");
    }

    #[test]
    fn writes_become_calls() {
        assert_eq!(rewritten("a[f(i, 2u)] = a[j] * (b + 1u); c"), "a_put(f(i, 2u), a_get(j) * (b + 1u)); c");
        assert_eq!(rewritten("a[i] |= 1u;"), "a_put(i, a_get(i) | (1u));");
        assert_eq!(rewritten("for (; i < 2u; a[i] += f(a[j])) {"), "for (; i < 2u; a_put(i, a_get(i) + (f(a_get(j))))) {");
        assert_eq!(rewritten("a[i] =\n    b;"), "a_put(i, \n    b);");
    }

    #[test]
    fn atomics_become_calls() {
        assert_eq!(rewritten("x = atomicAdd(&a[b + 1u], 2u);"), "x = a_atomicAdd(b + 1u, 2u);");
        assert_eq!(rewritten("(mine & ~atomicLoad(&a[0]))"), "(mine & ~a_atomicLoad(0))");
    }

    #[test]
    fn elements_of_rows_are_read_and_written_one_by_one() {
        let text = "@group(0) @binding(2) var<storage, read_write> a: array<array<u32, SLICE>>;\na[i + 1u][k % 2u] = a[a[0][1]][2] | b[3];\n";
        let found = split(text, &[array("a", 256, &[3])]);
        assert_eq!(
            found,
            "@group(0) @binding(2) var<storage, read_write> a_0: array<array<u32, SLICE>>; @group(0) @binding(3) var<storage, read_write> a_1: array<array<u32, SLICE>>;
a_put(i + 1u, k % 2u, a_get(a_get(0, 1), 2) | b[3]);
fn a_get(i: u32, k: u32) -> u32 { if i < 2u { return a_0[i][k]; } else { return a_1[i - 2u][k]; } }
fn a_put(i: u32, k: u32, v: u32) { if i < 2u { a_0[i][k] = v; } else { a_1[i - 2u][k] = v; } }
"
        );
    }

    #[test]
    fn other_text_is_unchanged() {
        for text in ["// a[i] = 1", "ba[i] = aa[j] + a_[k]", "step.a[i]", "let a = 1u;", "a.x", "fn f(a: u32)"] {
            assert_eq!(rewritten(text), text);
        }
        // The compiler refuses this: `a` no longer exists.
        assert_eq!(split("p(&a[i])", &[]), "p(&a[i])");
    }

    #[test]
    fn declarations_and_functions_are_generated_per_chunk() {
        let text = "@group(0) @binding(3) var<storage, read> b: array<vec4f>;\n@group(0) @binding(4) var<storage, read_write> \
                    a: array<u32>;\n";
        let found = split(text, &[array("a", 32, &[7, 8]), array("b", 64, &[6])]);
        let expected = "\
@group(0) @binding(3) var<storage, read> b_0: array<vec4f>; @group(0) @binding(6) var<storage, read> b_1: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> a_0: array<u32>; @group(0) @binding(7) var<storage, read_write> a_1: array<u32>; \
@group(0) @binding(8) var<storage, read_write> a_2: array<u32>;
fn a_get(i: u32) -> u32 { if i < 8u { return a_0[i]; } else { if i < 16u { return a_1[i - 8u]; } else { return a_2[i - 16u]; } } }
fn a_put(i: u32, v: u32) { if i < 8u { a_0[i] = v; } else { if i < 16u { a_1[i - 8u] = v; } else { a_2[i - 16u] = v; } } }
fn b_get(i: u32) -> vec4f { if i < 4u { return b_0[i]; } else { return b_1[i - 4u]; } }
";
        assert_eq!(found, expected);
        let text = "@group(0) @binding(2) var<storage, read_write> a: array<atomic<u32>>;\nlet x = atomicMax(&a[i], 3u);\n";
        let found = split(text, &[array("a", 32, &[3])]);
        let function = "fn a_atomicMax(i: u32, v: u32) -> u32 { if i < 8u { return atomicMax(&a_0[i], v); } else { return \
                        atomicMax(&a_1[i - 8u], v); } }\n";
        assert!(found.ends_with(function), "{found}");
    }
}
