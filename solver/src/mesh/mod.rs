//! Grids on the patch's disc.
//!
//! `disc_grid` (nodes and cells, their shapes at rest) | `chest` (the wall at rest), `geodesics` (over it), `height_field` (its heights in f64 and for four f32), `grid` (heights and thickness of a scan), `spline` (a function through samples) | `natural` (the stretch of the skin at rest), `grown` (the growth of its triangles) | `taper` (the edge of the innermost solid) | `weight` (a change of the tissue's weight) | `enclosed` (the volume under the inner face) | `rest` (the tissue at rest: columns of nodes, layers of cells) | `patch` (the simulated tissue, its pocket and its edge) |
//! `stencil` (the sparse matrix of a grid) | `part` (the quarter or half that determines a symmetric shape) | `lanes`, `lane_field`, `vec3` (the same grid and vectors at its nodes for four f32 at a time).
//!
//! Uses `number`. Used by `contact`, `model`, `solve` and all to their right.

mod chest;
mod disc_grid;
pub(crate) mod enclosed;
mod geodesics;
mod grid;
mod grown;
pub(crate) mod height_field;
mod lane_field;
pub(crate) mod lanes;
mod natural;
pub(crate) mod part;
mod patch;
pub(crate) mod rest;
mod spline;
pub(crate) mod stencil;
mod taper;
pub(crate) mod vec3;
mod weight;

pub use chest::Chest;
pub(crate) use disc_grid::coarser_nodes_per_side;
pub use disc_grid::{CELL_TRIANGLES, CellKind, NodeKind, Sheet, rounded_nodes_per_side};
pub use grid::{HeightGrid, ThicknessField};
pub use grown::Grown;
pub use natural::NaturalStretch;
pub use patch::{Attachment, Edge, Patch, Pocket};
pub use rest::{Cells, Rest, Surface, balanced_cells};
pub use taper::Taper;
pub use weight::Weight;
