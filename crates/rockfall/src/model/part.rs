//! WGSL files that are compiled into the library.

/// A WGSL file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Path below `src/`.
    pub file: &'static str,
    /// Contents of the file.
    pub text: &'static str,
}

macro_rules! part {
    ($file:literal) => {
        $crate::model::part::Part { file: $file, text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/", $file)) }
    };
}
pub(crate) use part;
