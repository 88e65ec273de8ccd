//! Experiments: the paper's tension test of a square sample, stability maps of the homogeneous sheet, the
//! axisymmetric reference solutions of the sheet and of layered tissue, errors of all nodes, the study of run time against
//! error, the comparisons with measurements, verification, robustness tests, and charts.
//!
//! Uses the core and its solver (`curve` … `session`) and the charts' page and panels. No files, no clocks, no toolkit. Used by the
//! command line, the JavaScript API and the tests.

pub mod accuracy;
pub mod axisymmetric;
pub mod axisymmetric_layers;
pub mod charts;
mod dense;
pub mod measurements;
pub mod robustness;
pub mod sample;
pub mod stability;
pub mod tension;
pub mod verification;
pub mod work_precision;
