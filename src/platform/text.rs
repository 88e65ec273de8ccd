//! Text from scripts, which may hand over anything.

use wasm_bindgen::prelude::*;

/// The text in a value; else an `Error` that says what it was to be.
pub(super) fn text(value: &JsValue, name: &str) -> Result<String, JsError> {
    value.as_string().ok_or_else(|| JsError::new(&format!("{name} is not text; allowed: a string")))
}

/// The same where there may be nothing.
#[cfg(feature = "js-api")]
pub(super) fn text_or_nothing(value: &JsValue, name: &str) -> Result<Option<String>, JsError> {
    if value.is_null() || value.is_undefined() { Ok(None) } else { text(value, name).map(Some) }
}
