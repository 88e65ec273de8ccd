//! The clock of a window or a worker.

use wasm_bindgen::JsCast;

/// A clock \[ms\].
pub(super) fn clock() -> impl Fn() -> f64 {
    let performance = js_sys::Reflect::get(&js_sys::global(), &"performance".into())
        .ok()
        .and_then(|performance| performance.dyn_into::<web_sys::Performance>().ok());
    move || performance.as_ref().map_or_else(js_sys::Date::now, web_sys::Performance::now)
}
