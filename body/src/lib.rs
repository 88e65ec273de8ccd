//! A body's surface: read from a file, marked, fitted by a chest wall and a thickness of tissue, deformed by a solution,
//! measured.
//!
//! Module order: `surface` → `read` → `write`, `pick`, `reduce` | `marks` → `frame`, `grid` → `raster`, `chest` → `field`, `wall`, `quality` → `fit` → `torso` | `deform`, `measures`, `mound`, `propose` → `before_after`.
//! Lengths in mm, f64.

pub mod before_after;
pub mod chest;
pub mod deform;
pub mod field;
pub mod fit;
pub mod frame;
pub mod grid;
mod half;
pub mod marks;
pub mod measures;
pub mod mound;
pub mod pick;
pub mod propose;
pub mod quality;
pub mod raster;
pub mod read;
pub mod reduce;
pub mod surface;
pub mod torso;
mod wall;
pub mod write;
