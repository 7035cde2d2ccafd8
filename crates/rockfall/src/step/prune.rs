//! Removes from the text of a kernel what its variant never runs.
//!
//! Compilers put the body of a function in the place of each call before they remove branches whose condition is constant. Pruneds
//! call geometry in hundreds of places, so that branches never taken would take most of the time and memory of a compilation.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Returns the text without branches whose conditions are constant, for example `if RODS { ... }` after `const RODS: bool = false;`.
/// Lines keep their numbers.
pub fn prune(text: &str) -> String {
    let mut kernel = Pruned::new(text);
    let mut at = 0;
    while let Some(start) = kernel.find_word("if", at) {
        at = start + 2;
        let Some(open) = kernel.find_at_depth_0(b'{', at) else { break };
        let close = kernel.close_of(open);
        match kernel.facts.value(kernel.text(at..open)) {
            Some(true) => kernel.keep(start, open, close),
            Some(false) => kernel.drop(start, close),
            None => {}
        }
    }
    String::from_utf8(kernel.out).expect("whole characters are replaced")
}

/// What the constants of a kernel say about conditions.
#[derive(Default)]
struct Facts {
    flags: HashMap<String, bool>,
    /// Contact laws by the names of their constants, and `LAW`, the law of the kernel.
    laws: HashMap<String, String>,
    /// Functions that always return `false`.
    never: HashSet<String>,
}

impl Facts {
    fn of(code: &str) -> Self {
        let mut facts = Self::default();
        for line in code.split("const ").skip(1) {
            let Some((head, value)) = line.split_once(';').and_then(|(head, _)| head.split_once('=')) else { continue };
            let (Some((name, kind)), value) = (head.split_once(':'), value.trim()) else { continue };
            match (kind.trim(), value) {
                ("bool", "true" | "false") => drop(facts.flags.insert(name.trim().to_owned(), value == "true")),
                ("u32", _) if name.starts_with("LAW") => drop(facts.laws.insert(name.trim().to_owned(), value.to_owned())),
                _ => {}
            }
        }
        for function in code.split("fn ").skip(1) {
            let body = function.split_once('{').and_then(|(_, rest)| rest.trim_start().strip_prefix("return "));
            let Some((expression, rest)) = body.and_then(|body| body.split_once(';')) else { continue };
            if rest.trim_start().starts_with('}') && facts.value(expression) == Some(false) {
                let name = function.split('(').next().unwrap_or_default();
                facts.never.insert(name.trim().to_owned());
            }
        }
        facts
    }

    /// The value of a condition, if constants decide it.
    fn value(&self, condition: &str) -> Option<bool> {
        let condition = condition.trim();
        // WGSL has no precedence between these operators: a condition that mixes them has parentheses.
        for (operator, decides) in [('|', true), ('&', false)] {
            let terms = terms(condition, operator);
            if terms.len() > 1 {
                let mut values = terms.into_iter().map(|term| self.value(term));
                let has_unknown = values.clone().any(|value| value.is_none());
                return if values.any(|value| value == Some(decides)) {
                    Some(decides)
                } else {
                    (!has_unknown).then_some(!decides)
                };
            }
        }
        if let Some(rest) = condition.strip_prefix('!') {
            return self.value(rest).map(|value| !value);
        }
        if let Some(inner) = condition.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) {
            return self.value(inner);
        }
        for (operator, if_same) in [("==", true), ("!=", false)] {
            if let Some((left, right)) = condition.split_once(operator) {
                let law = |name: &str| self.laws.get(name.trim());
                return Some((law(left)? == law(right)?) == if_same);
            }
        }
        let is_never = condition.split_once('(').is_some_and(|(name, _)| self.never.contains(name));
        if is_never { Some(false) } else { self.flags.get(condition).copied() }
    }
}

/// The terms between operators `&` or `&&`, or `|` or `||`, outside parentheses.
fn terms(condition: &str, operator: char) -> Vec<&str> {
    let mut depth = 0;
    let terms = condition.split(|letter: char| {
        match letter {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            _ => {}
        }
        letter == operator && depth == 0
    });
    // Between the letters of `&&` there is nothing.
    terms.filter(|term| !term.is_empty()).collect()
}

/// The text of a kernel, in which pieces are replaced by spaces.
struct Pruned {
    out: Vec<u8>,
    /// The same without comments.
    code: Vec<u8>,
    facts: Facts,
}

impl Pruned {
    fn new(text: &str) -> Self {
        let mut code = text.as_bytes().to_vec();
        let mut at = 0;
        for line in text.split_inclusive('\n') {
            if let Some(comment) = line.find("//") {
                blank(&mut code[at + comment..at + line.len()]);
            }
            at += line.len();
        }
        let facts = Facts::of(std::str::from_utf8(&code).expect("whole characters are replaced"));
        Self { out: text.as_bytes().to_vec(), code, facts }
    }

    fn text(&self, range: Range<usize>) -> &str {
        std::str::from_utf8(&self.code[range]).expect("ends beside ASCII letters")
    }

    fn blank(&mut self, range: Range<usize>) {
        blank(&mut self.out[range.clone()]);
        blank(&mut self.code[range]);
    }

    fn is_word_at(&self, word: &str, at: usize) -> bool {
        let is_letter = |byte: Option<&u8>| byte.is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_');
        self.code[at..].starts_with(word.as_bytes())
            && !is_letter(self.code.get(at + word.len()))
            && (at == 0 || !is_letter(self.code.get(at - 1)))
    }

    /// The next place of a word.
    fn find_word(&self, word: &str, from: usize) -> Option<usize> {
        (from..self.code.len()).find(|&at| self.is_word_at(word, at))
    }

    /// The next place of a letter outside the brackets that are open at a place.
    fn find_at_depth_0(&self, letter: u8, from: usize) -> Option<usize> {
        let mut depth = 0_i32;
        (from..self.code.len()).find(|&at| {
            let byte = self.code[at];
            let is_found = depth == 0 && byte == letter;
            depth += i32::from(b"([{".contains(&byte)) - i32::from(b")]}".contains(&byte));
            is_found
        })
    }

    /// The place behind the bracket that closes the one at `open`.
    fn close_of(&self, open: usize) -> usize {
        self.find_at_depth_0(b'}', open + 1).map_or(self.code.len(), |close| close + 1)
    }

    /// The place behind `else`, if it comes next.
    fn behind_else(&self, from: usize) -> Option<usize> {
        let spaces = self.code[from..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        self.is_word_at("else", from + spaces).then_some(from + spaces + 4)
    }

    /// The place of the `else` before a place.
    fn else_before(&self, start: usize) -> Option<usize> {
        let before = self.code[..start].trim_ascii_end().len();
        before.checked_sub(4).filter(|&at| self.is_word_at("else", at))
    }

    /// Removes a branch that is never taken.
    fn drop(&mut self, start: usize, close: usize) {
        match (self.behind_else(close), self.else_before(start)) {
            (Some(other), _) => self.blank(start..other),
            (None, Some(before)) => self.blank(before..close),
            (None, None) => self.blank(start..close),
        }
    }

    /// Keeps the block of a branch that is always taken, without its condition, the other branches, and what follows a return.
    fn keep(&mut self, start: usize, open: usize, close: usize) {
        self.blank(start..open);
        while let Some(other) = self.behind_else(close) {
            let end = self.find_at_depth_0(b'{', other).map_or(other, |open| self.close_of(open));
            self.blank(close..end);
        }
        let body = self.text(open + 1..close - 1).trim();
        let last = body.strip_suffix(';').and_then(|body| body.rsplit([';', '{', '}']).next());
        let returns = last.is_some_and(|last| last.trim_start().starts_with("return"));
        if returns
            && self.else_before(start).is_none()
            && let Some(end) = self.find_at_depth_0(b'}', close)
        {
            self.blank(close..end);
        }
    }
}

/// Replaces a text by spaces, but not the ends of lines.
fn blank(text: &mut [u8]) {
    text.iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAGS: &str = "const ON: bool = true; const OFF: bool = false;\nconst LAW: u32 = 1u; const LAW_ONE: u32 = 1u; const LAW_TWO: u32 = 2u;\n\
                         fn is_rare(x: u32) -> bool { return OFF && (x > 2u); }\n";

    /// What is left of statements, without spaces between words.
    fn left(statements: &str) -> String {
        let text = format!("{FLAGS}fn f() {{ {statements} }}");
        let pruned = prune(&text);
        assert_eq!(pruned.lines().count(), text.lines().count());
        let words: Vec<&str> = pruned.strip_prefix(FLAGS).expect("the same flags").split_whitespace().collect();
        words.join(" ").strip_prefix("fn f() { ").and_then(|rest| rest.strip_suffix('}')).expect("a function").trim().to_owned()
    }

    #[test]
    fn branches_that_are_never_taken_are_removed() {
        assert_eq!(left("if OFF { a(); } b();"), "b();");
        assert_eq!(left("if !ON | (OFF & (x == 1u)) { if c { a(); } } b();"), "b();");
        assert_eq!(left("if is_rare(x) { a(); } else { b(); }"), "{ b(); }");
        assert_eq!(left("if c { a(); } else if OFF { b(); }"), "if c { a(); }");
        assert_eq!(left("if c { a(); } else if OFF { b(); } else { d(); }"), "if c { a(); } else { d(); }");
        assert_eq!(left("if OFF { a(); } else if c { b(); } else { d(); }"), "if c { b(); } else { d(); }");
        assert_eq!(left("if LAW == LAW_TWO { a(); } if LAW != LAW_TWO { b(); }"), "{ b(); }");
    }

    #[test]
    fn nothing_follows_a_return_that_is_always_reached() {
        assert_eq!(left("if ON { return a(); } b();"), "{ return a(); }");
        assert_eq!(left("if c { if ON { return; } a(); } b();"), "if c { { return; } } b();");
        assert_eq!(left("if ON { if c { return; } a(); } b();"), "{ if c { return; } a(); } b();");
        assert_eq!(left("if ON { a(); } else if c { b(); } else { d(); } e();"), "{ a(); } e();");
    }

    #[test]
    fn other_conditions_stay() {
        for text in [
            "if c { a(); }",
            "if ON & (x > 1u) { a(); }",
            "if OFF | g(OFF) { a(); }",
            "if is_rare_or(x) { a(); }",
            "if (a & OFFSET) != 0u { a(); }",
        ] {
            assert_eq!(left(text), text);
        }
    }
}
