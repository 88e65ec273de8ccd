//! Charts as SVG text, on plotters: maps of scenes, and the page and the panels of all charts.
//!
//! A chart lists the axes and elements of its panels; `panel` draws the panels of all charts, `page` lays out title,
//! panels and legend. `backend`: texts of equal size on every platform. `scene_map`: the chart of a map.
//!
//! Uses `study`; no files, no clocks, no document. Used by the experiments, the app and the command line.

mod backend;
pub mod page;
pub mod panel;
pub mod scene_map;
