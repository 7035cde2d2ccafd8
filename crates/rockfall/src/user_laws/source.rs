//! The WGSL text of a law, within the function that surrounds it.

use crate::error::{Error, Result};

/// Names that begin so are reserved for the function that surrounds the text.
const RESERVED: &str = "rockfall_";
/// Largest number of rounds that all loops of a law may make in one evaluation. A loop without an end would hang a device.
pub(super) const MOST_ROUNDS: u32 = 10_000;
/// Lines of the function before the text.
const LINES_BEFORE: usize = 3;

/// What the text of a law may use and must compute.
#[derive(Debug)]
pub(super) struct Signature {
    /// Names and types of the values that are given, before the parameters.
    pub(super) inputs: &'static [(&'static str, &'static str)],
    /// Names and types of the values that are computed. They are 0 at the start.
    pub(super) outputs: &'static [(&'static str, &'static str)],
}

/// A place in the text of a law. Line 0 stands for the names of its parameters, before the text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Line, from 1.
    pub(super) line: usize,
    /// Column in characters, from 1; 0 for the whole line.
    pub(super) column: usize,
}

/// The text of a law, by name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    pub(super) law: &'a str,
    pub(super) text: &'a str,
}

impl Source<'_> {
    /// An error in the text.
    pub(super) fn error(&self, place: Place, message: impl Into<String>) -> Error {
        if place.line == 0 {
            let (law, message) = (self.law.to_owned(), message.into());
            return Error::Law { law, line: 0, column: 0, text: String::new(), message };
        }
        // An error after the end of the text is one of its last line.
        let last = self.text.lines().count().max(1);
        let (line, column) = if place.line > last { (last, 0) } else { (place.line, place.column) };
        let text = self.text.lines().nth(line - 1).unwrap_or_default().to_owned();
        Error::Law { law: self.law.to_owned(), line, column, text, message: message.into() }
    }

    /// The place of a byte of the text.
    fn place(&self, byte: usize) -> Place {
        let before = &self.text[..byte];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        Place { line: before.matches('\n').count() + 1, column: before[line_start..].chars().count() + 1 }
    }

    /// The place in the text of a byte of the function from [`wrapped`]. Bytes before the text are on line 0,
    /// those after it on the line after its last one.
    pub(super) fn place_in(&self, function: &str, byte: usize) -> Place {
        let start = function.match_indices('\n').nth(LINES_BEFORE - 1).map_or(0, |(at, _)| at + 1);
        let Some(byte) = byte.checked_sub(start) else { return Place { line: 0, column: 0 } };
        if byte > self.text.len() {
            return Place { line: self.text.lines().count() + 1, column: 0 };
        }
        self.place(byte)
    }
}

/// A word or a punctuation mark of WGSL, with the byte at which it begins.
type Token<'a> = (usize, &'a str);

/// The words and punctuation marks of a text, without comments. Block comments may be nested.
fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut found, mut at, mut comments) = (Vec::new(), 0, 0);
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
        let length = if rest.starts_with("/*") {
            comments += 1;
            2
        } else if comments > 0 {
            let ends = rest.starts_with("*/");
            comments -= i32::from(ends);
            if ends { 2 } else { first.len_utf8() }
        } else if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else {
            let word = rest.find(|letter| !is_word(letter)).unwrap_or(rest.len()).max(first.len_utf8());
            if !first.is_whitespace() {
                found.push((at, &rest[..word]));
            }
            word
        };
        at += length;
    }
    found
}

/// Checks what the compiler does not: that the text stays inside its function, and that it uses no reserved names.
pub(super) fn check(source: Source<'_>) -> Result<()> {
    let (mut open, tokens) = (Vec::new(), tokens(source.text));
    for (&(at, token), next) in tokens.iter().zip(tokens.iter().skip(1).map(|(_, next)| Some(*next)).chain([None])) {
        let refused = match token {
            // Kernels have a variable of this name.
            "step" if next == Some("(") => "the function step is not available, write select(0.0, 1.0, x >= edge)".to_owned(),
            "{" => {
                open.push(at);
                continue;
            }
            "}" if open.pop().is_none() => "this '}' closes nothing".to_owned(),
            "@" => "attributes are not allowed in a law".to_owned(),
            word if word.starts_with(RESERVED) => format!("names that begin with {RESERVED} are reserved"),
            _ => continue,
        };
        return Err(source.error(source.place(at), refused));
    }
    match open.pop() {
        Some(at) => Err(source.error(source.place(at), "this '{' is not closed")),
        None => Ok(()),
    }
}

/// Returns the text with a limit to the rounds of its loops, on the same lines.
pub(super) fn bounded(text: &str) -> String {
    let (mut result, mut copied, mut awaits_body) = (String::new(), 0, false);
    for (at, token) in tokens(text) {
        match token {
            "for" | "while" | "loop" => awaits_body = true,
            "{" if awaits_body => {
                awaits_body = false;
                result.push_str(&text[copied..=at]);
                copied = at + 1;
                result.push_str(&format!(" if rockfall_rounds >= {MOST_ROUNDS}u {{ break; }} rockfall_rounds += 1u;"));
            }
            _ => {}
        }
    }
    result + &text[copied..]
}

/// Returns the text as a function of WGSL.
pub(super) fn wrapped(signature: &Signature, parameters: &[&str], text: &str) -> String {
    let inputs = signature.inputs.iter().map(|(name, kind)| format!("{name}: {kind}"));
    let parameters = parameters.iter().map(|name| format!("{name}: f32"));
    let arguments: Vec<String> = inputs.chain(parameters).collect();
    let each = |write: fn(&str, &str) -> String| -> Vec<String> {
        signature.outputs.iter().map(|(name, kind)| write(name, kind)).collect()
    };
    let fields = each(|name, kind| format!("{name}: {kind}")).join(", ");
    let start = each(|name, kind| format!("var {name} = {kind}(0.0);")).join(" ");
    // The result of a law whose loops do not end is not a number. Its bits are computed, because the constant is refused.
    let results = each(|name, kind| {
        let not_a_number = "bitcast<f32>(rockfall_rounds | 0x7fc00000u)";
        let endless = if kind == "f32" { not_a_number.to_owned() } else { format!("{kind}({not_a_number})") };
        format!("select({name}, {endless}, rockfall_rounds >= {MOST_ROUNDS}u)")
    });
    format!(
        "struct rockfall_result {{ {fields} }}\nfn rockfall_law({}) -> rockfall_result {{\n{start} var rockfall_rounds = 0u;\n\
         {text}\nreturn rockfall_result({}); }}\n",
        arguments.join(", "),
        results.join(", "),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        check(Source { law: "pull", text }).unwrap_err().to_string()
    }

    #[test]
    fn text_that_leaves_its_function_is_refused() {
        let message = refused("force = position;\n  } fn more() {");
        assert!(message.contains("law 'pull', line 2, column 3: this '}' closes nothing"), "{message}");
        assert!(refused("if mass > 1.0 {\n").contains("line 1, column 15: this '{' is not closed"));
        assert!(refused("force.x = step(0.1, mass);").contains("column 11: the function step is not available"));
        assert!(refused("/* } */ let a = rockfall_rounds;").contains("column 17: names that begin with rockfall_"));
        assert!(check(Source { law: "pull", text: "/* { /* } */ */ // }\nif true { } " }).is_ok());
    }

    #[test]
    fn every_loop_gets_a_limit_on_its_line() {
        let text = "for (var k = 0; k < 3; k++) {\n while a { b(); } }\nloop { break; } // loop {\nif c { }";
        let result = bounded(text);
        assert_eq!(result.matches("rockfall_rounds += 1u").count(), 3);
        assert_eq!(result.lines().count(), text.lines().count());
        assert!(result.ends_with("// loop {\nif c { }"), "{result}");
    }
}
