//! Experiments: the paper's stretching of a square sample, where an evenly stretched sheet is stable,
//! the centred dome without a grid, as a reference, the study of run time against error, stress runs.
//!
//! Uses the modules before it (`curve` … `session`). No
//! files, no clocks, no toolkit. Used by the command line, the JavaScript API and the tests.

pub mod axisymmetric;
#[cfg(feature = "drawing")]
pub mod charts;
mod dense;
pub mod robustness;
pub mod sample;
pub mod stability;
pub mod tension;
pub mod work_precision;
