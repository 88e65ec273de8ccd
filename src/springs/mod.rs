//! Spring laws: how hard a spring of the sheet pulls, given the curve `Ef` and Poisson's ratio ν.
//!
//! Pure functions, each beside the equation it comes from. Uses `curve`; used by `sheet`, `solve`
//! and `experiment`.

pub mod coupled;
pub mod paper;
pub mod table;
