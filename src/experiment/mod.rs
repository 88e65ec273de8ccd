//! Experiments: the paper's stretching of a square sample, the centred dome without a grid, as a
//! reference, and the study of run time against error.
//!
//! Uses the modules before it (`curve` … `scene`); no files, no clocks, no toolkit. Used by the
//! command line, the JavaScript API and the tests.

pub mod axisymmetric;
mod dense;
pub mod sample;
pub mod stress;
pub mod tension;
pub mod work_precision;
