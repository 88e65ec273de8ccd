//! Charts as SVG text: run time against error, stability maps, tension tests, measurements.
//!
//! Each chart file lists the axes and elements of its panels.
//!
//! Uses `measurements`, `stability`, `tension`, `work_precision` and the crate `implant-preview-charts`; no files, no clocks, no document. Used by the command line and the
//! JavaScript API.

pub mod measurement;
pub mod stability_map;
pub mod tension;
pub mod work_precision;
