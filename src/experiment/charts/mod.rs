//! Charts as SVG text: run time against error, stability maps, tension tests, maps of scenes, measurements.
//!
//! Each chart file lists the axes and elements of its panels; `panel` draws the panels of all charts, `page`
//! lays out title, panels and legend.
//!
//! Uses `study`, `experiment` and `springs`; no files, no clocks, no document. Used by the command line and the
//! JavaScript API.

mod backend;
pub mod measurement;
mod page;
mod panel;
pub mod scene_map;
pub mod stability_map;
pub mod tension;
pub mod work_precision;
