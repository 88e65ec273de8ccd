//! Experiments with the spring laws: the paper's stretching of a square sample.
//!
//! Uses the modules before it (`curve`, `springs`); no files, no clocks, no toolkit. Used by the
//! command line and the tests.

mod dense;
pub mod sample;
pub mod tension;
