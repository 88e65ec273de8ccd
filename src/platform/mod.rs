//! Platform code: files, clocks, windows, the web page, JavaScript.
//!
//! Only these modules depend on a platform; no other module uses them.

#[cfg(all(feature = "js-api", target_arch = "wasm32"))]
mod benchmark;

#[cfg(all(feature = "js-package", target_arch = "wasm32"))]
mod clock;

#[cfg(all(feature = "js-package", target_arch = "wasm32"))]
pub mod js;

#[cfg(all(feature = "js-package", target_arch = "wasm32"))]
pub mod studies;

#[cfg(all(feature = "command-line", not(target_arch = "wasm32")))]
pub mod command_line;

#[cfg(all(any(feature = "app", feature = "command-line"), not(target_arch = "wasm32")))]
pub mod runner;

#[cfg(feature = "app")]
mod keep;

#[cfg(all(feature = "app", not(target_arch = "wasm32")))]
pub mod native;

#[cfg(all(feature = "app", target_arch = "wasm32"))]
mod page_handle;

#[cfg(all(any(feature = "app", feature = "js-package"), target_arch = "wasm32"))]
mod text;

#[cfg(all(feature = "app", target_arch = "wasm32"))]
pub mod web;

#[cfg(all(any(feature = "app", feature = "js-package"), target_arch = "wasm32"))]
pub mod workers;
