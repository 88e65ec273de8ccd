//! Platform code: files, clocks, windows, the web page, JavaScript. No other module uses it.
//!
//! `desktop` is the window, `page` the web page, `js` the JavaScript API of page and package, `command_line` the commands.
//! Natively jobs run on threads (`study::JobThreads`), in the browser on `workers`; `keep` has the texts that stay between starts.

#[cfg(all(feature = "command-line", not(target_arch = "wasm32")))]
pub mod command_line;

#[cfg(all(feature = "app", not(target_arch = "wasm32")))]
pub mod desktop;

#[cfg(all(feature = "js-package", target_arch = "wasm32"))]
pub mod js;

#[cfg(feature = "app")]
mod keep;

#[cfg(all(feature = "app", target_arch = "wasm32"))]
pub mod page;

#[cfg(all(any(feature = "app", feature = "js-package"), target_arch = "wasm32"))]
mod text;

#[cfg(all(any(feature = "app", feature = "js-package"), target_arch = "wasm32"))]
pub mod workers;
