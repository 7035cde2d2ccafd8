//! Errors of the engine as errors of JavaScript.

use rockfall::Error;
use wasm_bindgen::prelude::*;

/// Converts an error to an `Error` with the message of the engine. Its `name` identifies the kind of the error. An error in a
/// scene text also has the properties `line` (from 1) and `field`.
pub(crate) fn thrown(error: Error) -> JsValue {
    let made = js_sys::Error::new(&error.to_string());
    let name = match &error {
        Error::SceneLine { .. } => "SceneError",
        Error::NoAdapter(_) => "NoAdapterError",
        Error::Device(_) => "DeviceError",
        Error::DeviceLimit { .. } => "DeviceLimitError",
        _ => "RockfallError",
    };
    made.set_name(name);
    if let Error::SceneLine { line, field, .. } = &error {
        let set = |property: &str, value: JsValue| js_sys::Reflect::set(&made, &property.into(), &value);
        // Setting a new property of a plain object cannot fail.
        let _ = set("line", JsValue::from_f64(*line as f64));
        let _ = set("field", field.as_str().into());
    }
    made.into()
}
