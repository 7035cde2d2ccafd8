//! What force laws and contact laws have in common: a name, parameters, and WGSL text that is checked and compiled once.

use std::sync::{Arc, OnceLock};

use crate::error::{Error, Result, quoted};
use crate::user_laws::program::Program;
use crate::user_laws::source::{MOST_ROUNDS, Place, Signature, Source};

/// The name, the parameters and the WGSL text of a law.
#[derive(Clone, Debug)]
pub(super) struct LawText {
    pub(super) name: String,
    pub(super) parameters: Vec<(String, f32)>,
    pub(super) wgsl: Option<String>,
    compiled: OnceLock<Compiled>,
}

/// The WGSL function of a law, and the program for the CPU.
#[derive(Clone, Debug)]
struct Compiled {
    #[cfg_attr(not(feature = "gpu"), allow(dead_code, reason = "for kernels"))]
    wgsl: Arc<str>,
    program: Arc<Program>,
}

/// What is compiled follows from the rest.
impl PartialEq for LawText {
    fn eq(&self, other: &Self) -> bool {
        (&self.name, &self.parameters, &self.wgsl) == (&other.name, &other.parameters, &other.wgsl)
    }
}

impl LawText {
    pub(super) fn new(name: String) -> Self {
        Self { name, parameters: Vec::new(), wgsl: None, compiled: OnceLock::new() }
    }

    pub(super) fn add_parameter(&mut self, name: String, value: f32) {
        self.parameters.push((name, value));
        self.compiled = OnceLock::new();
    }

    pub(super) fn set_wgsl(&mut self, text: String) {
        self.wgsl = Some(text);
        self.compiled = OnceLock::new();
    }

    /// Checks names, values and the WGSL text.
    pub(super) fn check(&self, signature: &Signature, has_function: bool) -> Result<()> {
        if self.name.is_empty() {
            return Err(self.error("a law needs a name"));
        }
        for (place, (name, value)) in self.parameters.iter().enumerate() {
            let is_word = name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
            let starts = name.starts_with(|letter: char| letter.is_ascii_alphabetic());
            let is_taken = signature.inputs.iter().chain(signature.outputs).any(|(taken, _)| taken == name);
            if !is_word || !starts || name.starts_with("rockfall_") {
                let expected = "expected a letter, then letters, digits and '_'";
                return Err(self.error(format!("{} is no name for a parameter, {expected}", quoted(name))));
            }
            if is_taken || self.parameters[..place].iter().any(|(other, _)| other == name) {
                return Err(self.error(format!("the name {} of a parameter is taken", quoted(name))));
            }
            self.check_value(name, *value)?;
        }
        if self.wgsl.is_none() && !has_function {
            return Err(self.error("it has neither WGSL nor a function"));
        }
        self.compiled(signature).map(|_| ())
    }

    /// The place of a parameter.
    pub(super) fn place_of(&self, name: &str) -> Result<usize> {
        let names: Vec<&str> = self.parameters.iter().map(|(name, _)| name.as_str()).collect();
        names.iter().position(|known| *known == name).ok_or_else(|| {
            let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            self.error(format!("it has no parameter {}: it has {known}", quoted(name)))
        })
    }

    pub(super) fn set_parameter(&mut self, name: &str, value: f32) -> Result<()> {
        self.check_value(name, value)?;
        let place = self.place_of(name)?;
        self.parameters[place].1 = value;
        Ok(())
    }

    pub(super) fn check_value(&self, name: &str, value: f32) -> Result<()> {
        if value.is_finite() {
            Ok(())
        } else {
            Err(self.error(format!("parameter {} is {value}, expected a finite number", quoted(name))))
        }
    }

    /// An error about the law as a whole.
    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        Error::Law { law: self.name.clone(), line: 0, column: 0, text: String::new(), message: message.into() }
    }

    /// The function of WGSL for kernels.
    #[cfg(feature = "gpu")]
    pub(super) fn kernel_text(&self, signature: &Signature, setter: &str) -> Result<Arc<str>> {
        match self.compiled(signature)? {
            Some(compiled) => Ok(compiled.wgsl.clone()),
            None => {
                Err(self.error(format!("it has no WGSL, which the GPU needs; give it with {setter}, or use the CPU backend")))
            }
        }
    }

    /// Hash of the text (64-bit FNV-1a); 0 without a text.
    pub(super) fn hash(&self) -> u64 {
        let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        self.wgsl.as_ref().map_or(0, |text| text.bytes().fold(0xcbf2_9ce4_8422_2325, mix))
    }

    /// The compiled text, if the law has been checked and has one.
    pub(super) fn program(&self) -> Option<&Program> {
        self.compiled.get().map(|compiled| &*compiled.program)
    }

    /// The error of a result that is not finite, with the line of the text that is the cause. `what` is the body or contact.
    pub(super) fn not_finite(&self, message: String, what: &str, arguments: impl Iterator<Item = [f32; 4]>) -> Error {
        let line = self.program().and_then(|program| program.first_not_finite(arguments));
        let text = self.wgsl.as_deref().unwrap_or_default();
        match line {
            // The loops are checked after the text.
            Some(line) if line > text.lines().count() => {
                self.error(format!("its loops make more than {MOST_ROUNDS} rounds for {what}"))
            }
            Some(line) => Source { law: &self.name, text }.error(Place { line, column: 0 }, message),
            None => self.error(message),
        }
    }

    #[cfg(all(feature = "wgsl", not(target_family = "wasm")))]
    fn compiled(&self, signature: &Signature) -> Result<Option<&Compiled>> {
        let Some(text) = &self.wgsl else { return Ok(None) };
        if self.compiled.get().is_none() {
            let parameters: Vec<&str> = self.parameters.iter().map(|(name, _)| name.as_str()).collect();
            let source = Source { law: &self.name, text };
            let (wgsl, program) = crate::user_laws::compile::compile(source, signature, &parameters)?;
            // Another thread may have been first, with the same result.
            let _ = self.compiled.set(Compiled { wgsl: wgsl.into(), program: Arc::new(program) });
        }
        Ok(self.compiled.get())
    }

    /// Without the compiler, a law may have a function only.
    #[cfg(not(all(feature = "wgsl", not(target_family = "wasm"))))]
    fn compiled(&self, _signature: &Signature) -> Result<Option<&Compiled>> {
        match self.wgsl {
            None => Ok(None),
            Some(_) => Err(self.error("this build of rockfall cannot read WGSL: it does not have the feature wgsl")),
        }
    }
}
