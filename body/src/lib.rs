//! A body's surface: read from a file, marked, fitted by a chest wall and a thickness of tissue, deformed by a solution,
//! measured.
//!
//! Module order: `surface` → `read`. Lengths in mm, f64.

pub mod read;
pub mod surface;
