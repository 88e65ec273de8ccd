//! The core of implant-preview: stress–strain curves, spring laws, grids, contact, elastic model, equilibrium and its
//! measured quantities, scenes, studies and the document.
//!
//! Module order; imports point left only (`tests/modules.rs`):
//!
//! `number` → `curve` → `clinical` → `springs` → `mesh` → `contact` → `model` → `solve` → `measure` → `export` → `scene` → `simulate` →
//! `study` → `session`
//!
//! Units: mm, kPa, N (1 kPa·mm² = 1 mN); angles in radians inside, degrees in results.

pub mod clinical;
pub mod contact;
pub mod curve;
pub mod export;
pub mod measure;
pub mod mesh;
#[doc(hidden)]
pub mod model;
#[doc(hidden)]
pub mod number;
pub mod scene;
pub mod session;
pub mod simulate;
pub mod solve;
pub mod springs;
pub mod study;
