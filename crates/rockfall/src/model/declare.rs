//! What kernels share with the host is declared once, in Rust. The macros here also give its WGSL.

/// The value of a constant.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Value {
    U32(u32),
    F32(f32),
    Vec4([f32; 4]),
}

macro_rules! value {
    (u32, $value:expr) => {
        $crate::model::declare::Value::U32($value)
    };
    (f32, $value:expr) => {
        $crate::model::declare::Value::F32($value)
    };
    ([f32; 4], $value:expr) => {
        $crate::model::declare::Value::Vec4($value)
    };
}
pub(crate) use value;

/// Declares constants, and `CONSTANTS`, which has the names and values of all of them.
macro_rules! constants {
    ($($(#[$doc:meta])* pub const $name:ident: $type:tt = $value:expr;)+) => {
        $($(#[$doc])* pub const $name: $type = $value;)+

        /// Names and values for kernels.
        pub(crate) const CONSTANTS: &[(&str, $crate::model::declare::Value)] =
            &[$((stringify!($name), $crate::model::declare::value!($type, $name))),+];
    };
}
pub(crate) use constants;

/// The WGSL type of a field.
macro_rules! wgsl_type {
    (f32) => {
        "f32"
    };
    (u32) => {
        "u32"
    };
    ([f32; 3]) => {
        "vec3f"
    };
}
pub(crate) use wgsl_type;

/// A block of numbers and vectors, and its declaration in WGSL.
macro_rules! block {
    ($(#[$outer:meta])* pub struct $name:ident { $($(#[$inner:meta])* pub $field:ident: $type:tt,)+ }) => {
        $(#[$outer])*
        pub struct $name { $($(#[$inner])* pub $field: $type,)+ }

        impl $name {
            /// Name, offset and size of every field, in bytes.
            pub const FIELDS: &'static [(&'static str, usize, usize)] =
                &[$((stringify!($field), std::mem::offset_of!($name, $field), size_of::<$type>())),+];
            /// The fields in the declaration for kernels.
            pub(crate) const WGSL_FIELDS: &'static str =
                concat!($("    ", stringify!($field), ": ", $crate::model::declare::wgsl_type!($type), ",\n",)+);
        }
    };
}
pub(crate) use block;

/// A block of words that kernels write, with fields of other types before and after them. A word that many threads of a dispatch may
/// write is marked `=> atomic`: for the stages with such dispatches, its type is `atomic<u32>`.
macro_rules! words {
    (
        $(#[$outer:meta])*
        pub struct $name:ident {
            before { $($before:tt)* }
            words { $($(#[$inner:meta])* pub $field:ident: u32 $(=> $atomic:ident)?,)+ }
            after { $($after:tt)* }
        }
    ) => {
        $(#[$outer])*
        pub struct $name { $($before)* $($(#[$inner])* pub $field: u32,)+ $($after)* }

        impl $name {
            /// Name, offset and size of every word, in bytes.
            pub const FIELDS: &'static [(&'static str, usize, usize)] =
                &[$((stringify!($field), std::mem::offset_of!($name, $field), 4)),+];
            /// Names of the words, and whether they are marked `=> atomic`.
            pub(crate) const WORDS: &'static [(&'static str, bool)] =
                &[$((stringify!($field), $crate::model::declare::words!(@ $($atomic)?))),+];
        }
    };
    (@) => { false };
    (@ atomic) => { true };
}
pub(crate) use words;
