//! The table of physical constants.

use rockfall::Settings;
use wasm_bindgen::prelude::*;

/// A physical constant.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug)]
pub struct Constant {
    /// Name for `Simulation.setting` and `Simulation.setSetting`.
    pub name: String,
    /// Unit; empty for a number without one.
    pub unit: String,
    /// Meaning, in Markdown.
    pub doc: String,
    /// Least value of a slider, for constants that have one.
    pub least: Option<f32>,
    /// Greatest value of a slider.
    pub greatest: Option<f32>,
}

/// All physical constants.
#[wasm_bindgen]
pub fn constants() -> Vec<Constant> {
    let row = |constant: &rockfall::settings::Constant| Constant {
        name: constant.name.to_owned(),
        unit: constant.unit.to_owned(),
        doc: constant.doc.trim().to_owned(),
        least: constant.slider.map(|(least, _)| least),
        greatest: constant.slider.map(|(_, greatest)| greatest),
    };
    Settings::TABLE.iter().map(row).collect()
}
