//! The texts of the kernels, for a test that the browser accepts them.

use rockfall::exec::gpu::join;
use rockfall::model::step::Step;
use rockfall::step::catalog::ALL;
use rockfall::step::wgsl::Variant;
use wasm_bindgen::prelude::*;

/// Name and WGSL text of every stage except `run_worlds`, one after the other, for scenes with all kinds of objects (`all`) or
/// with spheres only.
#[wasm_bindgen]
pub fn kernels(all: bool) -> Vec<String> {
    let variant = Variant { rods: all, large: all, muscles: all, ..Variant::of(&Step::default()) };
    let stages = ALL.iter().filter(|stage| stage.name != "run_worlds");
    stages.flat_map(|stage| [stage.name.to_owned(), variant.apply(&join(&stage.parts()))]).collect()
}
