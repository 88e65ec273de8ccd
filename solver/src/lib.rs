//! The solver of implant-preview: stress–strain curves, spring laws, grids, contact, elastic model, equilibrium and its
//! measured quantities.
//!
//! Module order; imports point left only (`tests/modules.rs`):
//!
//! `number` → `curve` → `springs` → `mesh` → `contact` → `model` → `solve` → `measure` → `export`
//!
//! Units: mm, kPa, N (1 kPa·mm² = 1 mN); angles in radians inside, degrees in results.

pub mod contact;
pub mod curve;
pub mod export;
pub mod measure;
pub mod mesh;
#[doc(hidden)]
pub mod model;
#[doc(hidden)]
pub mod number;
pub mod solve;
pub mod springs;
