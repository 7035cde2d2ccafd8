//! A file of WGSL and its text.

/// A file of WGSL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Path below `src/`.
    pub file: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! part {
    ($file:literal) => {
        $crate::model::part::Part { file: $file, text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/", $file)) }
    };
}
pub(crate) use part;
