//! Conversion of JavaScript values to text; scripts may pass any type.

use wasm_bindgen::prelude::*;

/// Returns the text of a value, or an `Error` that names the parameter and the expected type.
pub(super) fn text(value: &JsValue, name: &str) -> Result<String, JsError> {
    value.as_string().ok_or_else(|| JsError::new(&format!("{name} is not text; allowed: a string")))
}

/// Returns the text of an optional value.
#[cfg(feature = "js-api")]
pub(super) fn text_or_nothing(value: &JsValue, name: &str) -> Result<Option<String>, JsError> {
    if value.is_null() || value.is_undefined() { Ok(None) } else { text(value, name).map(Some) }
}
