//! The WGSL of all that kernels share with the host.

use std::fmt::Write as _;

use crate::model::declare::Value;
use crate::model::status::{Counters, Status};
use crate::model::step::{Aabb, Pass, Step};
use crate::model::{layout, status};

/// The declaration of a block.
fn block(name: &str, fields: &str) -> String {
    format!("struct {name} {{\n{fields}}}\n")
}

/// The declarations of `model/step.wgsl` that have a twin in Rust.
pub(crate) fn wgsl() -> String {
    let mut text =
        [block("Step", &Step::wgsl_fields()), block("Pass", Pass::WGSL_FIELDS), block("Aabb", Aabb::WGSL_FIELDS)].concat();
    for suffix in ["", "Atomic"] {
        let words = |text: &mut String, all: &[(&str, bool)]| {
            for (name, is_atomic) in all {
                let of = if *is_atomic && !suffix.is_empty() { "atomic<u32>" } else { "u32" };
                let _ = writeln!(text, "    {name}: {of},");
            }
        };
        let _ = writeln!(text, "struct Counters{suffix} {{");
        words(&mut text, Counters::WORDS);
        (0..Counters::PADDING).for_each(|k| words(&mut text, &[(&format!("pad_{k}"), false)]));
        let _ = writeln!(text, "}}\nstruct Status{suffix} {{\n    counters: array<Counters{suffix}, COUNTER_BLOCKS>,");
        words(&mut text, Status::WORDS);
        let _ = writeln!(text, "}}");
    }
    for (name, value) in [layout::CONSTANTS, status::CONSTANTS].concat() {
        let _ = match value {
            Value::U32(value) => writeln!(text, "const {name}: u32 = {value}u;"),
            Value::F32(value) => writeln!(text, "const {name}: f32 = {value:?}f;"),
            Value::Vec4([x, y, z, w]) => writeln!(text, "const {name}: vec4f = vec4f({x:?}f, {y:?}f, {z:?}f, {w:?}f);"),
        };
    }
    text
}
